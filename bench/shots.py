"""Two shots of 48 frames in two furnished rooms that share a door; the only lamp hangs in the far one. The walk: the
camera goes from the near room through the open door into the far one. The door: the camera stands in the near room, and
the door opens from 5 to 90 degrees."""
import functools
from pathlib import Path

import numpy as np

import pages
from common import Setting, settings
from formats import FLOAT, Builder, exr_read
from rooms import CORNERS, FACES, GREEN, GREY, RED, WHITE, WOOD, Room, shell

FRAMES, FPS = 48, 24
HINGE, WIDTH, HEIGHT, LEAF = np.array((0.15, 0.0, 0.06)), 0.9, 2.05, 0.04  # of the door [m]
# Of the walk: frame, place, what the camera looks at.
WALK = ((1, (-1.5, 1.5, 3.9), (0.4, 1.2, 0.0)), (17, (0.1, 1.5, 2.2), (0.6, 1.2, -0.5)),
        (25, (0.55, 1.5, 0.8), (0.5, 1.2, -1.5)), (33, (0.6, 1.5, -0.6), (0.0, 1.1, -2.5)),
        (48, (0.9, 1.5, -2.4), (-1.2, 0.9, -3.4)))
STAND = ((-1.3, 1.5, 3.2), (0.5, 1.1, 0.0))


def rooms():
    room = Room((0, 0, 0), (0, 0, 1))
    shell(room, 2.2, 4.2, 2.6, {}, {"-x": RED, "-z": GREEN})
    room.wall((-2.3, -0.02, -0.06), (2.3, 2.65, 0.06), [((HINGE[0], -1, -1), (HINGE[0] + WIDTH, HEIGHT, 1))], GREY)
    for low, high, colour in (
            ((-2.1, 0, 0.5), (-1.7, 1.9, 1.6), WOOD), ((1.2, 0, 1.2), (2.0, 0.75, 2.6), WOOD), ((1.5, 0.75, 1.5), (1.7, 1.05, 1.7), RED),
            ((-0.6, 0.42, 1.4), (0.3, 0.46, 2.0), WOOD), ((-0.5, 0, 1.5), (-0.45, 0.42, 1.55), WOOD), ((0.15, 0, 1.85), (0.2, 0.42, 1.9), WOOD),
            ((-2.0, 0, -3.9), (-0.6, 0.5, -2.2), GREEN), ((-2.0, 0.5, -3.9), (-1.4, 0.9, -3.5), WHITE),
            ((1.4, 0, -3.9), (2.1, 1.8, -2.9), WOOD), ((1.5, 0, -1.2), (2.0, 0.7, -0.7), WHITE)):
        room.block(low, high, colour)
    return room


def turn(angle):
    """About +Y, as a quaternion."""
    return [0.0, float(np.sin(angle / 2)), 0.0, float(np.cos(angle / 2))]


def looking(eye, target):
    """The rotation of an upright camera, as a quaternion."""
    back = np.asarray(eye, float) - target
    back /= np.linalg.norm(back)
    yaw, pitch = np.arctan2(back[0], back[2]), -np.arcsin(back[1])
    (sy, cy), (sp, cp) = ((np.sin(a / 2), np.cos(a / 2)) for a in (yaw, pitch))
    return [float(v) for v in (cy * sp, sy * cp, -sy * sp, cy * cp)]


def animate(builder, node, path, frames, values, kind):
    """A straight line from key to key."""
    times = builder.accessor(np.array(frames) / FPS, FLOAT, "SCALAR", min=[min(frames) / FPS], max=[max(frames) / FPS])
    if "animations" not in builder.json:
        builder.add("animations", {"name": "shot", "channels": [], "samplers": []})
    animation = builder.json["animations"][0]
    animation["samplers"].append({"input": times, "output": builder.accessor(values, FLOAT, kind)})
    animation["channels"].append({"sampler": len(animation["samplers"]) - 1, "target": {"node": node, "path": path}})


def shot(walks, angles):
    """`walks`: whether the camera does; `angles`: of the door at the first and at the last frame [degrees]."""
    builder = Builder()
    triangles = [i for q in FACES for i in (*q[:3], q[0], *q[2:])]
    for colour, boxes in rooms().boxes.items():
        places = np.concatenate([low + CORNERS * (high - low) for low, high in boxes])
        builder.mesh(places, [8 * b + i for b in range(len(boxes)) for i in triangles],
                     material=builder.diffuse(colour, doubleSided=True))
    leaf = np.array((0.01, 0.01, -LEAF)) + CORNERS * (WIDTH - 0.02, HEIGHT - 0.02, LEAF)
    builder.mesh(leaf, triangles, material=builder.diffuse(WHITE, doubleSided=True), name="door",
                 translation=HINGE.tolist(), rotation=turn(np.radians(-angles[0])))
    door = len(builder.json["nodes"]) - 1
    lamp = builder.diffuse((0.8, 0.8, 0.8), emissiveFactor=[1.0, 0.9, 0.75],
                           extensions={"KHR_materials_emissive_strength": {"emissiveStrength": 40.0}})
    builder.mesh([(-0.9, 2.5, -2.9), (-0.3, 2.5, -2.9), (-0.3, 2.5, -2.3), (-0.9, 2.5, -2.3)], [0, 1, 2, 0, 2, 3], material=lamp)
    eye = builder.add("cameras", {"type": "perspective", "perspective": {"znear": 0.01, "yfov": 1.0, "aspectRatio": 16 / 9}})
    keys = WALK if walks else ((1, *STAND),)
    builder.node({"camera": eye, "name": "camera", "translation": list(keys[0][1]), "rotation": looking(*keys[0][1:])})
    if walks:
        node = len(builder.json["nodes"]) - 1
        animate(builder, node, "translation", [k[0] for k in keys], [k[1] for k in keys], "VEC3")
        animate(builder, node, "rotation", [k[0] for k in keys], [looking(*k[1:]) for k in keys], "VEC4")
    if angles[0] != angles[1]:
        frames = list(range(1, FRAMES + 1, 4)) + [FRAMES]
        turned = [angles[0] + (angles[1] - angles[0]) * (f - 1) / (FRAMES - 1) for f in frames]
        animate(builder, door, "rotation", frames, [turn(np.radians(-a)) for a in turned], "VEC4")
    return builder.content()


SHOTS = {"walk": lambda: shot(True, (85, 85)), "door": lambda: shot(False, (5, 90))}


@settings(OUT=Setting(".", "the folder of the files"))
def write_shots(bench):
    """The two shots, walk.glb and door.glb."""
    for name, make in SHOTS.items():
        (Path(bench.settings.out) / f"{name}.glb").write_bytes(make())


# ---- What is measured of them ----
PAIRS = {"walk": (8, 18, 30), "door": (3, 8, 30)}  # the first of two successive frames
BUFFERS = ("--aov", "halves,albedo,normal,depth")


class Shot:
    """One of the two, in a bench's cache."""

    def __init__(self, bench, name):
        self.bench, self.name, self.moves = bench, name, name == "door"
        made = SHOTS[name]()
        self.scene = bench.store.keep([name, made.hex()], lambda path: path.write_bytes(made), ".glb")

    def search(self, frames, time, draft):
        """Portals: the file, and CPU seconds of the four stages."""
        quality = ("--quality", "draft") if draft else ()
        run = self.bench.store.run
        network = run("ffgraph", self.scene, *frames, *quality, threads=0)
        cut = run("mincut", network.out, threads=0)
        grid = run("lightgrid", self.scene, cut.out, "--at", time / FPS, *quality, threads=0)
        found = run("portalfit", grid.out, threads=0)
        return found.out, sum(r.cpu for r in (network, cut, grid, found))

    def portals(self, frame):
        """As tdpt seeks them for the frame."""
        return self.search(("--frames", frame), frame, True) if self.moves else self.search(("--frames", f"1-{FRAMES}"), 1, False)

    def own(self, frame):
        """As they are sought for a picture."""
        return self.search(("--at", frame / FPS), frame, False)

    def render(self, frame, spp, seed, portals, *options):
        return self.bench.store.run("tdpt-render", self.scene, "--at", frame / FPS, "--portal", portals, "--integrator",
                                    "tdpt-guided", "--width", self.bench.settings.width, "--spp", spp, "--seed", seed, *options)

    def reference(self, frame):
        portals = self.own(frame)[0]
        return self.bench.halves(lambda seed: self.render(frame, self.bench.settings.ref, seed + frame, portals))


def flicker(before, after, references):
    """Error of the difference of two frames, relative to the first: the mean of products with two references of each, so
    that their noise does not count."""
    (a1, b1), (a2, b2) = (tuple(exr_read(half)[0] for half in (r.a, r.b)) for r in references)
    change = exr_read(after)[0] - exr_read(before)[0]
    scale = ((a1 + b1) / 2) ** 2
    return float(np.mean((change - (a2 - a1)) * (change - (b2 - b1)) / (scale + 1e-2 * scale.mean())))


def line_of_portals(shot, frame):
    """Worth of the shot's portals beside those of the frame's own, by error x CPU time of tdpt-guided."""
    s, reference = shot.bench.settings, shot.reference(frame)

    def price(portals):
        runs = [shot.render(frame, s.spp, seed * 1000 + frame, portals) for seed in range(1, s.seeds + 1)]
        return sum(reference.off(r.out)["relmse"] for r in runs) * sum(r.cpu for r in runs) / s.seeds**2

    (shared, cpu), (own, _) = shot.portals(frame), shot.own(frame)
    one = shot.render(frame, s.spp, 1000 + frame, shared).cpu
    search = cpu if shot.moves else cpu / FRAMES
    return [shot.name, frame, pages.hundredths(price(own) / price(shared)), pages.three(search), pages.three(one),
            pages.three(100 * search / (search + one))]


def line_of_flicker(shot, first):
    """Of the frames `first` and the next: the error of their difference, noisy, filtered alone and with others."""
    spp, rendered = shot.bench.settings.spp, {}
    for frame in range(first - 1, first + 3):
        rendered[frame] = shot.render(frame, spp, 1 + frame, shot.portals(frame)[0], *BUFFERS).out
    references = [shot.reference(frame) for frame in (first, first + 1)]
    alone, beside = ([shot.bench.store.run("exrdenoise", rendered[k], "--denoiser", "regression", *others(k)).out
                      for k in (first, first + 1)]
                     for others in (lambda k: (), lambda k: ("--previous", rendered[k - 1], "--next", rendered[k + 1])))
    noisy, single, both = (flicker(*pair, references) for pair in ((rendered[first], rendered[first + 1]), alone, beside))
    told = [pages.three(error) if error > 0 else "–" for error in (noisy, single, both)]
    return [shot.name, f"{first} to {first + 1}", *told, pages.hundredths(single / both) if single > 0 < both else "–"]


@settings(SPP=Setting(16, "samples per pixel", 2), WIDTH=Setting(160, "of the pictures", 48), SEEDS=Setting(4, "pictures of each kind", 2),
          REF=Setting(512, "samples per pixel of each half of a reference", 8))
def shots(bench):
    """What portals of a shot are worth beside portals of each frame's own, what they cost, and how far the filter over
    frames takes flicker away: doc/shots.md. A quarter of an hour."""
    both = [Shot(bench, name) for name in SHOTS if not bench.settings.only or name in bench.settings.only]
    made = [bench.side_by_side([functools.partial(line, shot, k) for shot in both for k in PAIRS[shot.name]])
            for line in (line_of_portals, line_of_flicker)]
    parts = {"portals": pages.table(("shot", "frame", "worth of the shot's portals over its own", "CPU s of portals, per frame",
                                     "CPU s of rendering", "share of portals, %"), made[0]),
             "flicker": pages.table(("shot", "frames", "noisy", "filtered alone", "with the frames beside", "falls by"), made[1])}
    print("\n\n".join(parts.values()))
    bench.page("shots", parts)
