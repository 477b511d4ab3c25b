"""What things cost: the whole light (in doc/efficiency.md), options and triangles (in doc/limit.md), rendering in
shards (in doc/farm.md)."""
import filecmp
import itertools
import math
import os
import statistics
from collections import namedtuple
from pathlib import Path

import numpy as np

import pages
import rooms
import stats
from common import STAGES, TESTDATA, Halves, Setting, Stop, settings, turns

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
        based and "Depth 6, after and before (the program named by BASE); the means must agree:",
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
    bench.page("efficiency", {"whole-light": light_tables(runs)})


# ---- What is not needed ----
def asked_row(what, scene, pairs):
    """Of CPU seconds (with, without): the median of the ratios, and the interval of their mean."""
    ratios = np.divide(*np.array(pairs).T)
    interval = stats.ratio(ratios, np.ones(len(ratios)), 1)
    return [what, scene, f"{np.median(ratios):.3f}", f"{interval.low:.3f} to {interval.high:.3f}"]


@settings(RUNS=Setting(15, "pairs of runs", 2), SPP=Setting(16, "samples per pixel", 1),
          WIDTH=Setting(160, "of the pictures", 16))
def option_costs(bench):
    """What options cost: CPU seconds of rendering with them over those without, runs taking turns, one thread. Half an
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
    bench.page("limit", {"options": pages.table(("what", "scene", "CPU time", "95 % interval of the mean"), asked)})


# ---- Shards ----
Shards = namedtuple("Shards", "whole parts parts_rendering merge")  # CPU seconds


def shards_row(picture, count, runs):
    """picture: words; runs: of Shards. Medians, and least and largest of the ratios."""
    middle = lambda field: statistics.median(getattr(r, field) for r in runs)
    ratios = [(r.parts + r.merge) / r.whole for r in runs]
    beside = statistics.median((r.parts - r.parts_rendering) / count for r in runs)
    return [*picture, len(runs), "%.1f" % middle("whole"), "%.1f" % middle("parts"), "%.2f" % middle("merge"),
            "%.3f (%.3f to %.3f)" % (statistics.median(ratios), min(ratios), max(ratios)),
            "%.2f" % beside]


@settings(PICTURES=Setting(("two-rooms", "320", "240", "64", "veach-ajar", "320", "180", "64"),
                           "scene, width, height, samples per pixel, of each picture", ("two-rooms", "32", "24", "4")),
          SHARDS=Setting(16, "of each picture", 3), RUNS=Setting(3, "times that everything is done", 1))
def shards(bench):
    """What it costs to render a picture in shards. CPU seconds of whole processes on one thread: the shards and their
    merge, over those of the undivided run, which takes turns with them; the bytes must be the same. A quarter of an
    hour."""
    s, rows, n = bench.settings, [], bench.settings.shards
    sums = [bench.store.sum_of(bench.store.program(p)) for p in ("tdpt-render", "exrmerge")]
    pictures = [s.pictures[i : i + 4] for i in range(0, len(s.pictures), 4)]
    files = bench.there([picture[0] for picture in pictures])

    def measure(given):
        render = lambda name, *more: bench.fresh("tdpt-render", *given, *more, output=bench.cache / name)
        whole = render("whole.exr")
        parts = [render(f"part.{i}.exr", "--shard", f"{i}/{n}") for i in range(n)]
        paths = [bench.cache / f"part.{i}.exr" for i in range(n)]
        merge = bench.fresh("exrmerge", *paths, output=bench.cache / "merged.exr")
        if not filecmp.cmp(bench.cache / "whole.exr", bench.cache / "merged.exr", shallow=False):
            raise Stop(1, "the merged picture differs from the undivided one")
        for path in paths:
            path.unlink()
        return Shards(whole.cpu, sum(p.cpu for p in parts), sum(p.said["cpu_seconds"] for p in parts), merge.cpu)

    for name, width, height, spp in (picture for picture in pictures if picture[0] in files):
        portal = bench.portals(files[name]).file
        given = [files[name], "--portal", portal, "--width", width, "--height", height, "--spp", spp]
        runs = []
        for i in range(s.runs):
            kept = bench.store.keep([*sums, bench.store.sum_of(portal), name, width, height, spp, n, i],
                                    lambda path, given=given: path.write_text(" ".join(map(repr, measure(given)))))
            runs.append(Shards(*map(float, kept.read_text().split())))
        rows.append(shards_row([name, f"{width} x {height}", spp], n, runs))
    heads = ("scene", "picture", "samples", "runs", "undivided", f"{n} shards", "merge", "all over undivided",
             "a shard beside rendering")
    bench.page("farm", {"shards": pages.table(heads, rows)})


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


def scale_table(rows):
    def growth(before, last):
        """How many times the CPU time grew in the last step."""
        if last.cpu < ENOUGH:
            return "too short to tell"
        grown = last.cpu / before.cpu
        n_log_n = last.triangles * math.log(last.triangles) / (before.triangles * math.log(before.triangles))
        return ("%.1f" if grown <= NOISE * n_log_n else "**%.1f**") % grown

    def each(before, last):
        step, whole = bytes_each(before, last), last.peak * MIB / last.triangles
        return ("%.0f, %.0f" if max(step, whole) < MOST_BYTES else "**%.0f, %.0f**") % (step, whole)

    decade = lambda row: round(math.log10(row.triangles))
    sizes, lines = sorted({decade(r) for r in rows}), []
    for form, program in itertools.product(dict.fromkeys(r.form for r in rows), PROGRAMS):
        of = series(rows, form, program)
        cells = {decade(r): "%.2f s, %.0f MiB" % (r.cpu, r.peak) for r in of}
        if of:
            lines.append([form, program, *(cells.get(s, "-") for s in sizes), growth(*of[-2:]), each(*of[-2:])])
    heads = ("mesh", "program", *("10^%d" % s for s in sizes), "time, last step", "bytes per triangle")
    return pages.table(heads, lines)


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
    bench.page("limit", {"scale": scale_table(rows)})
