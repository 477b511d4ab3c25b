"""sky_rooms.py FOLDER: diffuse rooms without a lamp, to be lit by an environment through their openings: window.gltf,
skylight.gltf, windows.gltf (a corner window, ground and a house outside), behind.gltf (a window, then a door). Beside
each NAME.portals.py: the openings to the outside as Blender's portals, as one would draw them by hand."""
import base64
import json
import os
import sys

import numpy as np

import exr_file
import sky_map

GREY, WHITE, RED, GREEN = (0.7, 0.7, 0.7), (0.8, 0.8, 0.78), (0.65, 0.45, 0.42), (0.45, 0.6, 0.48)
WOOD, GROUND = (0.5, 0.4, 0.3), (0.28, 0.3, 0.22)
# Of a box from 0 to 1, each face counter-clockwise from outside.
CORNERS = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
PORTALS = """import bpy
from mathutils import Matrix

for width, height, matrix in (
    {lamps},
):
    lamp = bpy.data.lights.new("by hand", "AREA")
    lamp.shape, lamp.size, lamp.size_y = "RECTANGLE", width, height
    lamp.cycles.is_portal = True
    portal = bpy.data.objects.new("by hand", lamp)
    portal.matrix_world = Matrix(matrix)
    bpy.context.scene.collection.objects.link(portal)
"""
FACES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))


class Room:
    def __init__(self, eye, target, yfov=1.0):
        self.boxes = {}  # colour: list of (low, high)
        self.openings = []  # to the outside: (low, high, axis across it, which way in along it)
        self.eye, self.target, self.yfov = np.array(eye, float), np.array(target, float), yfov

    def block(self, low, high, colour=GREY):
        self.boxes.setdefault(colour, []).append((np.array(low, float), np.array(high, float)))

    def wall(self, low, high, holes=(), colour=GREY):
        """A block without its `holes`, pairs of corners; it is cut into blocks along their sides."""
        cuts = [sorted({low[i], high[i], *(h[end][i] for h in holes for end in (0, 1) if low[i] < h[end][i] < high[i])})
                for i in range(3)]
        for x in zip(cuts[0], cuts[0][1:]):
            for y in zip(cuts[1], cuts[1][1:]):
                for z in zip(cuts[2], cuts[2][1:]):
                    middle = [(a + b) / 2 for a, b in (x, y, z)]
                    if not any(all(h[0][i] < middle[i] < h[1][i] for i in range(3)) for h in holes):
                        self.block((x[0], y[0], z[0]), (x[1], y[1], z[1]), colour)

    def opening(self, low, high, hole, axis):
        """That of `hole` in the wall from `low` to `high`: a rectangle in the middle of the wall, the room round 0."""
        ends = [np.clip(np.array(corner, float), low, high) for corner in hole]
        for end in ends:
            end[axis] = (low[axis] + high[axis]) / 2
        self.openings.append((*ends, axis, 1 if high[axis] <= 0 else -1))

    def portals_for_blender(self):
        """A script. There z is up: x, y, z are x, -z, y. An area lamp shines along its -Z."""
        turned = np.array([(1, 0, 0), (0, 0, -1), (0, 1, 0)], float)
        lamps = []
        for low, high, axis, inwards in self.openings:
            z = -inwards * np.eye(3)[axis]
            x = np.eye(3)[(axis + 1) % 3]
            y = np.cross(z, x)
            sides = [float(np.abs(np.dot(high - low, v)).max()) for v in (x, y)]
            frame = turned @ np.array([x, y, z, (low + high) / 2]).T
            lamps.append((*sides, [*map(list, frame), [0.0, 0.0, 0.0, 1.0]]))
        return PORTALS.format(lamps=",\n    ".join(map(repr, lamps)))

    def camera_matrix(self):
        """Column by column."""
        back = self.eye - self.target
        back /= np.linalg.norm(back)
        right = np.cross((0.0, 1.0, 0.0), back)
        right /= np.linalg.norm(right)
        return [float(v) for column, w in ((right, 0), (np.cross(back, right), 0), (back, 0), (self.eye, 1))
                for v in (*column, w)]

    def gltf(self):
        g = {"asset": {"version": "2.0", "generator": "sky_rooms.py"}, "scene": 0, "scenes": [{"nodes": []}],
             "extensionsUsed": ["KHR_materials_specular"], "nodes": [], "meshes": [], "materials": [], "accessors": [],
             "bufferViews": []}
        data = b""

        def accessor(values, component, kind, **more):
            nonlocal data
            g["bufferViews"].append({"buffer": 0, "byteOffset": len(data), "byteLength": values.nbytes})
            g["accessors"].append({"bufferView": len(g["bufferViews"]) - 1, "componentType": component, "type": kind,
                                   "count": len(values), **more})
            data += values.tobytes()
            return len(g["accessors"]) - 1

        for n, (colour, boxes) in enumerate(self.boxes.items()):
            places = np.concatenate([low + CORNERS * (high - low) for low, high in boxes]).astype("<f4")
            triangles = [i for q in FACES for i in (*q[:3], q[0], *q[2:])]
            corners = np.array([8 * b + i for b in range(len(boxes)) for i in triangles], "<u4")
            position = accessor(places, 5126, "VEC3", min=places.min(0).tolist(), max=places.max(0).tolist())
            g["meshes"].append({"primitives": [{"attributes": {"POSITION": position},
                                                "indices": accessor(corners, 5125, "SCALAR"), "material": n}]})
            g["materials"].append({"doubleSided": True, "extensions": {"KHR_materials_specular": {"specularFactor": 0}},
                                   "pbrMetallicRoughness": {"baseColorFactor": [*colour, 1], "metallicFactor": 0,
                                                            "roughnessFactor": 1}})
            g["nodes"].append({"mesh": n})
        g["cameras"] = [{"type": "perspective", "name": "camera", "perspective": {"yfov": self.yfov, "znear": 0.01}}]
        g["nodes"].append({"camera": 0, "name": "camera", "matrix": self.camera_matrix()})
        g["scenes"][0]["nodes"] = list(range(len(g["nodes"])))
        uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode("ascii")
        g["buffers"] = [{"byteLength": len(data), "uri": uri}]
        return json.dumps(g)


def shell(room, x, z, height, holes=None, colours=None):
    """Floor, ceiling and the walls -X, +X, -Z, +Z round the inside from -x to x, 0 to height and -z to z, 0.2 m thick.
    They reach into each other: no two have a face in one plane, which Cycles shows black."""
    holes, colours = holes or {}, colours or {}
    for name, low, high, colour in (
        ("floor", (-x - 0.25, -0.2, -z - 0.25), (x + 0.25, 0, z + 0.25), WOOD),
        ("ceiling", (-x - 0.25, height, -z - 0.25), (x + 0.25, height + 0.2, z + 0.25), WHITE),
        ("-x", (-x - 0.2, -0.05, -z - 0.2), (-x, height + 0.1, z + 0.2), GREY),
        ("+x", (x, -0.05, -z - 0.2), (x + 0.2, height + 0.1, z + 0.2), GREY),
        ("-z", (-x - 0.1, -0.06, -z - 0.2 + 0.01), (x + 0.1, height + 0.11, -z), GREY),
        ("+z", (-x - 0.1, -0.06, z), (x + 0.1, height + 0.11, z + 0.2 - 0.01), GREY),
    ):
        room.wall(low, high, holes.get(name, ()), colours.get(name, colour))
        for hole in holes.get(name, ()):
            room.opening(low, high, hole, "xyz".index(name[1]) if len(name) == 2 else 1)


def window():
    r = Room((-1.5, 1.5, 2.1), (0.9, 1.0, -1.0), 1.1)
    shell(r, 2, 2.5, 2.6, {"+x": [((1, 0.9, -0.8), (3, 2.2, 0.8))]}, {"-z": GREEN})
    r.block((-20, -0.4, -20), (20, -0.1, 20), GROUND)
    r.block((-0.4, -0.03, -2.2), (1.2, 0.75, -1.4))
    r.block((8, -0.3, -4), (9, 2, 3), RED)
    return r


def skylight():
    r = Room((-1.7, 1.5, 1.7), (0.6, 0.9, -0.8))
    shell(r, 2, 2, 2.5, {"ceiling": [((-0.3, 2, -1.2), (0.9, 3, 0.3))]}, {"+x": RED, "-z": GREEN})
    r.block((0.6, -0.03, -1.5), (1.2, 0.7, -0.9))
    return r


def windows():
    r = Room((-2.2, 1.4, 1.5), (1.6, 1.2, -1.0), 1.1)
    east = [((2, 0.8, -1.5), (3, 2.1, -0.3)), ((2, 0.8, 0.3), (3, 2.1, 1.5))]
    shell(r, 2.5, 2, 2.6, {"+x": east, "-z": [((1, 0.9, -3), (2.2, 2, -1))]}, {"-x": RED, "-z": GREEN})
    r.block((-20, -0.4, -20), (20, -0.1, 20), GROUND)
    r.block((8, -0.3, -5), (9, 3, 1), RED)
    return r


def behind():
    r = Room((-3.6, 1.5, 1.4), (-0.6, 1.0, -0.8), 1.1)
    shell(r, 4, 2, 2.6, {"+x": [((3, 0.8, -1.5), (5, 2.2, 1.5))]}, {"-z": GREEN})
    r.wall((-0.1, -0.03, -2.1), (0.1, 2.72, 2.1), [((-1, -1, -1.6), (1, 2, -0.7))], RED)
    return r


ROOMS = {"window": window, "skylight": skylight, "windows": windows, "behind": behind}


def quarters(width=256):
    """A map that shows how it lies: each quarter of the horizon its colour, dark below, one bright block of 11 degrees
    around azimuth 80 (from -Z towards +X), altitude 35."""
    w = sky_map.middles(width, width // 2)
    quarter = (w[..., 0] > 0) * 1 + (w[..., 2] > 0) * 2
    colours = np.array([(0.9, 0.3, 0.2), (0.2, 0.8, 0.3), (0.25, 0.3, 0.9), (0.7, 0.7, 0.2)])
    radiance = colours[quarter] * np.where(w[..., 1:2] > 0, 1.0, 0.2)
    x, y = (int(c) for c in sky_map.raster(sky_map.towards(75, 40), width, width // 2))
    radiance[y : y + width // 32, x : x + width // 32] = (60, 40, 90)
    return radiance


def main():
    folder = sys.argv[1]
    for name, room in ROOMS.items():
        with open(os.path.join(folder, name + ".gltf"), "w", encoding="ascii") as file:
            file.write(room().gltf())
        with open(os.path.join(folder, name + ".portals.py"), "w", encoding="ascii") as file:
            file.write(room().portals_for_blender())
    exr_file.write(os.path.join(folder, "quarters.exr"), quarters())


if __name__ == "__main__":
    main()
