#!/usr/bin/env python3
"""cameras.py SCENE.glb NAME=X,Y,Z ... > scene.gltf: the scene with more cameras, which look along -Z as its first camera's lens does."""

import base64
import json
import sys

data = open(sys.argv[1], "rb").read()
size = int.from_bytes(data[12:16], "little")
gltf, binary = json.loads(data[20 : 20 + size]), data[28 + size :]
gltf["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(binary).decode()
for more in sys.argv[2:]:
    name, place = more.rsplit("=", 1)
    gltf["cameras"].append({**gltf["cameras"][0], "name": name})
    gltf["scenes"][0]["nodes"].append(len(gltf["nodes"]))
    gltf["nodes"].append({"name": name, "camera": len(gltf["cameras"]) - 1, "translation": [float(x) for x in place.split(",")]})
json.dump(gltf, sys.stdout)
