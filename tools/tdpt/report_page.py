"""report_page.py FOLDER PAGE: the page of a scene, from what report_measure.py left in FOLDER.

The page is report_scene.html within report.html, with its figures filled in. It is one file that needs nothing else:
pictures are data, the plot is SVG, there is no script. Whatever comes from a file is a str, which text() escapes; only
what is made here is Markup. A figure that is missing is a dash. Standard library alone.
"""

import base64
import html
import json
import math
import os
import re
import string
import struct
import sys


class Markup(str):
    """HTML that is finished."""


# What an XML parser or a reader of text could not bear: control characters, marks that turn the direction of text.
UNSEEN = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff\u202a-\u202e\u2066-\u2069]")
VOID = {"img", "meta", "br", "hr"}


def text(value):
    """Escaped unless it is Markup; nothing for None; all of a list."""
    if value is None or isinstance(value, Markup):
        return value or Markup("")
    if isinstance(value, (list, tuple)):
        return Markup("".join(map(text, value)))
    return Markup(html.escape(UNSEEN.sub("\ufffd", str(value)), quote=True))


def el(tag, *children, **attributes):
    """An element. class_ is class, a_b is a-b; None leaves an attribute out."""
    words = "".join(f' {name.rstrip("_").replace("_", "-")}="{text(value)}"' for name, value in attributes.items() if value is not None)
    return Markup(f"<{tag}{words}>" if tag in VOID else f"<{tag}{words}>{text(children)}</{tag}>")


def filled(template, **values):
    """The file of HTML that lies beside this one, with values in the places of their names."""
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), template), encoding="utf-8") as stream:
        return Markup(string.Template(stream.read()).substitute({key: text(value) for key, value in values.items()}))


def document(title, body, maker, style=""):
    return filled("report.html", title=title, body=body, style=Markup(style),
                  foot=f"Made by {maker}. Figures that were not measured are a dash.")


# Figures and words.

DASH = "\u2013"


def number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def figure(value, digits=2, unit=""):
    """Rounded to so many digits that count; a dash where there is none."""
    if not number(value):
        return DASH
    if value == 0:
        return "0" + unit
    if isinstance(value, int) and abs(value) < 10 ** 15 and digits >= 9:
        return f"{value:,}".replace(",", "\u202f") + unit
    size = math.floor(math.log10(abs(value)) + 1e-12)
    if -4 <= size < 6:
        shown = f"{round(value, digits - 1 - size):,.{max(0, digits - 1 - size)}f}".replace(",", "\u202f")
    else:
        shown = f"{value / 10 ** size:.{digits - 1}f} \u00d7 10" + str(size).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return shown.replace("-", "\u2212") + unit


def percent(value, digits=3):
    return figure(100 * value, digits, "\u202f%") if number(value) else DASH


def seconds(value):
    return figure(value, 3, " CPU seconds")


def memory(value):
    return figure(value / 2 ** 20, 3, "\u202fMiB") if number(value) else DASH


def count(n, one, many=None):
    return f"{n} {one if n == 1 else many or one + 's'}"


def get(value, *path):
    for key in path:
        if isinstance(value, dict):
            value = value.get(key)
        elif isinstance(value, list) and isinstance(key, int) and -len(value) <= key < len(value):
            value = value[key]
        else:
            return None
    return value


# Pieces.

def picture(folder, file, alt):
    """An image as data, with its size so that nothing jumps; a sentence where it is not there."""
    try:
        with open(os.path.join(folder, file), "rb") as stream:
            data = stream.read()
        if file.endswith(".svg"):
            kind = "svg+xml"
            width, height = (round(float(v)) for v in re.search(rb'<svg [^>]*?width="([0-9.]+)(?:px)?" height="([0-9.]+)', data).groups())
        else:
            kind = "png"
            width, height = struct.unpack(">II", data[16:24])
    except (OSError, TypeError, AttributeError, ValueError, struct.error):
        return el("p", "This picture could not be made.", class_="none")
    return el("img", src=f"data:image/{kind};base64," + base64.b64encode(data).decode(), alt=alt, width=width, height=height)


def table(caption, head, rows, class_=None):
    """The first cell of a row is its heading. Columns whose heading begins with # are figures."""
    def cells(tag, row, scope):
        return [el("th" if i == 0 else tag, cell, class_="n" if head[i].startswith("#") else None, scope=scope if i == 0 or tag == "th" else None,
                   data_head=head[i].lstrip("#") if i and tag == "td" else None) for i, cell in enumerate(row)]
    if not rows:
        return el("p", f"{caption}: nothing is told.", class_="none")
    return el("div", el("table", el("caption", caption), el("thead", el("tr", cells("th", [h.lstrip("#") for h in head], "col"))),
                        el("tbody", [el("tr", cells("td", row, "row")) for row in rows]), class_=class_),
              class_="scroll", tabindex="0", role="region", aria_label=caption)


def items(lines):
    return [el("li", line) for line in lines]


def facts_of(pairs):
    """The figures below the heading of a page: (figure, what it is)."""
    return [el("div", el("dt", what), el("dd", shown)) for shown, what in pairs]


# Charts.

class Axis:
    """Of a chart: its ends, its ticks, and where a value lies between the ends."""

    def __init__(self, low, high, words, logarithmic=True, shown=lambda value: figure(value, 1)):
        self.low, self.high, self.words, self.logarithmic, self.shown = low, high if high > low else low + 1, words, logarithmic, shown

    def share(self, value):
        if self.logarithmic:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def ticks(self, most):
        """Round ones: powers of ten if there are enough, else also twice and five times these, else all."""
        if not self.logarithmic:
            size = 10.0 ** math.floor(math.log10((self.high - self.low) / most))
            step = next(m * size for m in (1, 2, 5, 10, 20) if (self.high - self.low) / (m * size) <= most)
            return [i * step for i in range(math.ceil(self.low / step), math.floor(self.high / step) + 1)]
        exponents = range(math.floor(math.log10(self.low)) - 1, math.ceil(math.log10(self.high)) + 1)
        for factors, enough in (((1,), 3), ((1, 2, 5), 2), (range(1, 10), 0)):
            found = [m * 10.0 ** e for e in exponents for m in factors if self.low * 0.9999 <= m * 10.0 ** e <= self.high * 1.0001]
            if len(found) >= enough:
                return found


def chart(lines, x, y, heights, title, ident, levels=(), changes=()):
    """A drawing for wide windows and one for narrow ones. lines: {label: [[(x, y), ...], ...]}, of which the first is drawn as
    "with" and the second as "without". levels: (y, words), lines across. changes: (x, words), lines from top to bottom."""
    keys = [(el("span", class_="key" + (" with" if i == 0 else ""), aria_hidden="true"), label, " \u00a0 ") for i, label in enumerate(lines)]
    return [el("p", keys, class_="note") if len(lines) > 1 else None,
            [drawing(lines, x, y, size, el("title", title, id=f"{ident}-{kind}"), levels, changes, viewBox="0 0 {} {}".format(*size),
                     role="img", aria_labelledby=f"{ident}-{kind}", class_="plot " + kind)
             for size, kind in (((760, heights[0]), "wide"), ((380, heights[1]), "narrow"))]]


def drawing(lines, x, y, size, title, levels, changes, **attributes):
    left, right, top, bottom = 58, size[0] - 14, 22, size[1] - 46
    out = []

    def px(value):
        return round(left + (right - left) * x.share(value), 1)

    def py(value):
        return round(bottom - (bottom - top) * y.share(value), 1)

    def line(class_, *ends):
        out.append(el("line", class_=class_, **dict(zip(("x1", "y1", "x2", "y2"), ends))))

    def words(value, class_, at, anchor="start", **more):
        out.append(el("text", value, class_=class_, x=at[0], y=at[1], text_anchor=anchor, **more))
    for tick in x.ticks(size[0] / 60):
        line("grid", px(tick), top, px(tick), bottom)
        words(x.shown(tick), "tick", (px(tick), bottom + 18), "middle")
    for tick in y.ticks(6):
        line("grid", left, py(tick), right, py(tick))
        words(y.shown(tick), "tick", (left - 8, py(tick) + 4), "end")
    out.append(el("path", d=f"M{left} {top}V{bottom}H{right}", class_="axis"))
    words(x.words, "label", ((left + right) / 2, size[1] - 8), "middle")
    middle = (top + bottom) / 2
    words(y.words, "label", (14, middle), "middle", transform=f"rotate(-90 14 {middle})")
    for value, said in levels:
        line("black", left, py(value), right, py(value))
        words(said, "remark", (left + 6, py(value) - 6))
    for (value, said), end in zip(changes, [value for value, _ in changes[1:]] + [x.high]):
        if value > x.low:
            line("change", px(value), top, px(value), bottom)
        if px(end) - px(value) > 7 * len(said):  # else the sentence above tells it
            words(said, "remark", (px(value) + 5, top - 6))
    for runs, kind in zip(lines.values(), ("with", "without")):
        for run in runs:
            out.append(el("polyline", points=" ".join(f"{px(a)},{py(b)}" for a, b in run), class_="line " + kind))
            # A disc and a square, so that no colour is needed to tell them apart.
            for a, b in run if len(run) < 20 else ():
                out.append(el("circle", cx=px(a), cy=py(b), r=4, class_="mark " + kind) if kind == "with" else
                           el("rect", x=px(a) - 4, y=py(b) - 4, width=8, height=8, class_="mark " + kind))
    return el("svg", title, out, **attributes)


def error_chart(m):
    """The error of both renderings over their time."""
    lines = {label: [sorted((s["cpu"], s["relmse"]) for s in m[key]["steps"] if number(s.get("relmse")) and s["relmse"] > 0 and s["cpu"] > 0)]
             for key, label in (("with", f"{m['integrator']}, portals (discs)"), ("without", "bdpt, no portals (squares, dashed)"))}
    points = [point for (run,) in lines.values() for point in run]
    if not points:
        return el("p", "No error could be measured: there is nothing to draw.", class_="none")
    levels = [(value, words) for value, words in ((get(m, "reference", "last", "noise", "relmse"), "the reference\u2019s own error"),
                                                  (get(m, "black", "relmse"), "a black picture")) if number(value) and value > 0]
    ys = [value for _, value in points] + [value for value, _ in levels]
    # Decades cost room where nothing is: the axes end half a step beyond what is drawn.
    x = Axis(min(points)[0] / 1.25, max(points)[0] * 1.25, "CPU seconds")
    return chart(lines, x, Axis(min(ys) / 1.6, max(ys) * 1.6, "relMSE"), (420, 340), "Error against time", "plot", levels)


# What was found.

class Verdict:
    """What the portals are worth: as tdpt-render estimated before it rendered, and as measured."""

    def __init__(self, m):
        self.stages = {stage["tool"]: stage for stage in m["stages"]}
        self.given, self.integrator = m["given"], m["integrator"]
        last, pilot = m["with"]["last"], get(m["with"], "first", "pilot")
        self.portals = get(last, "portals") or []
        self.foretold = get(pilot, "portals_gain")
        self.chosen = last.get("chosen") or self.integrator
        candidates = get(pilot, "candidates") or []
        self.used = next((bool(c.get("portals")) for c in candidates if c.get("integrator") == self.chosen),
                         not self.chosen.startswith(("pt", "nee", "bdpt")) or (get(last, "techniques", "portal") or 0) > 0)
        self.candidates = sorted((c for c in candidates if all(number(c.get(key)) for key in ("relmse", "work", "cost"))),
                                 key=lambda c: c["cost"])
        self.best_plain = next((", " + c["integrator"] for c in self.candidates if not c.get("portals")), "")
        self.way = (self.integrator + (f" ({self.chosen})" if self.chosen != self.integrator else "") +
                    (" with portals" if self.used and self.portals else ""))
        self.after, self.before = m["with"]["steps"][-1], m["without"]["steps"][-1]
        self.gain = None
        if all(number(s.get("relmse")) and s["relmse"] > 0 and s["cpu"] > 0 for s in (self.after, self.before)):
            self.gain = self.before["relmse"] * self.before["cpu"] / (self.after["relmse"] * self.after["cpu"])

    def sentence(self):
        n = len(self.portals)
        if not n:
            found = "No portal was found" if self.stages else "The files that were given hold no portal" if self.given else "No portals were given"
            reason = get(self.stages, "portalfit", "json", "reason")
            return found + (f": {reason}." if reason else ".")
        found = count(n, "portal was", "portals were") + (" found" if self.stages else " given")
        if not number(self.foretold):
            return f"{found}. What portals are worth was not estimated."
        worth = f"{figure(self.foretold)} times the efficiency of the best way without{self.best_plain}"
        if not self.used:
            return f"{found}, but tdpt-render left {'it' if n == 1 else 'them'} out: it expected {worth}, and rendered by {self.chosen}."
        return f"{found}, worth {worth}, as tdpt-render estimated before rendering."

    def measured(self):
        if self.gain is None:
            return "The two pictures could not be compared."
        db = [get(step, "psnr") for step in (self.after, self.before)]
        psnr = f"; the PSNR is {figure(db[0], 3)}\u202fdB instead of {figure(db[1], 3)}\u202fdB" if all(map(number, db)) else ""
        return f"Measured in equal time, {self.way} has {figure(self.gain)} times the efficiency of bdpt without portals{psnr}."


def limits(m):
    """Why the figures may be wrong, each in a sentence."""
    reference, noise = m["reference"]["last"], get(m, "reference", "last", "noise", "relmse")
    yield (f"The reference has {count(reference.get('spp'), 'sample')} per pixel, {figure(m['factor'])} times those of the longer picture with "
           f"portals, and another seed. By its own samples its relMSE is {figure(noise)}, which counts in every score here.")
    for key, label in (("with", m["integrator"]), ("without", "bdpt")):
        score, trimmed, mean, expected = (m[key]["steps"][-1].get(k) for k in ("relmse", "relmse_trimmed", "mean", "reference_mean"))
        if number(noise) and number(score) and score < 3 * noise:
            yield f"The score of {label}, {figure(score)}, is not far above the reference\u2019s own error: it is better than it looks."
        if number(mean) and number(expected) and expected > 0 and abs(mean / expected - 1) > 0.05:
            yield (f"The mean of {label} is {percent(abs(mean / expected - 1))} {'above' if mean > expected else 'below'} the reference\u2019s: one of "
                   "the two has not met all of the light.")
        if number(trimmed) and number(score) and score > 3 * trimmed:
            yield (f"Of the error of {label}, {percent(1 - trimmed / score)} lies in a thousandth of the pixels: with another seed its relMSE may be "
                   "another.")


STAGES = {
    "ffgraph": ("Who reaches what", "Amber is the light\u2019s, blue the camera\u2019s, violet of both. Two rooms of one colour each are what a "
                "bottleneck looks like."),
    "mincut": ("Where transport is narrowest", "The border between the colours is the cut; the lines are pairs of patches that exchange light "
               "across it."),
    "lightgrid": ("Where the light passes through the air", "Each pixel is the fullest voxel behind it, from above, from the front and from the "
                  "right; the ring marks the fullest of all."),
    "portalfit": ("The portals in plan", "Cut at eye height: walls are dark, panes blue. Green are the portals, each with the way of the light; "
                  "grey is what was refused, with the reason below.")}

# "what: decision, because reason (price)"; other lines are notes.
DECISION = re.compile(r"(.+?): (.+?), because (.*?)(?:(?<!:) \(((?:[^()]|\([^()]*\))*)\))?$")


def decisions(explained):
    """Lines "program: words" of --explain -> rows of what, decision, reason and price; the other lines."""
    lines = [line.partition(": ")[2] for line in explained.splitlines() if ": " in line]
    return [match.groups(default="") for match in map(DECISION.match, lines) if match], [line for line in lines if not DECISION.match(line)]


def stage_figures(folder, m):
    for stage in m["stages"]:
        heading, how = STAGES[stage["tool"]]
        body = picture(folder, stage["picture"], f"{stage['tool']}: {heading}") if stage["picture"] else el(
            "p", f"Not drawn: {stage['missing'] or 'there is no picture'}.", class_="none")
        note = el("span", *decisions(stage["text"])[1][:1], class_="said")
        yield el("figure", el("h3", el("code", stage["tool"]), " \u00b7 ", heading), body, el("figcaption", how, el("br"), note),
                 class_="picture wide" if stage["tool"] == "portalfit" else "picture")


def portals_table(v):
    fitted = {p.get("name"): p for p in get(v.stages, "portalfit", "json", "portals") or []}
    rows = []
    for p in v.portals:
        f = {**fitted.get(p.get("name"), {}), **{key: value for key, value in p.items() if value is not None}}
        rows.append((el("bdi", p.get("name", "")), figure(f.get("area"), 3), figure(f.get("conductance")), figure(f.get("tightness")),
                     percent(f.get("support")), figure(f.get("direction_angle"), 2, "\u00b0"), percent(f.get("energy")), f.get("drawback", "")))
    return table("Portals. By segments: share of the picture\u2019s light that paths begun in the portal brought",
                 ("Portal", "#Area [m\u00b2]", "#Conductance", "#Tightness", "#Support", "#Normal off by", "#By segments", "Drawback"), rows,
                 "stack")


def refused(v):
    for tool, what in (("portalfit", "A candidate for a portal"), ("mincut", "A cut")):
        for r in get(v.stages, tool, "json", "refused") or []:
            yield f"{what} was refused: {get(r, 'why') or get(r, 'reason') or json.dumps(r)}."


def costs(m, v):
    """-> rows of the programs, rows of the stages' phases, CPU seconds of the stages' pictures and of finding portals."""
    rows, phases, drawing_time = [], [], 0
    for tool, stage in v.stages.items():
        told = stage["json"] or {}
        of_stage = {key: phase for key, phase in (told.get("phases") or {}).items() if isinstance(phase, dict) and number(phase.get("cpu_seconds"))}
        drawn = get(of_stage.pop("pictures", None), "cpu_seconds") or 0
        cpu = told.get("cpu_seconds")
        drawing_time += drawn
        phases += [(tool, key, phase["cpu_seconds"], phase.get("seconds")) for key, phase in of_stage.items()]
        rows.append((tool, cpu - drawn if number(cpu) else None, sum(phase.get("seconds", 0) for phase in of_stage.values()), told.get("peak_bytes")))
    finding = sum(row[1] for row in rows if number(row[1]))
    rows.append(("tdpt-render, " + m["integrator"], v.after.get("cpu"), m["with"]["last"].get("seconds"), m["with"]["peak_bytes"]))
    return rows, phases, drawing_time, finding


def page(folder):
    with open(os.path.join(folder, "measured.json"), encoding="utf-8", errors="replace") as stream:
        m = json.load(stream)
    v = Verdict(m)
    a, b, black, last, reference = v.after, v.before, m.get("black") or {}, m["with"]["last"], m["reference"]["last"]
    scene = next((e.get("facts") for e in m["info"] if e.get("kind") == "scene"), None) or {}
    rows, phases, drawing_time, finding = costs(m, v)
    total = sum(row[1] for row in rows if number(row[1]))
    scores = [(what, *(figure(step.get(key), 4, unit) for step in (b, a, black))) for what, key, unit in (
        ("relMSE", "relmse", ""), ("relMSE without the worst 0.1\u202f% of the pixels", "relmse_trimmed", ""), ("PSNR", "psnr", "\u202fdB"),
        ("MAPE", "mape", "\u202f%"), (f"Mean (reference {figure(a.get('reference_mean'), 4)})", "mean", ""), ("CPU seconds", "cpu", ""))]
    things = ("triangles", "emitting_triangles", "lamps", "materials", "images")
    explained = [(s["tool"], *decisions(s["text"])) for s in [*m["stages"], {"tool": "tdpt-render", "text": m["with"]["text"]}]]
    found = "found" if v.stages else "given"
    body = filled(
        "report_scene.html", title=re.sub(r"\.gl(b|tf)$", "", m["scene"]), verdict=v.sentence(), measured=v.measured(),
        contents=f"{figure(scene.get('triangles'), 9)} triangles, {figure(scene.get('emitting_triangles'), 9)} of them emit; "
                 f"{figure(scene.get('lamps'), 9)} lamps without surface",
        facts=facts_of([(len(v.portals), f"portals {found}"),
                        (figure(v.foretold, 2, "\u202f\u00d7"), "efficiency over the best way without, as tdpt-render foretold" +
                         ("" if v.used or not number(v.foretold) else "; not rendered so")),
                        (figure(v.gain, 2, "\u202f\u00d7"), f"efficiency of {m['integrator']} over bdpt without portals, measured"),
                        (figure(finding, 2, "\u202fs") if v.stages else DASH, "CPU time of finding portals")]),
        reference_picture=picture(folder, "reference.png", "The scene as its camera sees it, the reference"),
        reference_samples=count(reference.get("spp"), "sample"),
        scene_table=table(f"What {m['scene']} holds", ("What", "#How many"), [
            *((key.replace("_", " ").capitalize(), figure(scene.get(key), 9)) for key in things),
            ("Cameras", ", ".join(map(str, scene.get("cameras") or [])) or DASH), ("Longest side", figure(scene.get("longest_side_m"), 3, "\u202fm"))]),
        warnings=items(scene.get("warnings") or []), width=last.get("width"), height=last.get("height"),
        path_length="any length" if last.get("max_depth") is None else f"at most {last['max_depth']} edges",
        stages=el("div", list(stage_figures(folder, m)), class_="stages") if v.stages else el(
            "p", "The stages did not run for this page: " + (
                "its portals were drawn by hand or come from elsewhere." if m["given"] else "pictures are made without portals.")),
        portals=portals_table(v), refused=el("ul", items(refused(v))), integrator=m["integrator"],
        candidate_count=count(len(v.candidates), "way"),
        candidates=table("Foretold: error of one sample per pixel, work of a sample, and the time for the same noise over the least",
                         ("Way", "Portals", "#relMSE", "#\u00b5s a sample", "#Time for the same noise"),
                         [(c["integrator"], "yes" if c.get("portals") else "no", figure(c["relmse"], 3), figure(c["work"] / 1000, 3),
                           figure(c["cost"] / v.candidates[0]["cost"], 2)) for c in v.candidates]),
        **{f"{key}_picture": picture(folder, key + ".png", f"The scene {words} portals") for key, words in (("with", "with"), ("without", "without"))},
        **{f"{key}_error": picture(folder, key + "-error.png", f"Difference {key} portals") for key in ("with", "without")},
        **{f"{key}_effort": f"{seconds(step['cpu'])}, {count(step['spp'], 'sample')} per pixel" for key, step in (("with", a), ("without", b))},
        way=v.way, limits=items(limits(m)),
        scores=table("Scores against the reference; all pictures are exposed alike", ("", "#bdpt without portals", "#" + v.way, "#all black"), scores),
        error_chart=error_chart(m),
        points=table("relMSE and PSNR against the same reference", ("#CPU seconds", "Way", "#Samples per pixel", "#relMSE", "#PSNR"),
                     [(figure(s["cpu"], 3), label, figure(s["spp"], 9), figure(s.get("relmse"), 3), figure(s.get("psnr"), 4, "\u202fdB"))
                      for key, label in (("without", "bdpt"), ("with", m["integrator"])) for s in m[key]["steps"]]),
        costs=table("From the scene to its picture", ("Program", "#CPU seconds", "#Share", "#Seconds", "#Memory at most"),
                    [(tool, figure(cpu, 3), percent(cpu / total) if number(cpu) and total else DASH, figure(wall, 3), memory(peak))
                     for tool, cpu, wall, peak in rows]),
        drawing=seconds(drawing_time), pilot=seconds(get(m, "with", "first", "pilot", "cpu")), without_memory=memory(m["without"]["peak_bytes"]),
        reference_memory=memory(m["reference"]["peak_bytes"]),
        phases=table("Phases", ("Stage", "Phase", "#CPU seconds", "#Seconds"), [(t, k, figure(c, 3), figure(s, 3)) for t, k, c, s in phases]),
        decisions=[el("details", el("summary", el("code", tool), f": {count(len(rows), 'decision')}"), el("ul", items(notes)),
                      table(f"What {tool} decided", ("What", "Decision", "Because", "Price"), rows, "stack")) for tool, rows, notes in explained],
        files=table("The files, their content and their seeds", ("File", "Kind", "Hash", "Intact", "Seed"), list(file_rows(m)), "stack"),
        commands="\n".join(m[key]["command"] for key in ("without", "with", "reference")),
        lines="\n".join(dict.fromkeys(str(line) for e in m["info"] for line in e.get("provenance") or [])), version="\n".join(m["version"]))
    return document(f"{m['scene']}: light portals", body, "tdpt.mk(7)")


def file_rows(m):
    for e in m["info"]:
        yield (el("bdi", e.get("file", "")), e.get("kind", DASH), el("code", e.get("hash", DASH), class_="hash"),
               "yes" if e.get("intact") else e.get("failed", "no"), get(e, "facts", "seed") or DASH)


def run(program, make_page, expected):
    """main() of a program that makes such a page of a folder."""
    if len(sys.argv) != 3:
        print(f"usage: {program} FOLDER PAGE", file=sys.stderr)
        return 2
    try:
        made = make_page(sys.argv[1])
        with open(sys.argv[2], "w", encoding="utf-8", errors="replace") as stream:
            stream.write(made)
    except (OSError, ValueError, KeyError) as error:
        print(f"{program}: {sys.argv[1]}: {error!r}, expected what {expected}", file=sys.stderr)
        return 3
    return 0


if __name__ == "__main__":
    sys.exit(run("report_page.py", page, "report_measure.py writes"))
