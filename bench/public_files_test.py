import contextlib
import io
import os
import tempfile
import unittest

import exr_file
import numpy as np
import public_files


class Kinds(unittest.TestCase):
    def test_are_told_by_status_words_and_picture(self):
        self.assertEqual(public_files.kind(0, ""), "read")
        self.assertEqual(public_files.kind(0, "tdpt-render: warning: 2 lamps\n"), "read with warnings")
        self.assertEqual(public_files.kind(3, "tdpt-render: a.glb: is empty"), "refused")
        for status in (-11, 1, 4, 134):
            self.assertEqual(public_files.kind(status, ""), "crash")
        self.assertEqual(public_files.kind(None, ""), "hang")

    def test_a_picture_with_a_value_that_is_no_number_is_wrong(self):
        picture = np.zeros((2, 2, 3))
        self.assertEqual(public_files.kind(0, "", picture), "read")
        picture[1, 0, 2] = np.nan
        self.assertEqual(public_files.kind(0, "", picture), "not finite")


class Messages(unittest.TestCase):
    def test_that_differ_in_numbers_and_names_are_one(self):
        def of(path, text):
            return public_files.message(f"ffgraph: warning: x\nffgraph: {path}:{text}\n", path)

        a = of("b/a 1.glb", 'nodes[7].rotation: is "0", expected 1.5e3')
        self.assertEqual(a, 'FILE:nodes[N].rotation: is "...", expected N')
        self.assertEqual(a, of("c.gltf", 'nodes[12].rotation: is "x", expected -2'))


class Files(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def write(self, name, text, mode=0o644):
        path = os.path.join(self.folder, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        os.chmod(path, mode)
        return path

    def test_copies_and_pointers_are_left_out(self):
        pointer = public_files.POINTER.decode() + "/spec/v1\n"
        self.write("a/one.gltf", '{"buffers": [{"uri": "b%20c.bin"}]}')
        self.write("a/b c.bin", "x")
        self.write("b/one.gltf", '{"buffers": [{"uri": "b%20c.bin"}]}')
        self.write("b/b c.bin", "y")
        self.write("c/two.GLB", "glTF")
        self.write("c/three.glb", "glTF")
        self.write("c/four.glb", pointer)
        self.write("d/one.gltf", '{"buffers": [{"uri": "b%20c.bin"}]}')
        self.write("d/b c.bin", pointer)
        found, copies, pointers = public_files.scenes(self.folder)
        self.assertEqual([os.path.relpath(p, self.folder) for p in found], ["a/one.gltf", "b/one.gltf", "c/three.glb"])
        self.assertEqual((copies, pointers), (1, 2))

    def told(self, renderer):
        for program in ("ffgraph", "tdpt-info"):
            self.write("bin/" + program, "#!/bin/sh\nexit 0\n", 0o755)
        self.write("bin/tdpt-render", "#!/bin/sh\n" + renderer, 0o755)
        self.write("scenes/a.glb", "glTF")
        with contextlib.redirect_stdout(io.StringIO()) as out:
            status = public_files.main([self.folder + "/bin", self.folder + "/scenes"])
        return status, out.getvalue()

    def test_a_refusal_is_told_and_no_fault(self):
        status, out = self.told('echo "tdpt-render: $1:nodes[1]: is flat" >&2\nexit 3\n')
        self.assertEqual(status, 0)
        self.assertIn("| tdpt-render | 0 | 0 | 1 | 0 | 0 | 0 |", out)
        self.assertIn("    1 refused: FILE:nodes[N]: is flat", out)

    def test_a_picture_is_looked_at(self):
        for value, status in ((0.5, 0), (np.nan, 1)):
            exr_file.write(self.folder + "/picture.exr", np.full((2, 3, 3), value, np.float32))
            found, _ = self.told(f'for out; do :; done\ncp "{self.folder}/picture.exr" "$out"\n')
            self.assertEqual(found, status)

    def test_twin_a_crash_is_a_fault(self):
        status, out = self.told("kill -SEGV $$\n")
        self.assertEqual(status, 1)
        self.assertIn("| tdpt-render | 0 | 0 | 0 | 1 | 0 | 0 |", out)


if __name__ == "__main__":
    unittest.main()
