"""The tables of doc/efficiency.md.

cost = error x CPU seconds, error = relMSE or MSE; gain of a over b = mean cost of b / mean cost of a. Intervals of
gains: stats.py. A firefly that no seed met is in no interval.

NAME-before is integrator NAME of the older program that gains are told over."""
import copy
import math
from collections import defaultdict
from dataclasses import dataclass, field

import numpy as np

import stats
from pages import table, three

BEFORE = "-before"
# Kinds of scenes in each table of gains.
GROUPS = {"doors": ("door",), "rooms": ("interior", "open"), "whole": ("whole",)}
INTERIORS_AIM = 2.5  # of the geometric mean of interiors' gains
OF_THE_AIM = 0.1  # the most that a reference's relMSE may be of the one it judges


@dataclass
class Scene:
    """kind: door, interior, open (no door), whole (no limit of depth). target: of the gain; wanted: relMSE after a
    minute; wanted_psnr: PSNR over the base's in the same time [dB]; None: no aim. reference: what is known of it (mean,
    half: difference of its halves' means / 2, relmse, black, integrator, spp)."""

    name: str
    width: int
    height: int
    kind: str
    target: float = None
    moonshot: float = None
    wanted: float = None
    wanted_moonshot: float = None
    wanted_psnr: float = None
    reference: dict = field(default_factory=dict)


def digits(x):
    formats = ((0.095, "%.2g"), (0.995, "%.2f"), (9.95, "%.1f"), (999.5, "%.0f"))
    return next((f for limit, f in formats if x < limit), "%.2g") % x


def decibels(x):
    return "%+.1f" % (10 * math.log10(x))


def verdict(gain, wanted):
    if not math.isfinite(gain.value):
        return "-"
    met = gain.value >= wanted
    doubtful = gain.low < wanted if met else gain.high >= wanted
    return ("met" if met else "missed") + (", but within the noise" if doubtful else "")


def aim(wanted, moonshot=None):
    return "-" if wanted is None else f"{wanted:g}" + ("" if moonshot is None else f" ({moonshot:g})")


def with_portals(integrator):
    return integrator.startswith(("tdpt", "auto"))


class Measurements:
    """Of scenes: Scene; rows: dictionaries, one a picture, with the columns of the CSV. seconds: nominal CPU seconds of
    the pictures that tables are about."""

    def __init__(self, scenes, rows, seconds):
        self.scenes, self.seconds, self.rows = {s.name: s for s in scenes}, seconds, defaultdict(list)
        self.integrators = list(dict.fromkeys(row["integrator"] for row in rows))
        for row in rows:
            self.rows[row["scene"], row["integrator"]].append(row)

    def at(self, seconds):
        """The same, of pictures of another length."""
        other = copy.copy(self)
        other.seconds = seconds
        return other

    def field(self, name, scene, integrator):
        """Of all seeds; nan where it is not known."""
        rows = [r for r in self.rows.get((scene, integrator), []) if r["seconds"] == self.seconds]
        return np.array([math.nan if r[name] is None else r[name] for r in rows], float)

    def measured(self, scene, integrators=None):
        return [i for i in integrators or self.integrators if len(self.field("seed", scene, i))]

    def average(self, name, scene, integrator):
        values = self.field(name, scene, integrator)
        return values.mean() if len(values) else 0.0

    def costs(self, scene, integrator, error="relmse"):
        return self.field(error, scene, integrator) * self.field("cpu_seconds", scene, integrator)

    def gain(self, scene, a, b, error="relmse"):
        gain = stats.ratio(self.costs(scene, b, error), self.costs(scene, a, error))
        return stats.Ratio(gain.value) if a == b else gain

    def cheapest(self, scene, integrators):
        """By relMSE. None where none is known."""
        means = {i: self.costs(scene, i).mean() for i in self.measured(scene, integrators)}
        return min((i for i in means if means[i] > 0), key=means.get, default=None)

    def base(self, scene):
        """What gains are over, or None: bdpt, without a door the better of bdpt and nee; of the older one if any."""
        names = ("bdpt", "nee") if self.scenes[scene].kind in GROUPS["rooms"] else ("bdpt",)
        there = self.measured(scene, [n + BEFORE for n in names]) or self.measured(scene, names)
        return self.cheapest(scene, there) or next(iter(there), None) if there else None

    def judged(self, scene):
        """What aims are asked of: auto, or the best with portals where auto was not measured."""
        there = [i for i in self.measured(scene) if with_portals(i)]
        return "auto" if "auto" in there else self.cheapest(scene, there) if there else None

    def pair(self, scene):
        return list(dict.fromkeys(i for i in (self.judged(scene), self.base(scene)) if i))

    def over_base(self, scene, integrator, error="relmse"):
        base = self.base(scene)
        return self.gain(scene, integrator, base, error) if base and integrator else stats.Ratio()

    def told(self, scene, integrator, error="relmse"):
        """The same as text; of MSE in decibels."""
        gain, itself = self.over_base(scene, integrator, error), integrator == self.base(scene)
        if error == "mse":
            return "0" if itself else gain.bounded().text(decibels)
        return "1" if itself else gain.text(digits, "?")

    def says(self, scene, wanted, error="relmse"):
        """Whether what aims are asked of has such a gain."""
        judged = self.judged(scene)
        asked = wanted is not None and judged
        return f"{judged}: {verdict(self.over_base(scene, judged, error), wanted)}" if asked else "-"

    def efficiency(self, scene, integrator):
        """1 / (relMSE x CPU s), as text."""
        costs = self.costs(scene, integrator)
        return "%.3g" % (1 / costs.mean()) if len(costs) and costs.mean() > 0 else "-"

    def geometric_mean(self, scenes, integrator):
        """Of the gains over the base; unknown where one of them is."""
        gains = [self.over_base(s, integrator).value for s in scenes]
        if not np.isfinite(gains).all():
            return stats.Ratio()
        value = math.exp(np.mean(np.log(gains)))
        others = [s for s in scenes if self.base(s) != integrator]  # a gain of 1 over itself has no interval
        if not others:
            return stats.Ratio(value)
        mean = stats.geometric([(self.costs(s, self.base(s)), self.costs(s, integrator)) for s in others])
        exponent = len(others) / len(scenes)
        high = mean.high if mean.high >= stats.NO_BOUND else mean.high**exponent
        return stats.Ratio(value, mean.low**exponent, high)

    def aimed_relmse(self, scene):
        """The least relMSE that an aim asks of a picture of the scene, without an aim the base's; None: not known."""
        s, base, judged = self.scenes[scene], self.base(scene), self.judged(scene)
        if not base or not judged:
            return None
        target = INTERIORS_AIM if s.kind == "interior" else s.target or 1
        relmse = self.costs(scene, base).mean() / target / self.average("cpu_seconds", scene, judged)
        return min((x for x in (relmse, s.wanted or 0) if x > 0), default=None)

    def all_means(self, scene, integrator):
        """Of the pictures of all lengths: how many, their samples, their mean, variance of one of one sample."""
        rows = self.rows.get((scene, integrator))
        if not rows:
            return 0, 0.0, 0.0, 0.0
        weights = np.array([r["spp"] for r in rows], float)
        return len(rows), weights.sum(), *stats.weighted_mean(np.array([r["mean"] for r in rows]), weights)

    def mean_ratio(self, scene, integrator):
        """Mean over the reference's and its standard error, (0, 0) where unknown. The reference's noise is known from
        other pictures of its integrator, or, from none, roughly from its halves."""
        reference = self.scenes[scene].reference
        runs, weight, mean, variance = self.all_means(scene, integrator)
        if reference["mean"] <= 0 or not runs:
            return 0.0, 0.0
        others, _, _, noise = self.all_means(scene, reference["integrator"])
        noise = noise / reference["spp"] if others > 2 else reference["half"] ** 2
        return mean / reference["mean"], math.sqrt(variance / weight + noise) / reference["mean"]

    # ---- Tables; empty where there is no scene ----
    def of_group(self, group):
        return [name for name, s in self.scenes.items() if s.kind in GROUPS[group] and self.base(name)]

    def shown(self, group):
        """Integrators. bdpt, where it is what all gains are over, has no column."""
        scenes = self.of_group(group)
        bases, there = {self.base(s) for s in scenes}, {i for s in scenes for i in self.measured(s)}
        return [i for i in self.integrators if i in there and (group == "rooms" or {i} != bases)]

    def gains(self, group):
        """Of bdpt also what it is itself: no gain comes of a bdpt made worse."""
        scenes, shown = self.of_group(group), self.shown(group)
        itself = [i for i in ("bdpt" + BEFORE, "bdpt") if any(self.measured(s, [i]) for s in scenes)]
        rows = [[name, *(self.told(name, i) for i in shown), aim(s.target, s.moonshot), self.says(name, s.target),
                 *(self.efficiency(name, i) for i in itself)] for name, s in self.scenes.items() if name in scenes]
        interiors = [s for s in scenes if self.scenes[s].kind == "interior"]
        if interiors:
            means = {i: self.geometric_mean(interiors, i) for i in shown}
            judged, more = self.judged(interiors[0]), ["-"] * len(itself)
            says = f"{judged}: {verdict(means[judged], INTERIORS_AIM)}" if judged else "-"
            rows.append([f"**geometric mean of {len(interiors)} interiors**",
                         *(means[i].text(digits, "?") for i in shown), INTERIORS_AIM, says, *more])
            rows.append(["**the least of them**", *(self.least(interiors, i) for i in shown), "-", "-", *more])
        heads = ("target (ambitious)", "met", *(f"efficiency of {i} [1/s]" for i in itself))
        return table(("scene", *shown, *heads), rows) if rows else ""

    def least(self, scenes, integrator):
        """The least gain; "-" where one is not known."""
        found = {s: self.over_base(s, integrator).value for s in scenes}
        scene = min(found, key=found.get)
        return f"{digits(found[scene])} ({scene})" if np.isfinite(list(found.values())).all() else "-"

    def psnrs(self, group):
        rows, shown = [], self.shown(group)
        for scene in self.of_group(group):
            wanted = self.scenes[scene].wanted_psnr
            rows.append([scene, *(self.told(scene, i, "mse") for i in shown), aim(wanted),
                         self.says(scene, None if wanted is None else 10 ** (wanted / 10), "mse")])
        return table(("scene", *shown, "at least", "met"), rows) if rows else ""

    def too_noisy(self, scene):
        aimed = self.aimed_relmse(scene)
        return aimed is not None and self.scenes[scene].reference["relmse"] > OF_THE_AIM * aimed

    def noisy(self):
        names = ", ".join(filter(self.too_noisy, self.scenes))
        words = "References too noisy for their scene, over a tenth of the relMSE that they judge"
        return f"{words}: {names}." if names else ""

    def agreement(self):
        """Whether the mean of all of bdpt's pictures is the reference's."""
        scenes = [scene for scene in self.scenes if self.all_means(scene, "bdpt")[0] >= 4]
        ratios = {scene: self.mean_ratio(scene, "bdpt") for scene in scenes}
        off = {scene: (ratio - 1) / error for scene, (ratio, error) in ratios.items() if ratio and error}
        if not off:
            return ""
        most = max(off, key=lambda scene: abs(off[scene]))
        wrong = ", ".join(scene for scene in off if abs(off[scene]) >= 3)
        return (f"The mean of bdpt's pictures agrees with the reference's in "
                f"{sum(abs(o) < 3 for o in off.values())} of {len(off)} scenes; the largest difference is "
                f"{off[most]:+.1f} standard errors, in {most}."
                + f" **They disagree in {wrong}.**" * bool(wrong))

    def long_rows(self, scene):
        """A row for each integrator with the relMSE of every seed."""
        s, rows = self.scenes[scene], []
        for i in self.measured(scene):
            relmse, words = self.field("relmse", scene, i), ["-", "-"]
            if s.wanted is not None and with_portals(i):
                words = [f"at most {aim(s.wanted, s.wanted_moonshot)}, every seed",
                         "met" if relmse.max() <= s.wanted else "missed"]
            rows.append([i, ", ".join(map(three, relmse)), "%.1f" % self.average("cpu_seconds", scene, i), *words])
        return rows

    def busy(self):
        got = np.concatenate([self.field("cpu_seconds", s, i) for s in self.scenes for i in self.integrators])
        if not len(got) or got.mean() >= 0.85 * self.seconds:
            return ""
        return "The machine was busy: on average a picture got %.3g of its %g CPU seconds." % (got.mean(), self.seconds)

    def points(self):
        """{(scene, integrator): [(CPU seconds, relMSE, its lowest, its highest)]} of pictures up to that length."""
        found = defaultdict(list)
        all_seconds = {r["seconds"] for rows in self.rows.values() for r in rows}
        for at in (self.at(seconds) for seconds in sorted(all_seconds) if seconds <= self.seconds):
            for key in self.rows:
                relmse = at.field("relmse", *key)
                if len(relmse) and relmse.mean() > 0:
                    low = relmse.min() if relmse.min() > 0 else relmse.mean()
                    found[key].append((at.average("cpu_seconds", *key), relmse.mean(), low, relmse.max()))
        return found
