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
from common import Setting, settings
from pages import hundredths, table
from tradeoff import CHAIN, DEPTHS, INTEGRATORS, KNOBS, RENDERER, TABLES, Tradeoff, run_all

RENDERS = (10, 100, 1000)  # R [CPU s]
DEFAULT, TRUE = ("default", ""), ("true", "")
DEPTH = "tdpt-render --max-depth"
WORDED = ("knob", "value", "scene", "kind", "verdict")  # columns that are no numbers


def read(path):
    """Rows as dictionaries; numbers as such."""
    with open(path, newline="", encoding="utf-8") as file:
        return [{k: v if k in WORDED or not v else float(v) for k, v in row.items()} for row in csv.DictReader(file)]


def cost(rows):
    return [r["relmse"] * r["cpu"] for r in rows]


def mean(rows, field):
    return float(np.mean([r[field] for r in rows]))


def by(rows, *names):
    groups = {}
    for row in rows:
        groups.setdefault(tuple(row[n] for n in names), []).append(row)
    return groups


class PortalCurves:
    """Of the four stages: rows of portals.csv, and of rooms.csv for the scores. A setting: (knob, value)."""

    def __init__(self, rows, rooms):
        self.by, self.rooms = by(rows, "knob", "value", "scene"), by(rooms, "knob", "value")
        self.scenes = list(dict.fromkeys(r["scene"] for r in rows))

    def rows(self, setting, scene):
        return self.by.get((*setting, scene), [])

    def settings(self, knob):
        """{value: setting} of what was measured of a knob, from cheap to dear."""
        of = {value: DEFAULT if value == knob.default else (knob.name, value) for value in knob.values}
        return {v: setting for v, setting in of.items() if any(self.rows(setting, s) for s in self.scenes)}

    def loss(self, setting, scenes=None):
        """Cost of pictures through its portals over that through the true ones: 1 is as good as can be."""
        return stats.geometric([(cost(self.rows(setting, s)), cost(self.rows(TRUE, s))) for s in scenes or self.scenes])

    def chain(self, setting, scene=None):
        """CPU seconds of the four stages, mean over scenes."""
        return float(np.mean([mean(self.rows(setting, s), "chain_cpu") for s in ([scene] if scene else self.scenes)]))

    def total(self, setting, render):
        """Geometric mean over the scenes of total(v, R)."""
        def of(scene):
            loss = np.mean(cost(self.rows(setting, scene))) / np.mean(cost(self.rows(TRUE, scene)))
            return self.chain(setting, scene) + render * loss
        return math.exp(np.mean([math.log(of(s)) for s in self.scenes]))

    def found(self, setting):
        """Share of the runs that found as many portals as there are, where that is known."""
        rows = [(r, t) for s in self.scenes for r in self.rows(setting, s) for t in self.rows(TRUE, s)[:1]
                if t["portals"] != ""]
        return stats.wilson(sum(r["portals"] == t["portals"] for r, t in rows), len(rows))

    def right(self, setting):
        """Share of the rooms whose portals are right."""
        rows = self.rooms.get(setting, [])
        return stats.wilson(sum(r["verdict"] == "ok" for r in rows), len(rows))

    def changed(self, setting):
        """The kinds of rooms that it loses (-) and wins (+), in words."""
        here, there = ({(r["kind"], r["seed"]): r["verdict"] == "ok" for r in self.rooms.get(s, [])}
                       for s in (setting, DEFAULT))
        words = []
        for sign, right in (("-", there), ("+", here)):
            kinds = [room[0] for room in here if room in there and here[room] != there[room] and right[room]]
            words += [f"{sign}{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds)]
        return ", ".join(words)

    def over_rooms(self, average, setting, field):
        rows = self.rooms.get(setting, [])
        return float(average([r[field] for r in rows])) if rows else math.nan


class PictureCurves:
    """Of the renderer: rows of pictures.csv."""

    def __init__(self, rows):
        self.all, self.by = rows, by(rows, "knob", "value", "scene")

    def scenes(self, knob):
        return list(dict.fromkeys(r["scene"] for r in self.all if r["knob"] == knob))

    def knobs(self):
        """(knob, its scenes, its values) of those that were measured."""
        for knob in KNOBS:
            scenes = self.scenes(knob.name) if knob.program == RENDERER else []
            if scenes:
                yield knob, scenes, [v for v in knob.values if (knob.name, v, scenes[0]) in self.by]

    def points(self, scene, integrator):
        """[(CPU s, relMSE, low, high)] by length."""
        found = []
        for _, rows in sorted(by(self.by.get(("integrator", integrator, scene), []), "spp").items()):
            values = np.array([r["relmse"] for r in rows])
            middle, n = values.mean(), len(values)
            half = stats.t_quantile(0.025, n - 1) * values.std(ddof=1) / math.sqrt(n) if n > 1 else math.nan
            found.append((mean(rows, "cpu"), middle, max(middle - half, 0.05 * middle), middle + half))
        return found

    def relative(self, knob, value, scenes=None):
        """Cost over that of the default."""
        return stats.geometric([(cost(self.by[knob.name, value, s]), cost(self.by[knob.name, knob.default, s]))
                                for s in scenes or self.scenes(knob.name)])

    def longest(self, scene, integrator):
        """Rows of the longest pictures."""
        rows = self.by.get(("integrator", integrator, scene), [])
        most = max((r["spp"] for r in rows), default=0)
        return [r for r in rows if r["spp"] == most]

    def pays_from(self, scene, chain, through="auto"):
        """CPU seconds of bdpt's picture from which on finding portals pays; None: never."""
        a, b = cost(self.longest(scene, through)), cost(self.longest(scene, "bdpt"))
        gain = np.mean(b) / np.mean(a) if a and b else 0
        return chain / (1 - 1 / gain) if gain > 1 else None


# ---- Figures ----
LOG = "set logscale xy"
TENS = 'set format y "10^{%T}"'
FEW_RATIOS = "0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10"
RATIOS = "0.2, 0.3, 0.5, 0.7, 1, 1.5, 2, 3, 5, 10, 20, 50, 100"
TIMELESS = 1.05  # between the least and the most time of a knob's values


def ratios(values, most):
    return "set logscale y", f"set ytics ({RATIOS}); set yrange " + pages.span(values, 0.7, most)


def labels(block):
    """Names at points, above and below by turns: neighbours may be near."""
    return ['%s every 2::%d using 1:2:5 with labels %s rotate by 40 offset %s font ",9" notitle' % (block, *of)
            for of in ((0, "left", "0.3,0.7"), (1, "right", "-0.3,-0.7"))]


def stage_figure(curves, program):
    """For each knob two panels: what pictures through its portals cost, and the rooms that are right, against time over
    that of the default; of a knob that costs no time, against its values."""
    figure = pages.Figure(4)
    for knob in (k for k in KNOBS if k.program == program):
        of = curves.settings(knob)
        if not of:
            continue
        seconds = [curves.chain(s) for s in of.values()]
        timeless = max(seconds) < TIMELESS * min(seconds)
        places = {s: i for i, s in enumerate(of.values())}

        def over(time, setting):
            return places[setting] if timeless else time(setting) / time(DEFAULT)

        def facts(time, ratio_of):
            """Places, values with their intervals, names."""
            return [(over(time, s), e.value, e.low, e.high, '"%s"' % pages.short(v))
                    for v, s in of.items() for e in (ratio_of(s),)]

        each = [[(over(lambda s: curves.chain(s, scene), s), curves.loss(s, [scene]).value) for s in of.values()]
                for scene in curves.scenes]
        times, losses = zip(*(point for points in each for point in points))
        few = FEW_RATIOS if max(times) > 6 * min(times) else RATIOS
        across = pages.ticks([*map(pages.short, of)]) if timeless else \
            f"set xtics ({few}); set logscale x; set xrange " + pages.span(times, 0.8, 1.25)
        costs = facts(curves.chain, curves.loss)
        rooms = facts(lambda s: curves.over_rooms(np.mean, s, "cpu"), lambda s: curves.right(s).percent())
        for words, y, points, lines, ranges in (
                ("pictures", "cost / through the true opening", costs, [pages.thin(figure.block(p)) for p in each],
                 ratios(losses, 3)),
                ("rooms", "rooms right [%]", rooms, [], ("set yrange [0:119]",))):
            block = figure.block(points)
            ring = pages.ring(figure.block([points[list(of).index(knob.default)][:2]]))
            figure.panel(f"{knob.name}: {words}",
                         knob.unit or "value" if timeless else "time of the four stages / at the default", y,
                         [*lines, *pages.bars(block, 0, 2, not knob.words), ring,
                          *([] if timeless else labels(block))], (*ranges, across))
    return figure


def integrators_figure(curves):
    """Error against time, a panel a scene."""
    figure = pages.Figure(4)
    for scene in curves.scenes("integrator"):
        drawn = []
        for k, integrator in enumerate(INTEGRATORS):
            points = curves.points(scene, integrator)
            drawn += pages.bars(figure.block(points), k) if points else []
        figure.panel(scene, "CPU seconds", "relMSE", drawn, (LOG, TENS))
    figure.key([pages.keyed(k, i) for k, i in enumerate(INTEGRATORS)])
    return figure


def chain_figure(pictures, portals):
    """Total time to an error, the four stages included: as measured, then as 1 / time from the longest pictures on."""
    figure = pages.Figure(4)
    lines = (("bdpt", "", 0), ("tdpt-guided", ", portals found first", 4), ("auto", ", portals found first", 5))
    for scene in (s for s in portals.scenes if pictures.longest(s, "tdpt-guided")):
        drawn, every = [], []
        for integrator, first, k in lines:
            extra = portals.chain(DEFAULT, scene) if first else 0
            points = [(t + extra, *errors) for t, *errors in pictures.points(scene, integrator)]
            if not points:
                continue
            seconds, error = points[-1][0] - extra, points[-1][1]
            ahead = [(seconds * 2**i + extra, error / 2**i) for i in range(13) if seconds * 2**i < 2000]
            drawn += pages.bars(figure.block(points), k, lines=False)
            drawn.append(pages.line(figure.block([p[:2] for p in points] + ahead), k))
            every += [p[1] for p in points]
        figure.panel(scene, "CPU seconds from .glb to picture", "relMSE", drawn,
                     (LOG, TENS, "set xrange [0.03:2000]", "set yrange [1e-4:%g]" % (2 * max(every))))
    figure.key([pages.keyed(k, i + first) for i, first, k in lines])
    return figure


def simplified_losses(rows, portals):
    """{scene: {share: (loss, rows)}}"""
    groups = by(rows, "scene", "share")
    return {s: {share: (stats.ratio(cost(groups[s, share]), cost(portals.rows(TRUE, s))), groups[s, share])
                for share in sorted({r["share"] for r in rows})} for s in portals.scenes}


# ---- Page ----
def with_default(knob):
    return f"`{knob.name.removeprefix(RENDERER + ' ')}` ({knob.default})"


def knob_table(curve):
    """The defaults, and a row for each other value of an option of the four stages."""
    usual, whole = [curve.total(DEFAULT, render) for render in RENDERS], "%.0f".__mod__

    def row(setting):
        totals = [curve.total(setting, render) for render in RENDERS]
        return [hundredths(curve.chain(setting)), curve.loss(setting).text(hundredths),
                curve.found(setting).percent().text(whole), curve.right(setting).percent().text(whole),
                *(("**%s**" if t < 0.995 * d else "%s") % hundredths(t) for t, d in zip(totals, usual))]

    rows = [["all defaults", "", *row(DEFAULT)]]
    rows += [[with_default(knob), value, *row(setting)] for knob in KNOBS if knob.program != RENDERER
             for value, setting in curve.settings(knob).items() if setting != DEFAULT]
    return table(("option (default)", "value", "CPU s", "cost / through the true opening", "right number [%]",
                  "rooms right [%]", *(f"total at {r} s" for r in RENDERS)), rows)


def renderer_table(pictures):
    every = list(dict.fromkeys(s for _, scenes, _ in pictures.knobs() for s in scenes))
    rows = [[with_default(knob), v, pictures.relative(knob, v).text(hundredths),
             *(hundredths(pictures.relative(knob, v, [s]).value) if s in scenes else "-" for s in every)]
            for knob, scenes, values in pictures.knobs() for v in values if v != knob.default]
    return table(("option (default)", "value", "all", *every), rows)


def depth_section(pictures):
    scenes, rows = pictures.scenes(DEPTH), []
    for depth in DEPTHS:
        of = [(pictures.by[DEPTH, depth, s], pictures.by[DEPTH, "none", s]) for s in scenes]
        rows.append([depth, *("%s, %s s, %.0f %%" % (hundredths(mean(rows, "relmse")), hundredths(mean(rows, "cpu")),
                                                     100 * mean(rows, "mean") / mean(whole, "mean"))
                              for rows, whole in of)])
    return table(("edges", *scenes), rows) if scenes else ""


def chain_section(pictures, portals):
    rows = []
    for s in portals.scenes:
        chain = portals.chain(DEFAULT, s)
        cells = [s, hundredths(chain)]
        if not pictures.longest(s, "tdpt-guided"):
            rows.append(cells + ["no opening"] * 2 + ["-"] * 4)
            continue
        for integrator in ("tdpt-guided", "auto"):
            pays = pictures.pays_from(s, chain, integrator)
            cells.append("never" if pays is None else hundredths(pays))
        for target in (0.1, 0.01):
            for integrator, extra in (("bdpt", 0), ("auto", chain)):
                cells.append(hundredths(extra + np.mean(cost(pictures.longest(s, integrator))) / target))
        rows.append(cells)
    return table(("scene", "the four stages [CPU s]", "tdpt-guided pays from [CPU s]", "auto pays from [CPU s]",
                  "bdpt to 0.1", "chain and auto to 0.1", "bdpt to 0.01", "chain and auto to 0.01"), rows)


def simplified_section(losses, portals):
    rows = [[s, portals.loss(DEFAULT, [s]).text(hundredths),
             *("%s, %.0f %%" % (loss.text(hundredths), 100 * of[0]["dropped"] / of[0]["triangles"])
               for loss, of in losses[s].values())] for s in losses]
    shares = losses[portals.scenes[0]]
    return table(("scene", "whole", *("%g %% of the area" % (100 * share) for share in shares)), rows)


def write_page(bench):
    data = {name: read(bench.cache / f"{name}.csv") for name in TABLES}
    portals, pictures = PortalCurves(data["portals"], data["rooms"]), PictureCurves(data["pictures"])
    for name, figure in (("quality", stage_figure(portals, CHAIN)), ("integrators", integrators_figure(pictures)),
                         ("chain", chain_figure(pictures, portals))):
        pages.draw(figure.script(f"tradeoff-{name}.png"), bench.doc)
    bench.page("tradeoff", {
        "knobs": knob_table(portals), "renderer": renderer_table(pictures),
        "depth": depth_section(pictures), "chain": chain_section(pictures, portals),
        "simplified": simplified_section(simplified_losses(data["simplified"], portals), portals)})


@settings(SEEDS=Setting(5, "of each setting", 2), ROOMS=Setting(3, "of each kind", 1))
def tradeoff(bench):
    """Every knob that buys speed with accuracy, as curves: doc/tradeoff.md, its plots and tables. A night on two cores,
    --quick three quarters of an hour. Every number is one run's: `cpu` seconds of the process; errors against the
    stored references."""
    bench.need("gnuplot")
    run = Tradeoff(bench)
    for name, tasks in TABLES.items():
        pages.write_csv(bench.cache / f"{name}.csv", run_all(bench, name, list(tasks(run))))
        shutil.copy(bench.cache / f"{name}.csv", bench.doc / f"tradeoff-{name}.csv")
    write_page(bench)
