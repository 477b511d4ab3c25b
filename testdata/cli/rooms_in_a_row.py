#!/usr/bin/env python3
"""rooms_in_a_row.py GAP: prints a glTF scene of three rooms along x, 2 m each. The lamp hangs in the last, which has a door 0.5 m
wide to the middle one; the door from there to the camera's room, the first, is open by GAP metres, 0 if shut. Floor, ceiling and
side walls are one quad each for all rooms, and walls between rooms have no thickness."""
import json
import os
import subprocess
import sys

gap = float(sys.argv[1])
END = 6


def wall(x, half):
    """Across x, with an opening of 2 * half from the floor to 1.5 m."""
    if half == 0:
        return [[(x, 0, -1), (x, 0, 1), (x, 2, 1), (x, 2, -1)]]
    return [[(x, 0, -1), (x, 0, -half), (x, 2, -half), (x, 2, -1)], [(x, 0, half), (x, 0, 1), (x, 2, 1), (x, 2, half)],
            [(x, 1.5, -half), (x, 1.5, half), (x, 2, half), (x, 2, -half)]]


quads = [[(0, y, -1), (0, y, 1), (END, y, 1), (END, y, -1)] for y in (0, 2)]
quads += [[(0, 0, z), (END, 0, z), (END, 2, z), (0, 2, z)] for z in (-1, 1)]
quads += wall(0, 0) + wall(2, gap / 2) + wall(4, 0.25) + wall(END, 0)
lamp = {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 100}]}}
given = {
    "extensionsUsed": ["KHR_lights_punctual"],
    "extensions": lamp,
    "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}],
    "nodes": [
        {"mesh": 0},
        {"translation": [5, 1.7, 0], "extensions": {"KHR_lights_punctual": {"light": 0}}},
        {"translation": [1.7, 1, 0.7], "rotation": [0, 0.38268343, 0, 0.92387953], "camera": 0},
    ],
}
polygons = [" ".join(",".join(map(str, corner)) for corner in quad) for quad in quads]
script = os.path.join(os.path.dirname(os.path.abspath(__file__)), "polygons.py")
sys.exit(subprocess.call([sys.executable, script, json.dumps(given), *polygons]))
