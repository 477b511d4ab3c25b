"""glTF files: their JSON, and portals as meshes [portal(5)]."""
import json
import os
import struct

MAGIC = 0x46546C67
JSON_CHUNK, BINARY_CHUNK = 0x4E4F534A, 0x004E4942


def read(path):
    """(JSON, the rest of the file's bytes: of a .glb the chunks behind it)"""
    with open(path, "rb") as file:
        data = file.read()
    if not path.endswith(".glb"):
        return json.loads(data), b""
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20 : 20 + length]), data[20 + length :]


def write(path, document, rest=b""):
    """Replaces the file at once, or not at all."""
    if not path.endswith(".glb"):
        text = json.dumps(document, indent="\t").encode()
    else:
        text = json.dumps(document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        head = struct.pack("<5I", MAGIC, 2, 20 + len(text) + len(rest), len(text), JSON_CHUNK)
        text = head + text + rest
    with open(path + ".new", "wb") as file:
        file.write(text)
    os.replace(path + ".new", path)


def numbers(document, binary, accessor, form, width):
    """The tuples of an accessor without a stride, as portalfit writes them. `form`: of struct, of one number."""
    accessor = document["accessors"][accessor]
    view = document["bufferViews"][accessor["bufferView"]]
    at = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    flat = struct.unpack_from(f"<{accessor['count'] * width}{form}", binary, at)
    return [flat[i : i + width] for i in range(0, len(flat), width)]


def read_portals(path):
    """[(name, corners [metres, +Y up], triangles, figures)] of a file of portalfit."""
    document, rest = read(path)
    binary = rest[8:]
    portals = []
    for index in document["scenes"][0].get("nodes", []):
        node = document["nodes"][index]
        part = document["meshes"][node["mesh"]]["primitives"][0]
        origin = node.get("translation", (0, 0, 0))
        corners = [
            tuple(a + b for a, b in zip(corner, origin))
            for corner in numbers(document, binary, part["attributes"]["POSITION"], "f", 3)
        ]
        flat = [i for (i,) in numbers(document, binary, part["indices"], "I", 1)]
        triangles = [tuple(flat[i : i + 3]) for i in range(0, len(flat), 3)]
        portals.append((node["name"], corners, triangles, node.get("extras", {})))
    return portals


def write_portals(path, portals):
    """portals: [(name, corners [metres, +Y up], triangles)]. Positions are relative to the first corner, so that their single
    precision is fine enough."""
    binary, document = b"", {
        "asset": {"version": "2.0", "extras": {"tdpt_portal_format": 1}},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(portals)))} if portals else {}],
    }
    lists = {key: [] for key in ("nodes", "meshes", "accessors", "bufferViews")}

    def add(data, kind, count, component, **more):
        nonlocal binary
        lists["bufferViews"].append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(data)})
        lists["accessors"].append(
            {"bufferView": len(lists["bufferViews"]) - 1, "componentType": component, "count": count, "type": kind, **more}
        )
        binary += data
        return len(lists["accessors"]) - 1

    for name, corners, triangles in portals:
        origin = corners[0]
        near = [tuple(a - b for a, b in zip(corner, origin)) for corner in corners]
        flat = [i for triangle in triangles for i in triangle]
        single = [struct.unpack("<3f", struct.pack("<3f", *corner)) for corner in near]
        position = add(
            b"".join(struct.pack("<3f", *corner) for corner in near), "VEC3", len(near), 5126,
            min=[min(c[i] for c in single) for i in range(3)], max=[max(c[i] for c in single) for i in range(3)],
        )
        index = add(struct.pack(f"<{len(flat)}I", *flat), "SCALAR", len(flat), 5125)
        lists["meshes"].append({"primitives": [{"attributes": {"POSITION": position}, "indices": index, "material": 0}]})
        lists["nodes"].append({"name": name, "mesh": len(lists["meshes"]) - 1, "translation": list(origin)})
    if portals:
        document.update(lists, buffers=[{"byteLength": len(binary)}], materials=[{"doubleSided": True}])
    chunk = struct.pack("<2I", len(binary), BINARY_CHUNK) + binary if binary else b""
    write(path, document, chunk)
