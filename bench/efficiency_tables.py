"""efficiency_tables.py TABLE SCENES CSV SECONDS [SCENE [INTEGRATOR]]: the tables of doc/efficiency.md, from
  SCENES  a line for each scene, tab-separated, as in Scene below; "-": none
  CSV     doc/efficiency.csv
SECONDS: nominal CPU seconds of the pictures that a table is about. TABLE:
  gains, psnr   all scenes and integrators
  scene         a row for each integrator
  check         a word on bdpt's mean
  busy          a warning, where pictures got much less CPU time than they should
  long          a row for each integrator with the relMSE of every seed
  paper         two cells: PSNR and MAPE of tdpt against bdpt's
  best          name of the best portal integrator
  means         CPU seconds, relMSE, its lowest and highest; for plots

cost = error x CPU seconds, error = relMSE or MSE; gain of a over b = mean cost of b / mean cost of a. Intervals of
gains: intervals.py. A firefly that no seed met is in no interval.
"""
import csv
import math
import sys
from dataclasses import dataclass

import numpy as np

import intervals

SEED = 20240229


@dataclass
class Scene:
    """A line of SCENES. wanted: relMSE after a minute; half: difference of the reference's halves' means / 2."""

    name: str
    target: str
    moonshot: str
    wanted: str
    wanted_moonshot: str
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

    def best(self, scene, portals, but=None):
        """The cheapest; among those with portals, or among all but one. None where there is none."""
        costs = {i: self.costs(scene, i, "relmse") for i in self.integrators if i != but}
        means = {i: c.mean() for i, c in costs.items() if len(c) and (with_portals(i) or not portals)}
        return min((i for i in means if means[i] > 0), key=means.get, default=None)

    def target_text(self, scene):
        s = self.scenes[scene]
        if s.target in ("-", "others"):
            return "-" if s.target == "-" else "0.9 x the best other"
        return s.target + ("" if s.moonshot == "-" else f" ({s.moonshot})")

    def met(self, scene, integrator):
        """Whether the integrator meets the scene's target."""
        target = self.scenes[scene].target
        if not integrator or target == "-" or not with_portals(integrator):
            return "-"
        if target != "others":
            return self.gain(scene, integrator, "bdpt").verdict(float(target))
        other = self.best(scene, portals=False, but=integrator)
        if not other:
            return "-"
        gain = self.gain(scene, integrator, other)
        return f"{gain.verdict(0.9)}: {gain.text()} x {other}"

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

    def psnr(self, scene, integrator):
        """Of the mean MSE."""
        mse, psnr = self.field("mse", scene, integrator), self.field("psnr", scene, integrator)
        known = ~np.isnan(psnr)
        if not known.any() or mse.mean() <= 0:
            return "-"
        peak = (mse * 10 ** (psnr / 10))[known][0]
        return "%.2f" % (10 * math.log10(peak / mse.mean()))


def overview(m, cell, heads):
    """A row for each scene, a cell for each integrator but bdpt; rest(scene): the cells of `heads`."""
    others = [i for i in m.integrators if i != "bdpt"]
    print("|".join(["", " scene ", *(f" {i} " for i in others), *(f" {h} " for h in heads), ""]))
    print("|---" * (1 + len(others) + len(heads)) + "|")
    for scene in m.scenes:
        print("|".join(["", f" {scene} ", *(f" {c} " for c in cell(scene, others)), ""]))


def print_gains(m):
    def cells(scene, others):
        best = m.best(scene, portals=True)
        says = f"{best}: {m.met(scene, best)}" if best and m.scenes[scene].target != "-" else "-"
        return [*(m.gain(scene, i, "bdpt").text() for i in others), m.target_text(scene), says]

    overview(m, cells, ("target (moonshot)", "met by the best with portals"))


def print_psnr(m):
    def cells(scene, others):
        best = m.best(scene, portals=True)
        says = f"{best}: {m.gain(scene, best, 'bdpt', 'mse').verdict(10**-0.03)}" if best else "-"
        return [*(m.gain(scene, i, "bdpt", "mse").decibels() for i in others), says]

    overview(m, cells, ("at least -0.3 dB, by the best with portals",))


def print_scene(m, scene):
    print("| integrator | spp | CPU s | relMSE [seeds] | PSNR [dB] | MAPE [%] | mean / reference | gain | target | met |"
          " PSNR - bdpt's |")
    print("|---" * 11 + "|")
    for i in m.integrators:
        if not m.count(scene, i):
            continue
        relmse, is_bdpt = m.field("relmse", scene, i), i == "bdpt"
        print("| %s | %.3g | %.2f | %.3g [%.3g, %.3g] | %s | %.3g | %.4f +- %.4f | %s | %s | %s | %s |" % (
            i, m.average("spp", scene, i), m.average("cpu_seconds", scene, i), relmse.mean(), relmse.min(), relmse.max(),
            m.psnr(scene, i), m.average("mape", scene, i), *m.mean_ratio(scene, i),
            "1" if is_bdpt else m.gain(scene, i, "bdpt").text(), m.target_text(scene) if with_portals(i) else "-",
            m.met(scene, i), "0" if is_bdpt else m.gain(scene, i, "bdpt", "mse").decibels()))
    s = m.scenes[scene]
    print(f"| all black | - | - | {number(s.black_relmse, '%.3g')} | {number(s.black_psnr, '%.2f')} | "
          f"{number(s.black_mape, '%.3g')} | 0 | - | - | - | - |")


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
    goal = "-" if s.wanted == "-" else f"at most {s.wanted} ({s.wanted_moonshot}), every seed"
    for i in m.integrators:
        relmse = m.field("relmse", scene, i)
        if not len(relmse):
            continue
        met = "-" if s.wanted == "-" or not with_portals(i) else "met" if relmse.max() <= float(s.wanted) else "missed"
        seeds = ", ".join("%.3g" % x for x in relmse)
        print(f"| {i} | {seeds} | {m.average('cpu_seconds', scene, i):.1f} | {goal} | {met} |")


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


def print_means(m, scene, integrator):
    relmse = m.field("relmse", scene, integrator)
    if len(relmse) and relmse.mean() > 0:
        low = relmse.min() if relmse.min() > 0 else relmse.mean()
        print("%.6g %.6g %.6g %.6g" % (m.average("cpu_seconds", scene, integrator), relmse.mean(), low, relmse.max()))


TABLES = {
    "gains": print_gains,
    "psnr": print_psnr,
    "scene": print_scene,
    "check": print_check,
    "busy": print_busy,
    "long": print_long,
    "paper": print_paper,
    "best": lambda m, scene: print(m.best(scene, portals=True) or ""),
    "means": print_means,
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
        sys.exit("usage: efficiency_tables.py TABLE SCENES CSV SECONDS [SCENE [INTEGRATOR]]")
    main(*sys.argv[1:])
