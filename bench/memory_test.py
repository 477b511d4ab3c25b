"""memory_test.py BIN: the five programs hold less than 400 bytes for each triangle that a scene has more,
one thread each."""
import os
import subprocess
import sys
import tempfile
import unittest

import many_triangles
import scale

BIN = os.path.abspath(sys.argv.pop(1))
SIZES = (50000, 200000)
FORM = "soup"  # costs most
FEW = {"ffgraph": ["--walks", "10000", "--samples", "20000"], "lightgrid": ["--resolution", "32"],
       "tdpt-render": ["--integrator", "bdpt", "--spp", "1", "--width", "16", "--height", "12"]}


def bytes_each(folder, command_of):
    """Of a program; command_of(triangles). Run by a Python without numpy, whose memory would hide theirs."""
    path = os.path.join(folder, "runs.csv")
    for n in SIZES:
        subprocess.run([sys.executable, "-S", scale.__file__, "run", path, FORM, str(n), "one", *command_of(n)], check=True)
    rows = scale.read(path)
    os.remove(path)
    return scale.bytes_each(*rows)


class Memory(unittest.TestCase):
    def test_of_each_program_is_below_the_limit(self):
        with tempfile.TemporaryDirectory() as folder:
            def file(n, end):
                return os.path.join(folder, str(n) + end)

            for n in SIZES:
                many_triangles.write_scene(n, FORM, file(n, ".glb"))
            files = {"ffgraph": ((".glb",), ".max"), "mincut": ((".max",), ".cut"),
                     "lightgrid": ((".glb", ".cut"), ".vdb"), "portalfit": ((".vdb",), ".portal.glb"),
                     "tdpt-render": ((".glb",), ".exr")}
            for program, (read, written) in files.items():
                each = bytes_each(folder, lambda n: [os.path.join(BIN, program), "--quiet", "--threads", "1", *FEW.get(program, []),
                                             *(file(n, end) for end in read), "-o", file(n, written)])
                print("%s: %.0f bytes a triangle" % (program, each))
                self.assertLess(each, scale.MOST_BYTES, program)

    def test_twin_a_program_that_holds_a_fifth_more_is_caught(self):
        def holds(each):
            with tempfile.TemporaryDirectory() as folder:
                return bytes_each(folder, lambda n: [sys.executable, "-S", "-c", "b = bytearray(%d)" % (each * n)])

        self.assertLess(holds(0.8 * scale.MOST_BYTES), scale.MOST_BYTES)
        self.assertGreater(holds(1.2 * scale.MOST_BYTES), scale.MOST_BYTES)


if __name__ == "__main__":
    unittest.main()
