"""whole_light.py RUNS: the tables of doc/whole-light.md from RUNS, a line for each picture: scene, integrator, kind,
seed, CPU s, relMSE, mean. Kinds: none (no limit), six (depth 6), base (depth 6 by another program, if at all)."""
import sys
from collections import namedtuple

import numpy as np

import intervals

Run = namedtuple("Run", "cpu relmse mean")
SEED = 20260229


def read(lines):
    """{(scene, integrator): {kind: [Run, ...]}}, runs in the order of their seeds."""
    runs = {}
    for line in lines:
        scene, integrator, kind, seed, *numbers = line.split()
        runs.setdefault((scene, integrator), {}).setdefault(kind, {})[int(seed)] = Run(*map(float, numbers))
    return {key: {kind: [of[s] for s in sorted(of)] for kind, of in kinds.items()} for key, kinds in runs.items()}


def cpu_ratio(a, b):
    """Of kind a over b: the median over seeds."""
    return float(np.median([x.cpu / y.cpu for x, y in zip(a, b, strict=True)]))


def efficiency_ratio(a, b):
    """Of a over b, and the ends of its interval; nan where an error hides in the reference's noise."""
    costs = [np.array([r.cpu * r.relmse for r in of]) for of in (a, b)]
    if min(c.mean() for c in costs) <= 0:
        return float("nan"), 0.0, float("inf")
    ends = intervals.ratio_interval(costs[1], costs[0], np.random.default_rng(SEED)) if len(a) > 1 else (0.0, np.inf)
    return costs[1].mean() / costs[0].mean(), *ends


def mean_ratio(a, b):
    """Of a over b, and its standard error; the two are independent."""
    means = [np.array([r.mean for r in of]) for of in (a, b)]
    ratio = means[0].mean() / means[1].mean()
    if len(a) < 2:
        return ratio, float("nan")
    relative = [error / mean for mean, error in map(intervals.mean_and_error, means)]
    return ratio, ratio * np.hypot(*relative)


def average(of, field):
    return np.mean([getattr(r, field) for r in of])


def row(key, above, below, mean):
    efficiency, low, high = efficiency_ratio(above, below)
    brackets = f" [{low:.2f}, {high:.2f}]" if 0 < low and high < intervals.NO_BOUND else ""
    spread = "" if np.isnan(mean[1]) else f" +- {mean[1]:.4f}"
    return (f"| {key[0]} | {key[1]} | {average(above, 'cpu'):.2f} | {average(below, 'cpu'):.2f} | {cpu_ratio(above, below):.2f} | "
            f"{average(above, 'relmse'):.3g} | {average(below, 'relmse'):.3g} | "
            f"{'-' if np.isnan(efficiency) else '%.2f' % efficiency}{brackets} | {mean[0]:.4f}{spread} |")


def head(above, below, mean):
    return (f"| scene | integrator | CPU s, {above} | CPU s, {below} | ratio | relMSE, {above} | relMSE, {below} | "
            f"efficiency, {above} / {below} | mean, {mean} |\n" + "|---" * 9 + "|")


def print_tables(runs):
    print(head("no limit", "depth 6", "depth 6 / no limit"))
    for key, kinds in runs.items():
        print(row(key, kinds["none"], kinds["six"], mean_ratio(kinds["six"], kinds["none"])))
    based = {key: kinds for key, kinds in runs.items() if "base" in kinds}
    if based:
        print("\n## Depth 6, before and after\n\nbefore: the program named by BASE. The means must agree.\n")
        print(head("after", "before", "after / before"))
        for key, kinds in based.items():
            print(row(key, kinds["six"], kinds["base"], mean_ratio(kinds["six"], kinds["base"])))


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as file:
        print_tables(read(file))
