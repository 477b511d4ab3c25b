"""What things cost that are asked for, or not: the whole light (doc/whole-light.md), options and stages that are not
needed (doc/only-needed.md), rendering in shards (doc/shards.md), and triangles (doc/scale.md)."""
import copy
import filecmp
import itertools
import math
import os
import re
import statistics
from collections import namedtuple
from pathlib import Path

import numpy as np

import pages
import rooms
import stats
from common import STAGES, TESTDATA, Halves, Setting, Stop, settings, turns
from formats import glb_content, glb_parse

# ---- The whole light ----
LIGHT_SEED = 20260229
SIZES = {"veach-ajar": (160, 90), "bathroom2": (128, 72), "two-rooms": (128, 96)}
Picture = namedtuple("Picture", "cpu relmse mean")


def mean_ratio(a, b):
    """Of a over b, and its standard error; the two are independent."""
    means = [np.array([p.mean for p in of]) for of in (a, b)]
    ratio = means[0].mean() / means[1].mean()
    if len(a) < 2:
        return ratio, math.nan
    return ratio, ratio * np.hypot(*(error / mean for mean, error in map(stats.mean_and_error, means)))


def light_table(runs, kinds, names, mean_of, mean_name):
    """runs: {(scene, integrator): {kind: [Picture]}}; kinds: two, called names; mean_of: those whose means are told."""
    rows = []
    for key, of in runs.items():
        above, below = (of[kind] for kind in kinds)
        cpu, error = ([np.mean([getattr(p, field) for p in kind]) for kind in (above, below)]
                      for field in ("cpu", "relmse"))
        mean, spread = mean_ratio(*(of[kind] for kind in mean_of))
        efficiency = stats.ratio(*([p.cpu * p.relmse for p in kind] for kind in (below, above)), LIGHT_SEED)
        ratio = np.median([a.cpu / b.cpu for a, b in zip(above, below)])
        rows.append([*key, *("%.2f" % c for c in (*cpu, ratio)), *map(pages.three, error),
                     efficiency.bounded().text("%.2f".__mod__),
                     "%.4f" % mean + ("" if math.isnan(spread) else " +- %.4f" % spread)])
    a, b = names
    return pages.table(("scene", "integrator", f"CPU s, {a}", f"CPU s, {b}", "ratio", f"relMSE, {a}", f"relMSE, {b}",
                        f"efficiency, {a} / {b}", f"mean, {mean_name}"), rows)


def light_tables(runs):
    based = {key: of for key, of in runs.items() if "base" in of}
    return pages.sections(
        light_table(runs, ("none", "six"), ("no limit", "depth 6"), ("six", "none"), "depth 6 / no limit"),
        based and "## Depth 6, before and after\n\nbefore: the program named by BASE. The means must agree.",
        based and light_table(based, ("six", "base"), ("after", "before"), ("six", "base"), "after / before"))


@settings(BASE=Setting("", "another tdpt-render, of an older commit: depth 6 is compared with its depth 6"),
          SPP=Setting(64, "samples per pixel", 4), SEEDS=Setting(6, "pictures of each kind", 2),
          REF_INTEGRATOR=Setting("tdpt-guided", "of the references"),
          REF_SECONDS=Setting(60.0, "of each half of a reference, all threads", 0.2),
          WIDTH=Setting(0, "of all pictures, for trials; else each scene has its own", 24),
          HEIGHT=Setting(0, "the same", 18))
def whole_light(bench):
    """What the whole light costs beside the light of paths of 6 edges, same samples: CPU time, error, efficiency
    1 / (relMSE x CPU s) and mean, with bdpt and with auto and the portals that the four stages find. Half an hour on
    two quiet cores. Runs take turns, one thread each, so that a busy machine slows all down."""
    s, runs = bench.settings, {}
    if s.base and not os.access(s.base, os.X_OK):
        raise Stop(2, f"BASE: {s.base} is no program")
    kinds = ("none", "six", "base") if s.base else ("none", "six")
    limits = {"none": (), "six": ("--max-depth", 6), "base": ("--max-depth", 6)}
    for name, scene in bench.there(SIZES).items():
        portal = ("--portal", bench.portals(scene).file)
        size = ("--width", s.width or SIZES[name][0], "--height", s.height or SIZES[name][1])
        halves = {kind: Halves(bench, *(
            bench.render(scene, *portal, "--integrator", s.ref_integrator, *limits[kind], *size, "--time",
                         f"{s.ref_seconds:g}", "--seed", 1000000 + half, threads=0).out for half in (1, 2)))
            for kind in ("none", "six")}
        halves["base"] = halves["six"]
        for integrator in ("bdpt", "auto"):
            of = runs[name, integrator] = {kind: [] for kind in kinds}
            for seed, kind in turns(range(1, s.seeds + 1), kinds):
                run = bench.store.run(Path(s.base).resolve() if kind == "base" else "tdpt-render", scene,
                                      *(() if integrator == "bdpt" else portal), "--integrator", integrator,
                                      *limits[kind], *size, "--spp", s.spp, "--seed", seed)
                of[kind].append(Picture(run.said["cpu_seconds"], halves[kind].off(run.out)["relmse"],
                                        bench.distance(run.out, halves[kind].a)["mean"]))
    bench.page("whole-light", f"""# What the whole light costs

Written by `make bench-whole-light` ({bench.version()}). Without a limit walks end by Russian roulette; with
`--max-depth 6` they end after 6 edges at the latest, and the light of longer paths is missing. {s.spp} samples per
pixel
both ways, {s.seeds} seeds, runs of one thread taking turns; auto gets the portals that the four stages find. Each way \
has a reference of its own, whose noise is taken out of relMSE. Efficiency = 1 / (relMSE x CPU s).

* CPU time: median of the ratios of runs that followed each other; at depth 6 with the samples that tell what is left
  out, 1 % of all, up to a tenth of few. Efficiency: of the means over seeds, in brackets the 95 %
  interval by bootstrap. Mean: +- a standard error; what it lacks to 1 is the light that depth 6 leaves out.

{light_tables(runs)}""")


# ---- What is not needed ----
def dark(scene):
    """Without anything that emits."""
    for material in scene["materials"]:
        material.pop("emissiveFactor", None)
        material.pop("extensions", None)
    return scene


def away(scene):
    """Its camera far above, looking up."""
    for node in scene["nodes"]:
        if "camera" in node:
            node.pop("matrix", None)
            node["translation"], node["rotation"] = [0, 50, 0], [0.5**0.5, 0, 0, 0.5**0.5]
    return scene


def asked_row(what, scene, pairs):
    """Of CPU seconds (with, without): the median of the ratios, and the interval of their mean."""
    ratios = np.divide(*np.array(pairs).T)
    interval = stats.ratio(ratios, np.ones(len(ratios)), 1)
    return [what, scene, f"{np.median(ratios):.3f}", f"{interval.low:.3f} to {interval.high:.3f}"]


PAYS = """## Done only when it pays

| what | who decides | price of deciding | held by |
|---|---|---|---|
| layers, frames, alpha | options; off | above | `layers_test`, `stats_test`, `alpha_test` |
| techniques | `auto`, by error x work of samples that are thrown away | \
about 3 % of the picture's work | `auto_test`, [regret.md](regret.md) |
| portals | a small picture's light, then `auto` | 2 % of the samples, at most 3072 | `portal_ways_test`, `auto_test`, \
[regret.md](regret.md) |
| tables of the sky through windows | there are both, a sky and portals | nothing | `sky_samplers_test` |
| kinds of light by what arrives | there is a sky beside other lights | a small picture of `nee` | `arrival_test` |
| panels | one big rectangle or 2 to 8 are all that emits | nothing | `panels_test` |
| cuts | drops of the potential; closets are not cut | two maximum flows for one opening | `series_cut_test` |
| batches of segments | until the counts change by less than 4 % | comparing two grids | `lightgrid_test` |
| the fine pass of a cut | a coarse segment joins its sides | nothing | \
`lightgrid_test`, `cli.lightgrid-no-bottleneck` |
| candidates of a portal | a quarter of the threshold of lines is left | nothing | `portalfit_test` |
| rounds of `ffgraph` | patches straddle an opening | below | `ffgraph_test` |

A round narrows the opening where patches straddle it, and is made whether it then pays or not: it pays where the
opening lets a twentieth less of the light pass than before."""


def nothing_rows(bench, room):
    """CPU seconds of programs that have nothing to do, and end as they should."""
    document, rest = glb_parse(room.read_bytes())
    for name, change in (("dark", dark), ("away", away)):
        changed = change(copy.deepcopy(document))
        (bench.cache / f"{name}.glb").write_bytes(glb_content(changed, rest))
    size, rows = "tdpt-render, 640 x 480 x 16, ", []
    for wanted, what, inputs, output in (
            (3, "ffgraph, no light", ["dark.glb"], "dark.max"),
            (0, "ffgraph, the camera sees no surface", ["away.glb"], "away.max"),
            (0, "mincut, no flow", ["away.max"], "away.cut"),
            (0, "lightgrid, no bottleneck", ["away.glb", "away.cut"], "away.vdb"),
            (0, "portalfit, empty grid", ["away.vdb"], "away.portal.glb"),
            (0, size + "no light", ["dark.glb"], "x.exr"),
            (0, size + "the camera sees no surface", ["away.glb"], "x.exr")):
        run = bench.fresh(what.split(",")[0], *(bench.cache / name for name in inputs), output=bench.cache / output,
                          threads=0, may_fail=(3,))
        if run.status != wanted:
            raise Stop(4, f"{what}: status {run.status}, expected {wanted}: {run.errors.strip()}")
        rows.append([what, "%.2f" % run.cpu])
    return rows


def round_rows(bench):
    """What ffgraph's rounds of splitting brought."""
    rows = []
    for name, scene in bench.there(("door-ajar", "half-metre-hole", "small-hole", "three-rooms", "two-rooms", "window",
                                    "veach-ajar", "cornell-box-portal")).items():
        told = bench.fresh("ffgraph", "--explain", scene, output=bench.cache / "rounds.max", threads=0).errors
        found = re.findall(r"^ffgraph: round 1: (.*), because (.*) \((.*) CPU s\)$", told, re.M)
        rows += [[name, *cells] for cells in found]
    return rows


@settings(RUNS=Setting(15, "pairs of runs", 2), SPP=Setting(16, "samples per pixel", 1),
          WIDTH=Setting(160, "of the pictures", 16))
def only_needed(bench):
    """What a scene or a command line does not ask for, costs how much? CPU seconds of rendering, runs taking turns, one
    thread: of tdpt-render with things asked for over itself without, and of stages that find nothing to do. Half an
    hour."""
    s, room = bench.settings, TESTDATA / "scenes/two-rooms.glb"
    bdpt = ("--integrator", "bdpt")

    def cpu(*options):
        return bench.fresh("tdpt-render", "--no-provenance", "--spp", s.spp, "--width", s.width, room, *options,
                           output=bench.cache / "picture.exr").said["cpu_seconds"]

    portal = ("--portal", bench.portals(room).file)
    asked = [asked_row(what, "two-rooms", [(cpu(*options), cpu(*bdpt)) for _ in range(s.runs)]) for what, options in (
        ("tdpt-org without portals, over bdpt", ("--integrator", "tdpt-org")),
        ("bdpt with a portal that it does not use, over bdpt", (*bdpt, *portal)),
        ("--explain", (*bdpt, "--explain")), ("--layers", (*bdpt, "--layers")),
        ("--stats", (*bdpt, "--stats", bench.cache / "stats.json")), ("--alpha", (*bdpt, "--alpha")),
        ("--environment 1e-30,0,0", (*bdpt, "--environment", "1e-30,0,0")))]
    bench.page("only-needed", pages.sections(
        f"""# What is not needed, and what it costs

`make bench-only-needed` writes this page. This one: RUNS={s.runs} pairs of runs that take turns, \
SPP={s.spp} samples a pixel, WIDTH={s.width} pixels;
one thread, CPU seconds of rendering alone. `--explain` of every program says what it leaves out, and why.

## What is not asked for

The price of asking for something, as a ratio to not asking: what is saved without it.""",
        pages.table(("what", "scene", "CPU time", "95 % interval of the mean"), asked),
        "## Nothing to do", pages.table(("stage", "CPU seconds"), nothing_rows(bench, room)),
        """A scene without light is refused by `ffgraph`, which has nothing to start from; the others end with status 0
        and a
sentence (`cli.nothing-to-do`, `longest_path_test`).""",
        PAYS, pages.table(("scene", "round", "why", "CPU seconds"), round_rows(bench))))


# ---- Shards ----
Shards = namedtuple("Shards", "whole whole_rendering plan parts parts_rendering merge")  # CPU seconds


def shards_row(picture, count, runs):
    """picture: words; runs: of Shards. Medians, and least and largest of the ratios."""
    middle = lambda field: statistics.median(getattr(r, field) for r in runs)
    ratios = [(r.plan + r.parts + r.merge) / r.whole for r in runs]
    beside = statistics.median((r.parts - r.parts_rendering) / count for r in runs)
    return [*picture, len(runs), "%.1f" % middle("whole"), "%.2f" % middle("plan"), "%.1f" % middle("parts"),
            "%.2f" % middle("merge"), "%.3f (%.3f to %.3f)" % (statistics.median(ratios), min(ratios), max(ratios)),
            "%.2f" % beside]


@settings(PICTURES=Setting(("two-rooms", "320", "240", "64", "veach-ajar", "320", "180", "64"),
                           "scene, width, height, samples per pixel, of each picture", ("two-rooms", "32", "24", "4")),
          SHARDS=Setting(16, "of each picture", 3), RUNS=Setting(3, "times that everything is done", 1))
def shards(bench):
    """What it costs to render a picture in shards. CPU seconds of whole processes on one thread: the plan, the shards
    and their merge, over those of the undivided run, which takes turns with them; the bytes must be the same. A quarter
    of an hour."""
    s, rows, n = bench.settings, [], bench.settings.shards
    sums = [bench.store.sum_of(bench.store.program(p)) for p in ("tdpt-render", "exrmerge")]
    pictures = [s.pictures[i : i + 4] for i in range(0, len(s.pictures), 4)]
    files = bench.there([picture[0] for picture in pictures])

    def measure(given):
        render = lambda name, *more: bench.fresh("tdpt-render", *given, *more, output=bench.cache / name)
        plan = bench.cache / "plan.json"
        whole = render("whole.exr")
        planned = bench.fresh("tdpt-render", *given, "--plan", plan)
        parts = [render(f"part.{i}.exr", "--plan", plan, "--shard", f"{i}/{n}") for i in range(n)]
        paths = [bench.cache / f"part.{i}.exr" for i in range(n)]
        merge = bench.fresh("exrmerge", *paths, output=bench.cache / "merged.exr")
        if not filecmp.cmp(bench.cache / "whole.exr", bench.cache / "merged.exr", shallow=False):
            raise Stop(1, "the merged picture differs from the undivided one")
        for path in paths:
            path.unlink()
        return Shards(whole.cpu, whole.said["cpu_seconds"], planned.cpu, sum(p.cpu for p in parts),
                      sum(p.said["cpu_seconds"] for p in parts), merge.cpu)

    for name, width, height, spp in (picture for picture in pictures if picture[0] in files):
        portal = bench.portals(files[name]).file
        given = [files[name], "--portal", portal, "--width", width, "--height", height, "--spp", spp]
        runs = []
        for i in range(s.runs):
            kept = bench.store.keep([*sums, bench.store.sum_of(portal), name, width, height, spp, n, i],
                                    lambda path, given=given: path.write_text(" ".join(map(repr, measure(given)))))
            runs.append(Shards(*map(float, kept.read_text().split())))
        rows.append(shards_row([name, f"{width} x {height}", spp], n, runs))
    bench.page("shards", f"""# What it costs to render in shards

Written by `make bench-shards` ({bench.version()}): a plan, {n} shards and their merge beside the undivided
run, by turns, each process on one thread. CPU seconds of whole processes, loading, deciding and writing among them;
medians, and least and largest of the ratios. Every merged picture had the bytes of the undivided one.

{pages.table(("scene", "picture", "samples", "runs", "undivided", "plan", f"{n} shards", "merge", "all over undivided",
              "a shard beside rendering"), rows)}

What shards cost more: each loads the scene, builds its hierarchy and writes a film, the last column; the plan is made
once more; films are read and added. None of that grows with the samples, so the more of them a shard has, the less it
matters. [farm.md](farm.md) says how to render in shards.""")


# ---- Time and memory against triangles ----
Row = namedtuple("Row", "form triangles program cpu peak")
PROGRAMS = (*STAGES, "tdpt-render")
MOST_BYTES = 400  # of a triangle
NOISE = 1.3  # times n log n
ENOUGH = 0.2  # CPU seconds
MIB = 2**20
POINTS = {"ffgraph": 'pt 7 lc rgb "#000000"', "mincut": 'pt 5 lc rgb "#8c8c8c"', "lightgrid": 'pt 9 lc rgb "#0072b2"',
          "portalfit": 'pt 11 lc rgb "#56b4e9"', "tdpt-render": 'pt 13 lc rgb "#d55e00"'}
DASHES = {"grid": " dt 1", "parts": " dt 3", "soup": " dt 2"}


def series(rows, form, program):
    """By triangles, the smallest scene first."""
    return sorted((r for r in rows if (r.form, r.program) == (form, program)), key=lambda r: r.triangles)


def bytes_each(before, last):
    """What each triangle costs that one scene has more than another."""
    return (last.peak - before.peak) * MIB / (last.triangles - before.triangles)


def triangle_table(rows, cell, last_head, last_cell):
    """`cell` of a row; `last_cell` of a series."""
    decade = lambda row: round(math.log10(row.triangles))
    sizes, lines = sorted({decade(r) for r in rows}), []
    for form, program in itertools.product(dict.fromkeys(r.form for r in rows), PROGRAMS):
        of = series(rows, form, program)
        cells = {decade(r): cell % r._asdict() for r in of}
        if of:
            lines.append([form, program, *(cells.get(s, "-") for s in sizes), last_cell(of)])
    return pages.table(("scene", "program", *("10^%d" % s for s in sizes), last_head), lines)


def scale_tables(rows):
    def verdict(of):
        """How many times the CPU time grew in the last step, and how many times n log n."""
        before, last = of[-2:]
        if last.cpu < ENOUGH:
            return "too short to tell"
        grown = last.cpu / before.cpu
        n_log_n = last.triangles * math.log(last.triangles) / (before.triangles * math.log(before.triangles))
        return "%.1f, of n log n %.1f: %s" % (grown, n_log_n, "no faster" if grown <= NOISE * n_log_n else "**faster**")

    def each(of):
        step, whole = bytes_each(*of[-2:]), of[-1].peak * MIB / of[-1].triangles
        return "%.0f, %.0f: %s" % (step, whole, "met" if max(step, whole) < MOST_BYTES else "**missed**")

    return pages.sections(
        "CPU seconds; a growth of up to %.1f times that of n log n counts as noise:" % NOISE,
        triangle_table(rows, "%(cpu).2f", "growth in the last step", verdict),
        "Peak memory [MiB]:",
        triangle_table(rows, "%(peak).0f",
              "bytes a triangle: of the last step, of the largest scene with all else; below %d" % MOST_BYTES, each))


def scale_plot(rows):
    figure, forms = pages.Figure(3, 467, 520), list(dict.fromkeys(r.form for r in rows))
    line = 'with lines dt 4 lc rgb "#666666"'
    for title, label, least, field, limit in (("Time", "CPU seconds", 0.02, "cpu", "1.5e-7*x*log(x)"),
                                              ("Memory", "peak MiB", 8, "peak", "400*x/1048576")):
        drawn = [f"[500:2e7] [{least}:] {limit} {line} notitle"]
        for form, program in itertools.product(forms, PROGRAMS):
            block = figure.block([(r.triangles, getattr(r, field)) for r in series(rows, form, program)])
            drawn.append(f"{block} using 1:2 with linespoints lw 2 {POINTS[program]}{DASHES[form]} notitle")
        figure.panel(title, "triangles", label, drawn, ("set logscale xy", 'set format x "10^{%T}"'))
    figure.key([f'NaN {line} title "n log n; 400 bytes a triangle"',
                *(f'NaN with linespoints lw 2 {POINTS[program]}{DASHES[form]} title "{program}, {form}"'
                  for form in forms for program in PROGRAMS)])
    return figure.script("scale.png")


def stages_of(stem, options={}):
    """(program, arguments, output) from room to picture; options: {program: more of it}."""
    return [(program, [*(f"{stem}.{end}" for end in inputs.split()), *options.get(program, ())], f"{stem}.{output}")
            for program, inputs, output in zip(PROGRAMS, ("glb", "max", "glb cut", "vdb", "glb"),
                                               ("max", "cut", "vdb", "portal.glb", "exr"))]


@settings(SIZES=Setting(("1e3", "1e4", "1e5", "1e6", "1e7"), "triangles of the scenes", ("1e3", "1e4")),
          FORMS=Setting(rooms.FORMS, "of: grid parts soup"))
def scale(bench):
    """CPU time and peak memory of the five programs on scenes of a thousand to ten million triangles, one thread each.
    A quarter of an hour, 5 GiB of memory, 1.5 GiB of disk in the cache."""
    bench.need("gnuplot")
    s, rows, stem = bench.settings, [], bench.cache / "room"
    picture = ("--portal", f"{stem}.portal.glb", "--integrator", "tdpt-guided", "--spp", 1, "--width", 64, "--height",
               48)
    for form, size in itertools.product(s.forms, s.sizes):
        n = rooms.write_scene(int(float(size)), form, f"{stem}.glb")
        for program, arguments, output in stages_of(stem, {"tdpt-render": picture}):
            run = bench.fresh(program, *arguments, output=output)
            rows.append(Row(form, n, program, round(run.cpu, 3), round(run.peak_mib, 1)))
        bench.say(f"{form}: {n} triangles")
    for room in bench.cache.glob("room.*"):
        room.unlink()
    (bench.doc / "scale.csv").write_text("".join("%s,%d,%s,%.3f,%.1f\n" % row for row in rows), encoding="ascii")
    pages.draw(scale_plot(rows), bench.doc)
    bench.page("scale", f"""# Time and memory against triangles

Written by `make bench-scale` ({bench.version()}), one thread. [scale.csv](scale.csv) has a row a run.

The scene is two furnished rooms with one opening, the same surfaces cut into more and more triangles
(`bench/rooms.py`): **grid**, large meshes whose triangles share corners (25 bytes of file a triangle); **parts**, a
mesh and a node for every 512 triangles at most; **soup**, no corner shared (72 bytes of file a triangle). tdpt-render
makes one sample per pixel at 64 x 48 with tdpt-guided, so its time is that of loading and of its hierarchy.

![CPU seconds and memory against triangles](scale.png)

{scale_tables(rows)}

What does not depend on triangles: ffgraph's 1.2 million hits of walks and its pairs of patches, the network that mincut
cuts, the voxels and lines of lightgrid. Up to 10^5 triangles that is most of the memory; it grows with the surfaces
that are found to be pieces. portalfit reads no triangle: it takes 0.4 s, or 4 s where the first plane through the lines
is not good enough, and which of the two is chance.

Where a triangle's memory is (soup, tdpt-render): 52 bytes are its corners and material, 36 more normals where they are
interpolated, 104 its plane and edges in double precision, the rest Embree's hierarchy, which has corners of its own.
Embree's compact hierarchy would save 50 to 60 bytes; rays through a soup of 10^6 triangles then take 1.55 times as
long, through a grid 1.1 times, and the pictures are the same bytes, so it is not used. `bench.memory` holds the
programs below the limit.

What corners have beside a place and a normal comes on top where a material uses it: 8 bytes for texture coordinates, 16
for a tangent or a colour. A scene that has surfaces with alpha or window panes costs 16 bytes a triangle more.""")
