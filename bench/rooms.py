"""Made-up scenes and skies: diffuse rooms without a lamp, to be lit by an environment through their openings; one whose
window has six panes; two furnished rooms of as many triangles as wanted; and a clear sky as an environment map."""
import itertools
from pathlib import Path

import numpy as np

from common import Setting, Stop, settings
from formats import Builder, exr_write, portals_glb

# ---- A clear sky ----
# Latitude-longitude, as tdpt-render reads it: centre of the picture -Z, three quarters of its width +X, top +Y.
# The sky is CIE's standard clear sky (CIE S 011/ISO 15469, type 12, low illuminance turbidity): in the zenith angle Z
# of a place and its angle s to the sun its luminance is in proportion to
#   (1 - exp(-0.32 / cos Z)) (1 + 10 (exp(-3 s) - exp(-3 pi / 2)) + 0.45 cos^2 s),
# scaled so that it brings a horizontal plane the irradiance pi, as a sky of radiance 1 all over would. The sun is a
# disc of 0.53 degrees with ten times that irradiance across its rays (a clear day's diffuse light is about a tenth of
# the direct, Meinel and Meinel 1976): a radiance of 4.7e5. A texel that it covers in part has the mean, so the map
# keeps its irradiance whatever the size. The ground below the horizon is grey and reflects `ground` of all that
# reaches it.
SUN_ANGLE = 0.53  # degrees across
SUN_RATIO = 10.0  # irradiance across its rays to that of the sky on the ground
POINTS = 512  # along the radius of the sun's disc, and around it
# Linear Rec.709, luminance 1.
SKY_TINT, SUN_TINT = (np.array(c) / np.dot(c, (0.2126, 0.7152, 0.0722)) for c in ((0.6, 0.95, 1.7), (1.0, 0.93, 0.8)))


def towards(azimuth, altitude):
    """Unit vector; degrees, azimuth from -Z towards +X, clockwise seen from above."""
    a, h = np.radians(azimuth), np.radians(altitude)
    return np.array([np.sin(a) * np.cos(h), np.sin(h), -np.cos(a) * np.cos(h)])


def directions(column, row, width, height):
    """Of places in the picture, in texels from its upper left corner: ... x 3."""
    azimuth = 2 * np.pi * (np.asarray(column) / width - 0.5)
    polar = np.pi * np.asarray(row) / height
    return np.stack([np.sin(azimuth) * np.sin(polar), np.cos(polar), -np.cos(azimuth) * np.sin(polar)], -1)


def solid_angles(width, height):
    """Of the texels of each row [sr]."""
    return -np.diff(np.cos(np.pi * np.arange(height + 1) / height)) * 2 * np.pi / width


def middles(width, height):
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    return directions(x, y, width, height)


def irradiance(radiance, normal):
    """On a plane that nothing hides [W/m2]; of the texels as they are, seen at their middles."""
    height, width = radiance.shape[:2]
    cosine = np.maximum(middles(width, height) @ normal, 0)
    return np.einsum("yxc,yx,y->c", np.atleast_3d(radiance), cosine, solid_angles(width, height))


def clear_sky(width, height, sun):
    """Luminance, 0 below the horizon."""
    w = middles(width, height)
    to_sun = np.arccos(np.clip(w @ sun, -1, 1))
    above = w[..., 1] > 0
    gradation = 1 - np.exp(-0.32 / np.where(above, w[..., 1], 1))
    indicatrix = 1 + 10 * (np.exp(-3 * to_sun) - np.exp(-1.5 * np.pi)) + 0.45 * np.cos(to_sun) ** 2
    sky = np.where(above, gradation * indicatrix, 0)
    return sky * np.pi / irradiance(sky, np.array([0.0, 1.0, 0.0]))[0]


def raster(w, width, height):
    """Column and row of directions, in texels from the upper left corner."""
    column = width * (0.5 + np.arctan2(w[..., 0], -w[..., 2]) / (2 * np.pi))
    return column, height * np.arccos(np.clip(w[..., 1], -1, 1)) / np.pi


def sun_share(width, height, sun):
    """Of the sun's solid angle the share that each texel holds: POINTS^2 directions evenly over its disc."""
    steps = (np.arange(POINTS) + 0.5) / POINTS
    cosine, turn = np.meshgrid(1 - (1 - np.cos(np.radians(SUN_ANGLE) / 2)) * steps, 2 * np.pi * steps)
    sine = np.sqrt(1 - cosine**2)
    side = np.cross(sun, (1.0, 0.0, 0.0) if abs(sun[0]) < 0.5 else (0.0, 1.0, 0.0))
    side /= np.linalg.norm(side)
    parts = ((cosine, sun), (sine * np.cos(turn), side), (sine * np.sin(turn), np.cross(sun, side)))
    x, y = (np.floor(c).astype(int).ravel() for c in raster(sum(a[..., None] * v for a, v in parts), width, height))
    texels = np.minimum(y, height - 1) * width + x % width
    return np.bincount(texels, minlength=width * height).reshape(height, width) / texels.size


def sky_map(width, height, sun, with_sun, ground=0.2):
    """Radiance, height x width x 3."""
    radiance = clear_sky(width, height, sun)[..., None] * SKY_TINT
    reaches_ground = np.pi * SKY_TINT
    if with_sun:
        share = sun_share(width, height, sun) / solid_angles(width, height)[:, None]
        radiance += (SUN_RATIO * np.pi * share)[..., None] * SUN_TINT
        reaches_ground = reaches_ground + SUN_RATIO * np.pi * max(sun[1], 0) * SUN_TINT
    radiance[height // 2 :] = ground * reaches_ground / np.pi
    return radiance


@settings(OUT=Setting("sky.exr", "the file"), WIDTH=Setting(256, "texels; the height is half of it"),
          AZIMUTH=Setting(0.0, "of the sun, degrees from -Z towards +X"),
          ALTITUDE=Setting(35.0, "of the sun, degrees above the horizon"), SUN=Setting(0, "1: with the sun itself"),
          GROUND=Setting(0.2, "albedo of the ground"))
def write_sky_map(bench):
    """A clear sky as an environment map, without its sun or with it."""
    s = bench.settings
    if s.width < 8 or s.width % 4:
        raise Stop(2, "WIDTH: expected a multiple of 4 from 8 on")
    if not 1 <= s.altitude <= 90:
        raise Stop(2, "ALTITUDE: expected 1 to 90 degrees")
    sky = sky_map(s.width, s.width // 2, towards(s.azimuth, s.altitude), s.sun, s.ground)
    exr_write(s.out, sky, " ".join(["made by bench/run.py sky-map", *map("=".join, bench.given.items())]))


def quarters(width=256):
    """A map that shows how it lies: each quarter of the horizon its colour, dark below, one bright block of 11 degrees
    around azimuth 80 (from -Z towards +X), altitude 35."""
    w = middles(width, width // 2)
    quarter = (w[..., 0] > 0) * 1 + (w[..., 2] > 0) * 2
    colours = np.array([(0.9, 0.3, 0.2), (0.2, 0.8, 0.3), (0.25, 0.3, 0.9), (0.7, 0.7, 0.2)])
    radiance = colours[quarter] * np.where(w[..., 1:2] > 0, 1.0, 0.2)
    x, y = (int(c) for c in raster(towards(75, 40), width, width // 2))
    radiance[y : y + width // 32, x : x + width // 32] = (60, 40, 90)
    return radiance


# ---- Rooms for a sky ----
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
        for cell in itertools.product(*(zip(c, c[1:]) for c in cuts)):
            if not any(all(h[0][i] < sum(cell[i]) / 2 < h[1][i] for i in range(3)) for h in holes):
                self.block(*zip(*cell), colour)

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
            lamps.append((*sides, [*frame.tolist(), [0.0, 0.0, 0.0, 1.0]]))
        return PORTALS.format(lamps=",\n    ".join(map(repr, lamps)))

    def glb(self):
        builder = Builder()
        for colour, boxes in self.boxes.items():
            places = np.concatenate([low + CORNERS * (high - low) for low, high in boxes])
            triangles = [i for q in FACES for i in (*q[:3], q[0], *q[2:])]
            corners = [8 * b + i for b in range(len(boxes)) for i in triangles]
            builder.mesh(places, corners, material=builder.diffuse(colour, doubleSided=True))
        builder.camera(self.eye, self.target, yfov=self.yfov)
        return builder.content()


def shell(room, x, z, height, holes, colours):
    """Floor, ceiling and the walls -X, +X, -Z, +Z round the inside from -x to x, 0 to height and -z to z, 0.2 m thick.
    They reach into each other: no two have a face in one plane, which Cycles shows black."""
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


def made(eye, target, yfov, inside, holes, colours, *blocks, landscape=False):
    """A room by the arguments of Room, of shell and of block; landscape: with ground outside."""
    room = Room(eye, target, yfov)
    shell(room, *inside, holes, colours)
    for block in (((-20, -0.4, -20), (20, -0.1, 20), GROUND),) * landscape + blocks:
        room.block(*block)
    return room


BOX = ((-0.4, -0.03, -2.2), (1.2, 0.75, -1.4))


def window():
    return made((-1.5, 1.5, 2.1), (0.9, 1.0, -1.0), 1.1, (2, 2.5, 2.6), {"+x": [((1, 0.9, -0.8), (3, 2.2, 0.8))]},
                {"-z": GREEN}, BOX, ((8, -0.3, -4), (9, 2, 3), RED), landscape=True)


def skylight():
    return made((-1.7, 1.5, 1.7), (0.6, 0.9, -0.8), 1.0, (2, 2, 2.5), {"ceiling": [((-0.3, 2, -1.2), (0.9, 3, 0.3))]},
                {"+x": RED, "-z": GREEN}, ((0.6, -0.03, -1.5), (1.2, 0.7, -0.9)))


def windows():
    holes = {"+x": [((2, 0.8, -1.5), (3, 2.1, -0.3)), ((2, 0.8, 0.3), (3, 2.1, 1.5))],
             "-z": [((1, 0.9, -3), (2.2, 2, -1))]}
    return made((-2.2, 1.4, 1.5), (1.6, 1.2, -1.0), 1.1, (2.5, 2, 2.6), holes, {"-x": RED, "-z": GREEN},
                ((8, -0.3, -5), (9, 3, 1), RED), landscape=True)


def behind():
    room = made((-3.6, 1.5, 1.4), (-0.6, 1.0, -0.8), 1.1, (4, 2, 2.6), {"+x": [((3, 0.8, -1.5), (5, 2.2, 1.5))]},
                {"-z": GREEN})
    room.wall((-0.1, -0.03, -2.1), (0.1, 2.72, 2.1), [((-1, -1, -1.6), (1, 2, -0.7))], RED)
    return room


ROOMS = {room.__name__: room for room in (window, skylight, windows, behind)}


# ---- A room whose window has three by two panes ----
LOW, HIGH = (0.7, -1.1), (2.3, 1.1)  # of the window, y and z
PANES_ACROSS, PANES_UP = 3, 2
WINDOW_X = 2.1  # x of the middle of the wall, where bars and portals are
BAR_DEPTH = 0.06  # of the bars


def panes(bar):
    """Corners (low, high) of each pane, y and z."""
    up, across = (((HIGH[i] - LOW[i]) - (n - 1) * bar) / n for i, n in ((0, PANES_UP), (1, PANES_ACROSS)))
    lows = [(LOW[0] + r * (up + bar), LOW[1] + c * (across + bar))
            for r in range(PANES_UP) for c in range(PANES_ACROSS)]
    return [(low, (low[0] + up, low[1] + across)) for low in lows]


def paned_room(bar):
    r = made((-1.6, 1.5, 2.1), (0.9, 1.0, -1.0), 1.1, (2, 2.5, 2.6), {"+x": [((1, *LOW), (3, *HIGH))]}, {"-z": GREEN},
             BOX, landscape=True)
    (y, z), (top, right) = panes(bar)[0]
    x = (WINDOW_X - BAR_DEPTH / 2, WINDOW_X + BAR_DEPTH / 2)
    for row in range(1, PANES_UP):
        low = top + (row - 1) * (top - y + bar)
        r.block((x[0], low, LOW[1] - 0.01), (x[1], low + bar, HIGH[1] + 0.01))
    for column in range(1, PANES_ACROSS):  # 1 cm less deep: no two faces in one plane
        low = right + (column - 1) * (right - z + bar)
        r.block((x[0] + 0.005, LOW[0] - 0.01, low), (x[1] - 0.005, HIGH[0] + 0.01, low + bar))
    return r


def write_paned_rooms(folder):
    """panes-4.glb and panes-20.glb, by the width of their bars [cm], and beside each its portals, one for all panes,
    one a column or one a pane: panes-4-one.glb, panes-4-three.glb, panes-4-six.glb, ..."""
    for centimetres in (4, 20):
        bar = centimetres / 100
        columns = [((LOW[0], low[1]), (HIGH[0], high[1])) for low, high in panes(bar)[:PANES_ACROSS]]
        (folder / f"panes-{centimetres}.glb").write_bytes(paned_room(bar).glb())
        for name, rectangles in (("one", [(LOW, HIGH)]), ("three", columns), ("six", panes(bar))):
            portals = [((WINDOW_X, y, z), (0, 0, right - z), (0, top - y, 0)) for (y, z), (top, right) in rectangles]
            (folder / f"panes-{centimetres}-{name}.glb").write_bytes(portals_glb(portals))


def write_rooms(folder):
    """NAME.glb of each room, the same as portals for Blender, and quarters.exr."""
    for name, room in ROOMS.items():
        (folder / f"{name}.glb").write_bytes(room().glb())
        (folder / f"{name}.portals.py").write_text(room().portals_for_blender(), encoding="ascii")
    exr_write(folder / "quarters.exr", quarters())


@settings(FOLDER=Setting(".", "that of the files"))
def write_all_rooms(bench):
    """In a folder window.glb, skylight.glb, windows.glb (a corner window, ground and a house outside), behind.glb (a
    window, then a door); beside each NAME.portals.py, the openings to the outside as Blender's portals, as one would
    draw them by hand; and quarters.exr."""
    write_rooms(Path(bench.settings.folder))


# ---- Many triangles ----
# The rooms stand along x, each 2 m wide, high and deep; the wall between them, 0.1 m thick, has the opening OPENING.
# The lamp hangs in the first room, the camera stands in the second. Every surface is a patch over the unit square, cut
# into cells of two triangles each; a third of the triangles is walls, the rest eight bumpy balls on the floors. FORM:
#   grid   a mesh for each patch, neighbours share their corners: half a vertex a triangle
#   parts  the same in pieces of at most 512 triangles, a mesh and a node each
#   soup   as grid, but no triangle shares a corner: three vertices each
# Vertices have a place and a normal, as exporters write them. The same bytes for the same arguments.
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


def walls():
    """Quads: the inner sides of both rooms but the wall between them; both faces of that, and its opening's jambs."""
    quads = []
    for x0, x1 in ((0, 2), (2.1, 4.1)):
        quads += [((x0, 0, 1), (x1, 0, 1), (x1, 0, -1), (x0, 0, -1)),
                  ((x0, 2, -1), (x1, 2, -1), (x1, 2, 1), (x0, 2, 1)),
                  ((x0, 0, -1), (x1, 0, -1), (x1, 2, -1), (x0, 2, -1)),
                  ((x1, 0, 1), (x0, 0, 1), (x0, 2, 1), (x1, 2, 1)),
                  ((x0, 0, 1), (x0, 0, -1), (x0, 2, -1), (x0, 2, 1)) if x0 == 0 else
                  ((x1, 0, -1), (x1, 0, 1), (x1, 2, 1), (x1, 2, -1))]
    xa, xb = OPENING["x"]
    outer, inner = ([(y0, z0), (y0, z1), (y1, z1), (y1, z0)] for (y0, y1), (z0, z1) in
                    (((0, 2), (-1, 1)), (OPENING["y"], OPENING["z"])))
    for k in range(4):
        o, p, i, j = outer[k], outer[(k + 1) % 4], inner[k], inner[(k + 1) % 4]
        quads += [((xa, *p), (xa, *j), (xa, *i), (xa, *o)), ((xb, *o), (xb, *i), (xb, *j), (xb, *p)),
                  ((xa, *i), (xa, *j), (xb, *j), (xb, *i))]
    return quads


def lengths(quad):
    """Of the sides of a quad along u and v, the longer of each two."""
    a, b, c, d = (np.array(p, float) for p in quad)
    return max(np.linalg.norm(b - a), np.linalg.norm(c - d)), max(np.linalg.norm(d - a), np.linalg.norm(c - b))


def patches(triangles):
    """(surface, cells along u, cells along v) of all but the lamp."""
    quads = walls()
    area = sum(u * v for u, v in map(lengths, quads))
    step = np.sqrt(2 * area / (triangles * SHARE_OF_WALLS))
    out = [(bilinear(*quad), *(max(1, round(side / step)) for side in lengths(quad))) for quad in quads]
    left = triangles - sum(2 * n * m for _, n, m in out)
    across = max(3, round(np.sqrt(max(left, 0) / (2 * 8 * 2))))
    return out + [(ball(x0 + x, z), 2 * across, across) for x0 in (0, 2.1) for x, z in BALLS]


def write_scene(triangles, form, path):
    """The number of triangles that there are in the end."""
    builder, count = Builder(), 2
    builder.diffuse((0.7, 0.7, 0.7), doubleSided=True)
    strength = {"KHR_materials_emissive_strength": {"emissiveStrength": LAMP_RADIANCE}}
    lamp = builder.diffuse((0, 0, 0), emissiveFactor=[1, 1, 1], extensions=strength)
    corners = np.array([(0.75, 1.99, -0.25), (1.25, 1.99, -0.25), (1.25, 1.99, 0.25), (0.75, 1.99, 0.25)])
    builder.mesh(corners, [0, 1, 2, 0, 2, 3], np.tile([0.0, -1, 0], (4, 1)), lamp)
    for surface, n, m in patches(triangles):
        size = PART if form == "parts" else max(n, m)
        for j, i in itertools.product(range(0, m, size), range(0, n, size)):
            across, up = min(size, n - i), min(size, m - j)
            v, u = np.meshgrid((j + np.arange(up + 1)) / m, (i + np.arange(across + 1)) / n, indexing="ij")
            place, normal = (a.reshape(-1, 3) for a in surface(u, v))
            a = (np.arange(up)[:, None] * (across + 1) + np.arange(across)[None, :]).ravel()
            corners = np.stack([a, a + 1, a + across + 2, a, a + across + 2, a + across + 1], -1).ravel()
            if form == "soup":
                place, normal, corners = place[corners], normal[corners], None
            builder.mesh(place, corners, normal, 0)
            count += 2 * across * up
    builder.camera(np.array([3.9, 1.6, 0.6]), np.array([2.6, 0.8, -0.2]), yfov=1.0, aspectRatio=4 / 3)
    Path(path).write_bytes(builder.content())
    return count


@settings(TRIANGLES=Setting(1e5, "about so many"), FORM=Setting("grid", "of: grid parts soup"),
          OUT=Setting("room.glb", "the file"))
def write_many_triangles(bench):
    """Two furnished rooms with one opening, of about so many triangles."""
    s = bench.settings
    print(write_scene(int(s.triangles), s.form, s.out))
