"""simplified.py: the smallest triangles go, lamps stay; what is said of portals that moved."""
import os
import tempfile
import unittest

import numpy as np

import many_triangles
import simplified


def square(side, x=0.0):
    return np.array([[[x, 0, 0], [x + side, 0, 0], [x + side, side, 0]], [[x, 0, 0], [x + side, side, 0], [x, side, 0]]])


class Simplified(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = os.path.join(folder.name, "scene.glb")

    def scene(self, lamp, *meshes):
        """Squares of these sides, a mesh each, and a lamp."""
        glb = many_triangles.Glb()
        glb.json["materials"] = [{}, {"emissiveFactor": [1, 1, 1]}]
        for material, sides in [(1, [lamp])] + [(0, m) for m in meshes]:
            place = np.concatenate([square(s, 10.0 * i) for i, s in enumerate(sides)]).reshape(-1, 3)
            glb.mesh(place, np.zeros_like(place), np.arange(len(place)), material)
        glb.write(self.path)
        return simplified.Scene(self.path)

    def areas(self):
        scene = simplified.Scene(self.path)
        return [sorted(np.linalg.norm(simplified.vectors(scene.triangles(scene.json["meshes"][m]["primitives"][0], at)),
                                      axis=-1).round(6)) for m, at in scene.placed_meshes()]

    def test_drops_the_smallest_and_no_lamp(self):
        scene = self.scene(0.01, [1, 2], [3, 4])  # 30 m2
        self.assertEqual(simplified.drop(scene, 5.1 / 30), (4, 8))
        scene.write(self.path)
        # Of the first mesh one stays: a mesh without triangles is none.
        self.assertEqual(self.areas(), [[5e-05, 5e-05], [2], [4.5, 4.5, 8, 8]])

    def test_drops_none_where_the_share_is_less_than_the_smallest(self):
        scene = self.scene(1, [1, 2])
        self.assertEqual(simplified.drop(scene, 0.01), (0, 4))

    def test_says_what_became_of_each_portal(self):
        here, up = np.zeros(3), np.array([0, 0, 1.0])
        tilted = np.array([0, np.sin(0.1), np.cos(0.1)])
        self.assertEqual(simplified.compare([(here, up, 2.0)], [(here + 0.1 * up, tilted, 1.0)]),
                         "moved 0.1 m, turned 5.7 degrees, area x 0.50")
        self.assertEqual(simplified.compare([(here, up, 2.0)], []), "lost (0 portals, not 1)")
        self.assertEqual(simplified.compare([], [(here, up, 2.0)]), "no portal to lose, 1 found")

    def test_reads_places_of_nodes(self):
        node = {"translation": [1, 2, 3], "rotation": [0, 0, np.sqrt(0.5), np.sqrt(0.5)], "scale": [2, 1, 1]}
        np.testing.assert_allclose(simplified.local(node) @ [1, 0, 0, 1], [1, 4, 3, 1], atol=1e-12)


if __name__ == "__main__":
    unittest.main()
