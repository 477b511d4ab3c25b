"""Small changes to glTF binaries: portals at known places, and scenes without their smallest triangles."""
import json
import struct

import numpy as np

FLOAT, ARRAY, ELEMENTS = 5126, 34962, 34963
TYPES = {5121: "<u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


def parse(data):
    """(document, binary chunk)"""
    magic, version, _ = struct.unpack_from("<4sII", data)
    if magic != b"glTF" or version != 2:
        raise ValueError("no glTF 2.0 binary")
    chunks, place = {}, 12
    while place < len(data):
        size, kind = struct.unpack_from("<I4s", data, place)
        chunks[kind] = data[place + 8 : place + 8 + size]
        place += 8 + size
    return json.loads(chunks[b"JSON"]), chunks.get(b"BIN\0", b"")


def content(document, binary):
    """A glTF binary; of no bytes, without a second chunk."""
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    if binary:
        binary = struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return (struct.pack("<4sII", b"glTF", 2, 20 + len(text) + len(binary)) + struct.pack("<I4s", len(text), b"JSON") + text
            + binary)


def portals(rectangles):
    """Of (corner, edge, edge), a mesh each; the light goes along edge x edge."""
    if not rectangles:
        return content({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{}]}, b"")
    document = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(rectangles)))}],
                "nodes": [], "meshes": [], "accessors": [], "bufferViews": []}
    binary = b""
    for i, rectangle in enumerate(rectangles):
        corner, u, v = (np.array(x, float) for x in rectangle)
        positions = np.array([corner, corner + u, corner + u + v, corner + v], "<f4")
        for view, bytes_of, accessor in (
                (ARRAY, positions.tobytes(), {"componentType": FLOAT, "count": 4, "type": "VEC3",
                                              "min": positions.min(0).tolist(), "max": positions.max(0).tolist()}),
                (ELEMENTS, np.array([0, 1, 2, 0, 2, 3], "<u2").tobytes(), {"componentType": 5123, "count": 6,
                                                                          "type": "SCALAR"})):
            document["bufferViews"].append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(bytes_of),
                                            "target": view})
            document["accessors"].append({"bufferView": len(document["bufferViews"]) - 1, **accessor})
            binary += bytes_of + b"\0" * (-len(bytes_of) % 4)
        document["meshes"].append({"primitives": [{"attributes": {"POSITION": 2 * i}, "indices": 2 * i + 1}]})
        document["nodes"].append({"mesh": i, "name": f"portal.{i}"})
    document["buffers"] = [{"byteLength": len(binary)}]
    return content(document, binary)


def array(document, binary, index):
    """Of an accessor; views on the binary, or copies where it is interleaved."""
    accessor = document["accessors"][index]
    view = document["bufferViews"][accessor["bufferView"]]
    kind, width, count = np.dtype(TYPES[accessor["componentType"]]), WIDTHS[accessor["type"]], accessor["count"]
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    stride = view.get("byteStride", kind.itemsize * width)
    rows = np.lib.stride_tricks.as_strided(np.frombuffer(binary, np.uint8)[start:], (count, kind.itemsize * width), (stride, 1))
    return np.ascontiguousarray(rows).view(kind).reshape(count, width)


def _matrix(node):
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    x, y, z, w = node.get("rotation", (0, 0, 0, 1))
    turn = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
    m = np.eye(4)
    m[:3, :3] = turn * np.array(node.get("scale", (1, 1, 1)), float)
    m[:3, 3] = node.get("translation", (0, 0, 0))
    return m


def _placed(document):
    """(node, its matrix to the world) of all that a scene shows."""
    found = []

    def visit(index, above):
        node = document["nodes"][index]
        matrix = above @ _matrix(node)
        found.append((node, matrix))
        for child in node.get("children", ()):
            visit(child, matrix)

    for root in document["scenes"][document.get("scene", 0)]["nodes"]:
        visit(root, np.eye(4))
    return found


def simplified(data, share):
    """The scene without its smallest triangles, which make at most `share` of the area (paper, 4.1); what emits stays. A mesh
    that several nodes show loses those that are small where it is largest. And: how many of how many are gone."""
    document, binary = parse(data)
    largest = {}  # of each primitive: areas, the most of all nodes
    for node, matrix in _placed(document):
        if "mesh" not in node:
            continue
        for p, primitive in enumerate(document["meshes"][node["mesh"]]["primitives"]):
            if primitive.get("mode", 4) != 4 or "indices" not in primitive or _emits(document, primitive):
                continue
            corners = array(document, binary, primitive["attributes"]["POSITION"]).astype(float) @ matrix[:3, :3].T
            a, b, c = (corners[array(document, binary, primitive["indices"]).reshape(-1, 3)[:, i]] for i in range(3))
            areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
            key = node["mesh"], p
            largest[key] = np.maximum(largest.get(key, 0), areas)
    all_areas = np.sort(np.concatenate(list(largest.values())))
    gone = np.searchsorted(np.cumsum(all_areas), share * all_areas.sum(), side="right")
    least = all_areas[min(gone, len(all_areas) - 1)]
    binary = bytearray(binary)
    dropped = 0
    for (mesh, p), areas in largest.items():
        primitive = document["meshes"][mesh]["primitives"][p]
        indices = array(document, bytes(binary), primitive["indices"]).reshape(-1, 3)
        kept = areas >= least
        if not kept.any():  # glTF has no empty primitives
            kept[np.argmax(areas)] = True
        dropped += int((~kept).sum())
        new = indices[kept].astype("<u4").tobytes()
        document["bufferViews"].append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(new), "target": ELEMENTS})
        document["accessors"].append({"bufferView": len(document["bufferViews"]) - 1, "componentType": 5125,
                                      "count": 3 * int(kept.sum()), "type": "SCALAR"})
        primitive["indices"] = len(document["accessors"]) - 1
        binary += new
    document["buffers"][0]["byteLength"] = len(binary)
    return content(document, bytes(binary)), dropped, len(all_areas)


def _emits(document, primitive):
    if "material" not in primitive:
        return False
    return any(document["materials"][primitive["material"]].get("emissiveFactor", (0,)))
