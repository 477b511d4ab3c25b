"""Files .glb: their JSON, and portals as meshes [portal(5)]."""
import json
import os
import struct

import numpy

MAGIC = 0x46546C67
JSON_CHUNK, BINARY_CHUNK = 0x4E4F534A, 0x004E4942


def read(path):
    """(JSON, the chunks behind it)"""
    with open(path, "rb") as file:
        data = file.read()
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20 : 20 + length]), data[20 + length :]


def write(path, document, rest):
    """Replaces the file at once, or not at all."""
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<5I", MAGIC, 2, 20 + len(text) + len(rest), len(text), JSON_CHUNK)
    with open(path + ".new", "wb") as file:
        file.write(head + text + rest)
    os.replace(path + ".new", path)


def read_portals(path):
    """[(name, corners [metres, +Y up], triangles, figures)] of a file of portalfit."""
    document, rest = read(path)

    def rows_of(accessor, kind):
        """Three numbers each, without a stride, as portalfit writes them."""
        accessor = document["accessors"][accessor]
        view = document["bufferViews"][accessor["bufferView"]]
        count = accessor["count"] if accessor["type"] == "VEC3" else accessor["count"] // 3
        at = 8 + view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        return numpy.frombuffer(rest, kind, 3 * count, at).reshape(count, 3)

    portals = []
    for index in document["scenes"][0].get("nodes", []):
        node = document["nodes"][index]
        part = document["meshes"][node["mesh"]]["primitives"][0]
        corners = rows_of(part["attributes"]["POSITION"], "<f4").astype(float) + node.get("translation", (0, 0, 0))
        triangles = rows_of(part["indices"], "<u4").tolist()
        portals.append((node["name"], [tuple(c) for c in corners.tolist()], triangles, node.get("extras", {})))
    return portals


def write_portals(path, portals):
    """portals: [(name, corners [metres, +Y up], triangles)], at least one. Positions are relative to the first corner, so that
    their single precision is fine enough."""
    nodes, meshes, accessors, views, binary = [], [], [], [], b""
    for number, (name, corners, triangles) in enumerate(portals):
        near = (numpy.array(corners) - corners[0]).astype("<f4")
        flat = numpy.array(triangles, "<u4").ravel()
        for data, kind, component, more in (
            (near, "VEC3", 5126, {"min": near.min(0).tolist(), "max": near.max(0).tolist()}), (flat, "SCALAR", 5125, {})):
            views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": data.nbytes})
            accessors.append({"bufferView": len(accessors), "componentType": component, "count": len(data), "type": kind, **more})
            binary += data.tobytes()
        part = {"attributes": {"POSITION": 2 * number}, "indices": 2 * number + 1, "material": 0}
        meshes.append({"primitives": [part]})
        nodes.append({"name": name, "mesh": number, "translation": list(corners[0])})
    document = {
        "asset": {"version": "2.0", "extras": {"tdpt_portal_format": 1}}, "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}],
        "nodes": nodes, "meshes": meshes, "accessors": accessors, "bufferViews": views, "materials": [{"doubleSided": True}],
        "buffers": [{"byteLength": len(binary)}],
    }
    write(path, document, struct.pack("<2I", len(binary), BINARY_CHUNK) + binary)
