"""wheel_test.py BIN ROOT: the wheel that cmake/wheel.py packs, and its module, over an archive whose programs call those in BIN. It is
unpacked without the right to execute anything, as Blender does it. Exit 77, with a word, where no Python has numpy."""
import base64
import hashlib
import importlib
import io
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
import tomllib
import unittest
import warnings
import zipfile
from pathlib import Path
from xml.etree import ElementTree

try:
    import numpy
except ModuleNotFoundError:
    if sys.executable != "/usr/bin/python3" and os.access("/usr/bin/python3", os.X_OK):
        os.execv("/usr/bin/python3", ["/usr/bin/python3", "-B", *sys.argv])
    print("skipped: numpy is missing")
    sys.exit(77)

BIN, ROOT = (Path(path).resolve() for path in sys.argv[1:3])
PROGRAMS = "ffgraph mincut lightgrid portalfit tdpt-render exrdiff exrmerge exrdenoise tdpt-info tdpt-import tdpt".split()
FOLDER = Path(tempfile.mkdtemp(prefix="wheel_test ö "))
ROOM = FOLDER / "room.glb"
QUICK = {"quality": "draft", "threads": 2}
SMALL = {**QUICK, "spp": 2, "width": 32}


def make_archive(path):
    """As cmake/tarball.sh packs it, of small files."""
    with tarfile.open(path, "w:gz") as tar:
        def add(name, data, mode):
            member = tarfile.TarInfo("tdpt-1.2.3-linux-here/" + name)
            member.size, member.mode, member.mtime = len(data), mode, 1700000000
            tar.addfile(member, io.BytesIO(data))

        for name in PROGRAMS:
            add("bin/" + name, f'#!/bin/sh\nexec "{BIN}/{name}" "$@"\n'.encode(), 0o755)
        for part in sorted((ROOT / "tools/blender/tdpt").glob("*.*")):
            add("share/tdpt/blender/tdpt/" + part.name, part.read_bytes(), 0o644)


def pack(out):
    """(wheel, extension)"""
    out.mkdir()
    words = [sys.executable, "-B", ROOT / "cmake/wheel.py", FOLDER / "archive.tar.gz", out]
    return [Path(line) for line in subprocess.run(words, check=True, capture_output=True, text=True).stdout.splitlines()]


def setUpModule():
    make_archive(FOLDER / "archive.tar.gz")
    shutil.copy(ROOT / "testdata/scenes/two-rooms.glb", ROOM)
    global wheel, extension, tdpt
    wheel, extension = pack(FOLDER / "packed")
    zipfile.ZipFile(wheel).extractall(FOLDER / "site")
    os.environ.update(PATH="/usr/bin:/bin", XDG_CACHE_HOME=str(FOLDER / "cache"), PYTHONPATH=str(FOLDER / "site"))
    sys.path[:0] = [str(FOLDER / "site"), str(ROOT / "bench")]
    tdpt = importlib.import_module("tdpt")


def tearDownModule():
    shutil.rmtree(FOLDER, ignore_errors=True)


class Packing(unittest.TestCase):
    def test_the_same_archive_gives_the_same_bytes(self):
        self.assertEqual([path.read_bytes() for path in pack(FOLDER / "again")], [wheel.read_bytes(), extension.read_bytes()])

    def test_the_record_holds_every_file(self):
        files = zipfile.ZipFile(wheel)
        lines = [line.split(",") for line in files.read("tdpt_render-1.2.3.dist-info/RECORD").decode().splitlines()]
        self.assertEqual(sorted(name for name, *_ in lines), sorted(files.namelist()))
        for name, digest, size in lines[:-1]:
            data = files.read(name)
            self.assertEqual(base64.urlsafe_b64decode(digest.split("=")[1] + "="), hashlib.sha256(data).digest(), name)
            self.assertEqual(int(size), len(data))
        self.assertEqual(files.getinfo("tdpt/bin/mincut").external_attr >> 16, 0o100755)
        tag = wheel.name.removeprefix("tdpt_render-1.2.3-").removesuffix(".whl")
        self.assertRegex(tag, r"^py3-none-manylinux_2_\d+_")
        self.assertIn(f"Tag: {tag}\n", files.read("tdpt_render-1.2.3.dist-info/WHEEL").decode())
        self.assertIn("tdpt/py.typed", files.namelist())

    def test_the_extension_names_its_wheel(self):
        files = zipfile.ZipFile(extension)
        manifest = tomllib.loads(files.read("tdpt/blender_manifest.toml").decode())
        self.assertEqual(manifest["wheels"], ["./wheels/" + wheel.name])
        self.assertEqual(files.read("tdpt/wheels/" + wheel.name), wheel.read_bytes())
        self.assertEqual(["linux-" + extension.stem.split("-")[-1]], manifest["platforms"])
        self.assertIn("files", manifest["permissions"])


class Module(unittest.TestCase):
    def test_portals_are_polygons(self):
        (portal,) = tdpt.find_portals(ROOM, **QUICK)
        self.assertLess(numpy.abs(portal.polygon.mean(0) - (2.05, 1, 0)).max(), 0.06)
        a, b, c = portal.polygon[:3]
        normal = numpy.cross(b - a, c - b)
        self.assertLess(normal[0], -0.99 * numpy.linalg.norm(normal))  # the way the light goes
        self.assertAlmostEqual(portal.figures["area"], 0.0625, delta=0.005)

    def test_a_picture_is_that_of_the_program(self):
        import formats
        picture = tdpt.render(ROOM, "--no-provenance", **SMALL)
        file = FOLDER / "picture.exr"
        subprocess.run([BIN / "tdpt", ROOM, "-o", file, "--quality", "draft", "--spp", "2", "--width", "32", "--quiet"], check=True)
        self.assertEqual((picture.shape, picture.dtype), ((24, 32, 3), numpy.float32))
        numpy.testing.assert_array_equal(picture, formats.exr_read(file))

    def test_portals_that_are_given_are_used(self):
        options = {**SMALL, "integrator": "tdpt-guided"}
        found = tdpt.find_portals(ROOM, **QUICK)
        moved = [found[0]._replace(polygon=found[0].polygon + (0, 5, 0))]
        own, given, other = (tdpt.render(ROOM, portals=portals, **options) for portals in (found, found, moved))
        numpy.testing.assert_array_equal(own, given)
        self.assertGreater(numpy.abs(other - given).max(), 0)

    def test_texts_for_other_renderers(self):
        with self.assertWarnsRegex(UserWarning, "sky"):  # the room has none
            compile(tdpt.for_cycles(ROOM, **QUICK), "portals.py", "exec")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            text = tdpt.for_mitsuba(ROOM, **QUICK)
        self.assertEqual(ElementTree.fromstring(text.encode()).tag, "scene")

    def test_errors_are_those_of_the_programs(self):
        for call, code, word in ((lambda: tdpt.render("none.glb"), 3, "none.glb"),
                                 (lambda: tdpt.find_portals(ROOM, look_from=(1, 2)), 2, "--look-from"),
                                 (lambda: tdpt.run("exrmerge", "--nonsense"), 2, "--nonsense")):
            with self.assertRaisesRegex(tdpt.Error, word) as caught:
                call()
            self.assertEqual(caught.exception.code, code)

    def test_a_console_script_is_the_program(self):
        script = FOLDER / "mincut"
        script.write_text("import tdpt\ntdpt.main()\n")
        done = subprocess.run([sys.executable, "-B", script, "--nonsense"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertTrue(done.stderr.startswith("mincut: --nonsense"), done.stderr)

    def test_without_numpy(self):
        code = "import sys; sys.modules['numpy'] = None; import tdpt; tdpt.find_portals('room.glb')"
        done = subprocess.run([sys.executable, "-B", "-c", code], capture_output=True, text=True)
        self.assertEqual(done.stderr.splitlines()[-1], "ImportError: tdpt: arrays need numpy: pip install numpy")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
