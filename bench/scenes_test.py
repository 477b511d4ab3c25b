"""Made-up scenes and skies against closed forms, and files against OpenEXR's reader."""
import ast
import functools
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

import formats
import public_files
import rooms
from common import MAPS

UP = np.array([0.0, 1.0, 0.0])


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


def squares():
    """(document, binary) of two squares of sides 10 and 1, with a material."""
    document, binary = formats.glb_parse(formats.portals_glb([((0, 0, 0), (10, 0, 0), (0, 10, 0)),
                                                              ((0, 0, 1), (1, 0, 0), (0, 1, 0))]))
    for mesh in document["meshes"]:
        mesh["primitives"][0]["material"] = 0
    return {**document, "materials": [{}]}, binary


class Glb(unittest.TestCase):
    def test_portals_can_be_read_back_and_look_along_edge_x_edge(self):
        document, binary = formats.glb_parse(formats.portals_glb([((1, 2, 3), (0, 0, 2), (0, 4, 0))] * 2))
        self.assertEqual([n["name"] for n in document["nodes"]], ["portal.0", "portal.1"])
        primitive = document["meshes"][1]["primitives"][0]
        corners = formats.gltf_array(document, binary, primitive["attributes"]["POSITION"])
        np.testing.assert_array_equal(corners, [(1, 2, 3), (1, 2, 5), (1, 6, 5), (1, 6, 3)])
        a, b, c = corners[formats.gltf_array(document, binary, primitive["indices"]).ravel()[:3]]
        self.assertLess(np.cross(b - a, c - a)[0], 0)  # the light goes along z x y = -x

    def test_smallest_triangles_go_first_and_never_more_area_than_told(self):
        data, dropped, of = formats.simplified(formats.glb_content(*squares()), 0.011)
        self.assertEqual((dropped, of), (1, 4))  # a half of the small square; a primitive is never empty
        document, _ = formats.glb_parse(data)
        self.assertEqual([document["accessors"][m["primitives"][0]["indices"]]["count"]
                         for m in document["meshes"]], [6, 3])
        self.assertEqual(formats.simplified(formats.glb_content(*squares()), 0.009)[1], 0)  # of equals all go or none

    def test_what_emits_stays_and_a_larger_instance_counts(self):
        document, binary = squares()
        document["materials"].append({"emissiveFactor": [1, 1, 1]})
        document["meshes"][1]["primitives"][0]["material"] = 1
        self.assertEqual(formats.simplified(formats.glb_content(document, binary), 0.4)[1:], (0, 2))
        document, binary = squares()
        document["nodes"][1]["scale"] = [100, 100, 1]  # now it is the larger one
        self.assertEqual(formats.simplified(formats.glb_content(document, binary), 0.011)[1], 1)


class Skies(unittest.TestCase):
    sun = rooms.towards(45, 34)

    def test_directions_are_those_of_tdpt_render_and_belong_to_places(self):
        for place, w in (((32, 16), (0, 0, -1)), ((48, 16), (1, 0, 0)), ((0, 16), (0, 0, 1)), ((5, 0), (0, 1, 0))):
            np.testing.assert_allclose(rooms.directions(*place, 64, 32), w, atol=1e-12)
        x, y = np.meshgrid(np.arange(16) + 0.5, np.arange(8) + 0.25)
        np.testing.assert_allclose(rooms.raster(rooms.directions(x, y, 16, 8), 16, 8), (x, y), atol=1e-9)
        self.assertAlmostEqual(64 * rooms.solid_angles(64, 32).sum(), 4 * np.pi)

    def test_sky_lights_the_ground_as_radiance_1_does_and_the_ground_reflects_it(self):
        sky = rooms.sky_map(128, 64, self.sun, False, ground=0)
        self.assertAlmostEqual((rooms.irradiance(sky, UP) @ (0.2126, 0.7152, 0.0722)) / np.pi, 1)
        for with_sun in (False, True):
            sky = rooms.sky_map(256, 128, self.sun, with_sun, ground=0.3)
            # The sun stands up to half a texel from where it should.
            np.testing.assert_allclose(np.pi * sky[-1, 0] / 0.3, rooms.irradiance(sky, UP), rtol=0.02)

    def test_luminances_are_those_of_the_standard(self):
        # ISO 15469: luminance over that of the zenith, sun 60 degrees from it; type 12. By hand.
        sky = rooms.clear_sky(1024, 512, rooms.towards(0, 30))
        f = lambda s: 1 + 10 * (np.exp(-3 * s) - np.exp(-1.5 * np.pi)) + 0.45 * np.cos(s) ** 2
        for azimuth, altitude, from_sun in ((0, 60, 30), (180, 60, 90), (180, 30, 120)):
            column, row = rooms.raster(rooms.towards(azimuth, altitude), 1024, 512)
            gradation = (1 - np.exp(-0.32 / np.sin(np.radians(altitude)))) / (1 - np.exp(-0.32))
            expected = gradation * f(np.radians(from_sun)) / f(np.radians(60))
            self.assertAlmostEqual(sky[int(row), int(column) % 1024] / sky[0].mean() / expected, 1, delta=0.01)

    def test_sun_keeps_its_irradiance_at_every_size(self):
        for width in (8, 64, 256, 1024):
            size = (width, width // 2)
            both = [rooms.sky_map(*size, self.sun, with_sun, ground=0) for with_sun in (True, False)]
            flux = np.einsum("yxc,y->c", both[0] - both[1], rooms.solid_angles(*size))
            np.testing.assert_allclose(flux, 10 * np.pi * rooms.SUN_TINT)

    def test_those_of_testdata_are_these(self):
        for name, with_sun in (("clear", False), ("clear-sun", True)):
            picture, _ = formats.exr_read(MAPS / f"{name}.exr")
            expected = rooms.sky_map(256, 128, rooms.towards(45.7, 34.45), with_sun)
            np.testing.assert_allclose(picture, expected, rtol=1e-3)

    def test_quarters_block_is_where_its_head_says(self):
        bright = np.argwhere(rooms.quarters()[..., 0] > 10) + 0.5
        w = rooms.directions(bright[:, 1], bright[:, 0], 256, 128).mean(0)
        self.assertGreater(np.dot(w / np.linalg.norm(w), rooms.towards(80, 35)), np.cos(np.radians(2)))


def boxes_of(room):
    return [box for boxes in room.boxes.values() for box in boxes]


def in_one_plane(boxes):
    """Pairs of boxes of which two faces that look the same way share a place in one plane; Cycles shows such black."""
    pairs = []
    for i, a in enumerate(boxes):
        for b in boxes[:i]:
            for axis in range(3):
                over = all(min(a[1][k], b[1][k]) - max(a[0][k], b[0][k]) > 1e-9 for k in range(3) if k != axis)
                if over and any(abs(a[side][axis] - b[side][axis]) < 1e-9 for side in (0, 1)):
                    pairs.append((a, b))
    return pairs


def ends_in_the_open(room, low, high, axis):
    """Whether all is open 1 cm within the rectangle's sides, and whether all is wall 1 cm beyond them."""
    solid = lambda place: any(all(b[0] < place) and all(place < b[1]) for b in boxes_of(room))
    middle, half = (low + high) / 2, (high - low) / 2
    sides = [np.where(np.arange(3) == k, sign, 0) for k in range(3) if k != axis for sign in (1, -1)]
    return (not any(solid(middle + s * (half - 0.01)) for s in sides),
            all(solid(middle + s * (half + 0.01)) for s in sides))


class Rooms(unittest.TestCase):
    def test_have_no_two_faces_in_one_place(self):
        for room in (*(make() for make in rooms.ROOMS.values()), rooms.paned_room(0.04), rooms.paned_room(0.2)):
            self.assertEqual(in_one_plane(boxes_of(room)), [])
        room = rooms.skylight()  # twin: a block flush with the floor
        room.block((0, -0.3, 0), (0.5, 0, 0.5))
        self.assertEqual(len(in_one_plane(boxes_of(room))), 1)

    def test_openings_are_in_the_holes_and_look_inside(self):
        for name, count in (("window", 1), ("skylight", 1), ("windows", 3), ("behind", 1)):
            room = rooms.ROOMS[name]()
            self.assertEqual(len(room.openings), count)
            for low, high, axis, inwards in room.openings:
                self.assertEqual(ends_in_the_open(room, low, high, axis), (True, True), name)
                self.assertGreater(((low + high) / 2)[axis] * -inwards, 0)
        room = rooms.window()  # twins: too narrow, too wide
        low, high, axis, _ = room.openings[0]
        self.assertEqual(ends_in_the_open(room, low + [0, 0, 0.02], high, axis), (True, False))
        self.assertEqual(ends_in_the_open(room, low - [0, 0, 0.02], high, axis), (False, True))

    def test_blenders_portals_shine_inside(self):
        # Blender's x, y, z are x, -z, y; a lamp shines along its -Z.
        lamps = [ast.literal_eval(line.strip().rstrip(",")) for line in
                 rooms.windows().portals_for_blender().splitlines() if line.startswith("    (")]
        for (width, height, matrix), way in zip(lamps, ((-1, 0, 0), (-1, 0, 0), (0, -1, 0))):
            frame = np.array(matrix)[:3]
            np.testing.assert_allclose(frame[:, 2], -np.array(way))
            np.testing.assert_allclose(frame[:, :3].T @ frame[:, :3], np.eye(3))
            self.assertAlmostEqual(np.abs(frame[:, :2] @ (width, height)).max(), 1.3 if way[0] else 1.2)

    def test_camera_looks_at_its_target(self):
        for room in (make() for make in rooms.ROOMS.values()):
            m = np.array(formats.glb_parse(room.glb())[0]["nodes"][-1]["matrix"]).reshape(4, 4).T
            to = room.target - room.eye
            np.testing.assert_allclose(m @ (0, 0, -1, 0), [*(to / np.linalg.norm(to)), 0], atol=1e-12)
            self.assertGreater(m[1, 1], 0)

    def test_portals_of_panes_are_where_the_window_is_open(self):
        for bar in (0.04, 0.2):
            boxes = [(low, high) for low, high in boxes_of(rooms.paned_room(bar)) if high[0] > 1.5 and low[0] < 3]
            for y in np.arange(0.6, 2.4, 0.034):
                for z in np.arange(-1.2, 1.2, 0.034):
                    is_open = not any(low[1] < y < high[1] and low[2] < z < high[2] for low, high in boxes)
                    within = any(low[0] < y < high[0] and low[1] < z < high[1] for low, high in rooms.panes(bar))
                    self.assertEqual(within, is_open, (y, z))

    def test_many_triangles_are_as_many_as_asked_for_and_leave_the_opening_free(self):
        with tempfile.TemporaryDirectory() as folder:
            path, areas = Path(folder) / "room.glb", []
            for form, per_vertex in (("grid", 1.8), ("parts", 1.5), ("soup", 1 / 3)):
                count = rooms.write_scene(20000, form, path)
                document, binary = formats.glb_parse(path.read_bytes())
                triangles, vertices = [], 0
                array = functools.partial(formats.gltf_array, document, binary)
                for primitive in (mesh["primitives"][0] for mesh in document["meshes"]):
                    place = array(primitive["attributes"]["POSITION"]).astype(float)
                    corners = array(primitive["indices"]).ravel() if "indices" in primitive else slice(None)
                    triangles.append(place[corners].reshape(-1, 3, 3))
                    vertices += len(place)
                triangles = np.concatenate(triangles)
                self.assertEqual(len(triangles), count)
                self.assertLess(abs(count / 20000 - 1), 0.1)
                self.assertGreater(count / (vertices - 4), 0.99 * per_vertex)
                area = lambda t: np.linalg.norm(np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]), axis=-1).sum() / 2
                areas.append(area(triangles))
                wall = triangles[np.isclose(triangles[:, :, 0], 2.0, atol=1e-6).all(1)]
                self.assertAlmostEqual(area(wall), 2 * 2 - 0.5 * 0.5, 5)
        np.testing.assert_allclose(areas, areas[0], rtol=1e-5)


class PublicFiles(unittest.TestCase):
    def test_messages_that_differ_in_numbers_and_names_are_one(self):
        of = lambda path, text: public_files.message(f"ffgraph: warning: x\nffgraph: {path}:{text}\n", path)
        self.assertEqual(of("b/a 1.glb", 'nodes[7].rotation: is "0", expected 1.5e3'),
                         of("c.gltf", 'nodes[12].rotation: is "x", expected -2'))

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
