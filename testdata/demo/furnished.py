#!/usr/bin/env python3
"""Writes furnished.glb: a furnished room whose only light comes from the next room, past a door ajar by 14 degrees.
Run it in this folder. Metres, +Y up; the camera's room is x 0..5.2, z 0..4.2, the lamp's room lies behind the wall at z = 0."""
import json
import math
import random
import struct

random.seed(7)
materials, meshes, nodes, binary = [], {}, [], bytearray()
views, accessors = [], []


def material(name, colour, roughness=0.9, metallic=0.0, emission=None):
    """The index of a material; `colour` linear, 0 to 1."""
    m = {"name": name, "doubleSided": True,
         "pbrMetallicRoughness": {"baseColorFactor": [*colour, 1], "roughnessFactor": roughness, "metallicFactor": metallic}}
    if emission:
        m["emissiveFactor"] = [c / max(emission) for c in emission]
        m["extensions"] = {"KHR_materials_emissive_strength": {"emissiveStrength": max(emission)}}
    materials.append(m)
    return len(materials) - 1


def accessor(rows, kind, code, component):
    data = b"".join(struct.pack("<" + code * len(r), *r) for r in rows)
    views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(data)})
    binary.extend(data + bytes(-len(data) % 4))
    accessors.append({"bufferView": len(views) - 1, "componentType": component, "count": len(rows) * (3 if kind == "SCALAR" else 1),
                      "type": kind})
    if kind == "VEC3":
        accessors[-1]["min"] = [min(r[i] for r in rows) for i in range(3)]
        accessors[-1]["max"] = [max(r[i] for r in rows) for i in range(3)]
    return len(accessors) - 1


def mesh(name, points, triangles, normals=None):
    """Geometry by its name, stored once; `normals` for what is round."""
    if name not in meshes:
        points = [tuple(struct.unpack("<3f", struct.pack("<3f", *p))) for p in points]
        meshes[name] = {"POSITION": accessor(points, "VEC3", "f", 5126)}, accessor(triangles, "SCALAR", "H", 5123)
        if normals:
            meshes[name][0]["NORMAL"] = accessor(normals, "VEC3", "f", 5126)
    return name


def place(name, of, at=(0, 0, 0), scale=(1, 1, 1), turn=0.0):
    """A mesh with a material at a place, turned about +Y by `turn` degrees."""
    half = math.radians(turn) / 2
    nodes.append({"mesh": (name, of), "translation": list(at), "scale": list(scale), "rotation": [0, math.sin(half), 0, math.cos(half)]})


def box(of, low, high, turn=0.0, about=None):
    """A box, turned about the upright line through `about` (x, z)."""
    mesh("box", [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)],
         [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)])
    size, at = [h - l for l, h in zip(low, high)], list(low)
    if turn and about:
        c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
        x, z = low[0] - about[0], low[2] - about[1]
        at = [about[0] + c * x + s * z, low[1], about[1] - s * x + c * z]
    place("box", of, at, size, turn)


def quad(of, a, b, c, d):
    name = mesh(f"quad{len(meshes)}", [a, b, c, d], [(0, 1, 2), (0, 2, 3)])
    place(name, of)


def lathe(name, profile, n=40):
    """A profile of (radius, height) from below to above, turned about +Y, smooth."""
    points, normals, triangles = [], [], []
    for i, (r, y) in enumerate(profile):
        (r0, y0), (r1, y1) = profile[max(i - 1, 0)], profile[min(i + 1, len(profile) - 1)]
        l = math.hypot(r1 - r0, y1 - y0) or 1
        for k in range(n):
            c, s = math.cos(2 * math.pi * k / n), math.sin(2 * math.pi * k / n)
            points.append((r * c, y, r * s))
            normals.append(((y1 - y0) / l * c, (r0 - r1) / l, (y1 - y0) / l * s))
    for i in range(len(profile) - 1):
        for k in range(n):
            a, b = i * n + k, i * n + (k + 1) % n
            triangles += [(a, a + n, b), (b, a + n, b + n)]
    return mesh(name, points, triangles, normals)


WALL, BEYOND = material("wall", (0.72, 0.71, 0.67)), material("wall of the next room", (0.76, 0.7, 0.6))
CEILING, TRIM = material("ceiling", (0.8, 0.8, 0.78)), material("trim", (0.75, 0.74, 0.7), 0.4)
PLANKS = [material(f"plank {i}", c, 0.35) for i, c in enumerate(((0.33, 0.19, 0.1), (0.38, 0.22, 0.12), (0.28, 0.16, 0.085), (0.35, 0.21, 0.13)))]
DOOR, WOOD = material("door", (0.45, 0.5, 0.48), 0.35), material("wood", (0.42, 0.25, 0.13), 0.45)
DARK, STEEL = material("dark wood", (0.12, 0.075, 0.05), 0.4), material("steel", (0.75, 0.73, 0.7), 0.22, 1.0)
COPPER, GLAZE = material("copper", (0.93, 0.6, 0.46), 0.18, 1.0), material("blue glaze", (0.05, 0.16, 0.33), 0.12)
WHITE, CLAY = material("porcelain", (0.82, 0.82, 0.8), 0.15), material("clay", (0.55, 0.25, 0.14), 0.8)
RUG, BORDER = material("rug", (0.34, 0.07, 0.07), 1.0), material("border of the rug", (0.6, 0.5, 0.36), 1.0)
LEAF, CLOTH = material("leaf", (0.1, 0.27, 0.07), 0.45), material("cloth", (0.16, 0.27, 0.36), 1.0)
FRUIT = [material(f"fruit {i}", c, 0.35) for i, c in enumerate(((0.62, 0.1, 0.05), (0.75, 0.38, 0.04), (0.42, 0.5, 0.08)))]
BOOKS = [material(f"book {i}", c, 0.7) for i, c in enumerate(
    ((0.4, 0.07, 0.06), (0.08, 0.16, 0.32), (0.1, 0.26, 0.15), (0.55, 0.42, 0.2), (0.28, 0.12, 0.25), (0.6, 0.55, 0.46), (0.07, 0.07, 0.08)))]
LAMP = material("lamp", (0, 0, 0), 1.0, 0.0, (66, 58, 46))

X, Y, Z = 5.2, 2.6, 4.2  # the room
L, R, H, T = 1.0, 1.86, 2.06, 0.12  # doorway: left, right, height; wall: thickness
BX0, BX1, BZ = -4.0, 4.4, -6.0  # the next room

# Shells.
for i in range(26):
    x0, x1 = X * i / 26, X * (i + 1) / 26
    cuts = [0] + sorted(random.uniform(0.3, Z - 0.3) for _ in range(2)) + [Z]
    for z0, z1 in zip(cuts, cuts[1:]):
        quad(random.choice(PLANKS), (x0, 0, z0), (x0, 0, z1), (x1, 0, z1), (x1, 0, z0))
quad(CEILING, (0, Y, 0), (X, Y, 0), (X, Y, Z), (0, Y, Z))
quad(WALL, (0, 0, Z), (X, 0, Z), (X, Y, Z), (0, Y, Z))
quad(WALL, (0, 0, 0), (0, 0, Z), (0, Y, Z), (0, Y, 0))
quad(WALL, (X, 0, 0), (X, Y, 0), (X, Y, Z), (X, 0, Z))
for z, of, low, high in ((0, WALL, 0, X), (-T, BEYOND, BX0, BX1)):
    quad(of, (low, 0, z), (L, 0, z), (L, Y, z), (low, Y, z))
    quad(of, (R, 0, z), (high, 0, z), (high, Y, z), (R, Y, z))
    quad(of, (L, H, z), (R, H, z), (R, Y, z), (L, Y, z))
quad(TRIM, (L, 0, -T), (L, 0, 0), (L, H, 0), (L, H, -T))
quad(TRIM, (R, 0, -T), (R, 0, 0), (R, H, 0), (R, H, -T))
quad(TRIM, (L, H, -T), (R, H, -T), (R, H, 0), (L, H, 0))
quad(DARK, (L, 0, -T), (R, 0, -T), (R, 0, 0), (L, 0, 0))
quad(PLANKS[1], (BX0, 0, BZ), (BX1, 0, BZ), (BX1, 0, -T), (BX0, 0, -T))
quad(CEILING, (BX0, Y, BZ), (BX1, Y, BZ), (BX1, Y, -T), (BX0, Y, -T))
quad(BEYOND, (BX0, 0, BZ), (BX1, 0, BZ), (BX1, Y, BZ), (BX0, Y, BZ))
quad(BEYOND, (BX0, 0, BZ), (BX0, Y, BZ), (BX0, Y, -T), (BX0, 0, -T))
quad(BEYOND, (BX1, 0, BZ), (BX1, Y, BZ), (BX1, Y, -T), (BX1, 0, -T))
quad(LAMP, (-1.0, Y - 0.03, -4.3), (0.2, Y - 0.03, -4.3), (0.2, Y - 0.03, -3.1), (-1.0, Y - 0.03, -3.1))

# The door, ajar, its frame, and skirting boards.
AJAR = -14
box(DOOR, (L + 0.005, 0.006, 0), (R - 0.005, H - 0.006, 0.04), AJAR, (L + 0.005, 0))
for low, high in ((0.16, 0.92), (1.06, 1.9)):
    box(DOOR, (L + 0.13, low, 0.04), (R - 0.13, high, 0.052), AJAR, (L + 0.005, 0))
box(STEEL, (R - 0.085, 0.98, 0.04), (R - 0.065, 1.0, 0.085), AJAR, (L + 0.005, 0))
box(STEEL, (R - 0.19, 0.982, 0.07), (R - 0.065, 0.998, 0.085), AJAR, (L + 0.005, 0))
box(TRIM, (L - 0.08, 0, 0), (L - 0.012, H + 0.08, 0.02))
box(TRIM, (R + 0.012, 0, 0), (R + 0.08, H + 0.08, 0.02))
box(TRIM, (L - 0.08, H + 0.012, 0), (R + 0.08, H + 0.08, 0.02))
for low, high in (((0, 0, 0), (L - 0.08, 0.09, 0.015)), ((R + 0.08, 0, 0), (X, 0.09, 0.015)), ((0, 0, 0), (0.015, 0.09, Z)),
                  ((X - 0.015, 0, 0), (X, 0.09, Z))):
    box(TRIM, low, high)

# A table on its rug, two chairs.
box(BORDER, (2.05, 0.0, 0.72), (4.15, 0.008, 2.28))
box(RUG, (2.15, 0.004, 0.82), (4.05, 0.012, 2.18))
box(WOOD, (2.35, 0.71, 1.05), (3.85, 0.75, 1.9))
for x in (2.42, 3.72):
    for z in (1.12, 1.77):
        box(WOOD, (x, 0.012, z), (x + 0.06, 0.71, z + 0.06))


def chair(x, z, turn):
    def part(of, low, high):
        box(of, [low[0] + x, low[1], low[2] + z], [high[0] + x, high[1], high[2] + z], turn, (x, z))
    part(CLOTH, (-0.21, 0.43, -0.2), (0.21, 0.48, 0.21))
    for a in (-0.2, 0.165):
        part(DARK, (a, 0.012, 0.17), (a + 0.035, 0.43, 0.205))
        part(DARK, (a, 0.012, -0.215), (a + 0.035, 0.95, -0.18))
    for y in (0.62, 0.74, 0.86):
        part(DARK, (-0.165, y, -0.208), (0.165, y + 0.05, -0.19))


chair(2.05, 1.5, 100)
chair(3.15, 0.82, 8)

# On the table: a vase, a copper pot, a bowl of fruit, books.
lathe("vase", [(0.001, 0), (0.055, 0), (0.075, 0.03), (0.095, 0.09), (0.1, 0.14), (0.085, 0.2), (0.05, 0.25), (0.035, 0.29), (0.04, 0.32), (0.055, 0.34)])
lathe("pot", [(0.001, 0), (0.07, 0), (0.1, 0.02), (0.115, 0.06), (0.11, 0.1), (0.085, 0.14), (0.06, 0.155), (0.02, 0.165), (0.012, 0.18), (0.022, 0.195), (0.001, 0.205)])
lathe("bowl", [(0.001, 0), (0.05, 0), (0.06, 0.012), (0.11, 0.05), (0.135, 0.09), (0.127, 0.09), (0.1, 0.055), (0.05, 0.022), (0.001, 0.018)])
lathe("ball", [(max(0.001, math.sin(math.pi * i / 14)), -math.cos(math.pi * i / 14)) for i in range(15)], 28)
place("vase", GLAZE, (3.5, 0.75, 1.28))
place("pot", COPPER, (3.1, 0.75, 1.42))
place("bowl", WHITE, (2.68, 0.75, 1.45))
for i, (x, y, z) in enumerate(((-0.045, 0.07, 0.03), (0.05, 0.068, 0.02), (0.0, 0.07, -0.05), (0.005, 0.125, 0.005))):
    place("ball", FRUIT[i % 3], (2.68 + x, 0.75 + y, 1.45 + z), (0.042, 0.04, 0.042))
for i, turn in enumerate((12, -8, 20)):
    box(BOOKS[i], (3.3, 0.75 + 0.035 * i, 1.55), (3.52, 0.782 + 0.035 * i, 1.71), turn, (3.41, 1.63))

# A shelf with books at the back wall, a picture, a plant, a lamp that is off.
for x in (4.0, 5.0):
    box(WOOD, (x, 0, 0.02), (x + 0.03, 1.95, 0.32))
box(WOOD, (4.03, 0, 0.02), (5.0, 1.95, 0.03))
for y in (0.06, 0.5, 0.9, 1.3, 1.68, 1.92):
    box(WOOD, (4.03, y, 0.03), (5.0, y + 0.025, 0.32))
for y, top in ((0.085, 0.38), (0.525, 0.33), (0.925, 0.33), (1.325, 0.3)):
    x = 4.04
    while x < 4.9 - random.choice((0, 0.15, 0.35)):
        wide, tall = random.uniform(0.018, 0.05), random.uniform(0.62, 0.95) * top
        box(random.choice(BOOKS), (x, y, 0.09), (x + wide, y + tall, random.uniform(0.24, 0.29)))
        x += wide + 0.001
place("pot", WHITE, (4.55, 1.705, 0.17), (0.9, 0.9, 0.9))
box(DARK, (2.45, 1.28, 0), (3.55, 2.06, 0.03))
box(WHITE, (2.49, 1.32, 0.03), (3.51, 2.02, 0.032))
for of, (x0, y0, x1, y1) in ((BOOKS[1], (2.56, 1.39, 2.95, 1.95)), (FRUIT[1], (2.98, 1.66, 3.44, 1.95)), (BOOKS[0], (2.98, 1.39, 3.2, 1.63)),
                             (BOOKS[3], (3.23, 1.39, 3.44, 1.63))):
    box(of, (x0, y0, 0.032), (x1, y1, 0.034))
lathe("flower pot", [(0.001, 0), (0.13, 0), (0.17, 0.3), (0.185, 0.3), (0.185, 0.33), (0.16, 0.33), (0.155, 0.29), (0.001, 0.28)])
place("flower pot", CLAY, (0.45, 0, 0.5))
leaf = [(side * 0.035 * math.sin(math.pi * (0.08 + 0.88 * t)) ** 0.8, 0.75 * math.sin(1.25 * t), 0.42 * t * t)
        for t in (i / 6 for i in range(7)) for side in (-1, 1)]
mesh("leaf", leaf, [q for i in range(0, 12, 2) for q in ((i, i + 1, i + 3), (i, i + 3, i + 2))])
for i in range(38):
    s = random.uniform(0.7, 1.5)
    place("leaf", LEAF, (0.45 + random.uniform(-0.05, 0.05), 0.25, 0.5 + random.uniform(-0.05, 0.05)),
          (1.2, s, random.uniform(0.4, 1.0) * s), 137.5 * i)
lathe("shade", [(0.05, 0.2), (0.2, 0.02), (0.2, 0), (0.19, 0), (0.045, 0.19)])
place("shade", WHITE, (3.1, 1.82, 1.47))
box(DARK, (3.097, 2.0, 1.467), (3.103, Y, 1.473))

# The next room: a chest.
box(DARK, (2.4, 0, -5.95), (3.8, 0.9, -5.5))

# A mesh of glTF is geometry with a material.
made, table = {}, []
for n in nodes:
    if n["mesh"] not in made:
        made[n["mesh"]] = len(table)
        attributes, indices = meshes[n["mesh"][0]]
        table.append({"primitives": [{"attributes": attributes, "indices": indices, "material": n["mesh"][1]}]})
    n["mesh"] = made[n["mesh"]]
    for key, plain in (("translation", [0, 0, 0]), ("scale", [1, 1, 1]), ("rotation", [0, 0, 0, 1])):
        if list(map(float, n[key])) == list(map(float, plain)):
            del n[key]
        else:
            n[key] = [round(v, 6) for v in n[key]]


def looking(eye, at):
    """The quaternion of a camera that looks along -z, upright."""
    d = [a - e for a, e in zip(at, eye)]
    turn, tilt = math.atan2(-d[0], -d[2]) / 2, math.atan2(d[1], math.hypot(d[0], d[2])) / 2
    return [round(v, 6) for v in (math.cos(turn) * math.sin(tilt), math.sin(turn) * math.cos(tilt),
                                  -math.sin(turn) * math.sin(tilt), math.cos(turn) * math.cos(tilt))]


EYE = [4.55, 1.5, 4.0]
nodes.append({"name": "camera", "camera": 0, "translation": EYE, "rotation": looking(EYE, (2.35, 0.98, 0.5))})
document = {
    "asset": {"version": "2.0", "generator": "furnished.py", "copyright": "CC0"}, "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}],
    "cameras": [{"type": "perspective", "name": "camera", "perspective": {"yfov": 0.82, "aspectRatio": 1.777778, "znear": 0.05}}],
    "extensionsUsed": ["KHR_materials_emissive_strength"], "nodes": nodes, "meshes": table, "materials": materials, "accessors": accessors,
    "bufferViews": views, "buffers": [{"byteLength": len(binary)}]}
text = json.dumps(document, separators=(",", ":")).encode()
text += b" " * (-len(text) % 4)
with open("furnished.glb", "wb") as out:
    out.write(struct.pack("<4s2I", b"glTF", 2, 28 + len(text) + len(binary)) + struct.pack("<I4s", len(text), b"JSON") + text
              + struct.pack("<I4s", len(binary), b"BIN\0") + binary)
