#!/usr/bin/env python3
"""polygons.py JSON "X,Y,Z X,Y,Z X,Y,Z ..." ...: prints a glTF scene of one mesh, convex polygons cut into triangles from their first
corners. Members of JSON (materials, cameras, nodes, ...) stand beside the mesh, or in place of what is made here."""
import base64
import json
import struct
import sys

corners = []
for polygon in sys.argv[2:]:
    first, *rest = [[float(x) for x in corner.split(",")] for corner in polygon.split()]
    for pair in zip(rest, rest[1:]):
        corners += [first, *pair]
data = b"".join(struct.pack("<3f", *corner) for corner in corners)
given = json.loads(sys.argv[1])
nodes = given.get("nodes", [{"mesh": 0}])
made = {
    "asset": {"version": "2.0"},
    "scene": 0,
    "scenes": [{"nodes": list(range(len(nodes)))}],
    "nodes": nodes,
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, **({"material": 0} if "materials" in given else {})}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": len(corners),
                   "min": [min(axis) for axis in zip(*corners)], "max": [max(axis) for axis in zip(*corners)]}],
    "bufferViews": [{"buffer": 0, "byteLength": len(data)}],
    "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}],
}
print(json.dumps({**made, **given}, separators=(",", ":")))
