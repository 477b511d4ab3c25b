"""The page of a scene, from what report_measure.py left in a folder.

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


def count(n, one, many=None):
    return f"{n} {one if n == 1 else many or one + 's'}"


def get(value, *path):
    for key in path:
        value = value.get(key) if isinstance(value, dict) else None
    return value


# Pieces.

def picture(folder, file, alt):
    """An image as data, with its size so that nothing jumps; a sentence where it is not there."""
    try:
        with open(os.path.join(folder, file), "rb") as stream:
            data = stream.read()
        kind, width, height = "svg+xml", None, None
        if file.endswith(".png"):
            kind, (width, height) = "png", struct.unpack(">II", data[16:24])
    except (OSError, struct.error):
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


# Charts.

class Axis:
    """A logarithmic one: its ends, its ticks, and where a value lies between the ends."""

    def __init__(self, low, high, words):
        self.low, self.high, self.words = low, high, words

    def share(self, value):
        return math.log(value / self.low) / math.log(self.high / self.low)

    def ticks(self):
        """Powers of ten, and where these are few twice and five times these, or all digits."""
        exponents = range(math.floor(math.log10(self.low)), math.ceil(math.log10(self.high)) + 1)
        decades = math.log10(self.high / self.low)
        digits = (1,) if decades > 3 else (1, 2, 5) if decades > 1 else range(1, 10)
        return [m * 10.0 ** e for e in exponents for m in digits if self.low <= m * 10.0 ** e <= self.high]


def chart(lines, x, y, title, levels):
    """lines: {label: [(x, y), ...]}, of which the first is drawn as "with" and the second as "without". levels: (y, words),
    lines across."""
    keys = [(el("span", class_="key" + (" with" if i == 0 else ""), aria_hidden="true"), label, " \u00a0 ") for i, label in enumerate(lines)]
    size, out = (480, 340), []
    left, right, top, bottom = 58, size[0] - 14, 22, size[1] - 46

    def px(value):
        return round(left + (right - left) * x.share(value), 1)

    def py(value):
        return round(bottom - (bottom - top) * y.share(value), 1)

    def line(class_, *ends):
        out.append(el("line", class_=class_, **dict(zip(("x1", "y1", "x2", "y2"), ends))))

    def words(value, class_, at, anchor="start", **more):
        out.append(el("text", value, class_=class_, x=at[0], y=at[1], text_anchor=anchor, **more))
    for tick in x.ticks():
        line("grid", px(tick), top, px(tick), bottom)
        words(figure(tick, 1), "tick", (px(tick), bottom + 18), "middle")
    for tick in y.ticks():
        line("grid", left, py(tick), right, py(tick))
        words(figure(tick, 1), "tick", (left - 8, py(tick) + 4), "end")
    out.append(el("path", d=f"M{left} {top}V{bottom}H{right}", class_="axis"))
    words(x.words, "label", ((left + right) / 2, size[1] - 8), "middle")
    middle = (top + bottom) / 2
    words(y.words, "label", (14, middle), "middle", transform=f"rotate(-90 14 {middle})")
    for value, said in levels:
        line("black", left, py(value), right, py(value))
        words(said, "remark", (left + 6, py(value) - 6))
    for points, kind in zip(lines.values(), ("with", "without")):
        out.append(el("polyline", points=" ".join(f"{px(a)},{py(b)}" for a, b in points), class_="line " + kind))
        # A disc and a square, so that no colour is needed to tell them apart.
        for a, b in points:
            out.append(el("circle", cx=px(a), cy=py(b), r=4, class_="mark " + kind) if kind == "with" else
                       el("rect", x=px(a) - 4, y=py(b) - 4, width=8, height=8, class_="mark " + kind))
    return [el("p", keys, class_="note"),
            el("svg", el("title", title), out, viewBox="0 0 {} {}".format(*size), role="img", aria_label=title, class_="plot")]


def error_chart(m):
    """The error of both renderings over their time."""
    lines = {label: sorted((s["cpu"], s["relmse"]) for s in m[key]["steps"] if number(s.get("relmse")) and s["relmse"] > 0 and s["cpu"] > 0)
             for key, label in (("with", f"{m['integrator']}, portals (discs)"), ("without", "bdpt, no portals (squares, dashed)"))}
    points = sum(lines.values(), [])
    if not points:
        return el("p", "No error could be measured: there is nothing to draw.", class_="none")
    levels = [(value, words) for value, words in ((get(m, "reference", "last", "noise", "relmse"), "the reference\u2019s own error"),
                                                  (get(m, "black", "relmse"), "a black picture")) if number(value) and value > 0]
    ys = [value for _, value in points] + [value for value, _ in levels]
    # Decades cost room where nothing is: the axes end half a step beyond what is drawn.
    x = Axis(min(points)[0] / 1.25, max(points)[0] * 1.25, "CPU seconds")
    return chart(lines, x, Axis(min(ys) / 1.6, max(ys) * 1.6, "relMSE"), "Error against time", levels)


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
        candidates = [c for c in get(pilot, "candidates") or [] if isinstance(c, dict) and number(c.get("cost"))]
        self.used = next((bool(c.get("portals")) for c in candidates if c.get("integrator") == self.chosen),
                         not self.chosen.startswith(("pt", "nee", "bdpt")) or (get(last, "techniques", "portal") or 0) > 0)
        plain = min((c for c in candidates if not c.get("portals")), key=lambda c: c["cost"], default=None)
        self.best_plain = f", {plain['integrator']}" if plain else ""
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
    noise = get(m, "reference", "last", "noise", "relmse")
    for key, label in (("with", m["integrator"]), ("without", "bdpt")):
        score, trimmed, mean, expected = (m[key]["steps"][-1].get(k) for k in ("relmse", "relmse_trimmed", "mean", "reference_mean"))
        if number(noise) and number(score) and score < 3 * noise:
            yield f"The score of {label}, {figure(score)}, is not far above the reference\u2019s own error: it is better than it looks."
        if number(mean) and number(expected) and expected > 0 and abs(mean / expected - 1) > 0.05:
            yield f"The mean of {label} is not that of the reference: one of the two has not met all of the light."
        if number(trimmed) and number(score) and score > 3 * trimmed:
            yield f"Most of the error of {label} lies in a thousandth of the pixels: with another seed it may be another."


def sentences_of(explained):
    """Lines "program: words" of --explain: (notes, decisions)."""
    lines = [line.partition(": ")[2] for line in explained.splitlines() if ": " in line]
    return [line for line in lines if ", because " not in line], [line for line in lines if ", because " in line]


def stages_of(folder, m):
    """Their pictures, and the first note of each."""
    values = {}
    for stage in m["stages"]:
        missing = el("p", f"Not drawn: {stage['missing']}.", class_="none")
        values[stage["tool"]] = picture(folder, stage["picture"], stage["tool"]) if stage["picture"] else missing
        values[stage["tool"] + "_note"] = sentences_of(stage["text"])[0][:1]
    if values:
        return filled("report_stages.html", **values)
    return el("p", "The stages did not run for this page: " + (
        "its portals were drawn by hand or come from elsewhere." if m["given"] else "pictures are made without portals."))


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


def page(folder):
    with open(os.path.join(folder, "measured.json"), encoding="utf-8", errors="replace") as stream:
        m = json.load(stream)
    v = Verdict(m)
    last, reference = m["with"]["last"], m["reference"]["last"]
    scene = next((e.get("facts") for e in m["info"] if e.get("kind") == "scene"), None) or {}
    finding = [stage["json"]["cpu_seconds"] for stage in m["stages"] if number(get(stage, "json", "cpu_seconds"))]
    explained = [(s["tool"], *sentences_of(s["text"])) for s in [*m["stages"], {"tool": "tdpt-render", "text": m["with"]["text"]}]]
    files = [(el("bdi", e.get("file", "")), e.get("kind", DASH), el("code", e.get("hash", DASH), class_="hash"),
              "yes" if e.get("intact") else e.get("failed", "no"), get(e, "facts", "seed") or DASH) for e in m["info"]]
    body = filled(
        "report_scene.html", title=re.sub(r"\.gl(b|tf)$", "", m["scene"]), verdict=v.sentence(), measured=v.measured(),
        number=len(v.portals), foretold=figure(v.foretold, 2, "\u202f\u00d7"), gain=figure(v.gain, 2, "\u202f\u00d7"),
        finding=figure(sum(finding), 2, "\u202fs") if finding else DASH, integrator=m["integrator"], way=v.way,
        **{key: figure(scene.get(key), 9) for key in ("triangles", "emitting_triangles", "lamps", "materials", "images")},
        cameras=", ".join(map(str, scene.get("cameras") or [])) or DASH, longest_side=figure(scene.get("longest_side_m"), 3, "\u202fm"),
        warnings=items(scene.get("warnings") or []), width=last.get("width"), height=last.get("height"),
        path_length="any length" if last.get("max_depth") is None else f"at most {last['max_depth']} edges",
        stages=stages_of(folder, m), portals=portals_table(v), refused=items(refused(v)),
        **{f"{key}_picture": picture(folder, key + ".png", f"The scene {key} portals") for key in ("with", "without", "reference")},
        **{f"{key}_error": picture(folder, key + "-error.png", f"Difference {key} portals") for key in ("with", "without")},
        **{f"{key}_effort": f"{figure(step['cpu'], 3)} CPU seconds, {count(step['spp'], 'sample')} per pixel" for key, step in (("with", v.after), ("without", v.before))},
        reference_samples=count(reference.get("spp"), "sample"), factor=figure(m["factor"]), noise=figure(get(reference, "noise", "relmse")),
        reference_mean=figure(v.after.get("reference_mean"), 4), limits=items(limits(m)),
        **{f"{way}_{key}": figure(step.get(key), 4) for way, step in (("with", v.after), ("without", v.before), ("black", m.get("black") or {}))
           for key in ("relmse", "relmse_trimmed", "psnr", "mape", "mean", "cpu")},
        error_chart=error_chart(m),
        decisions=[el("details", el("summary", el("code", tool), f": {count(len(decided), 'decision')}"), el("ul", items(notes + decided)))
                   for tool, notes, decided in explained],
        files=table("The files, their content and their seeds", ("File", "Kind", "Hash", "Intact", "Seed"), files, "stack"),
        commands="\n".join(m[key]["command"] for key in ("without", "with", "reference")),
        lines="\n".join(dict.fromkeys(str(line) for e in m["info"] for line in e.get("provenance") or [])), version="\n".join(m["version"]))
    return filled("report.html", title=f"{m['scene']}: light portals", body=body)
