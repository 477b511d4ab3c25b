"""Files and made-up scenes, against OpenEXR's reader and closed forms."""
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

import cost
import formats
import public_files


class Pictures(unittest.TestCase):
    def test_are_read_back_as_they_were(self):
        rng = np.random.default_rng(5)
        for shape in ((1, 1, 3), (16, 8, 3), (37, 20, 3)):
            for rgb in (np.arange(np.prod(shape)).reshape(shape), rng.uniform(0, 60000, shape), np.zeros(shape)):
                content = formats.exr_content(rgb, "more\nwords")
                picture, strings = formats.exr_parse(content)
                np.testing.assert_array_equal(picture, rgb.astype(np.float16).astype(float))
                self.assertEqual(strings, {"comments": "more\nwords"})
        with self.assertRaisesRegex(ValueError, "expected channels B G R"):
            formats.exr_parse(content.replace(b"R\0", b"S\0", 1))

    def test_are_float_beyond_the_range_of_half(self):
        rgb = np.full((20, 10, 3), 0.1)
        rgb[3, 4] = 467000.25, 65504, 65505
        picture, _ = formats.exr_parse(formats.exr_content(rgb))
        np.testing.assert_array_equal(picture[3, 4], [467000.25, 65504, 65505])
        np.testing.assert_array_equal(picture[0, 0], np.float16(0.1))

    def test_are_read_by_openexr(self):
        if not shutil.which("exrmaketiled"):
            self.skipTest("no exrmaketiled here (Debian: openexr)")
        with tempfile.TemporaryDirectory() as folder:
            for most in (100, 1e6):
                formats.exr_write(f"{folder}/a.exr", np.random.default_rng(3).uniform(0, most, (40, 30, 3)), "words")
                subprocess.run(["exrmaketiled", f"{folder}/a.exr", f"{folder}/tiled.exr"], check=True)


class Glb(unittest.TestCase):
    def test_portals_can_be_read_back_and_look_along_edge_x_edge(self):
        document, binary = formats.glb_parse(formats.portals_glb([((1, 2, 3), (0, 0, 2), (0, 4, 0))] * 2))
        self.assertEqual([n["name"] for n in document["nodes"]], ["portal.0", "portal.1"])
        primitive = document["meshes"][1]["primitives"][0]
        corners = formats.gltf_array(document, binary, primitive["attributes"]["POSITION"])
        np.testing.assert_array_equal(corners, [(1, 2, 3), (1, 2, 5), (1, 6, 5), (1, 6, 3)])
        a, b, c = corners[formats.gltf_array(document, binary, primitive["indices"]).ravel()[:3]]
        self.assertLess(np.cross(b - a, c - a)[0], 0)  # the light goes along z x y = -x


class ManyTriangles(unittest.TestCase):
    def test_are_as_many_as_asked_for_and_the_same_surface_the_same_way_round(self):
        triangles = np.random.default_rng(3).normal(size=(4, 3, 3))
        normals = lambda t: np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
        for n in (1, 2, 5):
            fine = cost.cut(triangles, n)
            self.assertEqual(len(fine), 4 * n * n)
            np.testing.assert_allclose(n * n * normals(fine), np.repeat(normals(triangles), n * n, 0), atol=1e-12)
            inside = np.linalg.solve(triangles[0].T, fine[: n * n].reshape(-1, 3).T)  # weights of the corners
            np.testing.assert_allclose(inside.sum(0), 1)
            self.assertGreater(inside.min(), -1e-12)
        with tempfile.TemporaryDirectory() as folder:
            made = cost.write_scene(20000, f"{folder}/room.glb")
            document, _ = formats.glb_parse(Path(f"{folder}/room.glb").read_bytes())
            self.assertLess(abs(made / 20000 - 1), 0.1)
            self.assertEqual(3 * made, sum(document["accessors"][m["primitives"][0]["attributes"]["POSITION"]]["count"]
                                           for m in document["meshes"]))


class PublicFiles(unittest.TestCase):
    def test_copies_and_pointers_are_left_out(self):
        with tempfile.TemporaryDirectory() as folder:
            pointer = public_files.POINTER.decode() + "/spec/v1\n"
            names = {"a/one.gltf": '{"buffers": [{"uri": "b%20c.bin"}]}', "a/b c.bin": "x", "c/two.GLB": "glTF",
                     "c/three.glb": "glTF", "c/four.glb": pointer, "d/one.gltf": '{"buffers": [{"uri": "b%20c.bin"}]}',
                     "d/b c.bin": pointer}
            for name, text in names.items():
                path = Path(folder) / name
                path.parent.mkdir(exist_ok=True)
                path.write_text(text)
            found, copies, pointers = public_files.scenes(folder)
            self.assertEqual([str(Path(p).relative_to(folder)) for p in found], ["a/one.gltf", "c/three.glb"])
            self.assertEqual((copies, pointers), (1, 2))


if __name__ == "__main__":
    unittest.main()
