"""report_shot.py FOLDER PAGE: the page of a shot, from what tdpt gathered in FOLDER.

A flip-book, the frames as a strip, and what their statistics tell over time: noise, the way that renders, light through
portals. Frames that were there before have no statistics, and no figures. No script, and nothing from outside, as in
report_page.py. Standard library alone.
"""

import base64
import json
import os
import re
import sys

from report_page import Axis, chart, count, details, document, el, figure, get, name, number, percent, run, section, table

def known(value):
    """A figure that can be drawn, or nothing: files may hold anything."""
    try:
        return value if number(value) and (value == 0 or 1e-30 < value < 1e30) else None
    except OverflowError:
        return None


class Frame:
    """What the statistics of one frame tell; `told` is empty where there are none."""

    def __init__(self, frame, told):
        self.number, self.told = frame, told if isinstance(told, dict) else {}
        way = get(self.told, "chosen") or get(self.told, "integrator")
        self.way = way if isinstance(way, str) else None
        self.noise = known(get(self.told, "noise", "relmse"))
        self.filtered, self.cpu = known(get(self.told, "filtered", "relmse")), known(get(self.told, "cpu_seconds"))
        self.spp, self.width, self.height = (known(get(self.told, key)) for key in ("spp", "width", "height"))
        portals = get(self.told, "portals")
        self.portals = [p for p in portals if isinstance(p, dict) and isinstance(p.get("name"), str)] if isinstance(portals, list) else []
        self.by_segments = known(get(self.told, "techniques", "portal"))


def spans(frames):
    """[(first, last, way)] of frames one after the other that have the same."""
    out = []
    for f in frames:
        if out and out[-1][2] == f.way:
            out[-1] = out[-1][0], f.number, f.way
        else:
            out.append((f.number, f.number, f.way))
    return out


def span_words(first, last):
    return f"frame {first}" if first == last else f"frames {first}\u2013{last}"


def over_time(frames, values, title, unit, logarithmic, ident, changes):
    """values: {label: {frame: value}}, drawn over the frames' numbers; gaps where there are none."""
    values = {label: {k: v for k, v in of.items() if number(v) and (v > 0 or not logarithmic)} for label, of in values.items()}
    every = [v for of in values.values() for v in of.values()]
    if not every:
        return el("p", "No frame has statistics that tell it.", class_="none")
    said = "; ".join(f"{label}: {figure(min(of.values()))} to {figure(max(of.values()))}" for label, of in values.items() if of)
    low, high = (min(every) / 1.3, max(every) * 1.3) if logarithmic else (0.0, max(max(every) * 1.1, 1e-9))
    y = Axis(low, high, "", logarithmic, percent if unit == "%" else lambda value: figure(value, 1))
    x = Axis(frames[0].number, frames[-1].number, "frame", False, lambda value: f"{value:g}")
    lines = {label: [[(k, of[k]) for k in run] for run in runs_of(sorted(of))] for label, of in values.items()}
    between = [(frame - 0.5 if frame > x.low else frame, words) for frame, words in changes]
    return el("figure", chart(lines, x, y, (300, 260), f"{title}. {said}", ident, changes=between))


def light_over_time(told):
    """{name: {frame: share of the light}} of the two portals that brought most, where they are the same in all frames;
    else of all portals together. Empty: none brought any."""
    places = {(p["name"], known(p.get("area"))) for f in told for p in f.portals}
    light = {"all portals": {f.number: f.by_segments for f in told if f.by_segments is not None}}
    if len(places) == len({label for label, _ in places}):
        light = {label: {f.number: known(p.get("energy")) for f in told for p in f.portals if p["name"] == label} for label, _ in places}
    most = {label: max((v for v in of.values() if v is not None), default=0) for label, of in light.items()}
    return {label: light[label] for label in sorted(light, key=lambda label: (-most[label], label))[:2] if most[label] > 0}


def runs_of(numbers):
    """Numbers in order -> those one after the other."""
    runs = []
    for k in numbers:
        if runs and k == runs[-1][-1] + 1:
            runs[-1].append(k)
        else:
            runs.append([k])
    return runs


def film(m):
    """Style and pictures: (style, the element that plays, the element of the i-th frame)."""
    with open(os.path.join(m["folder"], "strip.png"), "rb") as stream:
        data = base64.b64encode(stream.read()).decode()
    w, h, n = m["width"], m["height"], len(m["shown"])
    seconds = (m["last"] - m["first"] + 1) / m["fps"]
    style = (f".shot{{width:{w}px;height:{h}px;background-image:url(data:image/png;base64,{data})}}"
             f"@keyframes flip{{to{{background-position:-{n * w}px 0}}}}"
             f".flip{{animation-duration:{seconds:g}s;animation-timing-function:steps({n})}}")
    playing = el("div", class_="shot flip", role="img", tabindex="0", aria_label="The shot, played again and again")
    return style, playing, lambda i, words: el("span", class_="shot", role="img", aria_label=words, style=f"background-position:-{i * w}px 0")


def noise_words(told):
    noisy = [f for f in told if f.noise is not None]
    if not noisy:
        return "Their noise cannot be told from so few samples."
    worst, best = max(noisy, key=lambda f: f.noise), min(noisy, key=lambda f: f.noise)
    words = f"By its own samples the noise of a frame is a relMSE of {figure(best.noise)} (frame {best.number}) to {figure(worst.noise)} (frame {worst.number})"
    unsure = len(told) - len(noisy)
    words += f"; in {count(unsure, 'frame')} there are too few samples to tell" if unsure else ""
    left = [f.filtered for f in told if f.filtered is not None]
    return words + (f". The filter left {figure(min(left))} to {figure(max(left))}, as it estimates." if left else ".")


def rendered_words(frames, told):
    if not told:
        return "No frame has statistics: they were rendered without --report."
    ways = [s for s in spans(frames) if s[2]]
    by = ", ".join(f"{span_words(a, b)} by {way}" for a, b, way in ways[:6])
    return (by[:1].upper() + by[1:] + (f", and {len(ways) - 6} changes more" if len(ways) > 6 else "") + ".")


def page(folder):
    with open(os.path.join(folder, "shot.json"), encoding="utf-8", errors="replace") as stream:
        m = json.load(stream)
    m["folder"] = folder
    frames = [Frame(m["first"] + i, stats) for i, stats in enumerate(m["stats"])]
    told = [f for f in frames if f.told]
    style, playing, picture_of = film(m)
    title = re.sub(r"\.gl(b|tf)$", "", m["scene"])
    n, seconds = len(frames), len(frames) / m["fps"]
    cpu = [f.cpu for f in told if number(f.cpu)]
    size = next((f"{f.width} \u00d7 {f.height}" for f in told if f.width and f.height), None)
    missing = n - len(told)
    keys = [(str(n), "frame" if n == 1 else "frames"), (figure(seconds, 3, "\u202fs"), f"at {m['fps']:g} frames per second"),
            (size or "\u2013", "pixels"), (figure(sum(cpu), 3, "\u202fs") if cpu else "\u2013", "CPU time" if not missing else f"CPU time of {count(len(told), 'frame')}"),
            (figure(sorted(cpu)[len(cpu) // 2], 3, "\u202fs") if cpu else "\u2013", "CPU time of a frame, the median")]
    changes = [(a, way) for a, _, way in spans(frames) if way]
    noise = {"as rendered": {f.number: f.noise for f in told}}
    if any(number(f.filtered) for f in told):
        noise["filtered"] = {f.number: f.filtered for f in told}
    light = light_over_time(told)
    rows = [(f.number, f.way or "\u2013", figure(f.spp, 9), figure(f.cpu, 3), figure(f.noise, 2),
             len(f.portals) if f.told else "\u2013", percent(f.by_segments)) for f in frames]
    header = el("header", el("div", el("p", "A shot", class_="eyebrow"), el("h1", name(title)),
                             el("p", rendered_words(frames, told), class_="verdict"), el("p", noise_words(told) if told else None),
                             el("p", f"{count(missing, 'frame was', 'frames were')} there before, and {'has' if missing == 1 else 'have'} no statistics.",
                                class_="note") if missing and told else None),
                el("figure", playing, el("figcaption", f"The shot at its speed; it stops under the pointer. {count(len(m['shown']), 'frame')}"
                   + (f" of {n}" if len(m["shown"]) < n else "") + f", exposed by {figure(m['exposure'], 3)} stops.")), class_="hero")
    strip = el("ol", [el("li", picture_of(i, f"frame {k}"), f"{k}") for i, k in enumerate(m["shown"])], class_="frames")
    body = el("main", header, el("dl", [el("div", el("dt", k), el("dd", f)) for f, k in keys], class_="facts"),
              section("frames", "Frames", strip),
              section("noise", "Noise over time", el("p", "relMSE of each frame, as its own samples tell it: a lone bright pixel that they have not met is not in it."
                      + (" Filtered: what error is left, as the filter estimates it." if len(noise) > 1 else "")),
                      over_time(frames, noise, "Noise over time", "", True, "plot-noise", changes)),
              section("portals", "Portals over time",
                      el("p", "Share of the light that paths begun in portals brought; none where the plan does without them." if light else
                         "Portals brought no light, or there were none."),
                      over_time(frames, light, "Portals over time", "%", False, "plot-portals", changes) if light else None),
              section("table", "All figures", details(f"{count(n, 'frame')}", table("Frame by frame. By segments: share of the light that paths begun in portals brought",
                      ("Frame", "Way", "Samples per pixel", "CPU seconds", "relMSE", "Portals", "By segments"), rows, numeric=(2, 3, 4, 5, 6)))))
    return document(f"{title}: a shot", body, "Made by tdpt(1) --report. Figures that were not measured are a dash.", style)


if __name__ == "__main__":
    sys.exit(run("report_shot.py", page, "tdpt gathers"))
