"""portals_time.py NAME RUNS: the tables of portals-time.sh from RUNS, a line for each program that ran, in order:
scene, program, wall s, CPU s, CPU s of loading the scene and of its BVH, peak MiB. NAME: the scene; NAME/4: the same
with each of its triangles split in four. Medians over the runs; the four stages together are summed within a run."""
import sys
from collections import namedtuple

import intervals

Run = namedtuple("Run", "wall cpu aside peak")
STAGES = ("ffgraph", "mincut", "lightgrid", "portalfit")
ALL = "all four"


def read(lines):
    """{(scene, stage): [Run, ...]} in the order of their first lines, ALL after the stages."""
    runs, open_sums = {}, {}
    for line in lines:
        scene, stage, *numbers = line.split()
        run = Run(*map(float, numbers))
        runs.setdefault((scene, stage), []).append(run)
        if stage in STAGES:
            open_sums.setdefault(scene, []).append(run)
        if stage == STAGES[-1]:
            four = open_sums.pop(scene)
            runs.setdefault((scene, ALL), []).append(
                Run(*(sum(r[i] for r in four) for i in range(3)), max(r.peak for r in four)))
    return runs


def median(runs, value):
    return intervals.lower_median([value(r) for r in runs])


def print_tables(name, runs):
    print("| scene | stage | wall s | CPU s | CPU s of loading and BVH | peak MiB |")
    print("|---|---|---|---|---|---|")
    for (scene, stage), of in runs.items():
        loads = stage in ("ffgraph", "lightgrid", ALL)
        peak = max(r.peak for r in of)
        print("| %s | %s | %.2f | %.2f | %s | %s |" % (
            scene.removesuffix("/4") + (", split in four" if scene.endswith("/4") else ""),
            "tdpt-render bdpt, 1 spp, 1280x720" if stage == "bdpt" else stage,
            median(of, lambda r: r.wall), median(of, lambda r: r.cpu),
            "%.2f" % median(of, lambda r: r.aside) if loads else "-", "%d" % peak if peak > 0 else "-"))

    def ratio(value, above, below):
        return median(runs[above], value) / median(runs[below], value)

    whole, bdpt, split = (name, ALL), (name, "bdpt"), (name + "/4", ALL)
    print("\n| ratio | measured | at most |\n|---|---|---|")
    print("| four stages to bdpt, wall | %.2f | 1 |" % ratio(lambda r: r.wall, whole, bdpt))
    print("| four stages to bdpt, CPU | %.2f | 1 |" % ratio(lambda r: r.cpu, whole, bdpt))
    print("| split in four to whole, CPU without loading and BVH | %.2f | 1.5 |" % ratio(
        lambda r: r.cpu - r.aside, split, whole))


if __name__ == "__main__":
    with open(sys.argv[2], encoding="utf-8") as file:
        print_tables(sys.argv[1], read(file))
