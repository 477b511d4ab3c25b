"""many_triangles.py TRIANGLES FORM OUT.glb: two furnished rooms of about so many triangles, joined by one opening.

The rooms stand along x, each 2 m wide, high and deep; the wall between them, 0.1 m thick, has the opening OPENING. The
lamp hangs in the first room, the camera stands in the second. Every surface is a patch over the unit square, cut into
cells of two triangles each; a third of the triangles is walls, the rest eight bumpy balls on the floors. FORM:
  grid   a mesh for each patch, neighbours share their corners: half a vertex a triangle
  parts  the same in pieces of at most 512 triangles, a mesh and a node each
  soup   as grid, but no triangle shares a corner: three vertices each
Vertices have a place and a normal, as exporters write them. The same bytes for the same arguments."""
import json
import struct
import sys

import numpy as np

OPENING = {"x": (2.0, 2.1), "y": (0.75, 1.25), "z": (-0.25, 0.25)}  # m
FORMS = ("grid", "parts", "soup")
PART = 16  # cells along a side of a piece
BALLS = ((0.35, -0.65), (0.35, 0.65), (1.2, -0.7), (1.2, 0.7))  # x and z of a room's, from its low x
LAMP_RADIANCE = 10.0
SHARE_OF_WALLS = 1 / 3


def bilinear(a, b, c, d):
    """The patch with corners a, b, c, d, counter-clockwise from its front; a at (0,0), b at (1,0)."""
    a, b, c, d = (np.array(p, float) for p in (a, b, c, d))
    normal = np.cross(b - a, d - a)
    normal /= np.linalg.norm(normal)

    def at(u, v):
        u, v = u[..., None], v[..., None]
        place = (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * d + u * c)
        return place, np.broadcast_to(normal, place.shape)

    return at


def ball(x, z):
    """A bumpy ball that stands on the floor."""
    radius, bump = 0.22, 0.06

    def place(u, v):
        phi, theta = -2 * np.pi * u, np.pi * (0.02 + 0.96 * v)
        r = radius * (1 + bump * np.sin(9 * phi) * np.sin(7 * theta))
        return np.stack([x + r * np.sin(theta) * np.cos(phi), 0.26 + r * np.cos(theta),
                         z + r * np.sin(theta) * np.sin(phi)], -1)

    def at(u, v):
        step = 1e-4
        normal = np.cross(place(u + step, v) - place(u - step, v), place(u, v + step) - place(u, v - step))
        return place(u, v), -normal / np.linalg.norm(normal, axis=-1, keepdims=True)

    return at


def box_sides(x0, x1, left, right):
    """The inner sides of a room; those across x only where asked for."""
    sides = [((x0, 0, 1), (x1, 0, 1), (x1, 0, -1), (x0, 0, -1)), ((x0, 2, -1), (x1, 2, -1), (x1, 2, 1), (x0, 2, 1)),
             ((x0, 0, -1), (x1, 0, -1), (x1, 2, -1), (x0, 2, -1)), ((x1, 0, 1), (x0, 0, 1), (x0, 2, 1), (x1, 2, 1))]
    if left:
        sides.append(((x0, 0, 1), (x0, 0, -1), (x0, 2, -1), (x0, 2, 1)))
    if right:
        sides.append(((x1, 0, -1), (x1, 0, 1), (x1, 2, 1), (x1, 2, -1)))
    return sides


def pierced_wall():
    """Both faces of the wall around the opening, and its jambs."""
    xa, xb = OPENING["x"]
    (y0, y1), (z0, z1) = OPENING["y"], OPENING["z"]
    outer = [(0, -1), (0, 1), (2, 1), (2, -1)]
    inner = [(y0, z0), (y0, z1), (y1, z1), (y1, z0)]
    sides = []
    for k in range(4):
        o, p, i, j = outer[k], outer[(k + 1) % 4], inner[k], inner[(k + 1) % 4]
        sides += [((xa, *p), (xa, *j), (xa, *i), (xa, *o)), ((xb, *o), (xb, *i), (xb, *j), (xb, *p)),
                  ((xa, *i), (xa, *j), (xb, *j), (xb, *i))]
    return sides


def lengths(quad):
    """Of the sides of a quad along u and v, the longer of each two."""
    a, b, c, d = (np.array(p, float) for p in quad)
    return max(np.linalg.norm(b - a), np.linalg.norm(c - d)), max(np.linalg.norm(d - a), np.linalg.norm(c - b))


def patches(triangles):
    """(surface, cells along u, cells along v) of all but the lamp."""
    quads = box_sides(0, 2, True, False) + box_sides(2.1, 4.1, False, True) + pierced_wall()
    area = sum(u * v for u, v in map(lengths, quads))
    step = np.sqrt(2 * area / (triangles * SHARE_OF_WALLS))
    out = []
    for quad in quads:
        u, v = lengths(quad)
        out.append((bilinear(*quad), max(1, round(u / step)), max(1, round(v / step))))
    left = triangles - sum(2 * n * m for _, n, m in out)
    across = max(3, round(np.sqrt(max(left, 0) / (2 * 8 * 2))))
    for x0 in (0, 2.1):
        out += [(ball(x0 + x, z), 2 * across, across) for x, z in BALLS]
    return out


class Glb:
    """A .glb that grows, mesh by mesh."""

    def __init__(self):
        self.chunks, self.size = [], 0
        self.json = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [],
                     "accessors": [], "bufferViews": [], "materials": [], "cameras": []}

    def accessor(self, values, component, kind, **more):
        data = np.ascontiguousarray(values).tobytes()
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": self.size, "byteLength": len(data)})
        self.json["accessors"].append({"bufferView": len(self.json["bufferViews"]) - 1, "componentType": component,
                                       "count": len(values), "type": kind, **more})
        self.chunks.append(data)
        self.size += len(data)
        return len(self.json["accessors"]) - 1

    def node(self, content):
        self.json["nodes"].append(content)
        self.json["scenes"][0]["nodes"].append(len(self.json["nodes"]) - 1)

    def mesh(self, place, normal, corners, material):
        place = place.astype("<f4")
        primitive = {"attributes": {"POSITION": self.accessor(place, 5126, "VEC3", min=place.min(0).tolist(),
                                                              max=place.max(0).tolist()),
                                    "NORMAL": self.accessor(normal.astype("<f4"), 5126, "VEC3")}, "material": material}
        if corners is not None:
            primitive["indices"] = self.accessor(corners.astype("<u4"), 5125, "SCALAR")
        self.json["meshes"].append({"primitives": [primitive]})
        self.node({"mesh": len(self.json["meshes"]) - 1})

    def write(self, path):
        self.json["buffers"] = [{"byteLength": self.size}]
        text = json.dumps(self.json, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        with open(path, "wb") as file:
            file.write(struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + self.size, len(text), 0x4E4F534A))
            file.write(text)
            file.write(struct.pack("<II", self.size, 0x004E4942))
            for chunk in self.chunks:
                file.write(chunk)


def corners_of(n, m):
    """Three a triangle, of n x m cells over (n + 1) x (m + 1) vertices."""
    a = (np.arange(m)[:, None] * (n + 1) + np.arange(n)[None, :]).ravel()
    return np.stack([a, a + 1, a + n + 2, a, a + n + 2, a + n + 1], -1).ravel()


def add_block(glb, surface, n, m, cells, form):
    """Cells (first along u, v, their numbers) of a patch of n x m as a mesh; the number of its triangles."""
    i, j, across, up = cells
    v, u = np.meshgrid((j + np.arange(up + 1)) / m, (i + np.arange(across + 1)) / n, indexing="ij")
    place, normal = (a.reshape(-1, 3) for a in surface(u, v))
    corners = corners_of(across, up)
    if form == "soup":
        glb.mesh(place[corners], normal[corners], None, 0)
    else:
        glb.mesh(place, normal, corners, 0)
    return 2 * across * up


def write_scene(triangles, form, path):
    """The number of triangles that there are in the end."""
    glb = Glb()
    diffuse = {"metallicFactor": 0, "roughnessFactor": 1}
    specular = {"KHR_materials_specular": {"specularFactor": 0}}
    glb.json["extensionsUsed"] = ["KHR_materials_emissive_strength", "KHR_materials_specular"]
    glb.json["materials"] = [
        {"pbrMetallicRoughness": {"baseColorFactor": [0.7, 0.7, 0.7, 1], **diffuse}, "extensions": specular,
         "doubleSided": True},
        {"pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], **diffuse}, "emissiveFactor": [1, 1, 1],
         "extensions": {**specular, "KHR_materials_emissive_strength": {"emissiveStrength": LAMP_RADIANCE}}}]
    lamp = np.array([(0.75, 1.99, -0.25), (1.25, 1.99, -0.25), (1.25, 1.99, 0.25), (0.75, 1.99, 0.25)])
    glb.mesh(lamp, np.tile([0.0, -1, 0], (4, 1)), np.array([0, 1, 2, 0, 2, 3]), 1)
    count = 2
    for surface, n, m in patches(triangles):
        size = PART if form == "parts" else max(n, m)
        for j in range(0, m, size):
            for i in range(0, n, size):
                count += add_block(glb, surface, n, m, (i, j, min(size, n - i), min(size, m - j)), form)
    # At (3.9, 1.6, 0.6), turned towards the opening.
    eye, target = np.array([3.9, 1.6, 0.6]), np.array([2.6, 0.8, -0.2])
    back = (eye - target) / np.linalg.norm(eye - target)
    right = np.cross([0, 1, 0], back)
    right /= np.linalg.norm(right)
    up = np.cross(back, right)
    glb.json["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1.0, "aspectRatio": 4 / 3, "znear": 0.01}}]
    glb.node({"camera": 0, "matrix": [*right, 0, *up, 0, *back, 0, *eye, 1]})
    glb.write(path)
    return count


def main(triangles, form, path):
    if form not in FORMS:
        sys.exit("many_triangles.py: %s is none of %s" % (form, ", ".join(FORMS)))
    print(write_scene(int(float(triangles)), form, path))


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit("usage: many_triangles.py TRIANGLES FORM OUT.glb")
    main(*sys.argv[1:])
