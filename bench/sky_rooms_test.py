"""sky_rooms.py: rooms that a renderer can take as they are, and a map that lies where it says."""
import ast
import json
import unittest

import numpy as np

import sky_map
import sky_rooms


def in_one_plane(boxes):
    """Pairs of boxes of which two faces that look the same way share a place in one plane."""
    pairs = []
    for i, a in enumerate(boxes):
        for b in boxes[:i]:
            for axis in range(3):
                others = [k for k in range(3) if k != axis]
                over = all(min(a[1][k], b[1][k]) - max(a[0][k], b[0][k]) > 1e-9 for k in others)
                if over and any(abs(a[side][axis] - b[side][axis]) < 1e-9 for side in (0, 1)):
                    pairs.append((a, b))
    return pairs


def boxes_of(room):
    return [box for boxes in room.boxes.values() for box in boxes]


def ends_in_the_open(room, low, high, axis):
    """Whether all is open 1 cm within the rectangle's sides, and whether all is wall 1 cm beyond them."""
    def solid(place):
        return any(all(b[0] < place) and all(place < b[1]) for b in boxes_of(room))

    middle, half = (low + high) / 2, (high - low) / 2
    sides = [np.where(np.arange(3) == k, sign, 0) for k in range(3) if k != axis for sign in (1, -1)]
    return (not any(solid(middle + s * (half - 0.01)) for s in sides), all(solid(middle + s * (half + 0.01)) for s in sides))


class Rooms(unittest.TestCase):
    def test_have_no_two_faces_in_one_place(self):
        # Cycles shows such places black.
        for name, room in sky_rooms.ROOMS.items():
            self.assertEqual(in_one_plane(boxes_of(room())), [], name)

    def test_twin_a_block_flush_with_the_floor(self):
        room = sky_rooms.skylight()
        room.block((0, -0.3, 0), (0.5, 0, 0.5))
        self.assertEqual(len(in_one_plane(boxes_of(room))), 1)

    def test_holes_are_holes(self):
        room = sky_rooms.Room((0, 0, 1), (0, 0, 0))
        room.wall((0, 0, 0), (4, 3, 0.2), [((1, 1, -1), (2, 2, 1)), ((3, 0.5, -1), (3.5, 2, 1))])
        volume = sum(np.prod(high - low) for low, high in boxes_of(room))
        self.assertAlmostEqual(volume, 0.2 * (4 * 3 - 1 - 0.5 * 1.5))

    def test_openings_are_in_the_holes_and_look_inside(self):
        for name, count in (("window", 1), ("skylight", 1), ("windows", 3), ("behind", 1)):
            room = sky_rooms.ROOMS[name]()
            self.assertEqual(len(room.openings), count)
            for low, high, axis, inwards in room.openings:
                self.assertEqual(ends_in_the_open(room, low, high, axis), (True, True), name)
                middle = (low + high) / 2
                self.assertGreater(middle[axis] * -inwards, 0)

    def test_twin_an_opening_too_narrow_or_too_wide(self):
        room = sky_rooms.window()
        low, high, axis, _ = room.openings[0]
        self.assertEqual(ends_in_the_open(room, low + [0, 0, 0.02], high, axis), (True, False))
        self.assertEqual(ends_in_the_open(room, low - [0, 0, 0.02], high, axis), (False, True))

    def test_blenders_portals_shine_inside(self):
        # Blender's x, y, z are x, -z, y; a lamp shines along its -Z.
        lamps = [ast.literal_eval(line.strip().rstrip(",")) for line in
                 sky_rooms.windows().portals_for_blender().splitlines() if line.startswith("    (")]
        for (width, height, matrix), way in zip(lamps, ((-1, 0, 0), (-1, 0, 0), (0, -1, 0))):
            frame = np.array(matrix)[:3]
            np.testing.assert_allclose(frame[:, 2], -np.array(way))
            np.testing.assert_allclose(frame[:, :3].T @ frame[:, :3], np.eye(3))
            self.assertAlmostEqual(np.linalg.det(frame[:, :3]), 1)
            self.assertAlmostEqual(np.abs(frame[:, :2] @ (width, height)).max(), 1.3 if way[0] else 1.2)
        np.testing.assert_allclose(np.array(lamps[2][2])[:3, 3], (1.6, 2.095, 1.45))

    def test_faces_look_outwards(self):
        for q in sky_rooms.FACES:
            a, b, c = (sky_rooms.CORNERS[i] for i in q[:3])
            middle = sky_rooms.CORNERS[list(q)].mean(0)
            self.assertGreater(np.dot(np.cross(b - a, c - a), middle - 0.5), 0)

    def test_camera_looks_at_its_target(self):
        for room in (make() for make in sky_rooms.ROOMS.values()):
            m = np.array(json.loads(room.gltf())["nodes"][-1]["matrix"]).reshape(4, 4).T
            to = room.target - room.eye
            np.testing.assert_allclose(m @ (0, 0, -1, 0), [*(to / np.linalg.norm(to)), 0], atol=1e-12)
            self.assertAlmostEqual(np.linalg.det(m), 1)
            self.assertGreater(m[1, 1], 0)


class Quarters(unittest.TestCase):
    def test_every_quarter_of_the_horizon_has_its_colour(self):
        radiance = sky_rooms.quarters()
        seen = set()
        for azimuth in (10, 100, 190, 280):
            column, row = sky_map.raster(sky_map.towards(azimuth, 10), 256, 128)
            seen.add(tuple(radiance[int(row), int(column)]))
        self.assertEqual(len(seen), 4)

    def test_its_block_is_where_its_head_says(self):
        radiance = sky_rooms.quarters()
        bright = np.argwhere(radiance[..., 0] > 10) + 0.5
        self.assertEqual(len(bright), 64)
        w = sky_map.directions(bright[:, 1], bright[:, 0], 256, 128).mean(0)
        self.assertGreater(np.dot(w / np.linalg.norm(w), sky_map.towards(80, 35)), np.cos(np.radians(2)))


if __name__ == "__main__":
    unittest.main()
