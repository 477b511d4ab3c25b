"""stored_reference.py: what is kept of two halves, and which are no halves of one."""
import json
import os
import subprocess
import tempfile
import unittest

import numpy as np

import exr_file
import stored_reference

STATISTICS = {"integrator": "tdpt-guided", "spp": 40, "width": 20, "height": 30, "max_depth": 6, "cpu_seconds": 12.34}


class Stored(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.scene = os.path.join(self.folder, "room.glb")
        stored_reference.write(self.scene, "a scene")

    def path(self, name):
        return os.path.join(self.folder, name)

    def half(self, name, seed, scene="room.glb", **other):
        """A picture as tdpt-render writes it and what it says of it. Its pixels."""
        rgb = np.random.default_rng(seed).lognormal(-3, 3, (30, 20, 3))
        exr_file.write(self.path(name + ".exr"), rgb, seed=str(seed), provenance=f"made by hand\nfrom {scene} 12ab")
        stored_reference.write(self.path(name + ".json"), json.dumps({**STATISTICS, **other}))
        return exr_file.read(self.path(name + ".exr"))[0]

    def keep(self, folder):
        stored_reference.main(self.path(folder), "room", self.scene, self.path("a"), self.path("b"), "a program")

    def test_keeps_pixels_to_half_precision_and_what_they_are(self):
        halves = self.half("a", 7), self.half("b", 8, spp=50)
        os.mkdir(self.path("kept"))
        self.keep("kept")
        for i, rgb in enumerate(halves):
            kept, header = exr_file.read(self.path(f"kept/room-{i + 1}.exr"))
            np.testing.assert_allclose(kept, rgb, rtol=2**-11, atol=2**-25)
            self.assertEqual(header, {"seed": str(7 + i), "provenance": "made by hand\nfrom room.glb 12ab"})
        with open(self.path("kept/room.json"), encoding="utf-8") as file:
            about = json.load(file)
        with open(self.scene, "rb") as file:
            self.assertEqual(about["scene"], subprocess.check_output(["cksum"], stdin=file, text=True).strip())
        self.assertEqual((about["seeds"], about["spp"], about["cpu_seconds"]), ([7, 8], [40, 50], [12.3, 12.3]))
        with open(self.path("kept/README.md"), encoding="utf-8") as file:
            self.assertIn("\n| room | 20 x 30 | 6 | tdpt-guided | 40 and 50 | 12 and 12 | a program |\n", file.read())

    def test_refuses_halves_that_do_not_belong_together(self):
        self.half("a", 7)
        for words, seed, other in (("seed 7", 7, {}), ("max_depth", 8, {"max_depth": None}), ("width", 8, {"width": 21}),
                                   ("not from room.glb", 8, {"scene": "room2.glb"})):
            self.half("b", seed, **other)
            with self.assertRaisesRegex(ValueError, words):
                self.keep(".")
            self.assertFalse(os.path.exists(self.path("room.json")))


if __name__ == "__main__":
    unittest.main()
