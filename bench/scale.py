"""How time and memory of the programs grow with the triangles of a scene: doc/scale.{csv,md,png}."""
import csv
import itertools
import math
from collections import namedtuple

import pages
import rooms
from common import STAGES, Setting, settings

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


def table(rows, cell, last_head, last_cell):
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
        table(rows, "%(cpu).2f", "growth in the last step", verdict),
        "Peak memory [MiB]:",
        table(rows, "%(peak).0f",
              "bytes a triangle: of the last step, of the largest scene with all else; below %d" % MOST_BYTES, each))


def plot(rows):
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
          FORMS=Setting(rooms.FORMS, "of: grid parts soup"),
          KEEP=Setting(0, "1: the rows that are in the cache make the page anew, nothing runs"))
def scale(bench):
    """CPU time and peak memory of the five programs on scenes of a thousand to ten million triangles, one thread each.
    A quarter of an hour, 5 GiB of memory, 1.5 GiB of disk in the cache."""
    bench.need("gnuplot")
    path, s = bench.cache / "scale.csv", bench.settings
    if not s.keep:
        rows, stem = [], bench.cache / "room"
        picture = ("--portal", f"{stem}.portal.glb", "--integrator", "tdpt-guided", "--spp", 1, "--width", 64,
                   "--height", 48)
        for form, size in itertools.product(s.forms, s.sizes):
            n = rooms.write_scene(int(float(size)), form, f"{stem}.glb")
            for program, arguments, output in stages_of(stem, {"tdpt-render": picture}):
                run = bench.fresh(program, *arguments, output=output)
                rows.append((form, n, program, "%.3f" % run.cpu, "%.1f" % run.peak_mib))
            bench.say(f"{form}: {n} triangles")
        for room in bench.cache.glob("room.*"):
            room.unlink()
        with open(path, "w", newline="", encoding="ascii") as file:
            csv.writer(file, lineterminator="\n").writerows(rows)
    with open(path, newline="", encoding="ascii") as file:
        rows = [Row(form, int(n), program, float(cpu), float(peak)) for form, n, program, cpu, peak in csv.reader(file)]
    (bench.doc / "scale.csv").write_bytes(path.read_bytes())
    pages.draw(plot(rows), bench.doc)
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
