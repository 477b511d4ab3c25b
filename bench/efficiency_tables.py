"""The tables of doc/efficiency.md.

cost = error x CPU seconds, error = relMSE or MSE; gain of a over b = mean cost of b / mean cost of a. Intervals of
gains: stats.py. A firefly that no seed met is in no interval.

NAME-before is integrator NAME of the older program that gains are told over."""
import copy
import functools
import math
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
    def __init__(self, scenes, rows, seconds):
        """scenes: of Scene; rows: dictionaries, one a picture, with the columns of the CSV; seconds: nominal CPU
        seconds of the pictures that tables are about."""
        self.scenes, self.seconds = {s.name: s for s in scenes}, seconds
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
        """Of all seeds; nan where it is not known."""
        rows = [r for r in self.rows.get((scene, integrator), []) if r["seconds"] == self.seconds]
        return np.array([math.nan if r[name] is None else r[name] for r in rows], float)

    def count(self, scene, integrator):
        return len(self.field("seed", scene, integrator))

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
        means = {i: self.costs(scene, i).mean() for i in integrators if self.count(scene, i)}
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
        if wanted is None or not judged:
            return "-"
        return f"{judged}: {verdict(self.over_base(scene, judged, error), wanted)}"

    def efficiency(self, scene, integrator):
        """1 / (relMSE x CPU s), as text."""
        costs = self.costs(scene, integrator)
        return "%.3g" % (1 / costs.mean()) if len(costs) and costs.mean() > 0 else "-"

    def geometric_mean(self, scenes, integrator):
        """Of the gains over the base; unknown where one of them is."""
        gains = [self.over_base(s, integrator).value for s in scenes]
        if not gains or not np.isfinite(gains).all():
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
        """The least relMSE that an aim asks of a picture of the scene, without an aim the base's. None where it is not
        known."""
        s, base, judged = self.scenes[scene], self.base(scene), self.judged(scene)
        if not base or not judged:
            return None
        target = INTERIORS_AIM if s.kind == "interior" else s.target or 1
        relmse = self.costs(scene, base).mean() / target / self.average("cpu_seconds", scene, judged)
        return min((x for x in (relmse, s.wanted or 0) if x > 0), default=None)

    def all_means(self, scene, integrator):
        """Of the pictures of all lengths: how many, their samples, their mean, variance of one of one sample."""
        rows = self.rows.get((scene, integrator), [])
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

    def psnr(self, scene, integrator):
        """Of the mean MSE."""
        mse, psnr = self.field("mse", scene, integrator), self.field("psnr", scene, integrator)
        known = ~np.isnan(psnr)
        if not known.any() or mse.mean() <= 0:
            return "-"
        peak = (mse * 10 ** (psnr / 10))[known][0]
        return "%.2f" % (10 * math.log10(peak / mse.mean()))


def overview(m, group, cells, heads):
    """(scenes, integrators that are shown, heads, rows): a row for each scene of the group that was measured, with
    cells(scene, integrators). bdpt, where it is what all gains are over, has no column."""
    scenes = [s for s in m.of_group(group) if m.base(s)]
    bases = {m.base(s) for s in scenes}
    shown = [i for i in m.integrators if any(m.count(s, i) for s in scenes) and (group == "rooms" or {i} != bases)]
    return scenes, shown, ["scene", *shown, *heads], [[s, *cells(s, shown)] for s in scenes]


def gains(m, group):
    """Of bdpt also what it is itself: no gain comes of a bdpt made worse. Empty where there is no scene."""
    itself = [i for i in ("bdpt" + BEFORE, "bdpt") if any(m.count(s, i) for s in m.of_group(group))]

    def cells(scene, shown):
        s = m.scenes[scene]
        return [*(m.told(scene, i) for i in shown), aim(s.target, s.moonshot), m.says(scene, s.target),
                *(m.efficiency(scene, i) for i in itself)]

    heads = ("aim (moonshot)", "met", *(f"efficiency of {i} [1/s]" for i in itself))
    scenes, shown, heads, rows = overview(m, group, cells, heads)
    interiors = [s for s in scenes if m.scenes[s].kind == "interior"]
    if interiors:
        means = {i: m.geometric_mean(interiors, i) for i in shown}
        judged = m.judged(interiors[0])
        says = f"{judged}: {verdict(means[judged], INTERIORS_AIM)}" if judged else "-"
        more = ["-"] * len(itself)
        rows.append([f"**geometric mean of {len(interiors)} interiors**",
                     *(means[i].text(digits, "?") for i in shown), INTERIORS_AIM, says, *more])
        rows.append(["**the least of them**", *(least(m, interiors, i) for i in shown), "-", "-", *more])
    return table(heads, rows) if rows else ""


def least(m, scenes, integrator):
    """The least gain; "-" where one is not known."""
    found = {s: m.over_base(s, integrator).value for s in scenes}
    scene = min(found, key=found.get)
    return f"{digits(found[scene])} ({scene})" if np.isfinite(list(found.values())).all() else "-"


def psnr(m, group):
    def cells(scene, shown):
        wanted = m.scenes[scene].wanted_psnr
        return [*(m.told(scene, i, "mse") for i in shown), aim(wanted),
                m.says(scene, None if wanted is None else 10 ** (wanted / 10), "mse")]

    *_, heads, rows = overview(m, group, cells, ("at least", "met"))
    return table(heads, rows) if rows else ""


def scene_rows(m, scene):
    rows = []
    for i in (i for i in m.integrators if m.count(scene, i)):
        relmse, average = m.field("relmse", scene, i), functools.partial(m.average, scene=scene, integrator=i)
        rows.append([i, three(average("spp")), "%.2f" % average("cpu_seconds"),
                     "%.0f" % m.field("peak_mib", scene, i).max(),
                     "%.3g [%.3g, %.3g]" % (relmse.mean(), relmse.min(), relmse.max()), m.efficiency(scene, i),
                     m.told(scene, i), m.psnr(scene, i), m.told(scene, i, "mse"), three(average("mape")),
                     "%.4f +- %.4f" % m.mean_ratio(scene, i)])
    black = m.scenes[scene].reference["black"]
    rows.append(["all black", "-", "-", "-", three(black["relmse"]), "-", "-", "%.2f" % black["psnr"], "-",
                 three(black["mape"]), 0])
    return table(("integrator", "spp", "CPU s", "MiB", "relMSE [seeds]", "efficiency [1/s]", "gain", "PSNR [dB]",
                  f"PSNR - that of {m.base(scene)}", "MAPE [%]", "mean / reference"), rows)


def too_noisy(m, scene):
    aimed = m.aimed_relmse(scene)
    return aimed is not None and m.scenes[scene].reference["relmse"] > OF_THE_AIM * aimed


def reference_words(m, scene):
    aimed, words = m.aimed_relmse(scene), "relMSE %.3g" % m.scenes[scene].reference["relmse"]
    if aimed is not None:
        most = "MORE THAN" if too_noisy(m, scene) else "at most"
        words += ", %s a tenth of the %.3g that it judges" % (most, aimed)
    return words + "."


def noisy(m):
    names = [s for s in m.scenes if too_noisy(m, s)]
    return "References with more than a tenth of the relMSE that they judge: %s." % ", ".join(names) if names else ""


def check(m, scene):
    ratio, error = m.mean_ratio(scene, "bdpt")
    if ratio == 0 or error == 0 or m.all_means(scene, "bdpt")[0] < 4:
        return "No check: bdpt was not rendered often enough."
    off = (ratio - 1) / error
    words = "they agree" if abs(off) < 3 else "THEY DISAGREE"
    return (f"Check: the mean of all of bdpt's pictures is {ratio:.4f} +- {error:.4f} of the reference's, {off:+.1f} "
            f"standard errors: {words}.")


def long_rows(m, scene):
    """A row for each integrator with the relMSE of every seed."""
    s, rows = m.scenes[scene], []
    for i in (i for i in m.integrators if m.count(scene, i)):
        relmse = m.field("relmse", scene, i)
        asked = s.wanted is not None and with_portals(i)
        goal = f"at most {aim(s.wanted, s.wanted_moonshot)}, every seed" if asked else "-"
        met = "-" if not asked else "met" if relmse.max() <= s.wanted else "missed"
        rows.append([i, ", ".join(map(three, relmse)), "%.1f" % m.average("cpu_seconds", scene, i), goal, met])
    return rows


def busy(m):
    got = np.concatenate([m.field("cpu_seconds", s, i) for s in m.scenes for i in m.integrators])
    if not len(got) or got.mean() >= 0.85 * m.seconds:
        return ""
    return "The machine was busy: on average a picture got %.3g of its %g CPU seconds." % (got.mean(), m.seconds)


def paper(m, scene):
    """Two cells: PSNR and MAPE of tdpt against bdpt's."""
    gain = m.gain(scene, "tdpt", "bdpt", "mse").value
    if not math.isfinite(gain):
        return ["-", "-"]
    return [f"{decibels(gain)} dB",
            "%.3g %% against %.3g %%" % tuple(m.average("mape", scene, i) for i in ("tdpt", "bdpt"))]


def points(m):
    """{(scene, integrator): [(CPU seconds, relMSE, its lowest, its highest)]} of all pictures that are no longer."""
    found = {}
    for seconds in sorted({r["seconds"] for rows in m.rows.values() for r in rows if r["seconds"] <= m.seconds}):
        at = m.at(seconds)
        for scene, i in m.rows:
            relmse = at.field("relmse", scene, i)
            if len(relmse) and relmse.mean() > 0:
                low = relmse.min() if relmse.min() > 0 else relmse.mean()
                found.setdefault((scene, i), []).append((at.average("cpu_seconds", scene, i), relmse.mean(), low,
                                                         relmse.max()))
    return found
