"""panes.py FOLDER: a room with one window of three by two panes, its bars 4 cm or 20 cm wide: panes-4.gltf,
panes-20.gltf, to be lit by an environment; and its portals, one for all panes, one a column or one a pane:
panes-4-one.gltf, panes-4-three.gltf, panes-4-six.gltf, ..."""
import base64
import json
import os
import sys

import numpy as np

import sky_rooms

LOW, HIGH = (0.7, -1.1), (2.3, 1.1)  # of the window, y and z
COLUMNS, ROWS = 3, 2
WALL = 2.1  # x of the middle of the wall, where bars and portals are
DEPTH = 0.06  # of the bars


def panes(bar):
    """Corners (low, high) of each pane, y and z."""
    sides = [((HIGH[i] - LOW[i]) - (n - 1) * bar) / n for i, n in ((0, ROWS), (1, COLUMNS))]
    lows = [(LOW[0] + r * (sides[0] + bar), LOW[1] + c * (sides[1] + bar)) for r in range(ROWS) for c in range(COLUMNS)]
    return [(low, (low[0] + sides[0], low[1] + sides[1])) for low in lows]


def columns(bar):
    return [((LOW[0], low[1]), (HIGH[0], high[1])) for low, high in panes(bar)[:COLUMNS]]


def room(bar):
    r = sky_rooms.Room((-1.6, 1.5, 2.1), (0.9, 1.0, -1.0), 1.1)
    sky_rooms.shell(r, 2, 2.5, 2.6, {"+x": [((1, LOW[0], LOW[1]), (3, HIGH[0], HIGH[1]))]}, {"-z": sky_rooms.GREEN})
    r.block((-20, -0.4, -20), (20, -0.1, 20), sky_rooms.GROUND)
    r.block((-0.4, -0.03, -2.2), (1.2, 0.75, -1.4))
    (y, z), (top, right) = panes(bar)[0]
    x = (WALL - DEPTH / 2, WALL + DEPTH / 2)
    for row in range(1, ROWS):
        low = top + (row - 1) * (top - y + bar)
        r.block((x[0], low, LOW[1] - 0.01), (x[1], low + bar, HIGH[1] + 0.01))
    for column in range(1, COLUMNS):  # 1 cm less deep: no two faces in one plane
        low = right + (column - 1) * (right - z + bar)
        r.block((x[0] + 0.005, LOW[0] - 0.01, low), (x[1] - 0.005, HIGH[0] + 0.01, low + bar))
    return r


def portals(rectangles):
    """A portal file: rectangles (low, high), y and z, in the middle of the wall; light goes to -x."""
    corners = np.array([(WALL, *at) for (y, z), (top, right) in rectangles for at in ((y, z), (y, right), (top, right), (top, z))],
                       "<f4")
    order = np.array([0, 1, 2, 0, 2, 3], "<u4")
    data = corners.tobytes() + order.tobytes()
    n = len(rectangles)
    views = [{"buffer": 0, "byteOffset": 48 * i, "byteLength": 48} for i in range(n)]
    accessors = [{"bufferView": i, "componentType": 5126, "type": "VEC3", "count": 4,
                  "min": corners[4 * i : 4 * i + 4].min(0).tolist(), "max": corners[4 * i : 4 * i + 4].max(0).tolist()}
                 for i in range(n)]
    views.append({"buffer": 0, "byteOffset": 48 * n, "byteLength": 24})
    accessors.append({"bufferView": n, "componentType": 5125, "type": "SCALAR", "count": 6})
    return json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(n))}],
        "nodes": [{"mesh": i, "name": f"portal.{i}"} for i in range(n)],
        "meshes": [{"primitives": [{"attributes": {"POSITION": i}, "indices": n}]} for i in range(n)],
        "accessors": accessors, "bufferViews": views,
        "buffers": [{"byteLength": len(data),
                     "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode("ascii")}]})


def main():
    for centimetres in (4, 20):
        bar = centimetres / 100
        for name, text in (("", room(bar).gltf()), ("-one", portals([(LOW, HIGH)])), ("-three", portals(columns(bar))),
                           ("-six", portals(panes(bar)))):
            with open(os.path.join(sys.argv[1], f"panes-{centimetres}{name}.gltf"), "w", encoding="ascii") as file:
                file.write(text)


if __name__ == "__main__":
    main()
