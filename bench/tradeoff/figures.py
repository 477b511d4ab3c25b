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


def stage(curves, program):
    """For each knob two panels: what pictures through its portals cost, and the rooms that are right, against time."""
    figure = plots.Figure(4)
    for knob in knobs.KNOBS:
        if knob.program != program:
            continue
        settings = settings_of(curves, knob)
        mean, marks = [], []
        for setting, value in settings:
            loss = curves.loss(setting)
            mean.append((curves.chain(setting), loss.value, loss.low, loss.high, '"%s"' % value))
            if value == knob.default:
                marks.append(mean[-1][:2])
        lines = []
        for scene in curves.scenes:
            lines.append(plots.thin(figure.block([(curves.chain(s, scene), curves.loss(s, [scene]).value)
                                                  for s, _ in settings])))
        block = figure.block(mean)
        figure.panel(f"{knob.name}: pictures", "CPU seconds of the four stages", "cost / through the true opening",
                     lines + plots.bars(block, 0, 2, not knob.words) + [plots.ring(figure.block(marks))] +
                     [f"{block} using 1:2:5 with labels offset 0,1 font \",10\" notitle"], (LOG["xy"], "set offsets 0.1,0.1,0.1,0.1"))
        rooms, marks = [], []
        for setting, value in settings:
            right = curves.right(setting)
            rooms.append((curves.room_cpu(setting), 100 * right.value, 100 * right.low, 100 * right.high, '"%s"' % value))
            if value == knob.default:
                marks.append(rooms[-1][:2])
        block = figure.block(rooms)
        figure.panel(f"{knob.name}: rooms", "CPU seconds of the four stages", "rooms right [%]",
                     plots.bars(block, 1, 2, not knob.words) + [plots.ring(figure.block(marks))] +
                     [f"{block} using 1:2:5 with labels offset 0,1 font \",10\" notitle"],
                     (LOG["x"], "set yrange [0:110]", "set offsets 0.1,0.1,0,0"))
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
        mean = [(i, e.value, e.low, e.high) for i, e in
                enumerate(curves.relative(knob.name, v, knob.default) for v in values)]
        ticks = "set xtics (%s)" % ", ".join('"%s" %d' % (v, i) for i, v in enumerate(values))
        marks = figure.block([mean[values.index(knob.default)][:2]])
        figure.panel(knob.name, knob.unit or "heuristic", "cost / at the default",
                     lines + plots.bars(figure.block(mean), 0, 2, not knob.words) + [plots.ring(marks)],
                     (LOG["y"], ticks, "set xrange [-0.5:%g]" % (len(values) - 0.5), "set offsets 0,0,0.1,0.1"))
    return figure


def chain(pictures, portals):
    """Total time to an error, the four stages included."""
    figure = plots.Figure(4)
    lines = (("bdpt", False, 0), ("tdpt-guided", True, 4), ("auto", True, 5))
    for scene in portals.scenes:
        drawn = []
        for integrator, through, k in lines:
            extra = portals.chain(("default", ""), scene) if through else 0
            points = [(t + extra, e, low, high) for t, e, low, high in pictures.points(scene, integrator)]
            if points:
                drawn += plots.bars(figure.block(points), k, 1.5)
        figure.panel(scene, "CPU seconds from .glb to picture", "relMSE", drawn, (LOG["xy"], 'set format y "10^{%T}"'))
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
