#!/usr/bin/env python3
"""animate.py SCENE.glb NODE PATH "T T ..." "X X ...": prints the scene as .glb with one more animated property, PATH
(translation, rotation, scale) of the node of that name: its times, and its numbers key by key."""
import json
import struct
import sys

scene, node, path, times, values = sys.argv[1:]
times, values = ([float(x) for x in text.split()] for text in (times, values))
with open(scene, "rb") as stream:
    data = stream.read()
length, = struct.unpack_from("<I", data, 12)
made, binary = json.loads(data[20:20 + length]), data[28 + length:]


def accessor(numbers, kind):
    """The index of a new one."""
    global binary
    binary += bytes(-len(binary) % 4)
    place, content = len(binary), struct.pack(f"<{len(numbers)}f", *numbers)
    binary += content
    made["bufferViews"].append({"buffer": 0, "byteOffset": place, "byteLength": len(content)})
    count = len(numbers) // {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[kind]
    made["accessors"].append({"bufferView": len(made["bufferViews"]) - 1, "componentType": 5126, "type": kind, "count": count,
                              **({"min": [min(numbers)], "max": [max(numbers)]} if kind == "SCALAR" else {})})
    return len(made["accessors"]) - 1


animation = made.setdefault("animations", [{"channels": [], "samplers": []}])[0]
animation["samplers"].append({"input": accessor(times, "SCALAR"),
                              "output": accessor(values, "VEC4" if path == "rotation" else "VEC3")})
target = {"node": [n.get("name") for n in made["nodes"]].index(node), "path": path}
animation["channels"].append({"sampler": len(animation["samplers"]) - 1, "target": target})
made["buffers"][0]["byteLength"] = len(binary)
text = json.dumps(made, separators=(",", ":")).encode()
text += b" " * (-len(text) % 4)
binary += bytes(-len(binary) % 4)
sys.stdout.buffer.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary)) + struct.pack("<I4s", len(text), b"JSON") +
                        text + struct.pack("<I4s", len(binary), b"BIN\0") + binary)
