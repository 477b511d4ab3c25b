"""Writes OpenEXR pictures, since the distribution has no Python module that does: scanlines, ZIP, channels B G R; and
reads such, whatever wrote them. What is written is half, or float where a value is beyond half's range; the others come
to half's precision there, too, which packs to half the size."""
import struct
import zlib

import numpy as np

HALF_MAX = 65504.0
LINES = 16  # of a ZIP block


def _string(text):
    return text.encode("ascii") + b"\0"


def _attribute(name, kind, data):
    return _string(name) + _string(kind) + struct.pack("<i", len(data)) + data


def _zip(raw):
    """Even bytes before odd ones, differences to the byte before, deflated; as it was where that gains nothing."""
    parted = np.frombuffer(raw, np.uint8)
    parted = np.concatenate([parted[::2], parted[1::2]])
    steps = parted.copy()
    steps[1:] = parted[1:] - parted[:-1] + np.uint8(128)
    packed = zlib.compress(steps.tobytes(), 9)
    return packed if len(packed) < len(raw) else raw


def content(rgb, comments="", **strings):
    """The bytes of the file. `rgb`: height x width x 3, row 0 at the top; strings: more attributes."""
    height, width, channels = rgb.shape
    if channels != 3:
        raise ValueError(f"{channels} channels, expected 3")
    half = not np.abs(rgb).max() > HALF_MAX
    with np.errstate(over="ignore"):
        pixels = rgb.astype("<f2")
    if not half:
        pixels = np.where(np.abs(rgb) > HALF_MAX, rgb, pixels).astype("<f4")
    kinds = b"".join(_string(c) + struct.pack("<iiii", 1 if half else 2, 0, 1, 1) for c in "BGR") + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    head = struct.pack("<2i", 20000630, 2)
    head += _attribute("channels", "chlist", kinds)
    for name, text in {"comments": comments, **strings}.items():
        if text:
            head += _attribute(name, "string", text.encode("utf-8"))
    head += _attribute("compression", "compression", b"\x03")  # ZIP
    head += _attribute("dataWindow", "box2i", window)
    head += _attribute("displayWindow", "box2i", window)
    head += _attribute("lineOrder", "lineOrder", b"\0")
    head += _attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    head += _attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0))
    head += _attribute("screenWindowWidth", "float", struct.pack("<f", 1))
    head += b"\0"
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
    """{name: (type, bytes)}, and where the header ends."""
    found, place = {}, 8

    def word():
        nonlocal place
        start, place = place, data.index(0, place) + 1
        return data[start : place - 1].decode("ascii")

    while data[place]:
        name, kind = word(), word()
        (size,) = struct.unpack_from("<i", data, place)
        found[name] = kind, data[place + 4 : place + 4 + size]
        place += 4 + size
    return found, place + 1


def parse(data, path="picture"):
    """(height x width x 3 of R G B, its string attributes) of the bytes of a file."""
    attributes, place = _attributes(data)
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"][1])
    width, height = right - left + 1, bottom - top + 1
    head = attributes["channels"][1]
    channels = [struct.unpack_from("<2si", head, at) for at in range(0, len(head) - 1, 18)]
    types = {kind for _, kind in channels}
    if [name for name, _ in channels] != [b"B\0", b"G\0", b"R\0"] or len(types) > 1:
        raise ValueError(f"{path}: expected channels B G R alone, of one type")
    if attributes["compression"][1] != b"\x03":
        raise ValueError(f"{path}: expected ZIP compression")
    kind = {1: "<f2", 2: "<f4"}[types.pop()]
    rgb = np.empty((height, width, 3))
    for start in struct.unpack_from(f"<{-(-height // LINES)}Q", data, place):
        y, size = struct.unpack_from("<2i", data, start)
        lines = min(LINES, height - (y - top))
        raw = _unzip(data[start + 8 : start + 8 + size], lines * width * 3 * np.dtype(kind).itemsize)
        rgb[y - top : y - top + lines] = np.frombuffer(raw, kind).reshape(lines, 3, width).transpose(0, 2, 1)[..., ::-1]
    return rgb, {name: value.decode() for name, (kind, value) in attributes.items() if kind == "string"}


def read(path):
    with open(path, "rb") as file:
        return parse(file.read(), path)


def write(path, rgb, comments="", **strings):
    with open(path, "wb") as file:
        file.write(content(rgb, comments, **strings))
