"""liars_test.py BIN TESTDATA: files of a few bytes stand for many: what they declare, or hold by compression, would take
far more memory or time than their size. None makes a program take more than its size is worth, where --max-memory is
small; it is read, or refused with one line and exit code 3. A file of a kind each; readers' own tests have the others."""
import json
import os
import resource
import struct
import sys
import tempfile
import unittest
import zlib

BIN, TESTDATA = (os.path.abspath(path) for path in (sys.argv.pop(1), sys.argv.pop(1)))
LIMIT = 64  # --max-memory [MiB]
MOST_MEMORY, MEMORY_EACH = 3 * LIMIT, 20  # beyond what the program holds before it reads [MiB], and for each byte of the file
MOST_SECONDS, SECONDS_EACH = 1.5, 4e-6  # of the processor, and for each byte, of which deflate makes a thousand
ROOM = os.path.join(TESTDATA, "scenes", "furnace.glb")
FEW = ["--spp", "1", "--width", "8", "--height", "8", "--integrator", "nee"]

# What reads a file of a kind beside tdpt-info, and where it stands on the command line.
READERS = {".exr": [["exrdiff", "{}", "{}"], ["exrmerge", "{}", "-o", "o"],
                    ["tdpt-render", ROOM, *FEW, "--environment", "{}", "-o", "o.exr"]],
           ".hdr": [["tdpt-render", ROOM, *FEW, "--environment", "{}", "-o", "o.exr"]],
           ".glb": [["ffgraph", "{}", "--set", "walks=100", "--samples", "1000", "-o", "o.max"]],
           ".portal.glb": [["tdpt-render", ROOM, *FEW, "--portal", "{}", "-o", "o.exr"]],
           ".max": [["mincut", "{}", "-o", "o.cut"]],
           ".vdb": [["portalfit", "{}", "-o", "o.glb"]],
           ".csv": [["portalfit", "{}", "-o", "o.glb"]]}


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


def attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<I", len(value)) + value


def header(width, height, channels=("R", "G", "B"), more=b""):
    """Of an OpenEXR picture, deflated in chunks of 16 rows."""
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    listed = b"".join(c.encode() + b"\0" + struct.pack("<4i", 2, 0, 1, 1) for c in sorted(channels))
    return (attribute("channels", "chlist", listed + b"\0") + attribute("compression", "compression", b"\3")
            + attribute("dataWindow", "box2i", window) + attribute("displayWindow", "box2i", window)
            + attribute("lineOrder", "lineOrder", b"\0") + attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
            + attribute("screenWindowCenter", "v2f", bytes(8)) + attribute("screenWindowWidth", "float", struct.pack("<f", 1))
            + more + b"\0")


def exr(head, flags=0):
    return b"\x76\x2f\x31\x01" + struct.pack("<I", 2 | flags) + head


def black(side):
    """Whole, and deflated as far as it goes."""
    head = exr(header(side, side))
    data = zlib.compress(b"\0" + b"\x80" * (4 * side * 3 * 16 - 1), 9)
    chunk = struct.pack("<i", len(data)) + data
    at = [len(head) + 8 * side // 16 + k * (4 + len(chunk)) for k in range(side // 16)]
    return (head + struct.pack("<%dQ" % len(at), *at)
            + b"".join(struct.pack("<i", 16 * k) + chunk for k in range(side // 16)))


def files():
    """(file name, bytes)"""
    yield "nothing.exr", exr(header(8192, 4096)) + bytes(8 * 4096 // 16)
    yield "channels.exr", exr(header(16, 16, ["R", "G", "B"] + ["c%d" % k for k in range(20000)])) + bytes(8)
    tiles = attribute("tiles", "tiledesc", struct.pack("<2IB", 1, 1, 0))
    yield "tiles.exr", exr(header(65536, 65536, more=tiles), flags=0x200) + bytes(64)
    yield "black.exr", black(4096)
    yield "instances.glb", glb(*scene(20000, 2000))
    content, binary = scene(3000, 1, 50000)
    del content["materials"][0]["emissiveFactor"]
    content["nodes"][0] = {"mesh": 0, "name": "portal.0"}
    yield "vertices.portal.glb", glb(content, binary)
    yield "nodes.max", b"p max 1000000 1\nn 1 s\nn 2 t\na 1 2 1\n"
    # Multiples of a number of buckets that a table of 60 000 has.
    patches = b"".join(b"c patch %d 0 0 0 0 1 0 0 0 0 0 1\n" % (k * 62233) for k in range(1, 60000))
    yield "one-bucket.max", b"c tdpt max 1\n" + patches
    runs = b"\x80\x80\x80\x80\1\1\1\xff\1\1\1\x1f"
    yield "runs.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4096 +X 8192\n" + runs * 4096
    yield "voxels.csv", (b"cut,light_x,light_y,light_z,camera_x,camera_y,camera_z\n# tdpt light grid 1\n"
                         b"# grid 0 0 0 1 2048 500 1\n0,1,1,0.5,9,9,0.6\n")
    for name in ("points.vdb", "tiles.vdb"):
        with open(os.path.join(TESTDATA, "liars", name), "rb") as file:
            yield name, file.read()


def measured(command, folder):
    """(exit code, most memory [MiB], seconds of the processor, lines on standard error) of a run; what it takes is bounded
    for the sake of the machine."""
    errors = os.path.join(folder, "errors")
    child = os.fork()
    if child == 0:
        resource.setrlimit(resource.RLIMIT_AS, (8 << 30, 8 << 30))
        resource.setrlimit(resource.RLIMIT_CPU, (20, 20))
        os.chdir(folder)
        os.dup2(os.open(os.devnull, os.O_RDWR), 1)
        os.dup2(os.open(errors, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), 2)
        os.execv(command[0], command)
    _, status, used = os.wait4(child, 0)
    with open(errors, encoding="utf-8", errors="replace") as file:
        lines = file.read().splitlines()
    return os.waitstatus_to_exitcode(status), used.ru_maxrss / 1024, used.ru_utime + used.ru_stime, lines


def takes_too_much(before, memory, seconds, size):
    """Words; none where all is well. before: what the program holds before it reads [MiB]."""
    most = before + MOST_MEMORY + MEMORY_EACH * size / (1 << 20)
    longest = MOST_SECONDS + SECONDS_EACH * size
    return " ".join(["%.0f MiB, expected %.0f" % (memory, most)] * (memory > most)
                    + ["%.2f s, expected %.2f" % (seconds, longest)] * (seconds > longest))


def suffix_of(name):
    return ".portal.glb" if name.endswith(".portal.glb") else os.path.splitext(name)[1]


class Liars(unittest.TestCase):
    maxDiff = None

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.before = {}

    def judged(self, command, size):
        """What is wrong with a run."""
        program = os.path.join(BIN, command[0])
        if program not in self.before:
            self.before[program] = measured([program, "--version"], self.folder.name)[1]
        quiet = [] if command[0] in ("exrdiff", "tdpt-info") else ["--quiet"]  # they have no notes
        code, memory, seconds, lines = measured([program, *command[1:], "--max-memory", "%dM" % LIMIT, *quiet],
                                                self.folder.name)
        wrong = takes_too_much(self.before[program], memory, seconds, size)
        errors = [line for line in lines if " warning: " not in line]
        if code not in (0, 3) or len(errors) != (1 if code else 0):
            wrong += " exit code %d, %s" % (code, lines)
        if os.environ.get("SHOW"):
            print("%4d MiB %5.2f s  %d  %s  %s" % (memory - self.before[program], seconds, code, " ".join(command), lines[-1:]))
        return wrong

    def test_take_no_more_than_they_are_worth(self):
        faults = []
        for name, data in files():
            with open(os.path.join(self.folder.name, name), "wb") as file:
                file.write(data)
            for reader in [["tdpt-info", "{}"]] + READERS[suffix_of(name)]:
                command = [word.replace("{}", name) for word in reader]
                wrong = self.judged(command, len(data))
                if wrong:
                    faults.append("%s: %s" % (" ".join(command), wrong))
            os.remove(os.path.join(self.folder.name, name))
        self.assertEqual(faults, [])

    def test_twin_a_program_that_takes_too_much_is_caught(self):
        def run(text):
            _, memory, seconds, _ = measured([sys.executable, "-S", "-c", text], self.folder.name)
            return takes_too_much(before, memory, seconds, 1000)

        before = measured([sys.executable, "-S", "-c", ""], self.folder.name)[1]
        self.assertEqual(run("b = bytearray(%d << 20)" % (MOST_MEMORY // 2)), "")
        self.assertIn("MiB, expected", run("b = bytearray(%d << 20)" % (2 * MOST_MEMORY)))
        self.assertIn("s, expected", run("import time\nwhile time.process_time() < 2.5: pass"))


if __name__ == "__main__":
    unittest.main()
