"""How right the portals are, and what finding them costs: doc/portals.md."""
import shutil
import statistics
from collections import namedtuple

import pages
from common import ROOT, STAGES, Setting, checked, settings
from price import stages_of

KNOWN = "hole,slit,floor-door,through-floor,ajar-full,ajar,window,two-openings,holes-in-row,doors-in-row,closet"
UNDER_SKY = ("sky-window,sky-windows,corner-windows,skylight,sky-blinds,colonnade,room-behind,deep-facade,landscape,"
             "deep-room")
HEAD = """| rooms | all four | coverage >= 0.98 | tightness >= 0.90 | angle <= 3 | right number | strays | \
median coverage | median tightness | median angle | CPU s |
|---|---|---|---|---|---|---|---|---|---|---|---|"""
ALL = "all four"


# ---- Time ----
# wall, cpu [s]; aside: CPU seconds of loading the scene and of its BVH; peak [MiB].
Taken = namedtuple("Taken", "wall cpu aside peak", defaults=(0, 0))


def with_sums(rounds):
    """rounds: [{(scene, stage): Taken}]. {(scene, stage): [Taken]}, after the stages of a scene all four of a round."""
    runs = {}
    for of in rounds:
        for (scene, stage), taken in of.items():
            runs.setdefault((scene, stage), []).append(taken)
            if stage == STAGES[-1]:
                four = list(zip(*(of[scene, s] for s in STAGES)))
                runs.setdefault((scene, ALL), []).append(Taken(*map(sum, four[:3]), max(four[3])))
    return runs


def time_tables(name, runs):
    """name: of the scene; NAME/4: the same with each of its triangles split in four. Medians over the rounds."""
    median = lambda key, value: statistics.median_low([value(t) for t in runs[key]])
    wall, cpu, aside, rows = (lambda t: t.wall), (lambda t: t.cpu), (lambda t: t.aside), []
    for scene, stage in runs:
        key, loads = (scene, stage), stage in ("ffgraph", "lightgrid", ALL)
        rows.append([scene.removesuffix("/4") + (", split in four" if scene.endswith("/4") else ""),
                     "tdpt-render bdpt, 1 spp, 1280x720" if stage == "bdpt" else stage, "%.2f" % median(key, wall),
                     "%.2f" % median(key, cpu), "%.2f" % median(key, aside) if loads else "-",
                     max(t.peak for t in runs[key]) or "-"])

    whole, bdpt, split = (name, ALL), (name, "bdpt"), (name + "/4", ALL)
    ratios = (("four stages to bdpt, wall", wall, whole, bdpt, 1), ("four stages to bdpt, CPU", cpu, whole, bdpt, 1),
              ("split in four to whole, CPU without loading and BVH", lambda t: t.cpu - t.aside, split, whole, 1.5))
    return pages.sections(
        pages.table(("scene", "stage", "wall s", "CPU s", "CPU s of loading and BVH", "peak MiB"), rows),
        pages.table(("ratio", "measured", "at most"),
                    [[words, "%.2f" % (median(a, of) / median(b, of)), most] for words, of, a, b, most in ratios]))


def measured_time(bench):
    name = "veach-ajar"
    scene = bench.find(name)
    if not scene:
        bench.say("veach-ajar.glb is not there, door-ajar.glb of testdata takes its place")
        name = "door-ajar"
        scene = bench.find(name)
    whole, split, rounds = bench.cache / "whole.glb", bench.cache / "split.glb", []
    shutil.copy(scene, whole)
    checked([bench.store.program("split_scene"), scene, split])
    picture = ("--integrator", "bdpt", "--spp", 1, "--max-depth", 6, "--width", 1280, "--height", 720)

    def taken(program, arguments, output):
        run = bench.fresh(program, *arguments, output=output, threads=0)
        phases = run.said.get("phases", {}) if program in ("ffgraph", "lightgrid") else {}
        aside = sum(phases[p]["cpu_seconds"] for p in ("load", "bvh") if phases.get(p))
        return Taken(run.wall, run.cpu, aside, round((run.said.get("peak_bytes") or 0) / 2**20))

    for _ in range(bench.settings.runs):
        of = {(name, "bdpt"): taken("tdpt-render", (scene, *picture), bench.cache / "a.exr")}
        for key, room in ((name, whole), (name + "/4", split)):
            of.update({(key, stage[0]): taken(*stage) for stage in stages_of(room.with_suffix(""))[:4]})
        rounds.append(of)
    return time_tables(name, with_sums(rounds))


RUNS = Setting(3, "of each program whose time is told", 1)


@settings(RUNS=RUNS)
def portals_time(bench):
    """How long finding the portals takes, and how much memory, on veach-ajar and on the same scene with each of its
    triangles split in four, beside a rendering of one sample per pixel at depth 6. Prints a table of medians and one of
    ratios. Runs take turns, so that a busy machine slows all down."""
    print(measured_time(bench))


# ---- Rooms with known openings ----
def not_all_right(text):
    """What portals_bench prints, without the kinds of which every room is right; these are counted."""
    kept, right = [], 0
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) > 2 and cells[1].isdigit() and cells[1] == cells[2] and "together" not in cells[0]:
            right += 1
        else:
            kept.append(line)
    return "\n".join(kept) + f"\n\nEvery room is right in {right} other kinds."


@settings(ROOMS=Setting(20, "of each kind", 1),
          SEED=Setting(0, "of the first; if not set, the first seven digits of the commit's hash, so that nobody "
                       "chooses it"),
          RUNS=RUNS)
def portals(bench):
    """How right the portals are, on generated rooms whose openings are known, and what that costs. An hour on two quiet
    cores. Rows room by room stay in the cache."""
    s, seed, whence = bench.settings, bench.settings.seed, ""
    if not seed:
        head = checked(["git", "-C", ROOT, "rev-parse", "HEAD"]).said[:7]
        seed, whence = int(head, 16), f", the first digits of the commit that was measured, {head}"
    few = (s.rooms + 6) // 7  # rooms of each kind in the other tables
    program = bench.store.program("portals_bench")

    def table(name, count, *arguments):
        """Of portals_bench."""
        run = checked([program, bench.programs, "--seed", seed, "--rooms", count, "--jobs", s.jobs, *arguments],
                      may_fail=(1,))
        (bench.cache / f"{name}.rooms").write_text(run.errors, encoding="utf-8")
        return run.said.strip()

    def summary(label, **options):
        """One row over all kinds."""
        arguments = [word for stage, text in options.items() for word in (f"--{stage}", text)]
        rows = table(label.replace(" ", "-").replace("'", ""), few, "--kinds", KNOWN, *arguments).splitlines()
        kinds = "| all kinds together |"
        return "\n".join(f"| {label} |" + row.removeprefix(kinds) for row in rows if row.startswith(kinds))

    triangles, paper = {"ffgraph": "--nodes triangles"}, {"portalfit": "--set method=paper"}
    invariance = checked([bench.store.program("invariance_bench"), bench.programs, few])
    (bench.cache / "invariance.rooms").write_text(invariance.errors, encoding="utf-8")
    bench.page("portals", {
        "kinds": f"The first seed of each kind is {seed}{whence}.\n\n{not_all_right(table('kinds', s.rooms))}",
        "skies": not_all_right(table("skies", few, "--kinds", UNDER_SKY)),
        "rules": "\n".join((f"| method {HEAD}", summary("ours"), summary("triangles, our fit", **triangles),
                            summary("patches, the paper's fit", **paper),
                            summary("triangles, the paper's fit", **triangles, **paper))),
        "invariance": invariance.said.strip(), "time": measured_time(bench)}, "portalfit")
