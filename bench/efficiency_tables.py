"""efficiency_tables.py TABLE SCENES CSV SECONDS [ARGUMENT...]: the tables of doc/efficiency.md, from
  SCENES  a line for each scene, tab-separated, as in Scene below; "-": none
  CSV     doc/efficiency.csv
SECONDS: nominal CPU seconds of the pictures that a table is about. TABLE, and its ARGUMENTs:
  gains GROUP, psnr GROUP   scenes of a group (GROUPS below) and all integrators; nothing where there are none
  scene SCENE               words on the reference's relMSE and bdpt's mean, and a row for each integrator
  noisy                     the names of scenes whose references are too noisy
  busy                      a warning, where pictures got much less CPU time than they should
  long SCENE                a row for each integrator with the relMSE of every seed
  paper SCENE               two cells: PSNR and MAPE of tdpt against bdpt's
  pair SCENE                names of the integrator that aims are asked of, and of the one it is compared with
  points                    scene, integrator; CPU seconds, relMSE, its lowest and highest; for plots, of all
                            pictures that are no longer than SECONDS

cost = error x CPU seconds, error = relMSE or MSE; gain of a over b = mean cost of b / mean cost of a. Intervals of
gains: intervals.py. A firefly that no seed met is in no interval.

NAME-before is integrator NAME of the older program that gains are told over.
"""
import copy
import csv
import math
import sys
from dataclasses import dataclass

import numpy as np

import intervals

SEED = 20240229
BEFORE = "-before"
# Kinds of scenes in each table of gains.
GROUPS = {"doors": ("door",), "rooms": ("interior", "open"), "whole": ("whole",)}
INTERIORS_AIM = 2.5  # of the geometric mean of interiors' gains
OF_THE_AIM = 0.1  # the most that a reference's relMSE may be of the one it judges


@dataclass
class Scene:
    """A line of SCENES. kind: door, interior, open (no door), whole (no limit of depth). target: of the gain; wanted:
    relMSE after a minute; wanted_psnr: PSNR over the base's in the same time [dB]; half: difference of the reference's
    halves' means / 2."""

    name: str
    kind: str
    target: str
    moonshot: str
    wanted: str
    wanted_moonshot: str
    wanted_psnr: str
    mean: str
    half: str
    relmse: str
    cpu_seconds: str
    black_relmse: str
    black_psnr: str
    black_mape: str
    integrator: str
    spp: str


@dataclass
class Gain:
    """Of one integrator over another; 0: unknown. low, high: ends of its interval, high = 0: none."""

    value: float = 0
    low: float = 0
    high: float = 0

    def bounded(self):
        return self.high < intervals.NO_BOUND

    def verdict(self, wanted):
        if self.value <= 0:
            return "-"
        if self.value >= wanted:
            return "met" if self.high == 0 or self.low >= wanted else "met, but within the noise"
        return "missed, but within the noise" if self.high >= wanted else "missed"

    def text(self):
        if self.value <= 0:
            return "-"
        ends = f" [{digits(self.low)}, {digits(self.high) if self.bounded() else '?'}]" if self.high > 0 else ""
        return digits(self.value) + ends

    def decibels(self):
        if self.value <= 0:
            return "-"
        ends = f" [{decibels(self.low)}, {decibels(self.high)}]" if self.low > 0 and self.bounded() else ""
        return decibels(self.value) + ends


def digits(x):
    formats = ((0.095, "%.2g"), (0.995, "%.2f"), (9.95, "%.1f"), (999.5, "%.0f"))
    return next((f for limit, f in formats if x < limit), "%.2g") % x


def decibels(x):
    return "%+.1f" % (10 * math.log10(x))


def number(x, form):
    return "-" if x in ("", "-") else form % float(x)


def with_portals(integrator):
    return integrator.startswith(("tdpt", "auto"))


class Measurements:
    def __init__(self, scenes, rows, seconds):
        """scenes: of Scene; rows: dictionaries with the columns of the CSV, as text."""
        self.scenes = {s.name: s for s in scenes}
        self.seconds = seconds
        self.integrators = list(dict.fromkeys(row["integrator"] for row in rows))
        self.rows = {}
        for row in rows:
            self.rows.setdefault((row["scene"], row["integrator"]), []).append(row)

    def at(self, seconds):
        """The same, of pictures of another length."""
        other = copy.copy(self)
        other.seconds = seconds
        return other

    def of_group(self, group):
        return [name for name, s in self.scenes.items() if s.kind in GROUPS[group]]

    def field(self, name, scene, integrator):
        """Of all seeds; nan where the CSV has none."""
        rows = [r for r in self.rows.get((scene, integrator), []) if r["seconds"] == self.seconds]
        return np.array([float(r[name]) if r[name] else math.nan for r in rows])

    def count(self, scene, integrator):
        return len(self.field("seed", scene, integrator))

    def average(self, name, scene, integrator):
        values = self.field(name, scene, integrator)
        return values.mean() if len(values) else 0.0

    def costs(self, scene, integrator, error):
        return self.field(error, scene, integrator) * self.field("cpu_seconds", scene, integrator)

    def gain(self, scene, a, b, error="relmse"):
        of_a, of_b = self.costs(scene, a, error), self.costs(scene, b, error)
        if not (len(of_a) and len(of_b) and of_a.mean() > 0 and of_b.mean() > 0):
            return Gain()
        value = of_b.mean() / of_a.mean()
        if a == b or min(len(of_a), len(of_b)) < 2:
            return Gain(value)
        return Gain(value, *intervals.ratio_interval(of_b, of_a, np.random.default_rng(SEED)))

    def cheapest(self, scene, integrators):
        """By relMSE. None where none is known."""
        means = {i: self.costs(scene, i, "relmse").mean() for i in integrators if self.count(scene, i)}
        return min((i for i in means if means[i] > 0), key=means.get, default=None)

    def base(self, scene):
        """What gains are over: bdpt, in scenes without a door the better of bdpt and nee; of the older program where it
        was measured. None where none was."""
        names = ("bdpt", "nee") if self.scenes[scene].kind in GROUPS["rooms"] else ("bdpt",)
        before = [name + BEFORE for name in names if self.count(scene, name + BEFORE)]
        there = before or [name for name in names if self.count(scene, name)]
        return self.cheapest(scene, there) or next(iter(there), None)

    def judged(self, scene):
        """What aims are asked of: auto, or the best with portals where auto was not measured."""
        if self.count(scene, "auto"):
            return "auto"
        return self.cheapest(scene, [i for i in self.integrators if with_portals(i)])

    def over_base(self, scene, integrator, error="relmse"):
        base = self.base(scene)
        return self.gain(scene, integrator, base, error) if base and integrator else Gain()

    def efficiency(self, scene, integrator):
        """1 / (relMSE x CPU s), as text."""
        costs = self.costs(scene, integrator, "relmse")
        return "%.3g" % (1 / costs.mean()) if len(costs) and costs.mean() > 0 else "-"

    def geometric_mean(self, scenes, integrator):
        """Of the gains over the base; unknown where one of them is."""
        gains = [self.over_base(s, integrator) for s in scenes]
        if not gains or min(g.value for g in gains) <= 0:
            return Gain()
        pairs = [(self.costs(s, self.base(s), "relmse"), self.costs(s, integrator, "relmse"))
                 for s in scenes if self.base(s) != integrator]
        value = math.exp(np.mean([math.log(g.value) for g in gains]))
        if not pairs or min(len(v) for pair in pairs for v in pair) < 2:
            return Gain(value)
        # A gain of 1 over itself has no interval.
        exponent = len(pairs) / len(scenes)
        low, high = intervals.geometric_interval(pairs, np.random.default_rng(SEED))
        return Gain(value, low**exponent, high**exponent if high < intervals.NO_BOUND else high)

    def aimed_relmse(self, scene):
        """The least relMSE that an aim asks of a picture of the scene, without an aim the base's. None where it is not
        known."""
        s, base, judged = self.scenes[scene], self.base(scene), self.judged(scene)
        if not base or not judged:
            return None
        target = INTERIORS_AIM if s.kind == "interior" else 1 if s.target == "-" else float(s.target)
        relmse = self.costs(scene, base, "relmse").mean() / target / self.average("cpu_seconds", scene, judged)
        known = [x for x in (relmse, 0 if s.wanted == "-" else float(s.wanted)) if x > 0]
        return min(known, default=None)

    def all_means(self, scene, integrator):
        """Of the pictures of all lengths: how many, their samples, their mean, variance of one of one sample."""
        rows = self.rows.get((scene, integrator), [])
        if not rows:
            return 0, 0.0, 0.0, 0.0
        weights = np.array([float(r["spp"]) for r in rows])
        return len(rows), weights.sum(), *intervals.weighted_mean(np.array([float(r["mean"]) for r in rows]), weights)

    def mean_ratio(self, scene, integrator):
        """Mean over the reference's and its standard error, (0, 0) where unknown. The reference's noise is known from
        other pictures of its integrator, or, from none, roughly from its halves."""
        s = self.scenes[scene]
        reference = float(s.mean)
        runs, weight, mean, variance = self.all_means(scene, integrator)
        if reference <= 0 or not runs:
            return 0.0, 0.0
        others, _, _, noise = self.all_means(scene, s.integrator)
        noise = noise / float(s.spp) if others > 2 else float(s.half) ** 2
        return mean / reference, math.sqrt(variance / weight + noise) / reference

    def most_memory(self, scene, integrator):
        """MiB, as text."""
        peaks = self.field("peak_mib", scene, integrator)
        return "-" if np.isnan(peaks).any() else "%.0f" % peaks.max()

    def psnr(self, scene, integrator):
        """Of the mean MSE."""
        mse, psnr = self.field("mse", scene, integrator), self.field("psnr", scene, integrator)
        known = ~np.isnan(psnr)
        if not known.any() or mse.mean() <= 0:
            return "-"
        peak = (mse * 10 ** (psnr / 10))[known][0]
        return "%.2f" % (10 * math.log10(peak / mse.mean()))


def aim(wanted, moonshot):
    return "-" if wanted == "-" else wanted + ("" if moonshot == "-" else f" ({moonshot})")


def overview(m, group, cells, heads):
    """A row for each scene of the group that was measured: cells(scene, integrators), the last of them under `heads`.
    bdpt, where it is what all gains are over, has no column. The scenes and integrators that are shown."""
    scenes = [s for s in m.of_group(group) if m.base(s)]
    bases = {m.base(s) for s in scenes}
    shown = [i for i in m.integrators if any(m.count(s, i) for s in scenes) and (group == "rooms" or {i} != bases)]
    if scenes:
        print("|".join(["", " scene ", *(f" {i} " for i in shown), *(f" {h} " for h in heads), ""]))
        print("|---" * (1 + len(shown) + len(heads)) + "|")
    for scene in scenes:
        print("|".join(["", f" {scene} ", *(f" {c} " for c in cells(scene, shown)), ""]))
    return scenes, shown


def print_gains(m, group):
    """Of bdpt also what it is itself: no gain comes of a bdpt made worse."""
    itself = [i for i in ("bdpt" + BEFORE, "bdpt") if any(m.count(s, i) for s in m.of_group(group))]

    def cells(scene, shown):
        s, judged = m.scenes[scene], m.judged(scene)
        gain = m.over_base(scene, judged)
        says = "-" if s.target == "-" or not judged else f"{judged}: {gain.verdict(float(s.target))}"
        gains = ("1" if i == m.base(scene) else m.over_base(scene, i).text() for i in shown)
        return [*gains, aim(s.target, s.moonshot), says, *(m.efficiency(scene, i) for i in itself)]

    heads = ("aim (moonshot)", "met", *(f"efficiency of {i} [1/s]" for i in itself))
    scenes, shown = overview(m, group, cells, heads)
    interiors = [s for s in scenes if m.scenes[s].kind == "interior"]
    if interiors:
        print_interiors(m, interiors, shown, len(itself))


def print_interiors(m, interiors, shown, more):
    """Two rows that end the table; `more` cells stay empty."""
    means = {i: m.geometric_mean(interiors, i) for i in shown}
    judged = m.judged(interiors[0])
    says = f"{judged}: {means[judged].verdict(INTERIORS_AIM)}" if judged else "-"
    rows = {f"geometric mean of {len(interiors)} interiors": [*(means[i].text() for i in shown), INTERIORS_AIM, says],
            "the least of them": [*(least(m, interiors, i) for i in shown), "-", "-"]}
    for words, cells in rows.items():
        print("|".join(["", f" **{words}** ", *(f" {c} " for c in cells), *[" - "] * more, ""]))


def least(m, scenes, integrator):
    gains = {s: m.over_base(s, integrator).value for s in scenes}
    scene = min(gains, key=gains.get)
    return f"{digits(gains[scene])} ({scene})" if gains[scene] > 0 else "-"


def print_psnr(m, group):
    def cells(scene, shown):
        wanted, judged = m.scenes[scene].wanted_psnr, m.judged(scene)
        gain = m.over_base(scene, judged, "mse")
        says = "-" if wanted == "-" or not judged else f"{judged}: {gain.verdict(10 ** (float(wanted) / 10))}"
        return ["0" if i == m.base(scene) else m.over_base(scene, i, "mse").decibels() for i in shown] + [wanted, says]

    overview(m, group, cells, ("at least", "met"))


def print_scene(m, scene):
    print_reference(m, scene)
    print_check(m, scene)
    print()
    print_rows(m, scene)


def print_rows(m, scene):
    base = m.base(scene)
    print("| integrator | spp | CPU s | MiB | relMSE [seeds] | efficiency [1/s] | gain | PSNR [dB] |"
          f" PSNR - that of {base} | MAPE [%] | mean / reference |")
    print("|---" * 11 + "|")
    for i in m.integrators:
        if not m.count(scene, i):
            continue
        relmse, is_base = m.field("relmse", scene, i), i == base
        print("| %s | %.3g | %.2f | %s | %.3g [%.3g, %.3g] | %s | %s | %s | %s | %.3g | %.4f +- %.4f |" % (
            i, m.average("spp", scene, i), m.average("cpu_seconds", scene, i), m.most_memory(scene, i),
            relmse.mean(), relmse.min(), relmse.max(), m.efficiency(scene, i),
            "1" if is_base else m.over_base(scene, i).text(), m.psnr(scene, i),
            "0" if is_base else m.over_base(scene, i, "mse").decibels(), m.average("mape", scene, i),
            *m.mean_ratio(scene, i)))
    s = m.scenes[scene]
    print(f"| all black | - | - | - | {number(s.black_relmse, '%.3g')} | - | - | {number(s.black_psnr, '%.2f')} | - | "
          f"{number(s.black_mape, '%.3g')} | 0 |")


def too_noisy(m, scene):
    aimed = m.aimed_relmse(scene)
    return aimed is not None and float(m.scenes[scene].relmse) > OF_THE_AIM * aimed


def print_reference(m, scene):
    aimed = m.aimed_relmse(scene)
    words = "relMSE %.3g" % float(m.scenes[scene].relmse)
    if aimed is not None:
        words += ", %s a tenth of the %.3g that it judges" % (
            "MORE THAN" if too_noisy(m, scene) else "at most", aimed)
    print(words + ".")


def print_noisy(m):
    names = [s for s in m.scenes if too_noisy(m, s)]
    if names:
        print("References with more than a tenth of the relMSE that they judge: %s." % ", ".join(names))


def print_check(m, scene):
    ratio, error = m.mean_ratio(scene, "bdpt")
    if ratio == 0 or error == 0 or m.all_means(scene, "bdpt")[0] < 4:
        print("No check: bdpt was not rendered often enough.")
        return
    off = (ratio - 1) / error
    print("Check: the mean of all of bdpt's pictures is %.4f +- %.4f of the reference's, %+.1f standard errors: %s." % (
        ratio, error, off, "they agree" if abs(off) < 3 else "THEY DISAGREE"))


def print_long(m, scene):
    s = m.scenes[scene]
    goal = "-" if s.wanted == "-" else f"at most {aim(s.wanted, s.wanted_moonshot)}, every seed"
    for i in m.integrators:
        relmse = m.field("relmse", scene, i)
        if not len(relmse):
            continue
        met = "-" if s.wanted == "-" or not with_portals(i) else "met" if relmse.max() <= float(s.wanted) else "missed"
        seeds = ", ".join("%.3g" % x for x in relmse)
        goal_of_it = goal if with_portals(i) else "-"
        print(f"| {i} | {seeds} | {m.average('cpu_seconds', scene, i):.1f} | {goal_of_it} | {met} |")


def print_busy(m):
    got = np.concatenate([m.field("cpu_seconds", s, i) for s in m.scenes for i in m.integrators])
    if len(got) and got.mean() < 0.85 * float(m.seconds):
        print("The machine was busy: on average a picture got %.3g of its %s CPU seconds." % (got.mean(), m.seconds))


def print_paper(m, scene):
    gain = m.gain(scene, "tdpt", "bdpt", "mse").value
    if gain <= 0:
        print("- | -")
    else:
        print("%s dB | %.3g %% against %.3g %%" % (
            decibels(gain), m.average("mape", scene, "tdpt"), m.average("mape", scene, "bdpt")))


def print_points(m):
    lengths = {r["seconds"] for rows in m.rows.values() for r in rows}
    for seconds in sorted((s for s in lengths if float(s) <= float(m.seconds)), key=float):
        at = m.at(seconds)
        for scene, i in m.rows:
            relmse = at.field("relmse", scene, i)
            if len(relmse) and relmse.mean() > 0:
                low = relmse.min() if relmse.min() > 0 else relmse.mean()
                numbers = at.average("cpu_seconds", scene, i), relmse.mean(), low, relmse.max()
                print(scene, i, *("%.6g" % x for x in numbers))


TABLES = {
    "gains": print_gains,
    "psnr": print_psnr,
    "scene": print_scene,
    "noisy": print_noisy,
    "busy": print_busy,
    "long": print_long,
    "paper": print_paper,
    "pair": lambda m, scene: print(*dict.fromkeys(i for i in (m.judged(scene), m.base(scene)) if i)),
    "points": print_points,
}


def read(scenes, measured, seconds):
    """From open files."""
    lines = [line.rstrip("\n").split("\t") for line in scenes]
    return Measurements([Scene(*line) for line in lines], list(csv.DictReader(measured)), seconds)


def main(table, scenes, measured, seconds, *which):
    with open(scenes, encoding="utf-8") as first, open(measured, encoding="utf-8", newline="") as second:
        TABLES[table](read(first, second, seconds), *which)


if __name__ == "__main__":
    if len(sys.argv) < 5 or sys.argv[1] not in TABLES:
        sys.exit("usage: efficiency_tables.py TABLE SCENES CSV SECONDS [ARGUMENT...]")
    main(*sys.argv[1:])
