"""The figures of doc/tradeoff.md, from curves.py."""
import knobs
import plots

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
    return ['%s every 2::%d using 1:2:5 with labels %s rotate by 40 offset %s font ",9" notitle' % (block, first, side, offset)
            for first, side, offset in ((0, "left", "0.3,0.7"), (1, "right", "-0.3,-0.7"))]


def stage(curves, program):
    """For each knob two panels: what pictures through its portals cost, and the rooms that are right, against time over that
    of the default; of a knob that costs no time, against its values."""
    default = ("default", "")

    figure = plots.Figure(4)
    for knob in knobs.KNOBS:
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
        across = (f"set xtics ({FEW_RATIOS if wide else RATIOS}); set logscale x; set xrange " + plots.span(times, 0.8, 1.25)
                  if not timeless else "set xtics (%s); set xrange [-0.5:%g]" % (
                      ", ".join('"%s" %d' % (plots.short(v), i) for i, (_, v) in enumerate(settings)), len(settings) - 0.5))
        costs = [(chain(s), loss[s].value, loss[s].low, loss[s].high, '"%s"' % plots.short(v)) for s, v in settings]
        rooms = [(over(curves.room_cpu, s), *(100 * x for x in (e.value, e.low, e.high)), '"%s"' % plots.short(v))
                 for s, v in settings for e in (curves.right(s),)]
        here = [value for _, value in settings].index(knob.default)
        for words, y, points, lines, ranges in (
                ("pictures", "cost / through the true opening", costs, [plots.thin(figure.block(p)) for p in each],
                 (LOG["y"], f"set ytics ({RATIOS}); set yrange " + plots.span([y for _, y in every], 0.7, 3))),
                ("rooms", "rooms right [%]", rooms, [], ("set yrange [0:119]",))):
            block = figure.block(points)
            figure.panel(f"{knob.name}: {words}", knob.unit or "value" if timeless else "time of the four stages / at the default", y,
                         [*lines, *plots.bars(block, 0, 2, not knob.words), plots.ring(figure.block([points[here][:2]])),
                          *([] if timeless else labels(block))], (*ranges, across))
    return figure


def integrators(curves):
    """Error against time, a panel a scene."""
    figure = plots.Figure(4)
    for scene in curves.scenes("integrator"):
        drawn = []
        for k, integrator in enumerate(knobs.INTEGRATORS):
            points = curves.points(scene, integrator)
            if points:
                drawn += plots.bars(figure.block(points), k, 1.5)
        figure.panel(scene, "CPU seconds", "relMSE", drawn, (LOG["xy"], 'set format y "10^{%T}"'))
    figure.key(['NaN with linespoints %s title "%s"' % (plots.style(k), i) for k, i in enumerate(knobs.INTEGRATORS)])
    return figure


def renderer(curves):
    """Cost of each value of a knob over that of the default."""
    figure = plots.Figure(3)
    for knob in knobs.KNOBS:
        scenes = curves.scenes(knob.name)
        if knob.program != knobs.RENDERER or not scenes:
            continue
        values = [v for v in knob.values if (knob.name, v, scenes[0]) in curves.by]
        lines = []
        for scene in scenes:
            lines.append(plots.thin(figure.block([(i, curves.relative(knob.name, v, knob.default, [scene]).value)
                                                  for i, v in enumerate(values)])))
        every = [curves.relative(knob.name, v, knob.default, [s]).value for v in values for s in scenes]
        mean = [(i, e.value, e.low, e.high) for i, e in
                enumerate(curves.relative(knob.name, v, knob.default) for v in values)]
        ticks = "set xtics (%s)" % ", ".join('"%s" %d' % (v, i) for i, v in enumerate(values))
        marks = figure.block([mean[values.index(knob.default)][:2]])
        figure.panel(knob.name, knob.unit or "heuristic", "cost / at the default",
                     lines + plots.bars(figure.block(mean), 0, 2, not knob.words) + [plots.ring(marks)],
                     (LOG["y"], ticks, "set xrange [-0.5:%g]" % (len(values) - 0.5), f"set ytics ({RATIOS}); set yrange " + plots.span(every, 0.7, 2)))
    return figure


def chain(pictures, portals):
    """Total time to an error, the four stages included: what was measured, and from the longest pictures on as 1 / time."""
    figure = plots.Figure(4)
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
            drawn += plots.bars(figure.block(points), k, 1.5, False)
            drawn.append(f"{figure.block([p[:2] for p in points] + ahead)} using 1:2 with lines {plots.line(k)} notitle")
            every += [e for _, e, _, _ in points]
        figure.panel(scene, "CPU seconds from .glb to picture", "relMSE", drawn,
                     (LOG["xy"], 'set format y "10^{%T}"', "set xrange [0.03:2000]", "set yrange [1e-4:%g]" % (2 * max(every))))
    figure.key(['NaN with linespoints %s title "%s"' % (plots.style(k), i + (", portals found first" if p else ""))
                for i, p, k in lines])
    return figure


def simplified(rows, portals, curves_of):
    """Cost through portals that were found without the smallest triangles, against the share of the area that they make."""
    figure = plots.Figure(2, 500, 380)
    drawn, key = [], []
    for k, scene in enumerate(portals.scenes):
        points = []
        for share in sorted({r["share"] for r in rows}):
            loss = curves_of.ratio(curves_of.cost([r for r in rows if r["scene"] == scene and r["share"] == share]),
                                   curves_of.cost(portals.rows(("true", ""), scene)))
            points.append((100 * share, loss.value, loss.low, loss.high))
        drawn += plots.bars(figure.block(points), k, 1.5)
        key.append('NaN with linespoints %s title "%s"' % (plots.style(k), scene))
    figure.panel("Portals of simplified scenes", "area of the triangles left out [%]", "cost / through the true opening", drawn,
                 (LOG["xy"],))
    figure.key(key)
    return figure
