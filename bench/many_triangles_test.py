"""many_triangles.py: how many triangles there are, how they share corners, and where their opening is."""
import json
import os
import struct
import tempfile
import unittest

import numpy as np

import many_triangles


def read(path):
    """The triangles of a scene, (n, 3, 3), its number of vertices and of meshes."""
    with open(path, "rb") as file:
        data = file.read()
    size = struct.unpack_from("<I", data, 12)[0]
    text, body = json.loads(data[20:20 + size]), data[28 + size:]

    def values(accessor, kind, width):
        a = text["accessors"][accessor]
        view = text["bufferViews"][a["bufferView"]]
        return np.frombuffer(body, kind, a["count"] * width, view["byteOffset"]).reshape(-1, width)

    triangles, vertices = [], 0
    for mesh in text["meshes"]:
        primitive = mesh["primitives"][0]
        place = values(primitive["attributes"]["POSITION"], "<f4", 3)
        corners = values(primitive["indices"], "<u4", 1).ravel() if "indices" in primitive else np.arange(len(place))
        triangles.append(place[corners].reshape(-1, 3, 3))
        vertices += len(place)
    return np.concatenate(triangles).astype(float), vertices, len(text["meshes"])


def area(triangles):
    return np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=-1).sum() / 2


class ManyTriangles(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = os.path.join(folder.name, "room.glb")

    def test_all_forms_are_the_same_surfaces_of_about_as_many_triangles_as_asked_for(self):
        soup = None
        for form, per_vertex in (("grid", 1.8), ("parts", 1.5), ("soup", 1 / 3)):
            count = many_triangles.write_scene(20000, form, self.path)
            triangles, vertices, meshes = read(self.path)
            self.assertEqual(len(triangles), count)
            self.assertLess(abs(count / 20000 - 1), 0.1)
            self.assertGreater(count / (vertices - 4), 0.99 * per_vertex)
            self.assertGreater(meshes, 40 if form == "parts" else 20)
            soup = area(triangles) if soup is None else soup
            self.assertAlmostEqual(area(triangles), soup, 4)

    def test_nothing_stands_in_the_opening_and_the_wall_around_it_is_closed(self):
        many_triangles.write_scene(5000, "soup", self.path)
        triangles, _, _ = read(self.path)
        faces = triangles[np.isclose(triangles[:, :, 0], 2.0, atol=1e-6).all(1)]
        self.assertAlmostEqual(area(faces), 2 * 2 - 0.5 * 0.5, 5)
        (y0, y1), (z0, z1) = many_triangles.OPENING["y"], many_triangles.OPENING["z"]
        middle = faces.mean(1)
        inside = (middle[:, 1] > y0) & (middle[:, 1] < y1) & (middle[:, 2] > z0) & (middle[:, 2] < z1)
        self.assertFalse(inside.any())


if __name__ == "__main__":
    unittest.main()
