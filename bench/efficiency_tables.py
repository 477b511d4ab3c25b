"""The tables of doc/efficiency.md.

cost = relMSE x CPU seconds; gain of a over b = mean cost of b / mean cost of a. Intervals of
gains: stats.py. A firefly that no seed met is in no interval.

NAME-before is integrator NAME of the older program that gains are told over."""
import math
from collections import defaultdict
from dataclasses import dataclass, field

import numpy as np

import stats
from pages import table

BEFORE = "-before"
# Kinds of scenes in each table of gains.
GROUPS = {"doors": ("door",), "rooms": ("interior", "open"), "whole": ("whole",)}
INTERIORS_AIM = 2.5  # of the geometric mean of interiors' gains
OF_THE_JUDGED = 0.1  # the most that a reference's relMSE may be of the least mean relMSE that it judges


@dataclass
class Scene:
    """kind: door, interior, open (no door), whole (no limit of depth). target: of the gain, moonshot: the ambitious one;
    None: no aim. reference: what is known of it (means of its halves, relmse, black)."""

    name: str
    width: int
    height: int
    kind: str
    target: float = None
    moonshot: float = None
    reference: dict = field(default_factory=dict)


def digits(x):
    formats = ((0.095, "%.2g"), (0.995, "%.2f"), (9.95, "%.1f"), (999.5, "%.0f"))
    return next((f for limit, f in formats if x < limit), "%.2g") % x


def verdict(gain, wanted):
    if not math.isfinite(gain.value):
        return "-"
    met = gain.value >= wanted
    doubtful = gain.low < wanted if met else gain.high >= wanted
    return ("met" if met else "missed") + (", but within the noise" if doubtful else "")


def aim(wanted, moonshot=None):
    return "-" if wanted is None else f"{wanted:g}" + ("" if moonshot is None else f" ({moonshot:g})")


class Measurements:
    """Of scenes: Scene; rows: dictionaries, one a picture, with the columns of the CSV. seconds: nominal CPU seconds of
    the pictures that tables are about."""

    def __init__(self, scenes, rows, seconds):
        self.scenes, self.seconds, self.rows = {s.name: s for s in scenes}, seconds, defaultdict(list)
        self.integrators = list(dict.fromkeys(row["integrator"] for row in rows))
        for row in rows:
            self.rows[row["scene"], row["integrator"]].append(row)

    def field(self, name, scene, integrator, seconds=None):
        """Of all seeds; nan where it is not known."""
        rows = [r for r in self.rows.get((scene, integrator), []) if r["seconds"] == (seconds or self.seconds)]
        return np.array([math.nan if r[name] is None else r[name] for r in rows], float)

    def measured(self, scene, integrators=None):
        return [i for i in integrators or self.integrators if len(self.field("seed", scene, i))]

    def costs(self, scene, integrator):
        return self.field("relmse", scene, integrator) * self.field("cpu_seconds", scene, integrator)

    def cheapest(self, scene, integrators):
        """By relMSE; the first where none is known. None of none."""
        there = self.measured(scene, integrators)
        means = {i: self.costs(scene, i).mean() for i in there}
        return min((i for i in there if means[i] > 0), key=means.get, default=next(iter(there), None))

    def base(self, scene):
        """What gains are over, or None: bdpt, without a door the better of bdpt and nee; of the older one if any."""
        names = ("bdpt", "nee") if self.scenes[scene].kind in GROUPS["rooms"] else ("bdpt",)
        return self.cheapest(scene, [n + BEFORE for n in names]) or self.cheapest(scene, names)

    def judged(self, scene):
        """What aims are asked of: auto, or the best with portals where auto was not measured."""
        there = [i for i in self.measured(scene) if i.startswith(("tdpt", "auto"))]
        return "auto" if "auto" in there else self.cheapest(scene, there) if there else None

    def over_base(self, scene, integrator):
        base = self.base(scene)
        if not base or not integrator:
            return stats.Ratio()
        gain = stats.ratio(self.costs(scene, base), self.costs(scene, integrator))
        return stats.Ratio(gain.value) if base == integrator else gain

    def told(self, scene, integrator):
        """The same as text."""
        return "1" if integrator == self.base(scene) else self.over_base(scene, integrator).text(digits, "?")

    # ---- Tables; empty where there is no scene ----
    def of_group(self, group):
        return [name for name, s in self.scenes.items() if s.kind in GROUPS[group] and self.base(name)]

    def shown(self, group):
        """Integrators. bdpt, where it is what all gains are over, has no column."""
        scenes = self.of_group(group)
        bases, there = {self.base(s) for s in scenes}, {i for s in scenes for i in self.measured(s)}
        return [i for i in self.integrators if i in there and (group == "rooms" or {i} != bases)]

    def gains(self, group):
        """Of bdpt also its efficiency: no gain comes of a bdpt made worse."""
        scenes, shown, rows = self.of_group(group), self.shown(group), []
        for name in scenes:
            s, judged, bdpt = self.scenes[name], self.judged(name), self.costs(name, "bdpt")
            asked = s.target is not None and judged
            rows.append([name, *(self.told(name, i) for i in shown), aim(s.target, s.moonshot),
                         f"{judged}: {verdict(self.over_base(name, judged), s.target)}" if asked else "-",
                         "%.3g" % (1 / bdpt.mean()) if len(bdpt) and bdpt.mean() > 0 else "-"])
        interiors = [s for s in scenes if self.scenes[s].kind == "interior"]
        if interiors:
            gains = {i: [self.over_base(s, i).value for s in interiors] for i in shown}
            means = {i: stats.Ratio(math.exp(np.mean(np.log(of)))) if min(of) > 0 else stats.Ratio()
                     for i, of in gains.items()}
            judged = self.judged(interiors[0])
            rows.append([f"**geometric mean of {len(interiors)} interiors**", *(m.text(digits) for m in means.values()),
                         INTERIORS_AIM, f"{judged}: {verdict(means[judged], INTERIORS_AIM)}" if judged else "-", "-"])
        heads = ("scene", *shown, "target (ambitious)", "met", "efficiency of bdpt [1/s]")
        return table(heads, rows) if rows else ""

    def noisy(self):
        def too_noisy(scene):
            means = [m for m in (self.field("relmse", scene, i).mean() for i in self.measured(scene)) if m > 0]
            return means and self.scenes[scene].reference["relmse"] > OF_THE_JUDGED * min(means)

        names = ", ".join(filter(too_noisy, self.scenes))
        return f"References too noisy for their scene, over a tenth of the relMSE that they judge: {names}." if names else ""

    def in_errors(self, scene, integrator="bdpt"):
        """The mean of its pictures of all lengths less the reference's, in standard errors of both; nan where they are
        few. The reference's error is known from the difference of its halves."""
        rows, halves = self.rows.get((scene, integrator), ()), np.array(self.scenes[scene].reference["means"])
        if len(rows) < 4:
            return math.nan
        weights = np.array([r["spp"] for r in rows], float)
        mean, variance = stats.weighted_mean(np.array([r["mean"] for r in rows]), weights)
        return float(stats.in_errors((mean, math.sqrt(variance / weights.sum())), stats.mean_and_error(halves)))

    def agreement(self):
        """Whether the mean of bdpt's pictures is the reference's."""
        off = {scene: z for scene in self.scenes if math.isfinite(z := self.in_errors(scene))}
        if not off:
            return ""
        most = max(off, key=lambda scene: abs(off[scene]))
        wrong = ", ".join(scene for scene in off if abs(off[scene]) >= 3)
        return (f"The mean of bdpt's pictures agrees with the reference's in {sum(abs(o) < 3 for o in off.values())} of "
                f"{len(off)} scenes; the largest difference is {off[most]:+.1f} standard errors, in {most}."
                + f" **They disagree in {wrong}.**" * bool(wrong))

    def busy(self):
        got = np.concatenate([self.field("cpu_seconds", s, i) for s in self.scenes for i in self.integrators])
        if not len(got) or got.mean() >= 0.85 * self.seconds:
            return ""
        return "The machine was busy: on average a picture got %.3g of its %g CPU seconds." % (got.mean(), self.seconds)

    def points(self):
        """{(scene, integrator): [(CPU seconds, relMSE, its lowest, its highest)]} by length."""
        found = defaultdict(list)
        for seconds in sorted({r["seconds"] for rows in self.rows.values() for r in rows}):
            for key in self.rows:
                relmse = self.field("relmse", *key, seconds)
                if len(relmse) and relmse.mean() > 0:
                    low = relmse.min() if relmse.min() > 0 else relmse.mean()
                    found[key].append((self.field("cpu_seconds", *key, seconds).mean(), relmse.mean(), low, relmse.max()))
        return found
