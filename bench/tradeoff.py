"""Every knob that trades speed for accuracy, as curves: what is measured. tradeoff_page.py makes doc/tradeoff.md of
it."""
import functools
import itertools
import math
import random
import re
from dataclasses import dataclass

import numpy as np

import pages
from common import HAVE_QUALITY, SEEDED, STAGES, TESTDATA, Portals, checked
from formats import exr_read, portals_glb, simplified

# ---- What is measured: knobs with the values that their curves have, and scenes ----
CHAIN = "the four stages"  # an option of all of them
RENDERER = "tdpt-render"



@dataclass(frozen=True)
class Knob:
    """One option of one program, or setting (--set NAME); `values` from cheap to dear, as its command line has them. words: values
    are no numbers, so points are joined by no line."""

    program: str
    option: str
    values: tuple
    default: str
    unit: str = ""
    words: bool = False

    @property
    def name(self):
        return f"{self.program} {self.option}"

    def arguments(self, value):
        option, _, setting = self.option.partition(" ")
        return (option, f"{setting}={value}" if setting else value)

    def settings(self, value):
        """{program: options}"""
        return {p: self.arguments(value) for p in (HAVE_QUALITY if self.program == CHAIN else (self.program,))}


KNOBS = (
    Knob(CHAIN, "--quality", ("draft", "normal", "high"), "normal"),
    Knob("ffgraph", "--set walks", ("6250", "25000", "100000", "400000"), "100000", "walks"),
    Knob("ffgraph", "--samples", ("18750", "75000", "300000", "1200000"), "300000", "rays a round"),
    Knob("ffgraph", "--set rounds", ("0", "1", "2", "3"), "1", "rounds"),
    Knob("ffgraph", "--set cells", ("6", "12", "24", "48"), "24", "patches along the diagonal"),
    Knob("ffgraph", "--set bounces", ("2", "4", "8", "12", "24"), "12", "surfaces of a walk"),
    Knob("ffgraph", "--nodes", ("triangles", "patches"), "patches", words=True),
    Knob("mincut", "--cuts", ("1", "2", "4", "8", "16"), "8", "bottlenecks looked for"),
    Knob("mincut", "--set largest-conductance", ("0.03", "0.06", "0.12", "0.24"), "0.12", "share of the light"),
    Knob("lightgrid", "--resolution", ("32", "64", "128", "256"), "128", "voxels along the longest side"),
    Knob("lightgrid", "--set lines", ("512", "2048", "4096", "8192", "16384", "32768"), "8192", "lines of light"),
    Knob("portalfit", "--threshold", ("0.005", "0.02", "0.05", "0.2"), "0.02", "share of the lines"),
    Knob("portalfit", "--max-portals", ("1", "2", "4", "8"), "8", "portals at most"),
    Knob("portalfit", "--set method", ("paper", "tube"), "tube", words=True),
    Knob(RENDERER, "--set guide-light", ("0", "0.25", "0.5", "0.7", "0.9"), "0.5", "probability"),
    Knob(RENDERER, "--set guide-camera", ("0", "0.2", "0.4", "0.7", "0.9"), "0.4", "probability"),
    Knob(RENDERER, "--set segments", ("0.0625", "0.125", "0.25", "0.5", "1"), "0.25", "share of the samples"),
    Knob(RENDERER, "--set light-walks", ("0.0625", "0.125", "0.25", "0.5", "1"), "0.25", "share of the samples"),
    Knob(RENDERER, "--set mis", ("balance", "power"), "balance", words=True),
)
DEPTHS = ("2", "3", "4", "6", "8", "12", "none")
INTEGRATORS = ("nee", "bdpt", "tdpt-org", "tdpt", "tdpt-guided", "auto")
WITHOUT_PORTALS = ("nee", "bdpt")
GUIDED = ("--integrator", "tdpt-guided")
LENGTHS = (1, 2, 4, 8, 16, 32, 64)  # samples per pixel, of the samples that a scene's pictures have: LENGTHS / 8


@dataclass(frozen=True)
class Scene:
    """reference: of testdata/references/efficiency, which tells size and depth. apertures: the true ones, rectangles
    (corner, edge, edge) in metres whose normal, edge x edge, is the light's way; none where they are not known in
    figures: then the portal of the most accurate settings stands for them. aperture: whether there is any; where not,
    no portal is the right answer."""

    name: str
    apertures: tuple = ()
    aperture: bool = True

    @property
    def openings(self):
        """How many there are; "" where that is not known in figures."""
        return len(self.apertures) if self.apertures or not self.aperture else ""


def hole(x, side):
    """A square in the wall about x, the light's way -x, as testdata/scenes/README.md has it."""
    h = side / 2
    return ((x, 1 - h, -h), (0, 0, side), (0, side, 0))


SCENES = (
    Scene("two-rooms", (hole(2.05, 0.25),)),
    Scene("small-hole", (hole(2.05, 0.1),)),
    Scene("three-rooms", (hole(2.05, 0.5), hole(4.15, 0.5))),
    Scene("half-metre-hole", (hole(2.05, 0.5),)),
    Scene("door-ajar"),
    Scene("cornell-box-portal", (((1.01, 0.75, -0.25), (0, 0, 0.5), (0, 0.5, 0)),)),
    Scene("veach-ajar"),
    Scene("bathroom2-channel"),
    Scene("living-room-lamps", aperture=False),
)
# Where portals are worth little or nothing: for the renderer's curves alone.
OPEN = (Scene("window", (((2.05, 0.2, -0.8), (0, 0, 1.6), (0, 1.6, 0)),)), Scene("kitchen", aperture=False),
        Scene("cornell-box", aperture=False))
WHOLE = ("two-rooms-whole", "veach-ajar-whole", "kitchen-whole", "bathroom2-whole")

# Rooms whose openings are known (libcommon/testing/rooms/known_rooms.h) that score portals, one by one.
KINDS = ("slit", "hole", "ajar-full", "doors-in-row", "two-openings", "furnished-door", "shared-edge", "ajar",
         "keyhole", "sky-window", "deep-facade", "deep-room")

# Shares of the area that the smallest triangles make, dropped before the four stages.
SIMPLIFIED = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5)
# Options of the portal that stands for an aperture that is not known in figures.
ACCURATE = {"ffgraph": ("--set", "walks=400000", "--samples", "1200000", "--set", "rounds=2"),
            "lightgrid": ("--set", "lines=32768", "--resolution", "256")}


# ---- Measuring ----
class Reference:
    """In two halves A, B of different seeds: (x - A)(x - B) stands for the square of x's error, since the noise of
    neither half is in it on average. r: mean of the halves; the squares that relMSE divides by hold their noise, which
    makes it too small by about as much as the reference's own relMSE."""

    def __init__(self, a, b):
        self.a, self.b, self.r = a, b, (a + b) / 2
        self.mean, self.peak = np.abs(self.r).mean(), np.abs(self.r).max()

    def measures(self, x):
        """relmse, mse, psnr [dB], mape [%], mean of picture x. mape holds the reference's noise."""
        square = (x - self.a) * (x - self.b)
        mse = square.mean()
        return {"relmse": (square / (self.r**2 + 0.01 * self.mean**2)).mean(), "mse": mse,
                "psnr": 10 * np.log10(self.peak**2 / mse) if mse > 0 else float("inf"),
                "mape": 100 * (np.abs(x - self.r) / (np.abs(self.r) + 0.01 * self.mean)).mean(), "mean": x.mean()}


REFERENCES = TESTDATA / "references/efficiency"
SAMPLES = 200_000  # of a picture, about


class Tradeoff:
    """The benchmark: how much of it is measured, and how."""

    def __init__(self, bench):
        self.bench, self.store, self.quick = bench, bench.store, bench.quick
        self.seeds, self.rooms = bench.settings.seeds, bench.settings.rooms
        self.lengths = LENGTHS[1::2] if self.quick else LENGTHS
        slow = ("bathroom2-channel", "half-metre-hole", "kitchen", "cornell-box") if self.quick else ()
        wanted = [name for name in (*(s.name for s in SCENES + OPEN), *WHOLE) if name not in slow]
        self.files = bench.there(wanted)

    def values(self, knob):
        at = knob.values.index(knob.default)
        return tuple(v for i, v in enumerate(knob.values) if not self.quick or abs(i - at) == 1 or i in (at, 0))

    def scenes(self, scenes):
        return tuple(s for s in scenes if s.name in self.files)

    @functools.cache
    def reference(self, scene):
        """(Reference, width, height, depth)"""
        about = pages.read_json(REFERENCES / f"{scene}.json")
        halves = (exr_read(REFERENCES / f"{scene}-{half}.exr")[0] for half in (1, 2))
        return Reference(*halves), about["width"], about["height"], about["max_depth"]

    def samples_of(self, scene):
        """Samples per pixel of its pictures: a power of two."""
        _, width, height, _ = self.reference(scene)
        return max(1, 2 ** round(math.log2(SAMPLES / (4 if self.quick else 1) / (width * height))))

    def portal(self, path, seed, options):
        """Portals of a scene by the four stages, one thread."""
        return self.bench.portals(path, threads=1, options=lambda program: (
            *(("--seed", seed) if program in SEEDED else ()), *options.get(program, ())))

    def picture(self, scene, seed, options, spp, portal=None):
        """A row of what a picture is, `options` of the renderer."""
        reference, width, height, depth = self.reference(scene)
        limit = () if depth is None or "--max-depth" in options else ("--max-depth", str(depth))
        given = ("--portal", portal) if portal else ()
        run = self.bench.render(self.files[scene], *given, *options, *limit, "--spp", spp, "--seed", seed,
                                "--width", width, "--height", height)
        rgb = exr_read(run.out)[0]
        return {"scene": scene, "seed": seed, "spp": spp, "cpu": run.said["cpu_seconds"], **reference.measures(rgb)}

    def true_portal(self, scene):
        """Where it is known, that, or a file of none; else what the most accurate settings find."""
        if scene.openings != "":
            data = portals_glb(scene.apertures)
            return self.store.keep(("portals", repr(scene.apertures)), lambda path: path.write_bytes(data))
        return self.portal(self.files[scene.name], 1, ACCURATE).file


# ---- What each table needs: functions of no arguments, each a list of rows ----
def through(bench, scene, seed, found, **words):
    """The row of a picture through these portals."""
    row = bench.picture(scene.name, 100 + seed, GUIDED, bench.samples_of(scene.name), found.file)
    return [{**words, "chain_cpu": found.cpu, "portals": found.count, **row}]


def stage_settings(bench):
    """(knob's name, value, {program: options}) of all curves of the four stages; the default once."""
    of = [(knob, v) for knob in KNOBS if knob.program != RENDERER for v in bench.values(knob) if v != knob.default]
    return [("default", "", {}), *((knob.name, v, knob.settings(v)) for knob, v in of)]


def portal_tasks(bench):
    """The true ones take their turn among the settings: what else the machine does slows all alike."""
    def task(seed, knob, value, settings, scene):
        found = Portals(bench.true_portal(scene), None, scene.openings, 0, None) if settings is None else \
            bench.portal(bench.files[scene.name], seed, settings)
        return through(bench, scene, seed, found, knob=knob, value=value)

    for seed, setting, scene in itertools.product(
            range(1, bench.seeds + 1), [("true", "", None), *stage_settings(bench)], bench.scenes(SCENES)):
        yield functools.partial(task, seed, *setting, scene)


def simplified_tasks(bench):
    """The four stages on scenes without their smallest triangles; the portal is used in the whole one."""
    def task(seed, share, scene):
        data, gone, of = simplified(bench.files[scene.name].read_bytes(), share)
        path = bench.store.keep(("simplified", bench.store.sum_of(bench.files[scene.name]), share),
                                lambda p: p.write_bytes(data), ".glb")
        return through(bench, scene, seed, bench.portal(path, seed, {}), share=share, dropped=gone, triangles=of)

    for words in itertools.product(range(1, bench.seeds + 1), (0.01, 0.1, 0.5) if bench.quick else SIMPLIFIED,
                                   bench.scenes(SCENES)):
        yield functools.partial(task, *words)


def picture_tasks(bench):
    """Curves of the renderer: error against time by integrator, what its knobs do at one length, and depth."""
    scenes = bench.scenes(SCENES + OPEN)

    def black(scene):
        reference = bench.reference(scene.name)[0]
        return [{"knob": "black", "value": "", "scene": scene.name, "seed": 0, "spp": 0, "cpu": 0,
                 **reference.measures(np.zeros_like(reference.r))}]

    def picture(knob, value, scene, seed, spp, *options, with_portals=True):
        portal = bench.portal(bench.files[scene.name], 1, {}).file if scene.aperture and with_portals else None
        return [{"knob": knob, "value": value, **bench.picture(scene.name, seed, options, spp, portal)}]

    yield from (functools.partial(black, scene) for scene in scenes)
    for seed in range(1, bench.seeds + 1):
        for length, integrator, scene in itertools.product(bench.lengths, INTEGRATORS, scenes):
            spp = bench.samples_of(scene.name) * length / 8
            if spp >= 1 and (scene.aperture or not integrator.startswith("tdpt")):
                # Pictures of one seed begin with the same samples: each length has its own.
                yield functools.partial(picture, "integrator", integrator, scene, 1000 * length + seed, int(spp),
                                        "--integrator", integrator, with_portals=integrator not in WITHOUT_PORTALS)
        for knob in (k for k in KNOBS if k.program == RENDERER):
            for value, scene in itertools.product(bench.values(knob), (s for s in scenes if s.aperture)):
                yield functools.partial(picture, knob.name, value, scene, 500 + seed, bench.samples_of(scene.name),
                                        *GUIDED, *(knob.arguments(value) if value != knob.default else ()))
        for depth, name in itertools.product(DEPTHS, WHOLE[:: 2 if bench.quick else 1]):
            scene = Scene(name, aperture=not name.startswith(("kitchen", "bathroom2")))
            if name in bench.files:
                limit = () if depth == "none" else ("--max-depth", depth)
                yield functools.partial(picture, "tdpt-render --max-depth", depth, scene, 700 + seed,
                                        bench.samples_of(name), "--integrator", "auto", *limit)


ROOM = re.compile(r"(ok|MISS)\s+(\S+)\s+(\d+)\s+portals (\d+)/(\d+)\s+coverage (\S+)\s+tightness (\S+)\s+"
                  r"angle\s+(\S+)\s+strays (\d+) .* (\S+) s(?:  FAILED)?$")


def rooms_of(text):
    """Rows of what portals_bench says room by room."""
    fields = ("verdict", "kind", "seed", "portals", "openings", "coverage", "tightness", "angle", "strays", "cpu")
    return [dict(zip(fields, match.groups())) for match in map(ROOM.match, text.splitlines()) if match]


def room_tasks(bench):
    programs = bench.store.programs
    sums = [bench.store.sum_of(programs / p) for p in ("portals_bench", *STAGES)]

    def task(knob, value, settings, kind):
        command = [programs / "portals_bench", programs, "--rooms", bench.rooms, "--seed", 1801, "--jobs", 1,
                   "--kinds", kind]
        for program, options in settings.items():
            command += [f"--{program}", " ".join(options)]
        text = bench.store.keep((*sums, *command[2:]),
                                lambda path: path.write_text(checked(command, may_fail=(1,)).errors)).read_text()
        return [{"knob": knob, "value": value, **row} for row in rooms_of(text)]

    for setting, kind in itertools.product(stage_settings(bench), KINDS):
        yield functools.partial(task, *setting, kind)


TABLES = {"portals": portal_tasks, "pictures": picture_tasks, "rooms": room_tasks, "simplified": simplified_tasks}


def run_all(bench, name, tasks):
    """Their rows in order. They are run in another one, always the same, so that what is compared is not measured one
    after the other."""
    order = list(range(len(tasks)))
    random.Random(name).shuffle(order)
    found = dict(zip(order, bench.side_by_side([tasks[i] for i in order])))
    return [row for i in range(len(tasks)) for row in found[i]]
