#!/usr/bin/python3
"""regret.py FILE...: what `auto` loses by not knowing which integrator is best, from what regret_bench
printed: a table of the lengths, one of the scenes, and one of what is said of portals, in Markdown.

efficiency of integrator i   1 / (V_i T_i), V its relMSE for one sample, T its CPU time for one
efficiency of auto           that of its choice times t / (t + scout), t the time of its samples
"""
import collections
import math
import sys

WITHOUT = ("bdpt", "nee")
# At least, by the lengths from which on it holds: of the better of bdpt and nee, of the best of all.
TARGETS = {4: (0.9, None), 8: (0.9, 0.85), 16: (0.9, 0.85), 32: (0.95, 0.93), 64: (0.95, 0.93), 256: (0.95, 0.97)}


class Scene:
    def __init__(self):
        self.truth = {}  # integrator: (V, its standard error, T [ns])
        self.choices = collections.defaultdict(list)  # length: [(integrator, scout's CPU s)]
        self.told = collections.defaultdict(dict)  # (length, seed): {integrator: cost}
        self.pixels = 0

    def cost(self, integrator):
        v, _, t = self.truth[integrator]
        return v * t

    def best(self, names=None):
        return min(names or self.truth, key=self.cost)

    def efficiencies(self, length):
        """Of auto, of each seed: over the better of bdpt and nee, and over the best of all."""
        out = []
        for integrator, scout in self.choices[length]:
            rendering = length * self.pixels * self.truth[integrator][2] * 1e-9
            price = rendering / (rendering + scout)
            of = [self.cost(self.best([n for n in WITHOUT if n in self.truth])), self.cost(self.best())]
            out.append(tuple(c / self.cost(integrator) * price for c in of))
        return out


def read(lines):
    """Scenes by name. Throws ValueError."""
    scenes = collections.defaultdict(Scene)
    for number, line in enumerate(lines, 1):
        field = line.rstrip("\n").split("\t")
        try:
            if field[0] == "truth":
                scenes[field[1]].truth[field[2]] = tuple(float(x) for x in field[3:6])
            elif field[0] == "told":
                told = scenes[field[1]].told[int(field[2]), int(field[3])]
                told[field[4]] = float(field[5]) * float(field[6])
            elif field[0] == "choice":
                scene = scenes[field[1]]
                scene.choices[int(field[2])].append((field[4], float(field[5])))
                scene.pixels = int(field[7])
        except (IndexError, ValueError) as error:
            raise ValueError(f"line {number}: {error}") from error
    return scenes


def portals_gain(cost):
    """Efficiency of the best with portals over that of the best without; None where there are not both."""
    with_portals = [c for i, c in cost.items() if i.startswith("tdpt-")]  # tdpt itself is no candidate
    without = [c for i, c in cost.items() if not i.startswith("tdpt")]
    return min(without) / min(with_portals) if with_portals and without else None


def mean(values):
    return sum(values) / len(values)


def scene_table(scenes):
    lengths = sorted({length for s in scenes.values() for length in s.choices})
    rows = [
        "| scene | best of all | its gain over bdpt, nee | "
        + " | ".join(f"{n} spp" for n in lengths)
        + " | chosen at the longest |",
        "|---|---|---|" + "---|" * (len(lengths) + 1),
    ]
    for name, s in scenes.items():
        best = s.best()
        gain = s.cost(s.best([n for n in WITHOUT if n in s.truth])) / s.cost(best)
        cells = [f"{mean([e[1] for e in s.efficiencies(n)]):.3f}" for n in lengths]
        chosen = collections.Counter(i for i, _ in s.choices[lengths[-1]]).most_common(1)[0][0]
        rows.append(f"| {name} | {best} | {gain:.2f} | " + " | ".join(cells) + f" | {chosen} |")
    return rows


def length_table(scenes):
    rows = [
        "| samples per pixel | choices | mean of the better of bdpt and nee | 5 % | least of a scene | target | met in "
        "| mean of the best of all | 5 % | least of a scene | target | met in |",
        "|---|" + "---|" * 11,
    ]
    for length in sorted({n for s in scenes.values() for n in s.choices}):
        of_scene = [s.efficiencies(length) for s in scenes.values() if s.choices[length]]
        cells = []
        for k in range(2):
            each = sorted(e[k] for scene in of_scene for e in scene)
            means = [mean([e[k] for e in scene]) for scene in of_scene]
            target = TARGETS.get(length, (None, None))[k]
            met = "-" if target is None else f"{sum(m >= target for m in means)} of {len(means)}"
            cells += [
                f"{math.exp(mean([math.log(x) for x in each])):.3f}",
                f"{each[int(0.05 * len(each))]:.3f}",
                f"{min(means):.3f}",
                "-" if target is None else f"{target}",
                met,
            ]
        rows.append(f"| {length} | {sum(len(s) for s in of_scene)} | " + " | ".join(cells) + " |")
    return rows


def verdict_table(scenes):
    lengths = sorted({length for s in scenes.values() for length, _ in s.told})
    rows = ["| scene | gain by portals | " + " | ".join(f"told at {n} spp" for n in lengths) + " |",
            "|---|---|" + "---|" * len(lengths)]
    within = {n: [0, 0] for n in lengths}
    for name, s in scenes.items():
        true = portals_gain({i: s.cost(i) for i in s.truth})
        if true is None:
            continue
        cells = []
        for n in lengths:
            told = sorted(g for (length, _), cost in s.told.items() if length == n for g in [portals_gain(cost)] if g)
            within[n][0] += sum(0.5 <= g / true <= 2 for g in told)
            within[n][1] += len(told)
            cells.append(f"{told[len(told) // 2]:.2g} ({told[0]:.2g} to {told[-1]:.2g})" if told else "-")
        rows.append(f"| {name} | {true:.2f} | " + " | ".join(cells) + " |")
    rows.append("| **within a factor of two** | | "
                + " | ".join(f"{100 * a / b:.0f} %" if b else "-" for a, b in within.values()) + " |")
    return rows


def main(paths):
    lines = []
    for path in paths:
        with open(path, encoding="utf-8") as file:
            lines += file.readlines()
    scenes = {name: s for name, s in read(lines).items() if s.truth and s.choices}
    if not scenes:
        raise ValueError("no scene with truth and choices, expected what regret_bench prints")
    print("## All scenes\n\nGeometric means, the worst choice in twenty, and the scene where it is least.\n")
    print("\n".join(length_table(scenes)))
    print("\n## Scene by scene\n\nEfficiency over that of the best of all, mean over choices.\n")
    print("\n".join(scene_table(scenes)))
    print("\n## What portals are said to be worth\n\nThe best integrator with portals over the best without: measured,")
    print("and as told by `auto`, median (least to most).\n")
    print("\n".join(verdict_table(scenes)))


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except (OSError, ValueError) as error:
        sys.exit(f"regret.py: {error}")
