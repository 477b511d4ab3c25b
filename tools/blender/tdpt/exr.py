"""Reads the pictures of tdpt-render: OpenEXR in scan lines, uncompressed or ZIP."""
import struct
import zlib

import numpy

LINES = {0: 1, 2: 1, 3: 16}  # of a block, by compression: none, ZIPS, ZIP
TYPES = {0: numpy.uint32, 1: numpy.float16, 2: numpy.float32}


def string_at(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode("utf-8", "replace"), end + 1


def header(data):
    """(attributes as bytes, where the table of blocks begins)"""
    found, at = {}, 8
    while data[at]:
        name, at = string_at(data, at)
        _, at = string_at(data, at)
        size = struct.unpack_from("<I", data, at)[0]
        found[name] = data[at + 4 : at + 4 + size]
        at += 4 + size
    return found, at + 1


def channels_in(attribute):
    channels, at = [], 0
    while attribute[at]:
        name, at = string_at(attribute, at)
        channels.append((name, TYPES[struct.unpack_from("<i", attribute, at)[0]]))
        at += 16
    return channels


def unpacked(block, size):
    """ZIP of OpenEXR: bytes as differences, even ones first."""
    if len(block) == size:
        return block
    sums = numpy.cumsum(numpy.frombuffer(zlib.decompress(block), numpy.uint8).astype(numpy.int64) - 128)
    whole = numpy.empty(size, numpy.uint8)
    whole[0::2], whole[1::2] = numpy.split((sums + 128 & 255).astype(numpy.uint8), [(size + 1) // 2])
    return whole.tobytes()


def read(path, wanted):
    """{name: array [height, width], first row at the top} of those channels that are there. Raises ValueError."""
    with open(path, "rb") as file:
        data = file.read()
    try:
        attributes, at = header(data)
        lines = LINES[attributes["compression"][0]]
        left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"])
        width, height = right - left + 1, bottom - top + 1
        row = numpy.dtype([(name, kind, width) for name, kind in channels_in(attributes["channels"])])
        whole = numpy.zeros(height, row)
        for place in struct.unpack_from(f"<{-(-height // lines)}Q", data, at):
            y, size = struct.unpack_from("<2i", data, place)
            rows = min(lines, bottom + 1 - y)
            block = unpacked(data[place + 8 : place + 8 + size], rows * row.itemsize)
            whole[y - top : y - top + rows] = numpy.frombuffer(block, row, rows)
        return {name: whole[name] for name in row.names if name in wanted}
    except (struct.error, zlib.error, IndexError, KeyError) as error:
        raise ValueError(f"{path}: is damaged, or no OpenEXR file that is read") from error
