"""Writes OpenEXR pictures, since the distribution has no Python module that does: scanlines, ZIP, channels B G R. They
are half, or float where a value is beyond half's range; the others come to half's precision there, too, which packs to
half the size."""
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


def content(rgb, comments=""):
    """The bytes of the file. `rgb`: height x width x 3, row 0 at the top."""
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
    if comments:
        head += _attribute("comments", "string", comments.encode("ascii"))
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


def write(path, rgb, comments=""):
    with open(path, "wb") as file:
        file.write(content(rgb, comments))
