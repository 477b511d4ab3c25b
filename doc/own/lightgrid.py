#!/usr/bin/env python3
"""lightgrid.py room.glb room.cut > lines.csv: a sampler of lines of one's own, for lightgrid --lines-from.

It draws a pair of patches of the cut [cut(5)] in proportion to its capacity and a point on each, and keeps the segment
if no triangle of the scene blocks it. A patch is taken as a square of its area; the scene's nodes must not be moved.
"""

import json
import sys

import numpy as np

LINES = 8192


def read_triangles(path):
    """Corners [triangle, corner, axis] of a .glb."""
    data = open(path, "rb").read()
    size = int.from_bytes(data[12:16], "little")
    gltf, binary = json.loads(data[20 : 20 + size]), data[28 + size :]

    def array(accessor, width):
        a = gltf["accessors"][accessor]
        view = gltf["bufferViews"][a["bufferView"]]
        start, kind = view.get("byteOffset", 0) + a.get("byteOffset", 0), {5123: "<u2", 5125: "<u4", 5126: "<f4"}
        return np.frombuffer(binary, kind[a["componentType"]], width * a["count"], start).reshape(-1, width)

    parts = [part for mesh in gltf["meshes"] for part in mesh["primitives"]]
    corners = [array(p["attributes"]["POSITION"], 3)[array(p["indices"], 1)] for p in parts]
    return np.concatenate(corners).reshape(-1, 3, 3)


def read_cut(path):
    """The scene's hash; of each node its sides of the cuts, centre, normal and side [m]; pairs of nodes; their capacities."""
    words = [line.split() for line in open(path)]
    scene = next(w[2] for w in words if w[:2] == ["c", "scene"])
    cell = next(float(w[5]) for w in words if w[:2] == ["c", "grid"])
    nodes = {w[1]: np.array(w[3:], float) for w in words if w[0] == "n"}
    sides = {w[1]: w[2] for w in words if w[0] == "n"}
    # A patch has samples in proportion to its area, and most patches fill a cell.
    area = np.median([(cell / 4 ** n[0]) ** 2 / n[4] for n in nodes.values()])
    nodes = {name: (sides[name], n[5:8], n[8:11], np.sqrt(area * n[4])) for name, n in nodes.items()}
    arcs = [w for w in words if w[0] == "a"]
    return scene, nodes, [w[1:3] for w in arcs], np.array([w[3] for w in arcs], float)


def points_on(patches, random):
    centre, normal, side = (np.array([patch[k] for patch in patches]) for k in (1, 2, 3))
    x = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal), axis=1)])
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    u, v = (random.random((2, len(patches))) - 0.5) * side
    return centre + u[:, None] * x + v[:, None] * np.cross(normal, x)


def are_free(a, b, triangles):
    free = np.ones(len(a), bool)
    for p, q, r in triangles.astype(float):
        normal = np.cross(q - p, r - p)
        with np.errstate(divide="ignore", invalid="ignore"):
            t = (p - a) @ normal / ((b - a) @ normal)
            at = a + t[:, None] * (b - a) - p
        u, v = np.cross(at, r - p) @ normal, np.cross(q - p, at) @ normal
        free &= ~((t > 1e-4) & (t < 1 - 1e-4) & (u >= 0) & (v >= 0) & (u + v <= normal @ normal))
    return free


triangles = read_triangles(sys.argv[1])
scene, nodes, pairs, capacity = read_cut(sys.argv[2])
random = np.random.default_rng(1)
drawn = [pairs[k] for k in random.choice(len(pairs), 2 * LINES, p=capacity / capacity.sum())]
light, camera = ([nodes[pair[side]] for pair in drawn] for side in (0, 1))
a, b = points_on(light, random), points_on(camera, random)
# A line crosses the cuts of which it begins on side 0 and ends on side 1; the first of them counts.
cuts = [list(zip(*(patch[0] for patch in ends))).index(("0", "1")) for ends in zip(light, camera)]
rows = np.column_stack([cuts, a, b])[are_free(a, b, triangles)][:LINES]
header = f"cut,light_x,light_y,light_z,camera_x,camera_y,camera_z\n# tdpt light grid 1\n# scene {scene}"
np.savetxt(sys.stdout, rows, delimiter=",", header=header, comments="")
