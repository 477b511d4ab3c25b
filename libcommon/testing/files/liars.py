"""Files of a few bytes that stand for many: what they declare, or hold by compression, would take far more memory or time
than their size, if a reader believed it."""
import json
import os
import struct
import zlib

import liars_exr


def glb(content, binary):
    text = json.dumps(content, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    binary += bytes(-len(binary) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def scene(nodes, triangles=1, vertices=3):
    """A room of `nodes` nodes of one mesh that emits; what it is, and its buffer."""
    corners = b"".join(struct.pack("<9f", k, 0, 0, k, 1, 0, k + 1, 0, 0) for k in range(triangles))
    corners += struct.pack("<3f", 0, 0, 0) * (vertices - 3)
    count = 3 * triangles + vertices - 3
    indices = struct.pack("<%dI" % (3 * triangles), *range(3 * triangles))
    content = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(nodes + 1))}],
        "nodes": [{"mesh": 0}] * nodes + [{"camera": 0, "translation": [0, 0, 5]}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"emissiveFactor": [1, 1, 1]}], "buffers": [{"byteLength": len(corners) + len(indices)}],
        "bufferViews": [{"buffer": 0, "byteLength": len(corners)},
                        {"buffer": 0, "byteOffset": len(corners), "byteLength": len(indices)}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": count, "type": "VEC3"},
                      {"bufferView": 1, "componentType": 5125, "count": 3 * triangles, "type": "SCALAR"}]}
    return content, corners + indices


def png(width, height, bits, colour, rows, palette=b""):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", width, height, bits, colour, 0, 0, 0))
            + (chunk(b"PLTE", palette) if palette else b"") + chunk(b"IDAT", rows) + chunk(b"IEND", b""))


def jpeg_of_scans(side, count):
    """Grey, progressive: each scan passes over all blocks by runs of 32 767."""
    def segment(kind, data):
        return b"\xff" + bytes([kind]) + struct.pack(">H", len(data) + 2) + data

    def table(kind, symbol):
        return segment(0xc4, bytes([kind, 1]) + bytes(15) + bytes([symbol]))

    blocks = (side // 8) ** 2
    bits = ("0" + 14 * "1") * -(-blocks // 32767)
    bits += "1" * (-len(bits) % 8)
    runs = bytes(int(bits[k:k + 8], 2) for k in range(0, len(bits), 8)).replace(b"\xff", b"\xff\0")
    return (b"\xff\xd8" + segment(0xdb, b"\0" + b"\1" * 64) + segment(0xc2, struct.pack(">B2HB", 8, side, side, 1) + b"\1\x11\0")
            + table(0, 0) + table(0x10, 0xe0) + segment(0xda, b"\1\1\0\0\0\0") + bytes(-(-blocks // 8))
            + (segment(0xda, b"\1\1\0\1\x3f\0") + runs) * count + b"\xff\xd9")


def textured(images):
    content, binary = scene(1)
    content["images"], content["textures"], content["materials"] = [], [], []
    content["bufferViews"].append({"buffer": 0, "byteOffset": len(binary), "byteLength": 24})
    content["accessors"].append({"bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC2"})
    binary += bytes(24)
    primitives = content["meshes"][0]["primitives"] = []
    for k, image in enumerate(images):
        binary += bytes(-len(binary) % 4)
        content["bufferViews"].append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(image)})
        binary += image
        content["images"].append({"bufferView": len(content["bufferViews"]) - 1, "mimeType": "image/png"})
        content["textures"].append({"source": k})
        content["materials"].append({"pbrMetallicRoughness": {"baseColorTexture": {"index": k}}})
        primitives.append({"attributes": {"POSITION": 0, "TEXCOORD_0": 2}, "indices": 1, "material": k})
    content["buffers"][0]["byteLength"] = len(binary)
    return glb(content, binary)


def scenes():
    yield "instances", glb(*scene(20000, 2000))
    content, binary = scene(1)
    content["nodes"] += [content["nodes"][-1]] * 3000
    content["cameras"][0]["name"] = "one"
    content["scenes"][0]["nodes"] = list(range(3002))
    yield "cameras-of-one-name", glb(content, binary)
    content, binary = scene(5000)
    content["extensionsUsed"] = ["ACME_%d" % k for k in range(20000)]
    yield "extensions", glb(content, binary)
    content, binary = scene(1)
    primitive = content["meshes"][0]["primitives"][0]
    content["meshes"][0]["primitives"] = [dict(primitive, attributes={"POSITION": 2 + k}) for k in range(3000)]
    content["accessors"] += [{"componentType": 5126, "count": 150000, "type": "VEC3"}] * 3000
    yield "accessors-of-zeros", glb(content, binary)
    for name, element in (("nodes", "{}"), ("extras", "[]"), ("materials", "{}")):
        yield name, ('{"asset":{"version":"2.0"},"%s":[%s{}]}' % (name, (element + ",") * 100000)).encode()
    yield "nested", b'{"asset":{"version":"2.0"},"extras":' + b"[" * 1000000 + b"]" * 1000000 + b"}"
    bits = zlib.compress(bytes(1025) * 8192, 9)
    yield "texels-of-a-bit", textured([png(8192, 8192, 1, 3, bits, b"\xff\0\0\0\xff\0")] * 4)
    yield "scans", textured([jpeg_of_scans(4096, 40000)])
    yield "texels", textured([png(65535, 65535, 8, 6, zlib.compress(bytes(1 << 18)))])


def portals():
    content, binary = scene(3000, 1, 50000)
    del content["materials"][0]["emissiveFactor"]
    content["nodes"][0] = {"mesh": 0, "name": "portal.0"}
    yield "vertices", glb(content, binary)


def networks():
    yield "nodes", b"p max 2000000000 1\nn 1 s\nn 2 t\na 1 2 1\n"
    yield "nodes-for-nothing", b"p max 1000000 1\nn 1 s\nn 2 t\na 1 2 1\n"
    yield "arcs", b"p max 4 2000000000\nn 1 s\nn 2 t\na 1 2 1\n"
    # Multiples of a number of buckets that a table of 60 000 has.
    patches = b"".join(b"c patch %d 0 0 0 0 1 0 0 0 0 0 1\n" % (k * 62233) for k in range(1, 60000))
    yield "one-bucket", b"c tdpt max 1\n" + patches


def skies():
    head = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4096 +X 8192\n"
    yield "runs", head + (b"\x80\x80\x80\x80\1\1\1\xff\1\1\1\x1f") * 4096
    yield "short", head + bytes(4 * 4096)


def tables():
    """Tables of a light grid with one line."""
    text = "cut,light_x,light_y,light_z,camera_x,camera_y,camera_z\n# tdpt light grid 1\n# grid 0 0 0 1 %s\n0,1,1,0.5,9,9,0.6\n"
    yield "voxels-of-the-header", (text % "512 512 512").encode()
    yield "voxels-in-a-row", (text % "2048 500 1").encode()


def stored(testdata):
    folder = os.path.join(testdata, "liars")
    for name in sorted(os.listdir(folder)):
        if name.endswith(".vdb"):
            with open(os.path.join(folder, name), "rb") as file:
                yield name[:-4], file.read()


def all_of(testdata):
    """(file name, bytes)"""
    for suffix, kind in ((".exr", liars_exr.pictures()), (".glb", scenes()), (".portal.glb", portals()), (".max", networks()),
                         (".hdr", skies()), (".vdb", stored(testdata)), (".csv", tables())):
        for name, data in kind:
            yield name + suffix, data
