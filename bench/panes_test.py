"""panes.py: its portals fill its panes, and nothing else is open."""
import base64
import json
import unittest

import numpy as np

import panes
from sky_rooms_test import boxes_of, in_one_plane


def corners_of(portals):
    file = json.loads(portals)
    data = base64.b64decode(file["buffers"][0]["uri"].split(",")[1])
    return [np.frombuffer(data, "<f4", 12, view["byteOffset"]).reshape(4, 3) for view in file["bufferViews"][:-1]]


def open_at(room, y, z):
    """Whether light goes straight in there."""
    return not any(low[1] < y < high[1] and low[2] < z < high[2] and high[0] > 1.5 and low[0] < 3
                   for low, high in boxes_of(room))


class Panes(unittest.TestCase):
    def test_no_two_faces_in_one_place(self):
        for bar in (0.04, 0.2):
            self.assertEqual(in_one_plane(boxes_of(panes.room(bar))), [])

    def test_portals_of_panes_are_where_the_window_is_open(self):
        for bar in (0.04, 0.2):
            room = panes.room(bar)
            at = [(y, z) for y in np.arange(0.6, 2.4, 0.017) for z in np.arange(-1.2, 1.2, 0.017)]
            for rectangles, more in ((panes.panes(bar), False), (panes.columns(bar), True), ([(panes.LOW, panes.HIGH)], True)):
                for y, z in at:
                    within = any(low[0] < y < high[0] and low[1] < z < high[1] for low, high in rectangles)
                    if within != open_at(room, y, z):
                        self.assertTrue(more and within, (y, z))  # bars may lie in a portal of several panes

    def test_portals_look_into_the_room(self):
        for corners in corners_of(panes.portals(panes.panes(0.2))):
            self.assertLess(np.cross(corners[1] - corners[0], corners[2] - corners[0])[0], 0)

    def test_twin_a_portal_turned_round(self):
        corners = corners_of(panes.portals([(panes.HIGH, (panes.LOW[0], panes.HIGH[1] + 1))]))[0]
        self.assertGreater(np.cross(corners[1] - corners[0], corners[2] - corners[0])[0], 0)


if __name__ == "__main__":
    unittest.main()
