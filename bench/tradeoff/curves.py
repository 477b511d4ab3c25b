"""From rows of measure.py to what a page says: means over seeds, geometric means over scenes, intervals; no words, no
files.

A portal's worth is told as time. R: CPU seconds that a picture takes through the true aperture. Through another portal the
same error takes R cost / cost_true, cost = relMSE x CPU s of pictures of one length, and the four stages come on top:

  total(v, R) = chain(v) + R cost(v) / cost_true

A setting is worth its time at R where no other has a smaller total."""
import csv
import math
from dataclasses import dataclass

import numpy as np

import intervals

SEED = 20240229
RENDERS = (10, 100, 1000)  # R [CPU s]


def read(path):
    """Rows as dictionaries; numbers as such."""
    def value(text):
        try:
            return float(text)
        except ValueError:
            return text
    with open(path, newline="", encoding="utf-8") as file:
        return [{k: v if k in ("knob", "value", "scene", "kind", "verdict") else value(v) for k, v in row.items()}
                for row in csv.DictReader(file)]


@dataclass
class Estimate:
    """A mean and the ends of its 95 % interval."""

    value: float
    low: float
    high: float


def ratio(above, below):
    """Of means of two samples, by bootstrap."""
    above, below = np.asarray(above, float), np.asarray(below, float)
    value = above.mean() / below.mean()
    if min(len(above), len(below)) < 2:
        return Estimate(value, math.nan, math.nan)
    return Estimate(value, *intervals.ratio_interval(above, below, np.random.default_rng(SEED)))


def geometric(pairs):
    """Mean of the ratios of pairs of samples (above, below)."""
    pairs = [tuple(np.asarray(v, float) for v in pair) for pair in pairs]
    if any(v.mean() <= 0 for pair in pairs for v in pair):
        return Estimate(math.nan, math.nan, math.nan)
    value = math.exp(np.mean([math.log(a.mean() / b.mean()) for a, b in pairs]))
    if min(len(v) for pair in pairs for v in pair) < 2:
        return Estimate(value, math.nan, math.nan)
    return Estimate(value, *intervals.geometric_interval(pairs, np.random.default_rng(SEED)))


def wilson(hits, of):
    """Share of hits with its 95 % interval (Wilson's, which holds for few and for all)."""
    if not of:
        return Estimate(math.nan, math.nan, math.nan)
    z = 1.96
    p, below = hits / of, 1 + z * z / of
    middle, half = (p + z * z / (2 * of)) / below, z * math.sqrt(p * (1 - p) / of + z * z / (4 * of * of)) / below
    return Estimate(p, max(0.0, middle - half), min(1.0, middle + half))


def cost(rows):
    return [r["relmse"] * r["cpu"] for r in rows]


def by(rows, *names):
    groups = {}
    for row in rows:
        groups.setdefault(tuple(row[n] for n in names), []).append(row)
    return groups


class PortalCurves:
    """Of the four stages: rows of portals.csv, and of rooms.csv for the scores."""

    def __init__(self, rows, rooms):
        self.by = by(rows, "knob", "value", "scene")
        self.rooms = by(rooms, "knob", "value")
        self.scenes = list(dict.fromkeys(r["scene"] for r in rows))

    def rows(self, setting, scene):
        return self.by.get((*setting, scene), [])

    def loss(self, setting, scenes=None):
        """Cost of pictures through its portals over that through the true ones: 1 is as good as can be."""
        return geometric([(cost(self.rows(setting, s)), cost(self.rows(("true", ""), s))) for s in scenes or self.scenes])

    def chain(self, setting, scene=None):
        """CPU seconds of the four stages, mean over scenes."""
        scenes = [scene] if scene else self.scenes
        return float(np.mean([np.mean([r["chain_cpu"] for r in self.rows(setting, s)]) for s in scenes]))

    def total(self, setting, render):
        """Geometric mean over the scenes of total(v, R)."""
        def of(scene):
            loss = np.mean(cost(self.rows(setting, scene))) / np.mean(cost(self.rows(("true", ""), scene)))
            return self.chain(setting, scene) + render * loss
        return math.exp(np.mean([math.log(of(s)) for s in self.scenes]))

    def found(self, setting):
        """Share of the runs that found as many portals as there are, where that is known."""
        rows = [(r, t) for s in self.scenes for r in self.rows(setting, s) for t in self.rows(("true", ""), s)[:1]
                if t["portals"] != ""]
        return wilson(sum(r["portals"] == t["portals"] for r, t in rows), len(rows))

    def right(self, setting):
        """Share of the rooms whose portals are right."""
        rows = self.rooms.get(setting, [])
        return wilson(sum(r["verdict"] == "ok" for r in rows), len(rows))

    def changed(self, setting, other=("default", "")):
        """(kinds of the rooms that are wrong by it and right by the other, kinds of those the other way round)"""
        here, there = ({(r["kind"], r["seed"]): r["verdict"] == "ok" for r in self.rooms.get(s, [])} for s in (setting, other))
        both = [room for room in here if room in there]
        return ([kind for kind, seed in both if there[kind, seed] and not here[kind, seed]],
                [kind for kind, seed in both if here[kind, seed] and not there[kind, seed]])

    def room_median(self, setting, field):
        rows = self.rooms.get(setting, [])
        return float(np.median([r[field] for r in rows])) if rows else math.nan

    def room_cpu(self, setting):
        rows = self.rooms.get(setting, [])
        return float(np.mean([r["cpu"] for r in rows])) if rows else math.nan


class PictureCurves:
    """Of the renderer: rows of pictures.csv."""

    def __init__(self, rows):
        self.by = by(rows, "knob", "value", "scene")
        self.all = rows

    def scenes(self, knob):
        return list(dict.fromkeys(r["scene"] for r in self.all if r["knob"] == knob))

    def points(self, scene, integrator, error="relmse"):
        """[(CPU s, error, low, high)] by length."""
        found = []
        for _, rows in sorted(by(self.by.get(("integrator", integrator, scene), []), "spp").items()):
            values = np.array([r[error] for r in rows])
            mean = values.mean()
            half = intervals.t_quantile(0.025, len(values) - 1) * values.std(ddof=1) / math.sqrt(len(values)) \
                if len(values) > 1 else math.nan
            found.append((np.mean([r["cpu"] for r in rows]), mean, max(mean - half, 0.05 * mean), mean + half))
        return found

    def relative(self, knob, value, default, scenes=None):
        """Cost over that of the default."""
        scenes = scenes or self.scenes(knob)
        return geometric([(cost(self.by[knob, value, s]), cost(self.by[knob, default, s])) for s in scenes])

    def mean(self, knob, value, scene, field):
        return float(np.mean([r[field] for r in self.by[knob, value, scene]]))

    def longest(self, scene, integrator):
        """Rows of the longest pictures."""
        rows = self.by.get(("integrator", integrator, scene), [])
        most = max((r["spp"] for r in rows), default=0)
        return [r for r in rows if r["spp"] == most]

    def pays_from(self, scene, chain, without="bdpt", through="auto"):
        """CPU seconds of a picture without portals from which on finding them pays: chain / (1 - cost through / cost
        without). None: never."""
        a, b = cost(self.longest(scene, through)), cost(self.longest(scene, without))
        if not a or not b:
            return None
        gain = np.mean(b) / np.mean(a)
        return chain / (1 - 1 / gain) if gain > 1 else None


def best(options, total):
    """The one of the least total; of equals, the first."""
    return min(options, key=total)
