#!/usr/bin/python3
"""regret.py FILE...: what `auto` loses by not knowing which integrator is best, from what regret_bench
printed: a table of the scenes, one of the lengths, and the distribution, in Markdown.

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
            elif field[0] == "choice":
                scene = scenes[field[1]]
                scene.choices[int(field[2])].append((field[4], float(field[5])))
                scene.pixels = int(field[7])
        except (IndexError, ValueError) as error:
            raise ValueError(f"line {number}: {error}") from error
    return scenes


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


def main(paths):
    lines = []
    for path in paths:
        with open(path, encoding="utf-8") as file:
            lines += file.readlines()
    scenes = {name: s for name, s in read(lines).items() if s.truth and s.choices}
    if not scenes:
        raise ValueError("no scene with truth and choices, expected what regret_bench prints")
    print("\n".join(length_table(scenes)))
    print()
    print("\n".join(scene_table(scenes)))


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except (OSError, ValueError) as error:
        sys.exit(f"regret.py: {error}")
