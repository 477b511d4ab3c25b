"""report_shot.py FOLDER PAGE: the page of a shot, from what tdpt gathered in FOLDER.

The page is report_shot.html within report.html: a flip-book, the frames as a strip, and what their statistics tell over
time: noise, the way that renders, light through portals. Frames that were there before have no statistics, and no
figures. No script, and nothing from outside, as in report_page.py. Standard library alone.
"""

import base64
import itertools
import json
import os
import re
import sys

from report_page import DASH, Axis, chart, count, document, el, figure, filled, get, number, percent, run, table


def known(value):
    """A figure that can be drawn, or nothing: files may hold anything."""
    try:
        return value if number(value) and (value == 0 or 1e-30 < value < 1e30) else None
    except OverflowError:
        return None


class Frame:
    """What the statistics of one frame tell; all is None where there are none."""

    def __init__(self, frame, stats):
        self.number, self.stats = frame, stats if isinstance(stats, dict) else {}
        way = get(self.stats, "chosen") or get(self.stats, "integrator")
        self.way = way if isinstance(way, str) else None
        self.noise, self.filtered, self.by_segments = (known(get(self.stats, *path)) for path in (
            ("noise", "relmse"), ("filtered", "relmse"), ("techniques", "portal")))
        self.spp, self.width, self.height, self.cpu = (known(get(self.stats, key)) for key in ("spp", "width", "height", "cpu_seconds"))
        portals = get(self.stats, "portals")
        self.portals = [p for p in portals if isinstance(p, dict) and isinstance(p.get("name"), str)] if isinstance(portals, list) else []


def runs(frames, same):
    """Frames, as lists of those one after the other that have the same."""
    return [list(group) for _, group in itertools.groupby(frames, same)]


def over_time(frames, values, title, shown=None):
    """values: {label: {frame: value or None}}, drawn over the frames' numbers; gaps where there are none. Shares of light are
    shown as `shown` does, from zero; noise logarithmically."""
    values = {label: {k: v for k, v in of.items() if v is not None and (v > 0 or shown)} for label, of in values.items()}
    every = [v for of in values.values() for v in of.values()]
    if not every:
        return el("p", "No frame has statistics that tell it.", class_="none")
    y = Axis(0.0, max(max(every) * 1.1, 1e-9), "", False, shown) if shown else Axis(min(every) / 1.3, max(every) * 1.3, "")
    x = Axis(frames[0].number, frames[-1].number, "frame", False, lambda value: f"{value:g}")
    lines = {label: [[(k, of[k]) for _, k in run] for run in runs(enumerate(sorted(of)), lambda pair: pair[1] - pair[0])]
             for label, of in values.items()}
    return chart(lines, x, y, f"{title}, from {figure(min(every))} to {figure(max(every))}")


def light_over_time(frames):
    """{name: {frame: share of the light}} of the two portals that brought most, where they are the same in all frames;
    else of all portals together. Empty: none brought any."""
    places = {(p["name"], known(p.get("area"))) for f in frames for p in f.portals}
    light = {"all portals": {f.number: f.by_segments for f in frames}}
    if len(places) == len({label for label, _ in places}):
        light = {label: {f.number: known(p.get("energy")) for f in frames for p in f.portals if p["name"] == label} for label, _ in places}
    most = {label: max((v for v in of.values() if v is not None), default=0) for label, of in light.items()}
    return {label: light[label] for label in sorted(light, key=lambda label: (-most[label], label))[:2] if most[label] > 0}


def noise_words(frames):
    noisy = sorted((f for f in frames if f.noise is not None), key=lambda f: f.noise)
    if not noisy:
        return "The noise of frames cannot be told."
    best, worst = noisy[0], noisy[-1]
    return (f"By its own samples the noise of a frame is a relMSE of {figure(best.noise)} (frame {best.number}) to {figure(worst.noise)} "
            f"(frame {worst.number}).")


def rendered_words(frames):
    if not any(f.stats for f in frames):
        return "No frame has statistics: they were rendered without --report."
    ways = [f"frames {group[0].number}\u2013{group[-1].number} by {group[0].way}" for group in runs(frames, lambda f: f.way) if group[0].way]
    return f"Rendered: {', '.join(ways[:6])}" + (f", and {len(ways) - 6} changes more." if len(ways) > 6 else ".")


def film_style(folder, m):
    """Each frame is a part of one picture, which the flip-book moves."""
    with open(os.path.join(folder, "strip.png"), "rb") as stream:
        data = base64.b64encode(stream.read()).decode()
    w, n, seconds = m["width"], len(m["shown"]), (m["last"] - m["first"] + 1) / m["fps"]
    return (f".shot{{width:{w}px;height:{m['height']}px;background-image:url(data:image/png;base64,{data})}}"
            f"@keyframes flip{{to{{background-position:-{n * w}px 0}}}}"
            f".flip{{animation-duration:{seconds:g}s;animation-timing-function:steps({n})}}")


def page(folder):
    with open(os.path.join(folder, "shot.json"), encoding="utf-8", errors="replace") as stream:
        m = json.load(stream)
    frames = [Frame(m["first"] + i, stats) for i, stats in enumerate(m["stats"])]
    missing = sum(not f.stats for f in frames)
    cpu = sorted(f.cpu for f in frames if f.cpu is not None)
    noise = {"as rendered": {f.number: f.noise for f in frames}, "filtered": {f.number: f.filtered for f in frames if f.filtered is not None}}
    rows = [(f.number, f.way or DASH, figure(f.spp, 9), figure(f.cpu, 3), figure(f.noise, 2), len(f.portals) if f.stats else DASH,
             percent(f.by_segments)) for f in frames]
    body = filled(
        "report_shot.html", title=re.sub(r"\.gl(b|tf)$", "", m["scene"]), rendered=rendered_words(frames), noise_words=noise_words(frames),
        missing=f"{count(missing, 'frame was', 'frames were')} there before, and {'has' if missing == 1 else 'have'} no statistics."
                if 0 < missing < len(frames) else None,
        shown=f"{len(m['shown'])} of {count(len(frames), 'frame')}", exposure=figure(m["exposure"], 3),
        number=len(frames), length=figure(len(frames) / m["fps"], 3, "\u202fs"), fps=f"{m['fps']:g}",
        size=next((f"{f.width} \u00d7 {f.height}" for f in frames if f.width and f.height), DASH),
        counted=count(len(cpu), "frame"), cpu=figure(sum(cpu), 3, "\u202fs") if cpu else DASH,
        median=figure(cpu[len(cpu) // 2], 3, "\u202fs") if cpu else DASH,
        strip=[el("li", el("span", class_="shot", role="img", aria_label=f"frame {k}", style=f"background-position:-{i * m['width']}px 0"), k)
               for i, k in enumerate(m["shown"])],
        noise_chart=over_time(frames, {label: of for label, of in noise.items() if of}, "Noise over time"),
        portal_chart=over_time(frames, light_over_time(frames), "Portals over time", percent),
        frames=table("Frame by frame. By segments: share of the light that paths begun in portals brought",
                     ("Frame", "Way", "#Samples per pixel", "#CPU seconds", "#relMSE", "#Portals", "#By segments"), rows))
    return document(f"{m['scene']}: a shot", body, "tdpt(1) --report", film_style(folder, m))


if __name__ == "__main__":
    sys.exit(run("report_shot.py", page, "tdpt gathers"))
