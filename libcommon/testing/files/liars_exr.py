"""OpenEXR pictures that declare more than they hold, and pictures of zeros, which are small and whole."""
import json
import struct
import zlib

NONE, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA, DWAB = range(10)
ROWS = (1, 1, 1, 16, 32, 16, 32, 32, 32, 256)  # of a chunk
TILED, PARTS = 0x200, 0x1000


def attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<I", len(value)) + value


def header(width, height, channels, compression, shown=None, more=b"", pixel_type=2):
    """channels: names; shown: width and height of the display window."""
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    display = struct.pack("<4i", 0, 0, shown[0] - 1, shown[1] - 1) if shown else window
    listed = b"".join(c.encode() + b"\0" + struct.pack("<4i", pixel_type(c) if callable(pixel_type) else pixel_type, 0, 1, 1)
                      for c in sorted(channels))
    return (attribute("channels", "chlist", listed + b"\0") + attribute("compression", "compression", bytes([compression]))
            + attribute("dataWindow", "box2i", window) + attribute("displayWindow", "box2i", display)
            + attribute("lineOrder", "lineOrder", b"\0") + attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
            + attribute("screenWindowCenter", "v2f", bytes(8)) + attribute("screenWindowWidth", "float", struct.pack("<f", 1))
            + more + b"\0")


def tiles(x, y, mode=0):
    return attribute("tiles", "tiledesc", struct.pack("<2IB", x, y, mode))


def part(k, kind, chunks):
    return (attribute("name", "string", b"%d" % k) + attribute("type", "string", kind)
            + attribute("chunkCount", "int", struct.pack("<i", chunks)))


def layers(count):
    return [name + c for name in [""] + ["%d." % k for k in range(1, count)] for c in "RGB"]


def file_of(*headers, flags=0, behind=b""):
    end = b"\0" if flags & PARTS else b""
    return b"\x76\x2f\x31\x01" + struct.pack("<I", 2 | flags) + b"".join(headers) + end + behind


def scan_lines(height, compression, head, chunk_of):
    """With all chunks; chunk_of(rows): the bytes of one."""
    count = -(-height // ROWS[compression])
    at, table, chunks = len(head) + 8 * count, b"", []
    for k in range(count):
        data = chunk_of(min(ROWS[compression], height - k * ROWS[compression]))
        table += struct.pack("<Q", at)
        chunks.append(struct.pack("<2i", k * ROWS[compression], len(data)) + data)
        at += len(chunks[-1])
    return head + table + b"".join(chunks)


def black(width, height, channels, **how):
    """Whole, and deflated as far as it goes."""
    known = {}

    def chunk(rows):
        if rows not in known:
            known[rows] = zlib.compress(b"\0" + b"\x80" * (4 * width * len(channels) * rows - 1), 9)
        return known[rows]

    return scan_lines(height, ZIP, file_of(header(width, height, channels, ZIP, **how)), chunk)


FILM_LAYERS = ["layer%d" % k for k in range(8)]


def film_channels():
    sums = ["sum.%s.%d" % (c, k) for c in "RGB" for k in range(4)]
    return list("RGB") + sums + [layer + "." + s for layer in FILM_LAYERS for s in sums]


def film_facts(width, height):
    facts = {"format": 1, "width": width, "height": height, "unit": -62, "layers": FILM_LAYERS, "alpha": False,
             "halves": False, "blocks": 0, "before": False, "channels": [], "derived": [], "spp": 4, "processor": "",
             "plan": "", "state": "", "ranges": [[0, 4]], "shape": {}, "counts": {}}
    return attribute("film", "string", json.dumps({"hash": "", "facts": json.dumps(facts)}).encode())


def film(width, height, whole):
    """432 bytes a pixel, of zeros, or none of them."""
    how = {"more": film_facts(width, height), "pixel_type": lambda c: 2 if c in "RGB" else 0}
    if whole:
        return black(width, height, film_channels(), **how)
    return file_of(header(width, height, film_channels(), ZIP, **how), behind=bytes(8 * -(-height // 16)))


def pictures():
    """(name, bytes)"""
    def declared(width, height, channels, compression, **how):
        return file_of(header(width, height, channels, compression, **how), behind=bytes(8 * -(-height // ROWS[compression])))

    for count, width in ((20, 16384), (680, 4096)):
        yield "%d-layers" % count, declared(width, 256, layers(count), ZIP)
    for name, compression in (("rle", RLE), ("zip", ZIP), ("piz", PIZ), ("pxr24", PXR24), ("b44", B44), ("dwaa", DWAA), ("dwab", DWAB)):
        yield "nothing-" + name, declared(8192, 4096, layers(1), compression)
        yield "empty-chunks-" + name, scan_lines(4096, compression, file_of(header(8192, 4096, layers(1), compression)),
                                                 lambda rows: b"")
    yield "dwab-wide", declared(32768, 256, layers(2), DWAB)
    yield "channels", declared(16, 16, layers(1) + ["c%d" % k for k in range(20000)], ZIP)
    yield "small-in-large", black(16, 16, layers(1), shown=(65536, 8192))
    yield "layers-in-large", black(16, 16, layers(20), shown=(8192, 4096))
    for name, size, tile in (("tiles-1", (65536, 65536), (1, 1)), ("tiles-ripmap", (65536, 65536), (1, 1, 2)),
                             ("tiles-mipmap", (65536, 65536), (65536, 1024, 1)), ("tile-large", (8192, 8192), (8192, 2700)),
                             ("tile-high", (16, 16), (16, 1 << 26)), ("tiles-million", (1000, 1000), (1, 1))):
        yield name, file_of(header(*size, layers(1), ZIP, more=tiles(*tile)), flags=TILED, behind=bytes(64))
    yield "parts-tiled", file_of(*(header(1000, 1000, layers(1), ZIP, more=tiles(1, 1) + part(k, b"tiledimage", 1000000))
                                   for k in range(200)), flags=PARTS)
    yield "parts", file_of(*(header(65536, 65536, layers(1), NONE, more=part(k, b"scanlineimage", 65536)) for k in range(200)),
                           flags=PARTS, behind=bytes(8 * 65536))
    yield "chunk-count", file_of(header(16, 16, layers(1), NONE, more=part(0, b"scanlineimage", 0x7fffffff)), flags=PARTS,
                                 behind=bytes(100))
    yield "deep", file_of(header(65536, 65536, layers(1), ZIPS, more=part(0, b"deepscanline", 65536)
                                 + attribute("version", "int", struct.pack("<i", 1))), flags=PARTS, behind=bytes(100))
    yield "preview", file_of(header(16, 16, layers(1), NONE, more=attribute("preview", "preview", struct.pack("<2I", 65535, 16000)
                                                                              + bytes(16))), behind=bytes(128))
    yield "black", black(4096, 4096, layers(1))
    yield "film-of-nothing", film(8192, 8192, whole=False)
    yield "film-of-zeros", film(800, 800, whole=True)  # 271 MiB; 192 are borne
