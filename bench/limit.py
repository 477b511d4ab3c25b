"""limit.py: doc/limit.md from what limit.sh measured, on standard input:
  load L CORES                          processes that wanted a core, before and after each scene
  the lines of limit_bench, with their heads
  profile SCENE INTEGRATOR perf|callgrind, then lines COUNT|OBJECT|FUNCTION

factor   CPU time of a frame over that of its rays cast again: a median over seeds, between the least and the largest
"""
import collections
import re
import statistics
import sys

Frame = collections.namedtuple("Frame", "scene integrator threads seed samples closest shadow rays other "
                                        "frame_cpu raw_cpu frame_wall raw_wall")

# What a function of the renderer is counted as: the first that fits, by its name or that of its object.
PARTS = (
    ("Embree", r"^libembree", None),
    ("sines, cosines (libm)", r"^libm\b", None),
    ("memory, files, system", r"^(?!tdpt-render)", None),
    ("weights, densities of paths", None, r"\bPath::|::weigh$|NextEventPdf|NextEvents::pdf|emission_pdf|scatter_pdf"),
    ("joins and their choice", None, r"\bjoin|joined|\bEnds?::|Few::|Few>|LightPool|LightVertex|_columns|_chosen|estimate_"),
    ("portals, directed walks", None, r"PortalSet|Guide::|segment|through\b|PathSampler::see"),
    ("surfaces, textures", None, r"bsdf|albedo|layered|place_on_surface|lookup|span_of|shading|base_color|towards|add_lobes|"
                                 r"\bturn|interpolated|\bnode\b|ggx|emission_at"),
    ("rays: origins, hits", None, r"Tracer|::visible|to_places"),
    ("walks", None, r"Walker|walk_from|begin_at_light|place_on_light|place_in_sky"),
    ("lights", None, r"Lights|LightSource|Panels|WindowSky|Sky|NextEvents|CumulativeTable"),
    ("random numbers", None, r"Sequence|shader::|mix64|numbers"),
    ("film, tally", None, r"Film|Tally|FixedSum|UnitSum|to_pixel|to_film|project"),
    ("techniques", None, r"PathSampler|render_samples|tbb::"),
    ("other", None, r""),
)


WANTED = {"bdpt": 1.6, "tdpt-guided": 2.2}  # of a frame over its rays


def part_of(module, function):
    for name, of_module, of_function in PARTS:
        if of_module and re.search(of_module, module):
            return name
        if of_function is not None and re.search(of_function, function):
            return name
    raise ValueError(function)


def shares(profile):
    """Percentages of the parts of [(count, object, function)]."""
    total = sum(count for count, _, _ in profile)
    parts = dict.fromkeys((name for name, _, _ in PARTS), 0.0)
    for count, module, function in profile:
        parts[part_of(module, function)] += 100 * count / total
    return parts


def read(lines):
    """Loads, frames, profiles {(scene, integrator): [(count, object, function)]}, and how these were counted."""
    loads, frames, profiles, hows, profile = [], [], {}, set(), None
    for line in lines:
        line = line.rstrip("\n")
        words = line.split()
        if not words or words[0] == "scene":
            continue
        if words[0] == "load":
            loads.append((float(words[1]), int(words[2])))
        elif words[0] == "profile":
            profile = profiles.setdefault((words[1], words[2]), [])
            hows.add(words[3])
        elif "|" in line:
            count, module, function = line.split("|", 2)
            module = module.strip().rsplit("/", 1)[-1]
            profile.append((int(count), module, re.sub(r"^\[[.k]\] *", "", function.strip())))
        else:
            fields = line.split("\t")
            scene = fields[0].rsplit("/", 1)[-1].removesuffix(".glb")
            numbers = [int(x) for x in fields[2:9]] + [float(x) for x in fields[9:]]
            frames.append(Frame(scene, fields[1], *numbers))
    for f in frames:
        if f.other:
            raise ValueError(f"{f.scene}, {f.integrator}: {f.other} rays ended otherwise when they were cast again")
        if f.rays < f.closest + f.shadow:
            raise ValueError(f"{f.scene}, {f.integrator}: rays are missing from the record")
    return loads, frames, profiles, hows


def spread(values):
    """Median, and the least and the largest."""
    return f"{statistics.median(values):.2f} ({min(values):.2f} to {max(values):.2f})"


def groups(frames):
    """{(scene, integrator): {threads: [frames]}} in the order of the lines."""
    found = {}
    for f in frames:
        found.setdefault((f.scene, f.integrator), collections.defaultdict(list))[f.threads].append(f)
    return dict(sorted(found.items(), key=lambda item: [f.scene for f in frames].index(item[0][0])))


def factor_rows(frames):
    rows = []
    for (scene, integrator), by_threads in groups(frames).items():
        one = by_threads.get(1)
        if not one:
            continue
        median = statistics.median
        factors = [f.frame_cpu / f.raw_cpu for f in one]
        aim = WANTED.get(integrator)
        met = "-" if aim is None else f"{aim}: met" if median(factors) <= aim else f"{aim}: **missed**"
        rows.append((scene, f"`{integrator}`", f"{median(f.rays / f.samples for f in one):.1f}",
                     f"{100 * median(f.shadow / f.rays for f in one):.0f} %",
                     f"{1e9 * median(f.frame_cpu / f.samples for f in one):.0f}",
                     f"{1e9 * median(f.raw_cpu / f.rays for f in one):.0f}",
                     spread(factors), met))
    return rows


def aims(rows):
    """How many of the factors with an aim meet it, in a sentence."""
    told = [row[-1] for row in rows if row[-1] != "-"]
    return f"As low\nas wanted: {sum(t.endswith(': met') for t in told)} of the {len(told)} that have an aim."


def thread_rows(frames):
    """Of n threads over one: how many times as fast if every thread had a core, and by the clock."""
    rows = []
    for (scene, integrator), by_threads in groups(frames).items():
        for n, of_n in sorted(by_threads.items()):
            if n == 1 or 1 not in by_threads:
                continue
            pairs = [(a, b) for a in by_threads[1] for b in of_n if a.seed == b.seed]
            rows.append((scene, f"`{integrator}`", str(n), spread([n * a.frame_cpu / b.frame_cpu for a, b in pairs]),
                         spread([n * a.raw_cpu / b.raw_cpu for a, b in pairs]),
                         spread([a.frame_wall / b.frame_wall for a, b in pairs])))
    return rows


def table(head, rows):
    return "\n".join("| " + " | ".join(row) + " |" for row in [head, ["---"] * len(head), *rows])


def profile_table(profiles):
    of = {key: shares(profile) for key, profile in profiles.items()}
    rows = [[name] + [f"{s[name]:.0f} %" if s[name] >= 0.5 else "-" for s in of.values()] for name, _, _ in PARTS]
    return table(["part"] + [f"{scene}, `{integrator}`" for scene, integrator in of], rows)


HOW = {"perf": "samples of the processor's time by perf (cpu-clock)",
       "callgrind": "instructions by callgrind, of a picture 32 pixels wide, loading included"}


def page(loads, frames, profiles, hows):
    most = max((load for load, _ in loads), default=0)
    cores = loads[0][1] if loads else 0
    idle = most <= 1.2
    quiet = ("" if idle else f"The machine was not idle: up to {most:.0f} processes wanted its {cores} cores, so the clock tells "
                             "nothing,\nand shared caches make all times longer.\n\n")
    rows = factor_rows(frames)
    return f"""# How far rendering is from casting its rays

Written by `make limit` (bench/limit.sh). A frame is rendered, and the rays that it gave to Embree are given to it again:
the same queries, robust mode and flags, in the order in which they came, on as many threads as made them and each its own,
and nothing else. The factor says what a renderer that thinks at no cost would gain. No limit of depth, portals as the
stages find them; CPU times of frames and rays by turns; median over seeds, least and largest. {aims(rows)}

## One thread

{table(["scene", "integrator", "rays of a sample", "shadow rays", "sample [ns]", "ray alone [ns]", "frame over rays",
        "wanted"], rows)}

## More threads

As many times as fast as one: by CPU time, as if each thread had a core of its own (n times the CPU time of one over that of n),
and by the clock. Wanted: two threads 1.9 times one on an idle machine.

{quiet}{table(["scene", "integrator", "threads", "frame", "rays alone", "frame by the clock"], thread_rows(frames))}

## What the rest is

Shares of the time of `tdpt-render`, one thread, by function after inlining; {" and ".join(HOW[how] for how in sorted(hows))}.

{profile_table(profiles)}

What was tried to make a sample cheaper, and what came of it: [guided.md](guided.md), "What a sample costs".
"""


if __name__ == "__main__":
    sys.stdout.write(page(*read(sys.stdin)))
