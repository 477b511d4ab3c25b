"""report_page.py FOLDER PAGE: the page of a scene, from what report_measure.py left in FOLDER.

One file that needs nothing else: pictures are data, the plot is SVG, there is no script. Whatever comes from a file is a
str, which el() escapes; only what el() made is Markup. A figure that is missing is told as missing. Standard library alone.
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
    return value if isinstance(value, Markup) else Markup(html.escape(UNSEEN.sub("\ufffd", str(value)), quote=True))


def el(tag, *children, **attributes):
    """An element. class_ is class, a_b is a-b; None leaves an attribute or a child out; a list is its items."""
    words = "".join(f' {name.rstrip("_").replace("_", "-")}="{html.escape(UNSEEN.sub(chr(0xfffd), str(value)), quote=True)}"'
                    for name, value in attributes.items() if value is not None)
    if tag in VOID:
        return Markup(f"<{tag}{words}>")
    return Markup(f"<{tag}{words}>{join(children)}</{tag}>")


def join(children):
    out = []
    for child in children:
        if isinstance(child, (list, tuple)):
            out.append(join(child))
        elif child is not None:
            out.append(text(child))
    return Markup("".join(out))


# Figures and words.

def number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def figure(value, digits=2, unit=""):
    """Rounded to so many digits that count; a dash where there is none."""
    if not number(value):
        return "\u2013"
    if value == 0:
        return "0" + unit
    if isinstance(value, int) and abs(value) < 10 ** 15 and digits >= 9:
        return f"{value:,}".replace(",", "\u202f") + unit
    size = math.floor(math.log10(abs(value)) + 1e-12)
    if -4 <= size < 6:
        places = max(0, digits - 1 - size)
        shown = f"{round(value, digits - 1 - size):,.{places}f}".replace(",", "\u202f")
    else:
        shown = f"{value / 10 ** size:.{digits - 1}f} \u00d7 10" + str(size).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return shown.replace("-", "\u2212") + unit


def percent(value, digits=2):
    return figure(100 * value, digits if abs(value) < 0.995 else 3, "\u202f%") if number(value) else "\u2013"


def memory(value):
    if not number(value):
        return "\u2013"
    return figure(value / 2 ** 20, 3 if value < 2 ** 30 else 4, "\u202fMiB")


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


def name(value):
    return el("bdi", value)


# Pieces.

def picture(folder, file, alt, **more):
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
    return el("img", src=f"data:image/{kind};base64," + base64.b64encode(data).decode(), alt=alt, width=width, height=height, **more)


def table(caption, head, rows, numeric=(), foot=None, class_=None):
    """The first cell of a row is its heading. numeric: columns that are figures."""
    def cells(row):
        return [el("th" if i == 0 else "td", cell, scope="row" if i == 0 else None, class_="n" if i in numeric else None,
                   data_head=head[i] if i else None) for i, cell in enumerate(row)]
    return el("div", el("table", el("caption", caption),
                        el("thead", el("tr", [el("th", h, scope="col", class_="n" if i in numeric else None)
                                              for i, h in enumerate(head)])),
                        el("tbody", [el("tr", cells(row)) for row in rows]),
                        el("tfoot", el("tr", cells(foot))) if foot else None, class_=class_),
              class_="scroll", tabindex="0", role="region", aria_label=caption)


def section(ident, heading, *children):
    return el("section", el("h2", heading, id=ident + "-h"), *children, id=ident, aria_labelledby=ident + "-h")


def details(summary, *children):
    return el("details", el("summary", summary), *children)


# What was decided: lines "program: what: decision, because reason (price)"; the others are notes.

DECISION = re.compile(r"(.+?): (.+?), because (.*?)(?:(?<!:) \(((?:[^()]|\([^()]*\))*)\))?$")


def decisions(told):
    """-> rows of what, decision, reason and price; the other lines."""
    lines = [line.partition(": ")[2] for line in told.splitlines() if ": " in line]
    rows = [match.groups(default="") for match in map(DECISION.match, lines) if match]
    return rows, [line for line in lines if not DECISION.match(line)]


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


def chart(lines, x, y, heights, said, ident, marks=False, shade=None, level=None, changes=()):
    """A figure for wide windows and one for narrow ones. lines: {label: [[(x, y), ...], ...]}, of which the first is drawn as
    "with" and the second as "without". shade, level: (value, words), an area from below and a line across. changes: (x, words)."""
    keys = [el("span", el("span", class_="key" + (" with" if i == 0 else ""), aria_hidden="true"), label, Markup(" &nbsp; "))
            for i, label in enumerate(lines)]
    return [el("p", keys, class_="note") if len(lines) > 1 else None,
            [drawn(lines, x, y, width, height, f"{said}.", f"{ident}-{kind}", kind, marks, shade, level, changes)
             for width, height, kind in ((760, heights[0], "wide"), (380, heights[1], "narrow"))]]


def drawn(lines, x, y, width, height, said, ident, kind_of_plot, marks, shade, level, changes):
    left, right, top, bottom = 58, width - 14, 22, height - 46

    def px(value):
        return round(left + (right - left) * x.share(value), 1)

    def py(value):
        return round(bottom - (bottom - top) * y.share(value), 1)
    out = []
    if shade:
        out.append(el("rect", x=left, y=py(shade[0]), width=right - left, height=round(bottom - py(shade[0]), 1), class_="own"))
    for tick in x.ticks(width / 60):
        out.append(el("line", class_="grid", x1=px(tick), x2=px(tick), y1=top, y2=bottom))
        out.append(el("text", x.shown(tick), x=px(tick), y=bottom + 18, class_="tick", text_anchor="middle"))
    for tick in y.ticks(6):
        out.append(el("line", class_="grid", x1=left, x2=right, y1=py(tick), y2=py(tick)))
        out.append(el("text", y.shown(tick), x=left - 8, y=py(tick) + 4, class_="tick", text_anchor="end"))
    out.append(el("path", d=f"M{left} {top}V{bottom}H{right}", class_="axis"))
    out.append(el("text", x.words, x=(left + right) / 2, y=height - 8, class_="label", text_anchor="middle"))
    middle = (top + bottom) / 2
    out.append(el("text", y.words, x=14, y=middle, class_="label", text_anchor="middle", transform=f"rotate(-90 14 {middle})"))
    if level:
        out.append(el("line", x1=left, x2=right, y1=py(level[0]), y2=py(level[0]), class_="black"))
        out.append(el("text", level[1], x=left + 6, y=py(level[0]) - 6, class_="remark"))
    if shade:
        out.append(el("text", shade[1], x=left + 6, y=py(shade[0]) + (15 if bottom - py(shade[0]) > 20 else -6), class_="remark"))
    for (value, words), end in zip(changes, [value for value, _ in changes[1:]] + [x.high]):
        if value > x.low:
            out.append(el("line", x1=px(value), x2=px(value), y1=top, y2=bottom, class_="change"))
        if px(end) - px(value) > 7 * len(words):  # else the sentence above tells it
            out.append(el("text", words, x=px(value) + 5, y=top - 6, class_="remark"))
    for runs, kind in zip(lines.values(), ("with", "without")):
        for run in runs:
            out.append(el("polyline", points=" ".join(f"{px(a)},{py(b)}" for a, b in run), class_="line " + kind))
            # A disc and a square, so that no colour is needed to tell them apart.
            for a, b in run if marks or len(run) == 1 else ():
                out.append(el("circle", cx=px(a), cy=py(b), r=4.5, class_="mark " + kind) if kind == "with" else
                           el("rect", x=round(px(a) - 4, 1), y=round(py(b) - 4, 1), width=8, height=8, class_="mark " + kind))
    return el("svg", el("title", said, id=ident), *out, viewBox=f"0 0 {width} {height}", role="img", aria_labelledby=ident,
              class_="plot " + kind_of_plot)


def error_chart(m):
    """The error of both renderings over their time."""
    lines = {label: [sorted((s["cpu"], s["relmse"]) for s in m[key]["steps"] if number(s.get("relmse")) and s["relmse"] > 0 and s["cpu"] > 0)]
             for key, label in (("with", f"{m['integrator']}, portals (discs)"), ("without", "bdpt, no portals (squares, dashed)"))}
    points = [point for (run,) in lines.values() for point in run]
    if not points:
        return el("p", "No error could be measured: there is nothing to draw.", class_="none")
    own, black = (value if number(value) and value > 0 else None
                  for value in (get(m, "reference", "last", "noise", "relmse"), get(m, "black", "relmse")))
    ys = [value for _, value in points] + [value for value in (own, black) if value]
    # Decades cost room where nothing is: the axes end half a step beyond what is drawn.
    x = Axis(min(points)[0] / 1.25, max(points)[0] * 1.25, "CPU seconds")
    said = "; ".join(f"{label}: relMSE {figure(run[-1][1])} after {figure(run[-1][0])} CPU seconds" for label, (run,) in lines.items() if run)
    return chart(lines, x, Axis(min(ys) / 1.6, max(ys) * 1.6, "relMSE"), (420, 340),
                 "Error against time, both axes logarithmic. " + said, "plot", marks=True,
                 shade=(own, "the reference\u2019s own error") if own else None, level=(black, "a black picture") if black else None)


def bar(share, class_="bar"):
    """Beside its figure, so it says nothing that is not said."""
    return el("svg", el("rect", x=0, y=0, width=100, height=8, class_="track"),
              el("rect", x=0, y=0, width=round(100 * max(0.0, min(1.0, share)), 2), height=8, class_="fill"), viewBox="0 0 100 8",
              preserveAspectRatio="none", class_=class_, aria_hidden="true")


# What was found.

class Verdict:
    def __init__(self, m):
        self.m = m
        fit = next((s for s in m["stages"] if s["tool"] == "portalfit"), None)
        self.by_stages = fit is not None
        self.last = m["with"]["last"]
        self.portals = get(self.last, "portals") or []
        self.fitted = {p.get("name"): p for p in get(fit, "json", "portals") or []}
        self.reason = get(fit, "json", "reason") or ""
        self.foretold = get(m["with"], "first", "pilot", "portals_gain")
        self.chosen = self.last.get("chosen") or m["integrator"]
        candidates = get(m["with"], "first", "pilot", "candidates") or []
        self.used = next((bool(c.get("portals")) for c in candidates if c.get("integrator") == self.chosen),
                         not self.chosen.startswith(("pt", "nee", "bdpt")) or (get(self.last, "techniques", "portal") or 0) > 0)
        self.candidates = [c for c in candidates if all(number(c.get(key)) for key in ("relmse", "work", "cost"))]
        plain = [c for c in self.candidates if not c.get("portals")]
        self.best_plain = min(plain, key=lambda c: c["cost"])["integrator"] if plain else None
        a, b = get(m["with"], "steps", -1), get(m["without"], "steps", -1)
        self.after, self.before = a, b
        self.gain = None
        if all(number(s.get("relmse")) and s["relmse"] > 0 and s["cpu"] > 0 for s in (a, b)):
            self.gain = b["relmse"] * b["cpu"] / (a["relmse"] * a["cpu"])

    def sentence(self):
        n = len(self.portals)
        if not n and not self.by_stages and not self.m["given"]:
            return "No portals were given, so none are used."
        if not n:
            why = f": {self.reason}." if self.reason else "."
            said = self.m["integrator"] + " renders as without"
            return ("No portal was found" if self.by_stages else "The files that were given hold no portal") + why + f" {said}."
        found = count(n, "portal was", "portals were") + (" found" if self.by_stages else " given")
        found, they = found[0].upper() + found[1:], "it" if n == 1 else "they"
        if not number(self.foretold):
            return (f"{found}. What {they} {'is' if n == 1 else 'are'} worth was not estimated: {self.m['integrator']} weighed no "
                    "candidates with and without.")
        best = f"the best way without, {self.best_plain}" if self.best_plain else "the best way without"
        if not self.used:
            them = "it" if n == 1 else "them"
            return (f"{found}, but tdpt-render left {them} out: with {them}, it expected {figure(self.foretold)} times the efficiency of {best}" +
                    ("." if self.chosen == self.best_plain else f"; it rendered by {self.chosen}."))
        if self.foretold >= 1.1:
            return f"{found}, worth {figure(self.foretold)} times the efficiency of {best}, as tdpt-render estimated before rendering."
        if self.foretold >= 0.9:
            return f"{found}, and {they} bring next to nothing: {figure(self.foretold)} times the efficiency of {best}, as tdpt-render estimated."
        return (f"{found}, and {they} {'is' if n == 1 else 'are'} worth nothing here: with {'it' if n == 1 else 'them'} tdpt-render expected "
                f"{figure(self.foretold)} times the efficiency of {best}.")

    def measured(self):
        """The same, of the two pictures."""
        if self.gain is None:
            return "The two pictures could not be compared."
        name_with = self.m["integrator"] + (" with " + ("it" if len(self.portals) == 1 else "them") if self.portals and self.used else "")
        if self.m["integrator"] == "auto" and self.chosen != "auto" and not self.used:
            name_with = f"auto ({self.chosen})"
        if self.gain >= 1.1:
            words = f"Measured in equal time, {name_with} was {figure(self.gain)} times as efficient as bdpt without"
        elif self.gain >= 0.9:
            words = f"Measured in equal time, {name_with} and bdpt without portals did not differ by more than one pair of pictures can tell"
        else:
            words = f"Measured in equal time, {name_with} had {figure(self.gain)} of the efficiency of bdpt without"
        if self.gain >= 1.1 or self.gain < 0.9:
            words += " portals (relMSE)"
        db = get(self.after, "psnr"), get(self.before, "psnr")
        if all(number(v) for v in db):
            difference = db[0] - db[1]
            words += (f"; its PSNR is {figure(abs(difference))}\u202fdB {'higher' if difference > 0 else 'lower'}" if abs(difference) >= 0.05
                      else "; their PSNR is the same")
        return words + "."


def limits(m, v):
    """Why the figures may be wrong, each in a sentence."""
    out, noise = [], get(m, "reference", "last", "noise") or {}
    spp = get(m, "reference", "last", "spp")
    ref = m["reference"]["last"]
    head = (f"The reference has {count(spp, 'sample')} per pixel, {figure(m['factor'])} times those of the longer picture with portals, "
            f"and another seed ({m['seed'] + 1}); it took {figure(ref.get('cpu_seconds'), 3)} CPU seconds. ")
    if number(noise.get("relmse")):
        interval = noise.get("interval") or []
        between = f" ({figure(interval[0])} to {figure(interval[1])})" if len(interval) == 2 and all(map(number, interval)) else ""
        head += f"By its own samples its relMSE is about {figure(noise['relmse'])}{between}, which counts in every score here."
    else:
        head += "Its own error cannot be told from so few samples; it counts in every score here."
    out.append(head)
    for key, label in (("with", m["integrator"]), ("without", "bdpt")):
        step = m[key]["steps"][-1]
        if number(noise.get("relmse")) and number(step.get("relmse")) and step["relmse"] < 3 * noise["relmse"]:
            out.append(f"The score of {label}, {figure(step['relmse'])}, is not far above the reference\u2019s own error: it is better than it looks.")
        if number(step.get("mean")) and number(step.get("reference_mean")) and step["reference_mean"] > 0:
            off = step["mean"] / step["reference_mean"] - 1
            if abs(off) > 0.05:
                out.append(f"The mean of {label} is {percent(abs(off))} {'above' if off > 0 else 'below'} the reference\u2019s: one of the two has "
                           "not met all of the light.")
        dark = get(m, "black", "relmse")
        if number(dark) and number(step.get("relmse")) and step["relmse"] > 0.5 * dark:
            out.append(f"A black picture scores {figure(dark)}: by relMSE, {label} ({figure(step['relmse'])}) "
                       + ("is no better than that" if step["relmse"] >= dark else "is little better than that") + ". PSNR is beside it for that reason.")
        if number(step.get("relmse_trimmed")) and number(step.get("relmse")) and step["relmse"] > 3 * step["relmse_trimmed"]:
            out.append(f"Of the error of {label}, {percent(1 - step['relmse_trimmed'] / step['relmse'])} lies in a thousandth of the pixels: "
                       "with another seed its relMSE may be another.")
    a, b = v.after["cpu"], v.before["cpu"]
    if max(a, b) > 1.15 * min(a, b):
        out.append(f"The times differ, {figure(a, 3)} and {figure(b, 3)} CPU seconds: a pass over the picture is not divided. "
                   "Efficiency, 1 / (relMSE \u00d7 time), allows for that.")
    out.append("One picture each, of one seed; the reference is of the same program, so what all its integrators had wrong in common would "
               "not show.")
    return out


STAGE_TEXT = {
    "ffgraph": ("Who reaches what", "The scene by its camera and in plan: amber where walks from the light came, blue where the "
                "camera\u2019s came, violet both",
                "Amber is the light\u2019s, blue the camera\u2019s, violet of both. Two rooms of one colour each are what a bottleneck looks like."),
    "mincut": ("Where transport is narrowest", "The two sides of the minimum cut, and lines between the patches that face each other across it",
               "The border between the colours is the cut; the lines are pairs of patches that exchange light across it."),
    "lightgrid": ("Where the light passes through the air", "Counts of lines of light in the air, from above, from the front and from the right",
                  "Each pixel is the fullest voxel behind it; the ring marks the fullest of all."),
    "portalfit": ("The portals in plan", "The plan of each storey, with the portals, and the camera with what it sees",
                  "Cut at eye height: walls are dark, panes blue. Green are the portals, each with the way of the "
                  "light; grey is what was refused, with the reason below.")}


def document(title, body, foot, style=""):
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "report.html"), encoding="utf-8") as stream:
        return string.Template(stream.read()).substitute(title=text(title), body=body, foot=text(foot), style=style)


def scene_part(folder, m, v):
    facts = next((e.get("facts") for e in m["info"] if e.get("kind") == "scene"), None) or {}
    cameras = facts.get("cameras")
    shown = m["with"]["last"]
    rows = [("Triangles", figure(facts.get("triangles"), 9)),
            ("Cameras", join([[", " if i else "", name(c)] for i, c in enumerate(cameras)]) if cameras else "\u2013"),
            ("Triangles that emit", figure(facts.get("emitting_triangles"), 9)), ("Lamps without surface", figure(facts.get("lamps"), 9)),
            ("Materials", figure(facts.get("materials"), 9)), ("Images", figure(facts.get("images"), 9)),
            ("Longest side", figure(facts.get("longest_side_m"), 3, "\u202fm"))]
    sky = get(m, "sky")
    if sky:
        rows.append(("Sky", sky))
    return section("scene", "The scene", table(f"What {m['scene']} holds", ("What", "How many"), rows),
                   el("ul", [el("li", w) for w in facts["warnings"]]) if facts.get("warnings") else None,
                   el("p", f"All pictures here are {shown.get('width')} \u00d7 {shown.get('height')} pixels, paths of "
                      + ("any length." if shown.get("max_depth") is None else f"at most {shown['max_depth']} edges."), class_="note"))


def stages_part(folder, m, v):
    out = []
    for stage in m["stages"]:
        heading, alt, how = STAGE_TEXT[stage["tool"]]
        _, notes = decisions(stage["text"])
        body = picture(folder, stage["picture"], f"{stage['tool']}: {alt}") if stage["picture"] else el(
            "p", f"Not drawn: {stage['missing'] or 'there is no picture'}.", class_="none")
        out.append(el("figure", el("h3", el("code", stage["tool"]), " \u00b7 ", heading), body,
                      el("figcaption", how, [el("br"), el("span", notes[0], class_="said")] if notes else None), class_="picture wide" if stage["tool"] == "portalfit" else "picture"))
    if not out:
        out = [el("p", "The stages did not run for this page: " + (
            "its portals were drawn by hand or come from elsewhere." if m["given"] else "pictures are made without portals."))]
    return section("stages", "How portals were looked for", el("div", out, class_="stages") if m["stages"] else out)


def portals_part(m, v):
    rows = []
    for p in v.portals:
        f = dict(v.fitted.get(p.get("name")) or {})
        f.update({k: value for k, value in p.items() if value is not None})
        # What a portal drawn by hand has no figures for is left open.
        rows.append((name(p.get("name", "")), figure(f.get("area"), 3), figure(f.get("conductance")),
                     figure(f.get("tightness")), percent(f.get("support"), 3), figure(f.get("direction_angle"), 2, "\u00b0"),
                     percent(f.get("energy"), 3)))
    refused = get(next((s for s in m["stages"] if s["tool"] == "portalfit"), None), "json", "refused") or []
    cuts = get(next((s for s in m["stages"] if s["tool"] == "mincut"), None), "json", "refused") or []
    body = []
    if rows:
        body.append(table("The portals. By segments: share of the "
                          "picture\u2019s light that paths begun in the portal brought", ("Portal", "Area [m\u00b2]",
                          "Conduct\u00adance", "Tight\u00adness", "Support", "Normal off by", "By segments"), rows,
                          numeric=range(1, 7), class_="stack"))
        drawbacks = [el("li", name(n), f": {f['drawback']}.") for n, f in v.fitted.items() if f.get("drawback")]
        body.append(el("ul", drawbacks) if drawbacks else None)
        lead = f"Foretold by tdpt-render: {figure(v.foretold)} times the efficiency of {v.best_plain or 'the best way'} without, "\
            if number(v.foretold) else "What they are worth was not foretold, "
        body.append(el("p", lead + ("for this portal." if len(rows) == 1 else "for all portals together; what each alone is worth was not measured."),
                       None if v.used else " The portals were left out of the rendering, so no light came by their segments."))
    else:
        body.append(el("p", "There is no portal to list" + (f": {v.reason}." if v.reason else ".")))
    if refused or cuts:
        body.append(el("h3", "What was refused"))
        body.append(el("ul", [el("li", "A candidate for a portal: ", r.get("why") or r.get("reason") or json.dumps(r)) for r in refused if isinstance(r, dict)],
                       [el("li", f"A cut with {percent(c.get('light_side'))} of the surface on the light\u2019s side: {c.get('why', 'no reason is told')}.")
                        for c in cuts if isinstance(c, dict)]))
    if v.candidates:
        least = min(c["cost"] for c in v.candidates)
        order = sorted(v.candidates, key=lambda c: c["cost"])
        body.append(details(f"What {m['integrator']} weighed: {count(len(order), 'way')} to render",
                            table(f"Foretold from {get(m, 'with', 'first', 'pilot', 'samples')} samples: error of one sample per pixel, "
                                  "work of a sample, and the time for the same noise over the least",
                                  ("Way", "Portals", "relMSE", "\u00b5s a sample", "Time for the same noise"),
                                  [(c["integrator"], "yes" if c.get("portals") else "no", figure(c["relmse"], 3), figure(c["work"] / 1000, 3),
                                    figure(c["cost"] / least, 2)) for c in order], numeric=(2, 3, 4))))
    return section("portals", "The portals and their worth", *body)


def compare_part(folder, m, v):
    a, b, black = v.after, v.before, m.get("black") or {}
    label = m["integrator"] + (f", which took {v.chosen}" if v.chosen != m["integrator"] else "")

    def shown(key, step, words):
        return el("figure", picture(folder, key + ".png", words), el("figcaption", el("span", class_="key " + key, aria_hidden="true"),
                  el("strong", "bdpt, without portals" if key == "without" else label + (", with portals" if v.used and v.portals else "")),
                  f". {figure(step['cpu'], 3)} CPU seconds, {count(step['spp'], 'sample')} per pixel."), class_="picture")

    def error(key, words):
        return el("figure", picture(folder, key + "-error.png", words), el("figcaption", "Its difference from the reference: red too bright, "
                  "blue too dark, full where as large as the reference itself."), class_="picture")
    rows = []
    for title, digits, key, unit in (("relMSE", 3, "relmse", ""), ("relMSE without the worst 0.1\u202f% of the pixels", 3, "relmse_trimmed", ""),
                                     ("PSNR", 4, "psnr", "\u202fdB"), ("MAPE", 3, "mape", "\u202f%")):
        rows.append((title, figure(b.get(key), digits, unit), figure(a.get(key), digits, unit), figure(black.get(key), digits, unit)))
    rows.append(("Mean (reference " + figure(a.get("reference_mean"), 4) + ")", figure(b.get("mean"), 4), figure(a.get("mean"), 4), "0"))
    rows.append(("Samples per pixel", figure(b["spp"], 9), figure(a["spp"], 9), "\u2013"))
    rows.append(("CPU seconds", figure(b["cpu"], 3), figure(a["cpu"], 3), "\u2013"))
    return section("pictures", "Before and after, in equal time", el("p", v.measured()),
                   el("div", shown("without", b, "The scene by bdpt without portals"), shown("with", a, "The scene by " + label), class_="pair"),
                   el("div", error("without", "Difference of bdpt from the reference"), error("with", f"Difference of {m['integrator']} from the reference"),
                      class_="pair"),
                   table("Scores against the reference; all pictures are exposed alike", ("", "bdpt, no portals", m["integrator"] +
                         (", portals" if v.used and v.portals else ""), "all black"), rows, numeric=(1, 2, 3)),
                   el("ul", [el("li", line) for line in limits(m, v)], class_="limits"))


def time_part(m, v):
    steps = [(figure(s["cpu"], 3), label, figure(s["spp"], 9), figure(s.get("relmse"), 3), figure(s.get("psnr"), 4, "\u202fdB"))
             for key, label in (("without", "bdpt, no portals"), ("with", m["integrator"] + ", portals")) for s in m[key]["steps"]]
    words = "Both axes are logarithmic; an unbiased renderer\u2019s error falls as 1 / time, a straight line. "
    if v.gain and v.gain > 1.1:
        words += f"If that holds on, bdpt would need about {figure(v.gain * v.after['cpu'])} CPU seconds for what took {figure(v.after['cpu'])}."
    return section("error", "Error over time",
                   el("figure", error_chart(m),
                      el("figcaption", words + " The shaded ground is what the reference\u2019s own error hides, as it estimates it." )),
                   details("The points of the plot", table("relMSE and PSNR against the same reference", ("CPU seconds", "Way", "Samples per pixel",
                           "relMSE", "PSNR"), steps, numeric=(0, 2, 3, 4))))


def cost_part(m, v):
    rows, phases, total, drawn = [], [], 0.0, 0.0
    for stage in m["stages"]:
        told = stage["json"] or {}
        cpu = told.get("cpu_seconds")
        pictures = get(told, "phases", "pictures", "cpu_seconds") or 0
        rows.append([stage["tool"], cpu - pictures if number(cpu) else None, sum(p.get("seconds", 0) for k, p in (told.get("phases") or {}).items() if
                     k != "pictures") if told.get("phases") else None, told.get("peak_bytes")])
        drawn += pictures
        for key, p in (told.get("phases") or {}).items():
            if isinstance(p, dict) and number(p.get("cpu_seconds")):
                phases.append((stage["tool"], key, p["cpu_seconds"], p.get("seconds")))
    last = m["with"]["last"]
    rows.append(["tdpt-render, " + m["integrator"], v.after.get("cpu"), last.get("seconds"), m["with"]["peak_bytes"]])
    total = sum(r[1] for r in rows if number(r[1]))
    shown = [(r[0], figure(r[1], 3), percent(r[1] / total, 3) if number(r[1]) and total else "\u2013", bar(r[1] / total) if number(r[1]) and total else "",
              figure(r[2], 3), memory(r[3])) for r in rows]
    found = sum(r[1] for r in rows[:-1] if number(r[1]))
    words = []
    if m["stages"] and number(found):
        words.append(f"Finding portals took {figure(found)} CPU seconds, once for every picture of this scene.")
    if v.gain and v.gain > 1.1 and v.portals and v.used and m["stages"]:
        words.append(f"One picture as good as the one with portals would take bdpt about {figure(v.gain * v.after['cpu'])} CPU seconds; with portals, "
                     f"finding them included, it took {figure(found + v.after['cpu'])}.")
    if drawn:
        words.append(f"The pictures of the stages, made for this page alone, took {figure(drawn)} CPU seconds more, not counted above.")
    words.append(f"The pilot of {m['integrator']}, counted in its rendering, took "
                 f"{figure(get(m, 'with', 'first', 'pilot', 'cpu'))} CPU seconds." if number(get(m, "with", "first", "pilot", "cpu")) else
                 "What the decision of the renderer cost is not told.")
    words.append(f"bdpt took {memory(m['without']['peak_bytes'])}, the reference {memory(m['reference']['peak_bytes'])}. The renderer\u2019s memory is that of "
                 "its process; that of the stages is their own word.")
    return section("cost", "Where time and memory went",
                   table("From the scene to its picture", ("Program", "CPU seconds", "Share", "", "Seconds", "Memory at most"), shown, numeric=(1, 2, 4, 5),
                         foot=("All", figure(total, 3), percent(1.0, 3), "", "", "")),
                   [el("p", w) for w in words],
                   details("Phases of the stages", table("Phases, in the order of their names where a stage tells no other",
                           ("Stage", "Phase", "CPU seconds", "Share of all", "Seconds"),
                           [(t, k, figure(c, 3), percent(c / total) if total else "\u2013", figure(s, 3)) for t, k, c, s in phases], numeric=(2, 3, 4)))
                   if phases else el("p", "No stage told of its phases.", class_="none"))


def decisions_part(m, v):
    out = []
    for tool, told in [(s["tool"], s["text"]) for s in m["stages"]] + [("tdpt-render", m["with"]["text"])]:
        rows, notes = decisions(told)
        if not rows and not notes:
            out.append(el("p", el("code", tool), ": nothing is told.", class_="none"))
            continue
        out.append(details(join([el("code", tool), f": {count(len(rows), 'decision')}"]), el("ul", [el("li", n) for n in notes]) if notes else None,
                           table(f"What {tool} decided", ("What", "Decision", "Because", "Price"), rows, class_="stack") if rows else None))
    return section("decisions", "Decisions and their reasons",
                   el("p", "Each program\u2019s own words (--explain). Of the rendering with portals, those of its first quarter, "
                      "which hold for all of its time, then what it did to the end."), out)


def provenance_part(m, v):
    rows = []
    for e in m["info"]:
        facts = e.get("facts") or {}
        seed = get(facts, "seed")
        rows.append((name(e.get("file", "")), e.get("kind", "\u2013"), el("code", e["hash"], class_="hash") if e.get("hash") else "\u2013",
                     ("yes" if e["intact"] else "no") if "intact" in e else (e.get("failed") or "not told"), seed if seed is not None else "\u2013"))
    lines = []
    for e in m["info"]:
        for line in e.get("provenance") or []:
            if line not in lines:
                lines.append(line)
    return section("provenance", "Where it comes from",
                   table("The files, their content and their seeds", ("File", "Kind", "Hash", "Intact", "Seed"), rows, class_="stack"),
                   el("h3", "Commands of the three renderings"), el("pre", "\n".join(m[k]["command"] for k in ("without", "with", "reference"))),
                   el("p", "The first two went on from their own checkpoints with --add-samples, from a quarter of their time on; the reference with --spp "
                      f"{get(m, 'reference', 'last', 'spp')}.", class_="note"),
                   details("Every step, as the files tell it", el("pre", "\n".join(lines) or "No file tells of its making.")),
                   details("Versions", el("pre", "\n".join(m["version"]) or "Not told.")))


def page(folder):
    with open(os.path.join(folder, "measured.json"), encoding="utf-8", errors="replace") as stream:
        m = json.load(stream)
    v = Verdict(m)
    facts = next((e.get("facts") for e in m["info"] if e.get("kind") == "scene"), None) or {}
    title = re.sub(r"\.gl(b|tf)$", "", m["scene"])
    light = [count(facts["emitting_triangles"], "emitting triangle")] if facts.get("emitting_triangles") else []
    light += [count(facts["lamps"], "lamp") + " without surface"] if facts.get("lamps") else []
    cameras = facts.get("cameras")
    what = ", ".join([count(facts["triangles"], "triangle").replace(str(facts["triangles"]), figure(facts["triangles"], 9), 1)] if number(facts.get("triangles")) else []) or "a scene"
    what = join([what, ", ", count(len(cameras), "camera") if isinstance(cameras, list) else "cameras not told", ", ", " and ".join(light) or "no lamp"])
    cost = sum(get(s, "json", "cpu_seconds") - (get(s, "json", "phases", "pictures", "cpu_seconds") or 0) for s in m["stages"]
               if number(get(s, "json", "cpu_seconds")))
    keys = [(str(len(v.portals)), ("portal" if len(v.portals) == 1 else "portals") + (" found" if v.by_stages else " given")),
            (figure(v.foretold, 2, "\u202f\u00d7") if number(v.foretold) else "\u2013",
             ("efficiency over the best way without, as tdpt-render foretold" + ("" if v.used else "; not rendered so"))
             if number(v.foretold) else "efficiency over the best way without: not foretold"),
            (figure(v.gain, 2, "\u202f\u00d7"), f"efficiency of {m['integrator']} over bdpt without portals, measured"),
            (figure(cost, 2, "\u202fs") if m["stages"] else "\u2013", "CPU time of finding portals" if m["stages"] else "portals were not looked for")]
    parts = (("scene", "Scene"), ("stages", "Stages"), ("portals", "Portals"), ("pictures", "Before and after"), ("error", "Error over time"),
             ("cost", "Time and memory"), ("decisions", "Decisions"), ("provenance", "Provenance"))
    body = el("main",
              el("header", el("div", el("div", el("p", "Light portals: a report", class_="eyebrow"), el("h1", name(title)),
                                        el("p", v.sentence(), class_="verdict"), el("p", v.measured()), el("p", what, ".", class_="note")),
                              el("figure", picture(folder, "reference.png", f"{title} as its camera sees it, the reference"),
                                 el("figcaption", "What the camera sees: the reference, "
                                    f"{count(get(m, 'reference', 'last', 'spp'), 'sample')} per pixel."), class_="picture"), class_="hero"),
                 el("dl", [el("div", el("dt", k), el("dd", f)) for f, k in keys], class_="facts"),
                 el("nav", el("ul", [el("li", el("a", label, href="#" + ident)) for ident, label in parts]), aria_label="Sections")),
              scene_part(folder, m, v), stages_part(folder, m, v), portals_part(m, v), compare_part(folder, m, v), time_part(m, v), cost_part(m, v),
              decisions_part(m, v), provenance_part(m, v))
    return document(f"{title}: light portals", body, "Made by tdpt.mk(7). Figures that were not measured are a dash.")


def run(program, page, expected):
    """main() of a program that makes such a page of a folder."""
    if len(sys.argv) != 3:
        print(f"usage: {program} FOLDER PAGE", file=sys.stderr)
        return 2
    try:
        made = page(sys.argv[1])
        with open(sys.argv[2], "w", encoding="utf-8", errors="replace") as stream:
            stream.write(made)
    except (OSError, ValueError, KeyError) as error:
        print(f"{program}: {sys.argv[1]}: {error!r}, expected what {expected}", file=sys.stderr)
        return 3
    return 0


if __name__ == "__main__":
    sys.exit(run("report_page.py", page, "report_measure.py writes"))
