"""Cycles, Blender's path tracer, beside tdpt-render: whether they agree in the mean, and what each makes with portals
in equal CPU time: doc/cycles.md."""
import functools
import itertools
import math
import os
import shutil
from pathlib import Path

import numpy as np

import pages
import rooms
import stats
from common import (MAPS, ROOT, SKIES, TESTDATA, Halves, Setting, Stop, checked, environment,
                    measure, peers_python, settings, turns)
from formats import exr_read, exr_write, glb_content, glb_parse
from peers import without_panes
from sky import Cell, Picture, black_words

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # Rec.709
LIMIT = 4.0  # standard errors; by chance once in about 3000 comparisons of 16 with 16 seeds
BLOCKS = (8, 6)  # columns, rows


@functools.cache
def blenders():
    """Commands that run cycles_blender.py in the Blenders that there are: BLENDER alone, a program or a Python that has
    bpy, or what `make peers` built and the system's."""
    named = os.environ.get("BLENDER")
    commands = []
    for word in [named] if named else [peers_python(), "blender"]:
        program = shutil.which(word)
        if program and "python" in Path(program).name:
            if not measure([program, "-c", "import importlib.metadata as m; m.version('bpy')"]).status:
                commands.append((program, "-B", ROOT / "bench/cycles_blender.py"))
        elif program:
            commands.append((program, "-b", "--factory-startup", "--python-exit-code", 1, "--python",
                             ROOT / "bench/cycles_blender.py"))
    return commands


def need_blender():
    if not blenders():
        raise Stop(5, "there is no Blender (Debian: blender), nor what `make peers` installs")


def blender(*arguments, command=None):
    """Runs cycles_blender.py there. It takes the first Python on PATH for its own: the distribution's has numpy."""
    need_blender()
    return checked([*(command or blenders()[0]), "--", *arguments], env={"PATH": f"/usr/bin:{os.environ['PATH']}"})


# ---- Do they agree in the mean? ----
def percent(part, whole):
    """0 % of nothing is 0; something of nothing is infinite."""
    return 100 * part / whole if whole else 0.0 if not part else math.inf


def agreement(names, sets):
    """(lines of a table, whether no mean differs significantly) of two sets of pictures, one for each seed: both means
    with their standard errors, and the difference in standard errors; the same for every block of the picture."""
    lines, worst = [f"          {names[0]:>24} {names[1]:>24}   difference"], 0.0
    for label, weights in [*zip("RGB", np.eye(3)), ("luminance", LUMINANCE)]:
        one, two = (stats.mean_and_error((p @ weights).mean((1, 2))) for p in sets)
        z = float(stats.in_errors(one, two))
        worst = max(worst, abs(z))
        cells = " ".join(f"{m:.7f} +- {percent(e, m):.2f} %".rjust(24) for m, e in (one, two))
        lines.append(f"{label:9} {cells}   {percent(one[0] - two[0], two[0]):+.2f} % = {z:+.2f} s.e.")
    columns, rows = BLOCKS
    height, width = sets[0].shape[1:3]
    ys, xs = np.arange(height) * rows // height, np.arange(width) * columns // width
    index = (ys[:, None] * columns + xs[None, :]).ravel()
    means = lambda of: np.array([np.bincount(index, (p @ LUMINANCE).ravel()) / np.bincount(index) for p in of])
    z = stats.in_errors(*(stats.mean_and_error(means(of)) for of in sets))
    lit = int(np.count_nonzero(z))
    lines.append(f"blocks    {columns} x {rows}, {lit} not black: mean z {z.sum() / max(lit, 1):+.2f}, "
                 f"rms z {np.sqrt((z**2).sum() / max(lit, 1)):.2f}, largest {np.abs(z).max():.2f}")
    return lines, worst <= LIMIT


def compare_scenes(bench, jobs):
    """Prints the table of each (scene, depth, light); ends the benchmark where a mean differs."""
    s, all_agree = bench.settings, True
    for scene, depth, light in jobs:
        work = bench.cache / "-".join([scene.stem, depth, *map(str, light)]).replace("/", "_")
        work.mkdir(exist_ok=True)
        size = ["--max-depth", depth, "--width", s.width, "--height", s.height, *light]
        blender("render", scene, work / "cycles-%d.exr", "--seeds", s.seeds, "--spp", s.spp, *size, *s.cycles_options)
        ours = [bench.render(scene, "--integrator", s.integrator, "--seed", seed, "--spp", s.spp, *size, threads=0).out
                for seed in range(1, s.seeds + 1)]
        theirs = [work / f"cycles-{seed}.exr" for seed in range(1, s.seeds + 1)]
        sets = [np.array([exr_read(path)[0] for path in paths]) for paths in (theirs, ours)]
        for name, pictures in zip(("Cycles", s.integrator), sets):
            exr_write(work / f"{name}.exr", pictures.mean(0))
        lines, agree = agreement(("Cycles", s.integrator), sets)
        all_agree = all_agree and agree
        print("\n".join([f"\n{scene.name}, depth {depth}, {s.seeds} seeds of {s.spp} spp", *lines]), flush=True)
    print("\n" + bench.measured())
    if not all_agree:
        raise Stop(1, "means differ")


compare_settings = functools.partial(
    settings, SEEDS=Setting(16, "pictures of each program", 2), WIDTH=Setting(160, "of the pictures", 24),
    HEIGHT=Setting(120, "", 18), INTEGRATOR=Setting("nee", "of tdpt-render"),
    CYCLES_OPTIONS=Setting((), "more for cycles_blender.py render"))


@compare_settings(FILES=Setting(tuple(str(TESTDATA / f"scenes/{n}.glb") for n in ("two-rooms", "window", "door-ajar")),
                                "the scenes"),
                  DEPTHS=Setting(("2", "3", "6"), "edges of the longest path", ("3",)),
                  SPP=Setting(64, "samples per pixel", 4))
def compare(bench):
    """Do Cycles, Blender's path tracer, and tdpt-render agree in the mean? Renders the same diffuse scenes with both,
    several seeds each, and prints a table for each scene and depth. Exit code 1 if any mean differs significantly.
    BLENDER in the environment names Blender."""
    s = bench.settings
    compare_scenes(bench, [(Path(scene).resolve(), depth, ()) for scene in s.files for depth in s.depths])


@compare_settings(SKIES=Setting(("colour", "quarters", "sun"), "of: colour quarters sun"),
                  ROOMS=Setting(("skylight", "windows", "behind"), "of bench/rooms.py"),
                  DEPTHS=Setting(("6",), "edges of the longest path"), SPP=Setting(32, "samples per pixel", 4))
def compare_skies(bench):
    """Do Cycles and tdpt-render agree where an environment lights a room? Three rooms under one colour, under a map
    whose directions all differ, turned by 30 degrees, and under a clear sky with its sun in one texel. Prints the
    tables of the benchmark cycles, and ends with 1 if any mean differs significantly."""
    rooms.write_rooms(bench.cache)
    lights = {"colour": ("1,0.8,0.5", 0), "quarters": (bench.cache / "quarters.exr", 30),
              "sun": (MAPS / "clear-sun.exr", -45)}
    wrong = set(bench.settings.skies) - set(lights)
    if wrong:
        raise Stop(2, f"SKIES: {wrong.pop()} is none of {', '.join(lights)}")

    def jobs():
        for sky in bench.settings.skies:
            print(f"\n## {sky}")
            light = ("--environment", lights[sky][0], "--environment-rotation", lights[sky][1])
            yield from itertools.product([bench.cache / f"{room}.glb" for room in bench.settings.rooms],
                                         bench.settings.depths, [light])

    compare_scenes(bench, jobs())


# ---- In equal time ----
METHODS = {"cycles": "Cycles", "cycles-hand": "Cycles, portals by hand", "cycles-found": "Cycles, portals found",
           "ours-nee": "`nee`", "ours-auto": "`auto`, portals found"}
ORDER = ("cycles-hand", "cycles-found", "cycles", "ours-nee", "ours-auto")
BASE = "cycles"
INTERIORS = ("living-room", "classroom")  # of SCENES, which nobody drew portals for
SEED = 20261122


def all_diffuse(data):
    """A scene of the same shapes, for programs whose materials differ: no panes, each material Lambertian, one of its
    colour or, where that is a texture, grey."""
    document, binary = glb_parse(without_panes(data)[0])
    for material in document["materials"]:
        surface, more = material.get("pbrMetallicRoughness", {}), material.get("extensions", {})
        colour = (0.5, 0.5, 0.5) if "baseColorTexture" in surface else surface.get("baseColorFactor", (1, 1, 1))
        kept = {key: material[key] for key in ("name", "doubleSided", "emissiveFactor") if key in material}
        strength = {key: of for key, of in more.items() if key == "KHR_materials_emissive_strength"}
        material.clear()
        material.update(kept, pbrMetallicRoughness={"baseColorFactor": [*colour[:3], 1], "metallicFactor": 0},
                        extensions={"KHR_materials_specular": {"specularFactor": 0}, **strength})
    return glb_content(document, binary)


def geometric_mean(cells, method):
    """Of those cells that have the method; None where none has."""
    known = [c.gain(method).value for c in cells if c.pictures[method]]
    return math.exp(np.mean(np.log(known))) if known else None


def equal_tables(cells):
    """Cells have the methods that their room has."""
    others = [m for m in METHODS if m != BASE]

    def mean(of, method):
        value = geometric_mean(of, method)
        return "" if value is None else pages.three(value)

    def found_over_hand(cell):
        hand, found = cell.costs("cycles-hand"), cell.costs("cycles-found")
        return stats.ratio(hand, found, SEED).text(pages.three) if len(hand) else ""

    gains = [[*key, *(cell.gain(m).text(pages.three) if cell.pictures[m] else "" for m in others),
              found_over_hand(cell)] for key, cell in cells.items()]
    for sky in dict.fromkeys(sky for _, sky in cells):
        of = [c for (_, s), c in cells.items() if s == sky]
        gains.append(["geometric mean", sky, *(mean(of, m) for m in others), ""])
    gains.append(["geometric mean", "**all**", *(f"**{mean(cells.values(), m)}**" for m in others), ""])
    errors = []
    for key, c in cells.items():
        of = ["%.2g, %.1f (%.0f; %.1f s)" % (*c.error(m), *np.mean([(p.spp, p.cpu) for p in c.pictures[m]], 0))
              if c.pictures[m] else "" for m in METHODS]
        errors.append([*key, *of, black_words(c), f"{100 * c.off:+.2f} %"])
    heads = ("room", "sky", *(METHODS[m] for m in others), "found over by hand")
    return {"gains": pages.table(heads, gains),
            "errors": pages.table(("room", "sky", *METHODS.values(), "black", "means"), errors)}


class Room:
    """Its pictures by either program. light: options of an environment. amount of a picture: ("--spp", N) or
    ("--cpu-seconds", S)."""

    def __init__(self, bench, scene, light=()):
        self.bench, self.scene = bench, scene
        self.options = ["--width", bench.settings.width, "--height", bench.settings.height, *light]
        self.portals = bench.portals(scene, light)
        if not self.portals.count:
            raise Stop(1, f"{scene}: no portals")
        self.own = {"cycles": (), "ours-nee": ("--integrator", "nee"), "ours-bdpt": ("--integrator", "bdpt"),
                    "ours-auto": ("--portal", self.portals.file)}

    def made(self, method, seed, amount):
        """(path, samples, CPU seconds)"""
        if method.startswith("cycles"):
            words = [*self.options, *self.own[method], *amount, "--first-seed", seed, "--max-depth", 1026]

            def make(folder):
                folder.mkdir()
                blender("render", self.scene, folder / "picture.exr", "--threads", 1, *words, "--cpu", folder / "cpu")
            store = self.bench.store
            folder = store.keep([*blenders()[0], store.sum_of(self.scene), *words], make, ".cycles")
            _, samples, cpu = (folder / "cpu").read_text().split()
            return folder / "picture.exr", int(samples), float(cpu)
        render = functools.partial(self.bench.render, self.scene, *self.options, *self.own[method], "--seed", seed)
        if amount[0] == "--cpu-seconds":
            samples = 16
            for _ in range(2):  # What auto decides, and so what a sample costs, hangs on how many there are.
                samples = max(1, round(samples * amount[1] / render("--spp", samples).said["cpu_seconds"]))
            amount = ("--spp", samples)
        run = render(*amount)
        return run.out, run.said["spp"], run.said["cpu_seconds"]

    def reference(self, method):
        s = self.bench.settings
        first, spp, _ = self.made(method, 1000001, ("--cpu-seconds", s.ref * s.seconds_each))
        return Halves(self.bench, first, self.made(method, 1000002, ("--spp", spp))[0])

    def cell(self, order, base, ours, theirs):
        """Of these methods, which take turns, over `base`; Cycles' pictures against the reference `theirs`."""
        s, samples = self.bench.settings, {}
        cell = Cell(ours.black, ours.peak, (base,), SEED, off=theirs.both("mean") / ours.both("mean") - 1)
        for seed, method in turns(range(1, s.seeds + 1), order):
            amount = ("--spp", samples[method]) if method in samples else ("--cpu-seconds", s.seconds_each)
            path, samples[method], cpu = self.made(method, seed, amount)
            off = (theirs if method.startswith("cycles") else ours).off(path)
            cell.pictures[method].append(Picture(cpu, off["relmse"], off["mse"], spp=samples[method]))
        return cell


def window_cell(bench, name, sky):
    """Of a room that a sky lights through its windows: Cycles with portals by hand, where there are some, with those
    found, and without."""
    scene, by_hand = bench.cache / f"{name}.glb", bench.cache / f"{name}.portals.py"
    own = Path(bench.settings.scenes) / f"interiors/{name}.env.exr"
    light = ("--environment", environment(sky, own), "--environment-rotation", -45 if name in rooms.ROOMS else 0)
    room = Room(bench, scene, light)
    script = bench.store.run("portalfit", room.portals.runs["lightgrid"].out, "--for", "cycles", threads=0).out
    room.own |= {"cycles-found": ("--script", script)}
    if name in rooms.ROOMS:
        room.own |= {"cycles-hand": ("--script", by_hand)}
    cell = room.cell([m for m in ORDER if m in room.own], BASE, room.reference("ours-auto"),
                     room.reference("cycles-found"))
    bench.say(f"{name}, {sky}: {room.portals.count} portals found")
    return cell


@settings(ROOMS=Setting((*rooms.ROOMS, *INTERIORS), "of bench/rooms.py, or interiors of SCENES"),
          SKIES=Setting(SKIES, "of: overcast clear sun (sun: an interior has its own map instead)"),
          SECONDS_EACH=Setting(4.0, "CPU seconds of a picture", 0.1),
          SEEDS=Setting(4, "pictures of each kind", 2),
          REF=Setting(6.0, "how many times as long each half of a reference takes", 2.0),
          WIDTH=Setting(96, "of the pictures", 24), HEIGHT=Setting(72, "", 18))
def equal_time(bench):
    """What portals are worth to Cycles in equal CPU time, found by the stages or drawn by hand, and what tdpt-render
    makes of those found. Rooms x skies, several seeds taking turns, one thread each; a room and a sky take two minutes.
    Interiors are rendered by all as diffuse, without panes.

    CPU seconds are those of rendering. Cycles: of Blender's process in bpy.ops.render.render, less those of a picture
    of one sample. tdpt-render: cpu_seconds of its summary, the time that auto takes to choose included. Loading the
    scene is in neither. A program's pictures are held against its own reference, made with its portals."""
    need_blender()
    rooms.write_rooms(bench.cache)
    names = []
    for name in bench.settings.rooms:
        if name in rooms.ROOMS:
            names.append(name)
        elif name not in INTERIORS:
            raise Stop(2, f"ROOMS: there is no {name}")
        elif source := bench.find(name):
            names.append(name)
            (bench.cache / f"{name}.glb").write_bytes(all_diffuse(source.read_bytes()))
        else:
            bench.say(f"{name}: there is no {name}.glb in SCENES, left out")
    places = list(itertools.product(names, bench.settings.skies))
    cells = bench.side_by_side([functools.partial(window_cell, bench, *place) for place in places])
    bench.page("cycles", equal_tables(dict(zip(places, cells))))


DOORS = {"half-metre-hole": "a hole of 0.50 m", "two-rooms": "a hole of 0.25 m", "small-hole": "a hole of 0.10 m",
         "three-rooms": "two holes of 0.25 m in a row", "door-ajar": "a door ajar"}


def doors_table(cells):
    def over(cell, base):
        return stats.ratio(cell.costs(base), cell.costs("ours-auto"), SEED).text(pages.three)

    shown = ("cycles", "ours-bdpt", "ours-auto")
    rows = [[name, DOORS[name], over(c, "cycles"), over(c, "ours-bdpt"),
             *("%.2g, %.1f (%.0f)" % (*c.error(m), np.mean([p.spp for p in c.pictures[m]])) for m in shown),
             black_words(c)] for name, c in cells.items()]
    return {"doors": pages.table(("scene", "light comes through", "over Cycles", "over `bdpt`", "Cycles", "`bdpt`",
                                  "`auto`", "black"), rows)}


@settings(ROOMS=Setting(tuple(DOORS), "of testdata/scenes"), SECONDS_EACH=Setting(4.0, "CPU seconds of a picture", 0.1),
          SEEDS=Setting(4, "pictures of each kind", 2),
          REF=Setting(25.0, "how many times as long each half of a reference takes", 2.0),
          WIDTH=Setting(96, "of the pictures", 24), HEIGHT=Setting(72, "", 18))
def doors(bench):
    """What tdpt-render makes of rooms behind holes and doors with the portals that the stages find, beside its own bdpt
    and Cycles, in equal CPU time, as in the benchmark cycles-equal. All are held against one reference."""
    need_blender()
    cells = {}
    for name in bench.settings.rooms:
        if name not in DOORS:
            raise Stop(2, f"ROOMS: there is no {name}")
        bench.say(name)
        room = Room(bench, TESTDATA / f"scenes/{name}.glb")
        reference = room.reference("ours-auto")
        cells[name] = room.cell(("cycles", "ours-bdpt", "ours-auto"), "ours-bdpt", reference, reference)
    bench.page("cycles", doors_table(cells))
