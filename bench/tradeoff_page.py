"""doc/tradeoff.md, its plots and its tables: means over seeds, geometric means over scenes, intervals.

A portal's worth is told as time. R: CPU seconds that a picture takes through the true aperture. Through another portal
the same error takes R cost / cost_true, cost = relMSE x CPU s of pictures of one length; the four stages come on top:

  total(v, R) = chain(v) + R cost(v) / cost_true

A setting is worth its time at R where no other has a smaller total."""
import csv
import math
import shutil

import numpy as np

import pages
import stats
from common import STAGES, Setting, cores, settings
from pages import hundredths, table
from tradeoff import CHAIN, DEPTHS, INTEGRATORS, KNOBS, RENDERER, TABLES, Tradeoff, run_all, write_rows

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
        return stats.geometric(
            [(cost(self.rows(setting, s)),
              cost(self.rows(("true", ""),
                             s))) for s in scenes or self.scenes])

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
        return stats.wilson(sum(r["portals"] == t["portals"] for r, t in rows), len(rows))

    def right(self, setting):
        """Share of the rooms whose portals are right."""
        rows = self.rooms.get(setting, [])
        return stats.wilson(sum(r["verdict"] == "ok" for r in rows), len(rows))

    def changed(self, setting, other=("default", "")):
        """(kinds of the rooms that are wrong by it and right by the other, kinds of those the other way round)"""
        here, there = ({(r["kind"], r["seed"]): r["verdict"] == "ok" for r in self.rooms.get(s, [])}
                       for s in (setting, other))
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
            half = stats.t_quantile(0.025, len(values) - 1) * values.std(ddof=1) / math.sqrt(len(values)) \
                if len(values) > 1 else math.nan
            found.append((np.mean([r["cpu"] for r in rows]), mean, max(mean - half, 0.05 * mean), mean + half))
        return found

    def relative(self, knob, value, default, scenes=None):
        """Cost over that of the default."""
        scenes = scenes or self.scenes(knob)
        return stats.geometric([(cost(self.by[knob, value, s]), cost(self.by[knob, default, s])) for s in scenes])

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


# ---- Figures ----
LOG = {"x": "set logscale x", "y": "set logscale y", "xy": "set logscale xy"}


def settings_of(curves, knob):
    """((name, value) or the default, value) of what was measured of a knob, from cheap to dear."""
    found = []
    for value in knob.values:
        setting = ("default", "") if value == knob.default else (knob.name, value)
        if any(curves.rows(setting, s) for s in curves.scenes):
            found.append((setting, value))
    return found


FEW_RATIOS = "0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10"
TIMELESS = 1.05  # between the least and the most time of a knob's values
RATIOS = "0.2, 0.3, 0.5, 0.7, 1, 1.5, 2, 3, 5, 10, 20, 50, 100"


def labels(block):
    """Names at points, above and below by turns: neighbours may be near."""
    return ['%s every 2::%d using 1:2:5 with labels %s rotate by 40 offset %s font ",9" notitle' % (block, first,
                                                                                                    side, offset)
            for first, side, offset in ((0, "left", "0.3,0.7"), (1, "right", "-0.3,-0.7"))]


def stage_figure(curves, program):
    """For each knob two panels: what pictures through its portals cost, and the rooms that are right, against time over
    that of the default; of a knob that costs no time, against its values."""
    default = ("default", "")

    figure = pages.Figure(4)
    for knob in KNOBS:
        settings = settings_of(curves, knob) if knob.program == program else []
        if not settings:
            continue
        loss = {s: curves.loss(s) for s, _ in settings}
        places = {s: i for i, (s, _) in enumerate(settings)}
        seconds = [curves.chain(s) for s, _ in settings]
        timeless = max(seconds) < TIMELESS * min(seconds)

        def over(time, setting):
            return places[setting] if timeless else time(setting) / time(default)

        def chain(setting, scene=None):
            return over(lambda s: curves.chain(s, scene), setting)

        each = [[(chain(s, scene), curves.loss(s, [scene]).value) for s, _ in settings] for scene in curves.scenes]
        every = [point for points in each for point in points]
        times = [x for x, _ in every]
        wide = not timeless and max(times) > 6 * min(times)
        across = (
            f"set xtics ({FEW_RATIOS if wide else RATIOS}); set logscale x; set xrange " +pages.span(
                times, 0.8, 1.25)
            if not timeless else "set xtics (%s); set xrange [-0.5:%g]" %
            (", ".join('"%s" %d' % (pages.short(v),
                                   i) for i, (_, v) in enumerate(settings)),
             len(settings) -0.5))
        costs = [(chain(s), loss[s].value, loss[s].low, loss[s].high, '"%s"' % pages.short(v)) for s, v in settings]
        rooms = [(over(curves.room_cpu, s), *(100 * x for x in (e.value, e.low, e.high)), '"%s"' % pages.short(v))
                 for s, v in settings for e in (curves.right(s),)]
        here = [value for _, value in settings].index(knob.default)
        for words, y, points, lines, ranges in (
                ("pictures", "cost / through the true opening", costs, [pages.thin(figure.block(p)) for p in each],
                 (LOG["y"], f"set ytics ({RATIOS}); set yrange " + pages.span([y for _, y in every], 0.7, 3))),
                ("rooms", "rooms right [%]", rooms, [], ("set yrange [0:119]",))):
            block = figure.block(points)
            figure.panel(
                f"{knob.name}: {words}", knob.unit or "value"
                if timeless else "time of the four stages / at the default", y,
                [*lines, *pages.bars(block, 0, 2, not knob.words),
                 pages.ring(figure.block([points[here] [: 2]])),
                 *([] if timeless else labels(block))],
                (*ranges, across))
    return figure


def integrators_figure(curves):
    """Error against time, a panel a scene."""
    figure = pages.Figure(4)
    for scene in curves.scenes("integrator"):
        drawn = []
        for k, integrator in enumerate(INTEGRATORS):
            points = curves.points(scene, integrator)
            if points:
                drawn += pages.bars(figure.block(points), k, 1.5)
        figure.panel(scene, "CPU seconds", "relMSE", drawn, (LOG["xy"], 'set format y "10^{%T}"'))
    figure.key(['NaN with linespoints %s title "%s"' % (pages.style(k), i) for k, i in enumerate(INTEGRATORS)])
    return figure


def renderer_figure(curves):
    """Cost of each value of a knob over that of the default."""
    figure = pages.Figure(3)
    for knob in KNOBS:
        scenes = curves.scenes(knob.name)
        if knob.program != RENDERER or not scenes:
            continue
        values = [v for v in knob.values if (knob.name, v, scenes[0]) in curves.by]
        lines = []
        for scene in scenes:
            lines.append(pages.thin(figure.block([(i, curves.relative(knob.name, v, knob.default, [scene]).value)
                                                  for i, v in enumerate(values)])))
        every = [curves.relative(knob.name, v, knob.default, [s]).value for v in values for s in scenes]
        mean = [(i, e.value, e.low, e.high) for i, e in
                enumerate(curves.relative(knob.name, v, knob.default) for v in values)]
        ticks = "set xtics (%s)" % ", ".join('"%s" %d' % (v, i) for i, v in enumerate(values))
        marks = figure.block([mean[values.index(knob.default)][:2]])
        figure.panel(
            knob.name, knob.unit or "heuristic", "cost / at the default", lines +pages.bars(
                figure.block(mean),
                0, 2, not knob.words) +[pages.ring(marks)],
            (LOG["y"],
             ticks, "set xrange [-0.5:%g]" % (len(values) -0.5),
             f"set ytics ({RATIOS}); set yrange " +pages.span(every, 0.7, 2)))
    return figure


def chain_figure(pictures, portals):
    """Total time to an error, the four stages included: what was measured, and from the longest pictures on as 1 /
    time."""
    figure = pages.Figure(4)
    lines = (("bdpt", False, 0), ("tdpt-guided", True, 4), ("auto", True, 5))
    for scene in (s for s in portals.scenes if pictures.longest(s, "tdpt-guided")):
        drawn, every = [], []
        for integrator, through, k in lines:
            extra = portals.chain(("default", ""), scene) if through else 0
            points = [(t + extra, e, low, high) for t, e, low, high in pictures.points(scene, integrator)]
            if not points:
                continue
            seconds, error = points[-1][0] - extra, points[-1][1]
            ahead = [(seconds * 2**i + extra, error / 2**i) for i in range(13) if seconds * 2**i < 2000]
            drawn += pages.bars(figure.block(points), k, 1.5, False)
            drawn.append(
                f"{figure.block([p[:2] for p in points] + ahead)} using 1:2 with lines {pages.line(k)} notitle")
            every += [e for _, e, _, _ in points]
        figure.panel(
            scene, "CPU seconds from .glb to picture", "relMSE", drawn,
            (LOG["xy"],
             'set format y "10^{%T}"', "set xrange [0.03:2000]", "set yrange [1e-4:%g]" % (2 * max(every))))
    figure.key(['NaN with linespoints %s title "%s"' % (pages.style(k), i + (", portals found first" if p else ""))
                for i, p, k in lines])
    return figure


def simplified_figure(rows, portals):
    """Cost through portals that were found without the smallest triangles, against the share of the area that they
    make."""
    figure = pages.Figure(2, 500, 380)
    drawn, key = [], []
    for k, scene in enumerate(portals.scenes):
        points = []
        for share in sorted({r["share"] for r in rows}):
            loss = stats.ratio(cost([r for r in rows if r["scene"] == scene and r["share"] == share]),
                                   cost(portals.rows(("true", ""), scene)))
            points.append((100 * share, loss.value, loss.low, loss.high))
        drawn += pages.bars(figure.block(points), k, 1.5)
        key.append('NaN with linespoints %s title "%s"' % (pages.style(k), scene))
    figure.panel("Portals of simplified scenes",
                 "area of the triangles left out [%]", "cost / through the true opening", drawn, (LOG["xy"],))
    figure.key(key)
    return figure


# ---- Page ----
DEFAULT, TRUE = ("default", ""), ("true", "")


def interval(e, percent=False):
    if percent:
        return stats.Ratio(*(100 * x for x in (e.value, e.low, e.high))).text(lambda x: "%.0f" % x)
    return e.text(hundredths)


def bold_least(values):
    """As text, the least in bold, and those that are within half a per cent of it."""
    least = min(values)
    return [("**%s**" if v <= 1.005 * least else "%s") % hundredths(v) for v in values]


def changed_words(curve, setting):
    """The kinds of rooms that a setting loses (-) and wins (+)."""
    return ", ".join(f"{sign}{kinds.count(kind)} {kind}" for sign, kinds in zip("-+", curve.changed(setting))
                     for kind in dict.fromkeys(kinds))


def verdict(knob, settings, curve):
    """Where the default lies: its total over the least, at each length."""
    says = []
    for render in RENDERS:
        totals = {value: curve.total(setting, render) for setting, value in settings}
        best = min(totals, key=totals.get)
        if knob.default in totals:
            over = totals[knob.default] / totals[best]
            says.append(f"{render} s: " + ("the best" if best ==
                        knob.default else f"{hundredths(over)} of that of `{best}`"))
    return "Total time of the default, by R. " + "; ".join(says) + "."


def summary_section(portals, pictures):
    """Where each default lies: what is best at each R, and the default's total over that one's."""
    rows = []
    for knob in KNOBS:
        cells = [f"`{knob.name}`", knob.default]
        if knob.program == RENDERER:
            scenes = pictures.scenes(knob.name)
            if not scenes:
                continue
            each = {v: pictures.relative(knob.name, v, knob.default).value for v in knob.values
                    if (knob.name, v, scenes[0]) in pictures.by}
            value = min(each, key=each.get)
            rows.append([*cells, *["" if value == knob.default else f"`{value}`, {hundredths(1 / each[value])}"] * 3])
            continue
        settings = settings_of(portals, knob)
        if not settings:
            continue
        for render in RENDERS:
            totals = {v: portals.total(s, render) for s, v in settings}
            value = min(totals, key=totals.get)
            cells.append(
                "" if value ==knob.default else f"`{value}`, {hundredths(totals[knob.default] / totals[value])}")
        rows.append(cells)
    return table(("knob", "default", *(f"better at {r} s" for r in RENDERS)), rows)


def stage_section(program, curve):
    picture = picture_of(program)
    lines = [f"## {program}", "", f"![Cost and rooms against time for each knob of {program}]({picture})"]
    for knob in KNOBS:
        settings = settings_of(curve, knob) if knob.program == program else []
        if not settings:
            continue
        totals = [bold_least([curve.total(s, render) for s, _ in settings]) for render in RENDERS]
        rows = []
        for i, (setting, value) in enumerate(settings):
            rows.append(
                [value +(" (default)" if value ==knob.default else ""),
                 hundredths(curve.chain(setting)),
                 interval(curve.loss(setting)),
                 interval(curve.found(setting),
                          True),
                 interval(curve.right(setting),
                          True),
                 changed_words(curve, setting),
                 "%.4f" % curve.room_median(setting, "coverage"),
                 "%.3f" % curve.room_median(setting, "tightness"),
                 *(t[i] for t in totals)])
        lines +=["", f"### {knob.name}" +(f" [{knob.unit}]" if knob.unit else ""),
                 "",
                 table(
                     ("value", "CPU s", "cost / through the true opening", "right number [%]", "rooms right [%]",
                      "rooms lost, won", "coverage", "tightness", *(f"total at {r} s" for r in RENDERS)),
                     rows),
                 "", verdict(knob, settings, curve)]
    return lines


def renderer_section(pictures):
    lines = []
    for knob in KNOBS:
        scenes = pictures.scenes(knob.name)
        if knob.program != RENDERER or not scenes:
            continue
        values = [v for v in knob.values if (knob.name, v, scenes[0]) in pictures.by]
        rows = []
        for value in values:
            each = [hundredths(pictures.relative(knob.name, value, knob.default, [s]).value) for s in scenes]
            name = value + (" (default)" if value == knob.default else "")
            rows.append([name, interval(pictures.relative(knob.name, value, knob.default))
                         if value !=knob.default else "1", *each])
        lines += ["", f"### {knob.name}" + (f" [{knob.unit}]" if knob.unit else ""), "",
                  table(("value", "all", *scenes), rows)]
    return lines


def errors_section(pictures):
    """Every measure of the longest pictures, and what a black one has."""
    def told(rows):
        relmse, psnr, mape = (sum(r[field] for r in rows) / len(rows) for field in ("relmse", "psnr", "mape"))
        return "%s, %.1f dB, %s %%" % (hundredths(relmse) if relmse >= 0.1 else "%.2g" % relmse, psnr, hundredths(mape))
    rows = []
    for s in pictures.scenes("integrator"):
        found = [pictures.longest(s, i) for i in INTEGRATORS]
        rows.append(
            [s, told(pictures.by["black", "", s]),
             *(f"{hundredths(sum(r['cpu'] for r in of) / len(of))} s: {told(of)}" if of else "-" for of in found)])
    return table(("scene", "black", *INTEGRATORS), rows)


def depth_section(pictures):
    name = "tdpt-render --max-depth"
    scenes = pictures.scenes(name)
    rows = []
    for depth in DEPTHS:
        cells = []
        for s in scenes:
            if (name, depth, s) in pictures.by:
                mean, whole = (pictures.mean(name, d, s, "mean") for d in (depth, "none"))
                cells.append(
                    "%s, %s s, %.0f %%" %
                    (hundredths(pictures.mean(name, depth, s, "relmse")),
                     hundredths(pictures.mean(name, depth, s, "cpu")),
                     100 * mean / whole))
        rows.append([depth, *cells])
    return table(("edges", *scenes), rows) if scenes else []


def chain_section(pictures, portals):
    rows = []
    for s in portals.scenes:
        chain = portals.chain(DEFAULT, s)
        cells = [s, hundredths(chain)]
        if not pictures.longest(s, "tdpt-guided"):
            rows.append(cells + ["no opening"] * 2 + ["-"] * 4)
            continue
        for integrator in ("tdpt-guided", "auto"):
            pays = pictures.pays_from(s, chain, through=integrator)
            cells.append("never" if pays is None else hundredths(pays))
        errors = []
        for target in (0.1, 0.01):
            for integrator, extra in (("bdpt", 0), ("auto", chain)):
                rows_of = pictures.longest(s, integrator)
                errors.append(hundredths(extra + sum(cost(rows_of)) / len(rows_of) / target) if rows_of else "-")
        rows.append(cells + errors)
    return table(("scene", "the four stages [CPU s]", "tdpt-guided pays from [CPU s]", "auto pays from [CPU s]",
                  "bdpt to 0.1", "chain and auto to 0.1", "bdpt to 0.01", "chain and auto to 0.01"), rows)


def simplified_section(rows, portals):
    out = []
    shares = sorted({r["share"] for r in rows})
    for s in portals.scenes:
        cells = []
        for share in shares:
            of = [r for r in rows if r["scene"] == s and r["share"] == share]
            loss = stats.ratio(cost(of), cost(portals.rows(TRUE, s)))
            cells.append("%s, %.0f %%" % (interval(loss), 100 * of[0]["dropped"] / of[0]["triangles"]))
        out.append([s, interval(portals.loss(DEFAULT, [s])), *cells])
    return table(("scene", "whole", *("%g %% of the area" % (100 * share) for share in shares)), out)


WORDS = {
    "head": """# Speed against accuracy

Written by `{extent}make bench-tradeoff` ({version}, {cores} cores). Every knob that buys speed with
accuracy, the others at their defaults; {seeds} seeds of each setting, programs taking turns on one thread each. CPU
seconds throughout. The data: [portals](tradeoff-portals.csv), [rooms](tradeoff-rooms.csv),
[pictures](tradeoff-pictures.csv), [simplified](tradeoff-simplified.csv).

* **cost** = relMSE x CPU seconds of a picture; errors are against references of two halves (doc/efficiency.md).
* **cost / through the true opening**: of `tdpt-guided` through the portals that a setting finds over that through the
  true ones, geometric mean of {count} scenes; 1 is as good as can be, with no portal it is what portals are worth. In
  door-ajar, veach-ajar and bathroom2-channel the portals of the most accurate settings stand for the true ones;
  living-room-lamps has no opening: there it is what useless portals cost.
* **right number**: of the runs, where the number of openings is known. **rooms right**: of generated rooms with known
  openings those with all four marks of [portals.md](portals.md); **lost, won**: the kinds of those that are right by
  the default and wrong by the setting (-), or the other way round (+); coverage and tightness are medians.
* **total at R s**: the four stages and then a picture as good as R CPU seconds give through the true opening: chain + R
  x cost / that through the true opening; geometric mean. The least in bold. A default is right where its total is the
  least or near it.
* A picture's noise is that of few bright paths: of the default's own cost the interval is a factor of [{low}, {high}].
  Nearer than that, two settings are alike.
* Brackets: 95 % intervals over seeds (bootstrap; of shares Wilson's). Plots: grey lines are single scenes, the ring is
  the default.
""",
    "summary": """## Where the defaults lie

The values that do better than the default, if only by chance, and the default's total over theirs (of the renderer's
knobs: its cost).

Most of these scenes are bare rooms, which would do with less: `--quality draft`. What keeps the defaults where they are
stands in no mean: a furnished room without an opening, where settings beside the default find a useless portal (the
right number is below 100 %), and rooms that a setting loses. A room that cheaper and dearer settings lose alike stands
at an edge and tells nothing.
""",
    "integrators": """## tdpt-render

Error against time by integrator, found portals, depth 6.

![Error against CPU time, a panel for each scene](tradeoff-integrators.png)

The longest of these pictures, and a black one: CPU seconds, relMSE, PSNR, MAPE (which holds the reference's noise).

{errors}

What each knob of `tdpt-guided` costs: cost over that at the default, geometric mean of the scenes and each scene.

![Cost over that at the default, a panel for each knob](tradeoff-renderer.png)
""",
    "depth": """### tdpt-render --max-depth

relMSE against the whole light (no limit), CPU seconds, share of the light; `auto`, as many samples everywhere.
""",
    "chain": """## From .glb to picture

When finding portals pays: from which length of `bdpt`'s picture on the four stages and a picture through their portals
are done earlier; and CPU seconds to a relMSE of 0.1 and of 0.01, extrapolated from the longest pictures.

![Total time to an error](tradeoff-chain.png)
""",
    "simplified": """## Simplified scenes

"Proper simplification does not affect the stability of the results" (paper, 4.1). The smallest triangles are left out,
those that make so much of the area, before the four stages; the picture is of the whole scene. Cost / through the true
opening, and the share of the triangles that are gone.

![Cost through portals of simplified scenes](tradeoff-simplified.png)
""",
}


def picture_of(program):
    return f"tradeoff-{'quality' if program == CHAIN else program}.png"


def page(bench, extent):
    data = {name: read(bench.cache / f"{name}.csv") for name in TABLES}
    portals, pictures = PortalCurves(data["portals"], data["rooms"]), PictureCurves(data["pictures"])
    drawn = {picture_of(program): stage_figure(portals, program) for program in (CHAIN, *STAGES)}
    drawn["tradeoff-integrators.png"] = integrators_figure(pictures)
    drawn["tradeoff-renderer.png"] = renderer_figure(pictures)
    drawn["tradeoff-chain.png"] = chain_figure(pictures, portals)
    drawn["tradeoff-simplified.png"] = simplified_figure(data["simplified"], portals)
    for name, figure in drawn.items():
        pages.draw(figure.script(name), bench.doc)
    own = portals.loss(DEFAULT)
    bench.page("tradeoff", pages.sections(
        WORDS["head"].format(version=bench.version(), cores=cores(), extent=extent, count=len(portals.scenes),
                             seeds=len({r["seed"] for r in data["portals"]}), low=hundredths(own.low / own.value),
                             high=hundredths(own.high / own.value)),
        WORDS["summary"], summary_section(portals, pictures),
        *("\n".join(stage_section(program, portals)) for program in (CHAIN, *STAGES)),
        WORDS["integrators"].format(errors=errors_section(pictures)), "\n".join(renderer_section(pictures)),
        WORDS["depth"], depth_section(pictures), WORDS["chain"], chain_section(pictures, portals), WORDS["simplified"],
        simplified_section(data["simplified"], portals)))


@settings(SEEDS=Setting(5, "of each setting", 2), ROOMS=Setting(3, "of each kind", 1),
          TABLES=Setting(tuple(TABLES), "of: portals pictures rooms simplified"))
def tradeoff(bench):
    """Every knob that buys speed with accuracy, as curves: doc/tradeoff.md, its plots and tables. A night on two cores,
    --quick three quarters of an hour. Every number is one run's: `cpu` seconds of the process; errors against the
    stored references."""
    bench.need("gnuplot")
    run = Tradeoff(bench)
    for name in bench.settings.tables:
        write_rows(bench.cache / f"{name}.csv", run_all(bench, name, list(TABLES[name](run))))
    for name in TABLES:
        shutil.copy(bench.cache / f"{name}.csv", bench.doc / f"tradeoff-{name}.csv")
    extent = "".join(f"{key}={value} " for key, value in bench.given.items() if key in ("SEEDS", "ROOMS"))
    page(bench, ("QUICK=1 " if bench.quick else "") + extent)
