"""What things cost: the settings of --quality (in doc/efficiency.md), and triangles (in doc/limit.md)."""
import functools
import itertools
import math
from collections import namedtuple
from pathlib import Path

import numpy as np

import pages
import stats
from common import SEEDED, STAGES, TESTDATA, Halves, Setting, settings
from formats import Builder, glb_parse, gltf_array

# ---- Quality ----
QUALITIES = ("draft", "normal", "high")
RENDERS = (10, 100, 1000)  # CPU seconds of a picture through the portals of --quality normal
SAMPLES = 200_000  # of a picture, about
REFERENCES = TESTDATA / "references/efficiency"  # which tell size and depth
# A furnished room without an opening is the last: no portal is right there.
ROOMS = ("two-rooms", "small-hole", "three-rooms", "door-ajar", "cornell-box-portal", "veach-ajar", "living-room-lamps")
# Of one scene, quality and seed: CPU seconds and peak MiB of the four stages, how many portals, relMSE x CPU s of a picture.
Quality = namedtuple("Quality", "scene quality cpu peak portals cost")


def quality_row(bench, scene, quality, seed):
    """Portals found with that quality, and a picture by tdpt-guided through them, always of as many samples."""
    path, about = bench.find(scene), pages.read_json(REFERENCES / f"{scene}.json")
    found = bench.portals(path, threads=1, options=lambda program: (
        "--seed", seed, "--quality", quality) if program in SEEDED else ())
    size = ("--width", about["width"], "--height", about["height"], "--max-depth", about["max_depth"])
    spp = max(1, round(bench.settings.samples / (about["width"] * about["height"])))
    run = bench.render(path, "--portal", found.file, "--integrator", "tdpt-guided", *size, "--spp", spp, "--seed", 100 + seed)
    off = Halves(bench, *(REFERENCES / f"{scene}-{half}.exr" for half in (1, 2))).off(run.out)
    return Quality(scene, quality, found.cpu, max(r.peak for r in found.runs.values()), found.count,
                   off["relmse"] * run.said["cpu_seconds"])


def quality_of(rows):
    """{quality: (CPU seconds, peak MiB, cost over that of normal, [total of each of RENDERS])}: means over scenes, of
    the ratios geometric ones. total(q, R): the four stages, and a picture as good as R CPU seconds give through the
    portals of normal."""
    scenes, found = list(dict.fromkeys(r.scene for r in rows)), {}
    of = lambda scene, quality, field: [getattr(r, field) for r in rows if (r.scene, r.quality) == (scene, quality)]
    for quality in dict.fromkeys(r.quality for r in rows):
        cpu = {s: np.mean(of(s, quality, "cpu")) for s in scenes}
        each = {s: np.mean(of(s, quality, "cost")) / np.mean(of(s, "normal", "cost")) for s in scenes}
        cost = stats.Ratio(1.0) if quality == "normal" else \
            stats.geometric([(of(s, quality, "cost"), of(s, "normal", "cost")) for s in scenes])
        found[quality] = (np.mean(list(cpu.values())), max(r.peak for r in rows if r.quality == quality), cost,
                          [math.exp(np.mean([math.log(cpu[s] + render * each[s]) for s in scenes])) for render in RENDERS])
    return found


def quality_table(rows):
    return pages.table(("--quality", "four stages [CPU s]", "peak [MiB]", "cost / with normal",
                        *(f"total at {r} s" for r in RENDERS)),
                       [[quality, pages.hundredths(cpu), "%.0f" % peak, cost.text(pages.hundredths),
                         *map(pages.hundredths, totals)] for quality, (cpu, peak, cost, totals) in quality_of(rows).items()])


def quality_plot(rows):
    """Cost over that of normal, and memory, against the time of the four stages: a line a scene."""
    figure, scenes = pages.Figure(3, 420, 340), list(dict.fromkeys(r.scene for r in rows))
    each = [[quality_of([r for r in rows if r.scene == scene])[quality] for quality in QUALITIES] for scene in scenes]
    for words, value, axis in (("cost / with normal", lambda q: q[2].value, "yrange [0.3:3]; set ytics (0.3, 0.5, 0.7, 1, 1.5, 2, 3)"),
                               ("peak [MiB]", lambda q: q[1], "yrange [50:1000]; set ytics (50, 100, 200, 500, 1000)")):
        drawn = [f"{figure.block([(q[0], value(q)) for q in of])} using 1:2 with linespoints lw 2 notitle" for of in each]
        figure.panel(words, "the four stages [CPU s]", "", drawn, (
            "set logscale xy", "set xtics (0.5, 1, 2, 5, 10, 20, 50)", f"set {axis}"))
    figure.key([f'NaN with linespoints lw 2 title "{scene}"' for scene in scenes])
    return figure.script("quality.png")


@settings(SEEDS=Setting(5, "of each setting", 2), SAMPLES=Setting(SAMPLES, "of a picture, about", 20_000))
def quality(bench):
    """What --quality draft, normal and high are worth: time and memory of the four stages, and how noisy pictures through
    their portals are, against the stored references of efficiency. Ten minutes on two cores."""
    bench.need("gnuplot")
    scenes = bench.there(ROOMS)
    rows = bench.side_by_side([functools.partial(quality_row, bench, scene, quality, seed) for seed, quality, scene in
                               itertools.product(range(1, bench.settings.seeds + 1), QUALITIES, scenes)])
    pages.draw(quality_plot(rows), bench.doc)
    bench.page("efficiency", {"quality": quality_table(rows)})


# ---- Time and memory against triangles ----
Row = namedtuple("Row", "triangles program cpu peak")
PROGRAMS = (*STAGES, "tdpt-render")
MOST_BYTES = 400  # of a triangle
NOISE = 1.3  # times n log n
ENOUGH = 0.2  # CPU seconds
MIB = 2**20


def cut(triangles, n):
    """Each of the triangles (... x 3 x 3) cut into n^2 of its shape."""
    i, j = (k.ravel() for k in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    same, turned = (np.stack([i + u, j + v], -1)[i + j < n - less] for u, v, less in ((0, 0, 0), (1, 1, 1)))
    corners = np.concatenate([np.stack([same, same + (1, 0), same + (0, 1)], 1),
                              np.stack([turned, turned - (1, 0), turned - (0, 1)], 1)]) / n
    a, b, c = (triangles[..., None, None, k, :] for k in range(3))
    return (a + corners[..., :1] * (b - a) + corners[..., 1:] * (c - a)).reshape(-1, 3, 3)


def write_scene(triangles, path, room=TESTDATA / "scenes/two-rooms.glb"):
    """The room with its surfaces cut into about so many triangles that share no corner; how many there are. Their vertices
    have a place and a normal, as exporters write them."""
    document, binary = glb_parse(room.read_bytes())
    primitives = [p for mesh in document["meshes"] for p in mesh["primitives"]]
    places = [gltf_array(document, binary, p["attributes"]["POSITION"])[
        gltf_array(document, binary, p["indices"]).reshape(-1, 3)] for p in primitives]
    n, builder = max(1, round(math.sqrt(triangles / sum(map(len, places))))), Builder()
    builder.json.update({key: document[key] for key in ("materials", "extensionsUsed")})
    for primitive, of in zip(primitives, places):
        finer = cut(of.astype("f4"), n)
        normals = np.cross(finer[:, 1] - finer[:, 0], finer[:, 2] - finer[:, 0])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        builder.mesh(finer.reshape(-1, 3), None, np.repeat(normals, 3, 0), primitive["material"])
    node = next(node for node in document["nodes"] if "camera" in node)
    builder.json["cameras"] = document["cameras"]
    builder.node(node)
    Path(path).write_bytes(builder.content())
    return n * n * sum(map(len, places))


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

    sizes, lines = sorted({r.triangles for r in rows}), []
    for program in dict.fromkeys(r.program for r in rows):
        of = sorted((r for r in rows if r.program == program), key=lambda r: r.triangles)
        lines.append([program, *("%.2f s, %.0f MiB" % (r.cpu, r.peak) for r in of), growth(*of[-2:]), each(*of[-2:])])
    return pages.table(("program", *map(str, sizes), "time, last step", "bytes per triangle"), lines)


def stages_of(stem, options={}):
    """(program, arguments, output) from room to picture; options: {program: more of it}."""
    return [(program, [*(f"{stem}.{end}" for end in inputs.split()), *options.get(program, ())], f"{stem}.{output}")
            for program, inputs, output in zip(PROGRAMS, ("glb", "max", "glb cut", "vdb", "glb"),
                                               ("max", "cut", "vdb", "portal.glb", "exr"))]


@settings(SIZES=Setting(("1e3", "1e4", "1e5", "1e6", "1e7"), "triangles of the scenes, about", ("1e3", "1e4")))
def scale(bench):
    """CPU time and peak memory of the five programs on scenes of a thousand to ten million triangles, one thread each.
    Five minutes, 5 GiB of memory, 1 GiB of disk in the cache."""
    rows, stem = [], bench.cache / "room"
    picture = ("--portal", f"{stem}.portal.glb", "--integrator", "tdpt-guided", "--spp", 1, "--width", 64, "--height", 48)
    for size in bench.settings.sizes:
        n = write_scene(float(size), f"{stem}.glb")
        for program, arguments, output in stages_of(stem, {"tdpt-render": picture}):
            run = bench.fresh(program, *arguments, output=output)
            rows.append(Row(n, program, round(run.cpu, 3), round(run.peak_mib, 1)))
        bench.say(f"{n} triangles")
    for room in bench.cache.glob("room.*"):
        room.unlink()
    bench.page("limit", {"scale": scale_table(rows)})
