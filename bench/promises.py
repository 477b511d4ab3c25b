"""What the renderer promises: that `auto` chooses well, and that a picture has the error that was asked for. Both are
in doc/regret.md."""
import functools
import json
import math
import shutil
from collections import defaultdict, namedtuple
from statistics import mean

import numpy as np

import pages
import stats
from common import Setting, Stop, checked, settings
from formats import Builder, glb_parse, portals_glb

# ---- Regret ----
WITHOUT = ("bdpt", "nee")
# At least, by the lengths from which on it holds: of the better of bdpt and nee, of the best of all.
TARGETS = {4: (0.9, None), 8: (0.9, 0.85), 16: (0.9, 0.85), 32: (0.95, 0.93), 64: (0.95, 0.93), 256: (0.95, 0.97)}
KINDS = ("hole,slit,floor-door,ajar,window,two-openings,holes-in-row,arch,banister,glazing-bars,blinds,curtains,bay,"
         "windows-in-row,double-door,shared-edge,l-room,lamp-outside")
# Portals drawn by hand: corner, edge, edge; the light goes along edge x edge.
DRAWN = {
    "window": [((2.05, 0.2, -0.8), (0, 0, 1.6), (0, 1.6, 0))],
    "kitchen": [((-0.62, 0.9, -2.6), (1.4, 0, 0), (0, 1.66, 0))],
    "bathroom": [((-2.46, 0.5, -1.85), (0, 1.7, 0), (0, 0, 0.9))],
    "living-room-lamps": [((0.38, 2.35, 0.3), (0.72, 0, 0), (0, -1.6, 0)),
                          ((2.64, 2.35, 0.3), (0.7, 0, 0), (0, -1.6, 0)),
                          ((-0.3, 0.75, -2.96), (0, 1.7, 0), (0, 0, 0.82)),
                          ((-0.3, 0.75, -1.02), (0, 1.7, 0), (0, 0, 0.84))],
    "classroom-lamps": [((-4.05, 0.9, 0.45), (0, 1.6, 0), (0, 0, 5.15)),
                        ((-4.05, 0.9, -5.7), (0, 1.6, 0), (0, 0, 5.25))],
}
# Buildings, of which NAME.openings.json lists the true openings, and cameras in them.
HOUSES = {"jasmin-night": ("storeroom", "wc", "bedroom", "cellar"), "renga-house": ("corridor", "hall", "living"),
          "institute-floor": ("corridor-west", "wc"), "niedri-house": ("landing", "kitchen"),
          "sample-house-night": ("bedroom", "hall"), "five-zone-office": ("core",)}
ALONE = ("two-rooms", "window", "cornell-box", "bathroom2", "veach-ajar", "kitchen", "bathroom", "living-room-lamps",
         "classroom-lamps")
FOUND = ("two-rooms", "small-hole", "half-metre-hole", "door-ajar", "three-rooms", "veach-ajar", "cornell-box-portal",
         "bathroom2-channel")


def openings_glb(building, camera):
    """Portals in the openings through which light reaches the camera's room, towards it."""
    document, _ = glb_parse(building.read_bytes())
    room = next(n["extras"]["room"] for n in document["nodes"] if "camera" in n and n.get("name") == camera)
    builder = Builder()
    for opening in json.loads(building.with_suffix(".openings.json").read_text(encoding="utf-8")):
        if opening["state"] == "closed" or room not in opening["rooms"]:
            continue
        builder.polygon(opening["polygon"][:: 1 if opening["rooms"][1] == room else -1], opening["name"])
    return builder.content()


class Regret:
    """Of a scene, what `auto` loses by not knowing which integrator is best.

    efficiency of integrator i   1 / (V_i T_i), V its relMSE for one sample, T its CPU time for one
    efficiency of auto           that of its choice times t / (t + pilot), t the time of its samples; over several
                                 seeds that of their mean error, as of the frames of a shot: one wrong choice costs
                                 more than many right ones gain"""

    def __init__(self):
        self.truth = {}  # integrator: (V, its standard error, T [ns])
        self.choices = defaultdict(list)  # length: [(integrator, the pilot's CPU s)]
        self.told = defaultdict(dict)  # (length, seed): {integrator: cost}
        self.intervals = defaultdict(list)  # length: [(least, most)] of the gain by portals, told to hold it in 90 %
        self.pixels = 0

    def cost(self, integrator):
        v, _, t = self.truth[integrator]
        return v * t

    def best(self, names=None):
        return min(names or self.truth, key=self.cost)

    def without(self):
        return self.best([n for n in WITHOUT if n in self.truth])

    def portals_told(self, length):
        """Gains by portals, by the seeds' pilot samples, the least first."""
        return sorted(filter(None, (portals_gain(cost) for (n, _), cost in self.told.items() if n == length)))

    def efficiencies(self, length):
        """Of auto, of each seed: over the better of bdpt and nee, and over the best of all."""
        out = []
        for integrator, pilot in self.choices[length]:
            rendering = length * self.pixels * self.truth[integrator][2] * 1e-9
            price = rendering / (rendering + pilot)
            out.append(tuple(self.cost(best) / self.cost(integrator) * price for best in (self.without(), self.best())))
        return out


def of_mean_error(efficiencies):
    return 1 / mean([1 / e for e in efficiencies])


def read_regret(lines):
    """Scenes by name, of what regret_bench prints."""
    scenes = defaultdict(Regret)
    for kind, name, *field in (line.rstrip("\n").split("\t") for line in lines):
        scene = scenes[name]
        if kind == "truth" and float(field[2]) > 0:  # all pictures are black where nothing scatters
            scene.truth[field[0]] = tuple(map(float, field[1:4]))
        elif kind == "told":
            scene.told[int(field[0]), int(field[1])][field[2]] = float(field[3]) * float(field[4])
        elif kind == "choice":
            scene.choices[int(field[0])].append((field[2], float(field[3])))
            scene.pixels = int(field[5])
            if len(field) > 8 and float(field[7]) < float(field[8]):
                scene.intervals[int(field[0])].append((float(field[7]), float(field[8])))
    return {name: s for name, s in scenes.items() if s.truth and s.choices}


def portals_gain(cost):
    """Efficiency of the best with portals over that of the best without; None where there are not both. A cost of 0 tells
    that no light was met."""
    with_portals = [c for i, c in cost.items() if i.startswith("tdpt-") and c > 0]  # tdpt itself is no candidate
    without = [c for i, c in cost.items() if not i.startswith("tdpt") and c > 0]
    return min(without) / min(with_portals) if with_portals and without else None


def scene_table(scenes, lengths):
    """What auto has of the best, and what portals are worth, measured and told at the last length but one: of scenes
    where auto then loses more than a tenth, and of those that are better without their portals."""
    rows, told_at = [], lengths[-2:][0]
    for name, s in scenes.items():
        true = portals_gain({i: s.cost(i) for i in s.truth})
        over_best = lambda n, s=s: of_mean_error([e[1] for e in s.efficiencies(n)])
        if over_best(told_at) >= 0.9 and not (true and true < 1):
            continue
        told = s.portals_told(told_at) if true else []
        rows.append([name, f"{s.cost(s.without()) / s.cost(s.best()):.2f}",
                     *(f"{over_best(n):.3f}" for n in lengths),
                     f"{true:.2f}" if true else "-",
                     f"{told[len(told) // 2]:.2g} ({told[0]:.2g} to {told[-1]:.2g})" if told else "-"])
    return pages.table(("scene", "best over bdpt, nee", *(f"auto over best, {n} spp" for n in lengths),
                        "gain by portals", f"auto's estimate, {told_at} spp"), rows)


def length_table(scenes, lengths):
    rows = []
    for length in lengths:
        of_scene = [s.efficiencies(length) for s in scenes.values() if s.choices[length]]
        rows.append([length, sum(map(len, of_scene))])
        for k, target in enumerate(TARGETS.get(length, (None, None))):
            each = sorted(e[k] for scene in of_scene for e in scene)
            means = [of_mean_error([e[k] for e in scene]) for scene in of_scene]
            met = f"{sum(m >= target for m in means)} of {len(means)}" if target else "-"
            rows[-1] += [f"{math.exp(mean([math.log(x) for x in means])):.3f}", f"{each[int(0.05 * len(each))]:.3f}",
                         f"{min(means):.3f}", target or "-", met]
    each = ("5 %", "least of a scene", "target", "met in")
    return pages.table(("samples per pixel", "choices", "over the better of bdpt and nee", *each,
                        "over the best of all", *each), rows)


def kind_of(name):
    _, plus, suffix = name.partition("+")
    return {"": "no portals", "found": "portals that the stages find", "drawn": "windows drawn by hand",
            "true": "true openings of buildings"}[suffix if plus else ""]


def kind_table(scenes, lengths):
    """Geometric means over scenes, with the interval of 95 % that their scatter tells."""
    rows = []
    for kind in dict.fromkeys(map(kind_of, scenes)):
        of_kind = [s for name, s in scenes.items() if kind_of(name) == kind]
        rows.append([kind, len(of_kind)])
        for n in lengths:
            logs = np.array([math.log(of_mean_error([e[1] for e in s.efficiencies(n)])) for s in of_kind])
            error = 1.96 * np.std(logs, ddof=1) / math.sqrt(len(logs)) if len(logs) > 1 else math.inf
            middle = np.mean(logs)
            rows[-1].append("%.2f [%.2f, %.2f]" % (math.exp(middle), math.exp(middle - error),
                                                  min(1, math.exp(middle + error))))
    return pages.table(("kind of scene", "scenes", *(f"{n} spp" for n in lengths)), rows)


def verdict_table(scenes, lengths):
    """How often what is told of portals is right."""
    within, held = {n: [] for n in lengths}, {n: [] for n in lengths}
    for s in scenes.values():
        true = portals_gain({i: s.cost(i) for i in s.truth})
        for n in lengths if true else ():
            within[n] += [0.5 <= g / true <= 2 for g in s.portals_told(n)]
            held[n] += [low <= true <= high for low, high in s.intervals[n]]
    shares = lambda shares: [f"{100 * mean(of):.0f} %" if of else "-" for of in shares.values()]
    return pages.table(("the true gain is", *(f"{n} spp" for n in lengths)),
                       [["within a factor of two of auto's estimate", *shares(within)],
                        ["within auto's interval", *shares(held)]])


def regret_parts(scenes):
    lengths = sorted({length for s in scenes.values() for length in s.choices})
    return {"lengths": length_table(scenes, lengths), "kinds": kind_table(scenes, lengths),
            "verdicts": verdict_table(scenes, lengths),
            "scenes": scene_table(scenes, sorted({lengths[0], *lengths[-2:]}))}


def regret_scenes(bench, rooms, seed):
    """(name, scene, portals, other options) of all that are there, with those that ONLY names. rooms: generated ones of
    each kind, from that seed on."""
    only = bench.settings.only
    for names, suffix in ((ALONE, ""), (DRAWN, "+drawn"), (FOUND, "+found")):
        for name in (n for n in names if not only or n + suffix in only):
            path, portal = bench.find(name), ()
            if not path:
                bench.say(f"{name} is not there: left out")
                continue
            if suffix == "+drawn":
                portal = (bench.cache / f"{name}.drawn.glb",)
                portal[0].write_bytes(portals_glb(DRAWN[name]))
            elif suffix:
                portal = (bench.portals(path).file,)
            yield name + suffix, path, portal, ()
    for building, camera in ((b, c) for b, cameras in HOUSES.items() for c in cameras):
        name = f"{building}.{camera}+true"
        path = bench.find(building) if not only or name in only else None
        if path:
            portal = bench.cache / f"{building}.{camera}.true.glb"
            portal.write_bytes(openings_glb(path, camera))
            sky = path.with_suffix(".env.exr")
            yield name, path, (portal,), ("--camera", camera, *(("--environment", str(sky)) if sky.exists() else ()))
    if rooms and not only:
        folder = bench.cache / "rooms"
        folder.mkdir(exist_ok=True)
        if not list(folder.glob("*.portal.glb")):
            checked([bench.store.program("portals_bench"), bench.programs, "--rooms", rooms,
                     "--seed", seed, "--kinds", KINDS, "--keep", folder], may_fail=(1,))
        for portal in sorted(folder.glob("*.portal.glb")):
            room = portal.name.removesuffix(".portal.glb")
            yield f"{room}+found", folder / f"{room}.glb", (portal,), ()


@settings(SECONDS_EACH=Setting(4.0, "CPU seconds for the true error of each integrator", 0.2),
          SEEDS=Setting(12, "choices of each scene and length", 2),
          ROOMS=Setting(1, "generated rooms of each kind"), SEED=Setting(1, "of the first"))
def regret(bench):
    """What `auto` loses by not knowing which integrator is best, and how right its verdict on portals is. About 25
    minutes on two quiet cores. ONLY: names of scenes, with +found or +drawn for those with portals."""
    s, texts = bench.settings, []
    for name, scene, portal, options in regret_scenes(bench, s.rooms, s.seed):
        command = [bench.store.program("regret_bench"), scene, *portal, *options, "--name", name, "--seconds",
                   f"{s.seconds_each:g}", "--seeds", s.seeds, "--width", 64, "--height", 48]
        sums = [bench.store.sum_of(path) for path in (command[0], scene, *portal)]
        kept = bench.store.keep([*sums, *options, *command[-10:]],
                                lambda path, command=command: path.write_text(checked(command).said, encoding="utf-8"), ".txt")
        bench.say(name)
        texts.append(kept.read_text(encoding="utf-8"))
    if not texts:
        raise Stop(3, "none of the scenes is there")
    measured = read_regret("".join(texts).splitlines())
    bench.page("regret", regret_parts(dict(sorted(measured.items()))))


# ---- Target error ----
MET, BETTER = 0.9, 2.5  # share of pictures at least, median of target / relMSE at most
# A line of target_bench after the seed: samples fixed, relMSE as the program estimates it (-1: not), the ends of its
# interval, samples of the pilot, reached (1) or not (0).
Picture = namedtuple("Picture", "relmse fixed told low high pilot reached")
# Width, height, target, whether portals are looked for.
SIZES = {"two-rooms": (32, 24, 0.01, True), "veach-ajar": (32, 18, 0.03, True),
         "cornell-box-portal": (32, 32, 0.05, True), "cornell-box": (32, 32, 0.013, False),
         "kitchen": (40, 24, 0.013, False)}


def target_row(name, pixels, target, pictures):
    """How well a scene's pictures keep their target."""
    ratios, missed = target / np.array([p.relmse for p in pictures]), [p for p in pictures if p.relmse > target]
    met, better = stats.wilson(len(pictures) - len(missed), len(pictures)), np.quantile(ratios, [0.1, 0.5, 0.9])
    known = sum(not p.reached for p in missed)
    return [name, pixels, f"{target:g}", len(pictures), "%.0f %% [%.0f, %.0f]" % (100 * met.value, 100 * met.low, 100 * met.high),
            "%.2f [%.2f, %.2f]" % (better[1], better[0], better[2]), "%.0f" % np.median([p.fixed for p in pictures]),
            "%.0f %%" % (100 * np.median([p.pilot / p.fixed for p in pictures])),
            "%.2f" % np.median([p.told / p.relmse for p in pictures if p.told >= 0]), f"{len(missed)}, {known}",
            sum(not p.reached for p in pictures) - known, "yes" if met.value >= MET and better[1] <= BETTER else "no"]


def target_table(scenes):
    """scenes: {name: (pixels, target, pictures)}"""
    ratios = np.array([target / p.relmse for _, target, pictures in scenes.values() for p in pictures])
    return pages.sections(
        pages.table(("scene", "pixels", "E", "pictures", "meet it [95 %]", "E / relMSE, median [10 %, 90 %]", "samples",
                     "pilot samples", "estimate / relMSE", "missed, of these reported", "met, but reported as missed", "kept"),
                    [target_row(name, *of) for name, of in scenes.items()]),
        f"Of all {len(ratios)} pictures {100 * np.mean(ratios >= 1):.1f} % meet their target, and the median picture is "
        f"{np.median(ratios):.2f} times too good.")


@settings(SEEDS=Setting(100, "pictures of each scene", 2))
def target_error(bench):
    """How many of the pictures that tdpt-render renders to a relMSE (--target-error) have it, as exrdiff says against
    the mean of the other seeds' pictures, and how much better they are than asked. Ten minutes of CPU time."""
    seeds, files = bench.settings.seeds, bench.there(SIZES)

    def measure(name):
        width, height, target, with_portals = SIZES[name]
        portal = (bench.portals(files[name]).file,) if with_portals else ()
        program = bench.store.program("target_bench")
        options = ["--width", width, "--height", height, "--target", target, "--integrator", "auto", "--seeds", seeds]

        def make(path):
            folder = path.with_suffix(".pictures")
            folder.mkdir(exist_ok=True)
            lines = []
            for line in checked([program, files[name], folder, *portal, *options, "--threads", 1]).said.splitlines():
                seed, numbers = line.split(" ", 1)
                off = bench.distance(folder / f"{seed}.exr", folder / f"{seed}.reference.exr")
                lines.append(f"{off['relmse']} {numbers}")
            shutil.rmtree(folder)
            path.write_text("\n".join(lines), encoding="ascii")

        sums = [bench.store.sum_of(path) for path in (program, files[name], *portal)]
        lines = bench.store.keep([*sums, *options], make).read_text(encoding="ascii").splitlines()
        return width * height, target, [Picture(*map(float, line.split())) for line in lines]

    kept = bench.side_by_side([functools.partial(measure, name) for name in files])
    bench.page("regret", {"target-error": target_table(dict(zip(files, kept)))})
