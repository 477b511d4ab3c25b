"""Files that the distribution has no Python module for. OpenEXR pictures: scanlines, ZIP, channels B G R; what is
written is half, or float where a value is beyond half's range; the others come to half's precision there, too, which
packs to half the size. And glTF binaries: made-up ones, portals at known places."""
import json
import struct
import zlib
from pathlib import Path

import numpy as np

HALF_MAX = 65504.0
LINES, ZIP = 16, b"\x03"  # of a block; the kind of compression


def _attribute(name, kind, data):
    return f"{name}\0{kind}\0".encode("ascii") + struct.pack("<i", len(data)) + data


def _zip(raw):
    """Even bytes before odd ones, differences to the byte before, deflated; as it was where that gains nothing."""
    parted = np.frombuffer(raw, np.uint8)
    parted = np.concatenate([parted[::2], parted[1::2]])
    steps = parted.copy()
    steps[1:] = parted[1:] - parted[:-1] + np.uint8(128)
    packed = zlib.compress(steps.tobytes(), 9)
    return packed if len(packed) < len(raw) else raw


def exr_content(rgb):
    """The bytes of the file. `rgb`: height x width x 3, row 0 at the top."""
    height, width, channels = rgb.shape
    if channels != 3:
        raise ValueError(f"{channels} channels, expected 3")
    half = np.abs(rgb).max() <= HALF_MAX
    with np.errstate(over="ignore"):
        pixels = rgb.astype("<f2")
    if not half:
        pixels = np.where(np.abs(rgb) > HALF_MAX, rgb, pixels).astype("<f4")
    kinds = b"".join(struct.pack("<2s4i", c, 1 if half else 2, 0, 1, 1) for c in (b"B", b"G", b"R")) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    head = struct.pack("<2i", 20000630, 2) + b"".join(_attribute(*of) for of in (
        ("channels", "chlist", kinds),
        ("compression", "compression", ZIP), ("dataWindow", "box2i", window), ("displayWindow", "box2i", window),
        ("lineOrder", "lineOrder", b"\0"), ("pixelAspectRatio", "float", struct.pack("<f", 1)),
        ("screenWindowCenter", "v2f", bytes(8)), ("screenWindowWidth", "float", struct.pack("<f", 1)))) + b"\0"
    blocks = []
    for y in range(0, height, LINES):
        packed = _zip(np.ascontiguousarray(pixels[y : y + LINES, :, ::-1].transpose(0, 2, 1)).tobytes())
        blocks.append(struct.pack("<2i", y, len(packed)) + packed)
    places = len(head) + 8 * len(blocks) + np.cumsum([0] + [len(b) for b in blocks[:-1]])
    return head + places.astype("<u8").tobytes() + b"".join(blocks)


def _unzip(packed, size):
    if len(packed) == size:
        return packed
    steps = np.frombuffer(zlib.decompress(packed), np.uint8)
    parted = np.cumsum(steps - np.uint8(128), dtype=np.uint8) + np.uint8(128)
    raw = np.empty(size, np.uint8)
    raw[::2], raw[1::2] = parted[: (size + 1) // 2], parted[(size + 1) // 2 :]
    return raw.tobytes()


def _attributes(data):
    """{name: bytes}, and where the header ends."""
    found, place = {}, 8
    while data[place]:
        name, kind, rest = data[place:].split(b"\0", 2)
        place += len(name) + len(kind) + 6
        (size,) = struct.unpack_from("<i", rest)
        found[name.decode()] = rest[4 : 4 + size]
        place += size
    return found, place + 1


def _channels(head):
    """[(name, bytes per number)] of the attribute `channels`."""
    found = []
    while head[0]:
        name, rest = head.split(b"\0", 1)
        found.append((name.decode(), 2 if struct.unpack_from("<i", rest)[0] == 1 else 4))
        head = rest[16:]
    return found


def exr_parse(data, path="picture"):
    """Height x width x 3 of R G B, of the bytes of a file; what else it has is left out."""
    attributes, place = _attributes(data)
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    channels = _channels(attributes["channels"])
    if not {"R", "G", "B"} <= {name for name, _ in channels}:
        raise ValueError(f"{path}: expected channels B G R")
    if attributes["compression"] != ZIP:
        raise ValueError(f"{path}: expected ZIP compression")
    line = sum(size for _, size in channels) * width
    rgb = np.empty((height, width, 3))
    for start in struct.unpack_from(f"<{-(-height // LINES)}Q", data, place):
        y, size = struct.unpack_from("<2i", data, start)
        lines = min(LINES, height - (y - top))
        raw = np.frombuffer(_unzip(data[start + 8 : start + 8 + size], lines * line), np.uint8).reshape(lines, line)
        at = 0
        for name, size in channels:
            if name in ("R", "G", "B"):
                part = np.ascontiguousarray(raw[:, at : at + size * width]).view("<f2" if size == 2 else "<f4")
                rgb[y - top : y - top + lines, :, "RGB".index(name)] = part
            at += size * width
    return rgb


def exr_read(path):
    return exr_parse(Path(path).read_bytes(), path)


def exr_write(path, rgb):
    Path(path).write_bytes(exr_content(rgb))


# ---- glTF binaries ----
FLOAT, SHORTS, INTEGERS = 5126, 5123, 5125
TYPES = {5121: "<u1", SHORTS: "<u2", INTEGERS: "<u4", FLOAT: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


def glb_parse(data):
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


def glb_content(document, binary):
    """A glTF binary; of no bytes, without a second chunk."""
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    binary += bytes(-len(binary) % 4)
    if binary:
        binary = struct.pack("<I4s", len(binary), b"BIN\0") + binary
    size = 20 + len(text) + len(binary)
    return struct.pack("<4sIII4s", b"glTF", 2, size, len(text), b"JSON") + text + binary


class Builder:
    """A .glb that grows, mesh by mesh; a node for each."""

    def __init__(self):
        self.chunks, self.size = [], 0
        self.json = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{}]}

    def add(self, kind, content):
        """The index of what is one more of the document's `kind`."""
        self.json.setdefault(kind, []).append(content)
        return len(self.json[kind]) - 1

    def accessor(self, values, component, kind, **more):
        data = np.ascontiguousarray(values, TYPES[component]).tobytes()
        view = self.add("bufferViews", {"buffer": 0, "byteOffset": self.size, "byteLength": len(data)})
        self.chunks.append(data + b"\0" * (-len(data) % 4))
        self.size += len(self.chunks[-1])
        return self.add("accessors", {"bufferView": view, "componentType": component, "count": len(values),
                                      "type": kind, **more})

    def node(self, content):
        self.json["scenes"][0].setdefault("nodes", []).append(self.add("nodes", content))

    def mesh(self, places, corners=None, normals=None, material=None, **node):
        """Triangles, three corners each; without corners three places each."""
        places = np.asarray(places, "<f4")
        ends = {"min": places.min(0).tolist(), "max": places.max(0).tolist()}
        primitive = {"attributes": {"POSITION": self.accessor(places, FLOAT, "VEC3", **ends)}}
        if normals is not None:
            primitive["attributes"]["NORMAL"] = self.accessor(normals, FLOAT, "VEC3")
        if corners is not None:
            primitive["indices"] = self.accessor(np.ravel(corners), INTEGERS, "SCALAR")
        if material is not None:
            primitive["material"] = material
        self.node({"mesh": self.add("meshes", {"primitives": [primitive]}), **node})

    def polygon(self, corners, name):
        """A flat one, as a fan of triangles."""
        self.mesh(corners, [i for k in range(1, len(corners) - 1) for i in (0, k, k + 1)], name=name)

    def diffuse(self, colour, **more):
        """A material that reflects evenly and nothing else; its index."""
        self.json["extensionsUsed"] = ["KHR_materials_emissive_strength", "KHR_materials_specular"]
        extensions = {"KHR_materials_specular": {"specularFactor": 0}, **more.pop("extensions", {})}
        surface = {"baseColorFactor": [*colour, 1], "metallicFactor": 0, "roughnessFactor": 1}
        return self.add("materials", {"pbrMetallicRoughness": surface, "extensions": extensions, **more})

    def content(self):
        if self.size:
            self.json["buffers"] = [{"byteLength": self.size}]
        return glb_content(self.json, b"".join(self.chunks))


def portals_glb(rectangles):
    """A portal file of (corner, edge, edge), a mesh each; the light goes along edge x edge."""
    builder = Builder()
    for i, rectangle in enumerate(rectangles):
        corner, u, v = (np.array(x, float) for x in rectangle)
        builder.polygon([corner, corner + u, corner + u + v, corner + v], f"portal.{i}")
    return builder.content()


def gltf_array(document, binary, index):
    """Of an accessor; views on the binary, or copies where it is interleaved."""
    accessor = document["accessors"][index]
    view = document["bufferViews"][accessor["bufferView"]]
    kind, width, count = np.dtype(TYPES[accessor["componentType"]]), WIDTHS[accessor["type"]], accessor["count"]
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    stride = view.get("byteStride", kind.itemsize * width)
    rows = np.lib.stride_tricks.as_strided(np.frombuffer(binary, np.uint8)[start:], (count, kind.itemsize * width),
                                           (stride, 1))
    return np.ascontiguousarray(rows).view(kind).reshape(count, width)


def _matrix(node):
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    *axis, w = node.get("rotation", (0, 0, 0, 1))
    turn = np.array([v + 2 * np.cross(axis, np.cross(axis, v) + w * v) for v in np.eye(3)]).T
    m = np.eye(4)
    m[:3, :3] = turn * np.array(node.get("scale", (1, 1, 1)), float)
    m[:3, 3] = node.get("translation", (0, 0, 0))
    return m


def placed(document, nodes, above):
    """(node, its matrix to the world) of all that these nodes show."""
    for index in nodes:
        node = document["nodes"][index]
        matrix = above @ _matrix(node)
        yield node, matrix
        yield from placed(document, node.get("children", ()), matrix)
