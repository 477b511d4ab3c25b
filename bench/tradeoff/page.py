"""page.py BIN CACHE DOC: doc/tradeoff.md, its plots and its CSV from what measure.py left in CACHE."""
import csv
import math
import shutil
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

import curves
import figures
import knobs

DEFAULT, TRUE = ("default", ""), ("true", "")


def digits(x):
    if x is None or not math.isfinite(x):
        return "-"
    return "%.2f" % x if x < 9.95 else "%.1f" % x if x < 99.5 else "%.0f" % x


def interval(e, percent=False):
    scale, form = (100, lambda x: "%.0f" % x) if percent else (1, digits)
    if not math.isfinite(e.value):
        return "-"
    ends = f" [{form(scale * e.low)}, {form(scale * e.high)}]" if math.isfinite(e.low) else ""
    return form(scale * e.value) + ends


def row(*cells):
    return "|" + "|".join(f" {c} " for c in cells) + "|"


def table(heads, rows):
    return [row(*heads), "|---" * len(heads) + "|", *(row(*r) for r in rows)]


def bold_least(values):
    """As text, the least in bold, and those that are within half a per cent of it."""
    least = min(values)
    return [("**%s**" if v <= 1.005 * least else "%s") % digits(v) for v in values]


def changed(curve, setting):
    """The kinds of rooms that a setting loses (-) and wins (+)."""
    return ", ".join(f"{sign}{kinds.count(kind)} {kind}" for sign, kinds in zip("-+", curve.changed(setting))
                     for kind in dict.fromkeys(kinds))


def verdict(knob, settings, curve):
    """Where the default lies: its total over the least, at each length."""
    says = []
    for render in curves.RENDERS:
        totals = {value: curve.total(setting, render) for setting, value in settings}
        best = min(totals, key=totals.get)
        if knob.default in totals:
            over = totals[knob.default] / totals[best]
            says.append(f"{render} s: " + ("the best" if best == knob.default else f"{digits(over)} of that of `{best}`"))
    return "Total time of the default, by R. " + "; ".join(says) + "."


def summary_section(portals, pictures):
    """Where each default lies: what is best at each R, and the default's total over that one's."""
    rows = []
    for knob in knobs.KNOBS:
        cells = [f"`{knob.name}`", knob.default]
        if knob.program == knobs.RENDERER:
            scenes = pictures.scenes(knob.name)
            if not scenes:
                continue
            each = {v: pictures.relative(knob.name, v, knob.default).value for v in knob.values
                    if (knob.name, v, scenes[0]) in pictures.by}
            value = curves.best(each, each.get)
            rows.append([*cells, *["" if value == knob.default else f"`{value}`, {digits(1 / each[value])}"] * 3])
            continue
        settings = figures.settings_of(portals, knob)
        if not settings:
            continue
        for render in curves.RENDERS:
            totals = {v: portals.total(s, render) for s, v in settings}
            value = curves.best(totals, totals.get)
            cells.append("" if value == knob.default else f"`{value}`, {digits(totals[knob.default] / totals[value])}")
        rows.append(cells)
    return table(("knob", "default", *(f"better at {r} s" for r in curves.RENDERS)), rows)


def stage_section(program, curve):
    picture = picture_of(program)
    lines = [f"## {program}", "", f"![Cost and rooms against time for each knob of {program}]({picture})"]
    for knob in knobs.KNOBS:
        settings = figures.settings_of(curve, knob) if knob.program == program else []
        if not settings:
            continue
        totals = [bold_least([curve.total(s, render) for s, _ in settings]) for render in curves.RENDERS]
        rows = []
        for i, (setting, value) in enumerate(settings):
            rows.append([value + (" (default)" if value == knob.default else ""), digits(curve.chain(setting)),
                         interval(curve.loss(setting)), interval(curve.found(setting), True),
                         interval(curve.right(setting), True), changed(curve, setting), "%.4f" % curve.room_median(setting, "coverage"),
                         "%.3f" % curve.room_median(setting, "tightness"), *(t[i] for t in totals)])
        lines += ["", f"### {knob.name}" + (f" [{knob.unit}]" if knob.unit else ""), "", *table(
            ("value", "CPU s", "cost / through the true opening", "right number [%]", "rooms right [%]", "rooms lost, won", "coverage",
             "tightness", *(f"total at {r} s" for r in curves.RENDERS)), rows), "", verdict(knob, settings, curve)]
    return lines


def renderer_section(pictures):
    lines = []
    for knob in knobs.KNOBS:
        scenes = pictures.scenes(knob.name)
        if knob.program != knobs.RENDERER or not scenes:
            continue
        values = [v for v in knob.values if (knob.name, v, scenes[0]) in pictures.by]
        rows = []
        for value in values:
            each = [digits(pictures.relative(knob.name, value, knob.default, [s]).value) for s in scenes]
            name = value + (" (default)" if value == knob.default else "")
            rows.append([name, interval(pictures.relative(knob.name, value, knob.default)) if value != knob.default else "1",
                         *each])
        lines += ["", f"### {knob.name}" + (f" [{knob.unit}]" if knob.unit else ""), "",
                  *table(("value", "all", *scenes), rows)]
    return lines


def errors_section(pictures):
    """Every measure of the longest pictures, and what a black one has."""
    def told(rows):
        relmse, psnr, mape = (sum(r[field] for r in rows) / len(rows) for field in ("relmse", "psnr", "mape"))
        return "%s, %.1f dB, %s %%" % (digits(relmse) if relmse >= 0.1 else "%.2g" % relmse, psnr, digits(mape))
    rows = []
    for s in pictures.scenes("integrator"):
        found = [pictures.longest(s, i) for i in knobs.INTEGRATORS]
        rows.append([s, told(pictures.by["black", "", s]),
                     *(f"{digits(sum(r['cpu'] for r in of) / len(of))} s: {told(of)}" if of else "-" for of in found)])
    return table(("scene", "black", *knobs.INTEGRATORS), rows)


def depth_section(pictures):
    name = "tdpt-render --max-depth"
    scenes = pictures.scenes(name)
    rows = []
    for depth in knobs.DEPTHS:
        cells = []
        for s in scenes:
            if (name, depth, s) in pictures.by:
                mean, whole = (pictures.mean(name, d, s, "mean") for d in (depth, "none"))
                cells.append("%s, %s s, %.0f %%" % (digits(pictures.mean(name, depth, s, "relmse")),
                                                    digits(pictures.mean(name, depth, s, "cpu")), 100 * mean / whole))
        rows.append([depth, *cells])
    return table(("edges", *scenes), rows) if scenes else []


def chain_section(pictures, portals):
    rows = []
    for s in portals.scenes:
        chain = portals.chain(DEFAULT, s)
        cells = [s, digits(chain)]
        if not pictures.longest(s, "tdpt-guided"):
            rows.append(cells + ["no opening"] * 2 + ["-"] * 4)
            continue
        for integrator in ("tdpt-guided", "auto"):
            pays = pictures.pays_from(s, chain, through=integrator)
            cells.append("never" if pays is None else digits(pays))
        errors = []
        for target in (0.1, 0.01):
            for integrator, extra in (("bdpt", 0), ("auto", chain)):
                rows_of = pictures.longest(s, integrator)
                errors.append(digits(extra + sum(curves.cost(rows_of)) / len(rows_of) / target) if rows_of else "-")
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
            loss = curves.ratio(curves.cost(of), curves.cost(portals.rows(TRUE, s)))
            cells.append("%s, %.0f %%" % (interval(loss), 100 * of[0]["dropped"] / of[0]["triangles"]))
        out.append([s, interval(portals.loss(DEFAULT, [s])), *cells])
    return table(("scene", "whole", *("%g %% of the area" % (100 * share) for share in shares)), out)


WORDS = {
    "head": """# Speed against accuracy

Written by `{extent}make tradeoff` ({version}, {cores} cores). Every knob that buys speed with
accuracy, the others at their defaults; {seeds} seeds of each setting, programs taking turns on one thread each. CPU seconds
throughout. The data: [portals](tradeoff-portals.csv), [rooms](tradeoff-rooms.csv), [pictures](tradeoff-pictures.csv),
[simplified](tradeoff-simplified.csv).

* **cost** = relMSE x CPU seconds of a picture; errors are against references of two halves (doc/efficiency.md).
* **cost / through the true opening**: of `tdpt-guided` through the portals that a setting finds over that through the true
  ones, geometric mean of {count} scenes; 1 is as good as can be, with no portal it is what portals are worth. In door-ajar,
  veach-ajar and bathroom2-channel the portals of the most accurate settings stand for the true ones; living-room-lamps has no
  opening: there it is what useless portals cost.
* **right number**: of the runs, where the number of openings is known. **rooms right**: of generated rooms with known openings
  those with all four marks of [portals.md](portals.md); **lost, won**: the kinds of those that are right by the default and
  wrong by the setting (-), or the other way round (+); coverage and tightness are medians.
* **total at R s**: the four stages and then a picture as good as R CPU seconds give through the true opening: chain + R x cost /
  that through the true opening; geometric mean. The least in bold. A default is right where its total is the least or near it.
* A picture's noise is that of few bright paths: of the default's own cost the interval is a factor of [{low}, {high}]. Nearer
  than that, two settings are alike.
* Brackets: 95 % intervals over seeds (bootstrap; of shares Wilson's). Plots: grey lines are single scenes, the ring is the default.
""",
    "summary": """## Where the defaults lie

The values that do better than the default, if only by chance, and the default's total over theirs (of the renderer's knobs: its
cost).

Most of these scenes are bare rooms, which would do with less: `--quality draft`. What keeps the defaults where they are stands in
no mean: a furnished room without an opening, where settings beside the default find a useless portal (the right number is below
100 %), and rooms that a setting loses. A room that cheaper and dearer settings lose alike stands at an edge and tells nothing.
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

When finding portals pays: from which length of `bdpt`'s picture on the four stages and a picture through their portals are done
earlier; and CPU seconds to a relMSE of 0.1 and of 0.01, extrapolated from the longest pictures.

![Total time to an error](tradeoff-chain.png)
""",
    "simplified": """## Simplified scenes

"Proper simplification does not affect the stability of the results" (paper, 4.1). The smallest triangles are left out, those
that make so much of the area, before the four stages; the picture is of the whole scene. Cost / through the true
opening, and the share of the triangles that are gone.

![Cost through portals of simplified scenes](tradeoff-simplified.png)
""",
}


def picture_of(program):
    return f"tradeoff-{'quality' if program == knobs.CHAIN else program}.png"


def draw(figure, path):
    script = path.with_suffix(".gnuplot")
    script.write_text(figure.script(str(path)), encoding="utf-8")
    subprocess.run(["gnuplot", str(script)], check=True)
    script.unlink()


def main(programs, cache, doc, extent, cores):
    cache, doc = Path(cache), Path(doc)
    read = {name: curves.read(cache / f"{name}.csv") for name in ("portals", "rooms", "pictures", "simplified")}
    portals, pictures = curves.PortalCurves(read["portals"], read["rooms"]), curves.PictureCurves(read["pictures"])
    for program in (knobs.CHAIN, *knobs.STAGES):
        draw(figures.stage(portals, program), doc / picture_of(program))
    for name, figure in (("integrators", figures.integrators(pictures)), ("renderer", figures.renderer(pictures)),
                         ("chain", figures.chain(pictures, portals)),
                         ("simplified", figures.simplified(read["simplified"], portals, curves))):
        draw(figure, doc / f"tradeoff-{name}.png")
    for name in read:
        shutil.copy(cache / f"{name}.csv", doc / f"tradeoff-{name}.csv")
    version = subprocess.run([f"{programs}/tdpt-render", "--version"], check=True, capture_output=True, text=True).stdout
    own = portals.loss(DEFAULT)
    lines = [WORDS["head"].format(version=version.splitlines()[0], cores=cores, extent=extent, count=len(portals.scenes),
                                  seeds=len({r["seed"] for r in read["portals"]}), low=digits(own.low / own.value),
                                  high=digits(own.high / own.value))]
    lines += [WORDS["summary"], *summary_section(portals, pictures), ""]
    for program in (knobs.CHAIN, *knobs.STAGES):
        lines += [*stage_section(program, portals), ""]
    lines += [WORDS["integrators"].format(errors="\n".join(errors_section(pictures))).rstrip(), *renderer_section(pictures), "", WORDS["depth"], *depth_section(pictures), "",
              WORDS["chain"], *chain_section(pictures, portals), "", WORDS["simplified"],
              *simplified_section(read["simplified"], portals)]
    (doc / "tradeoff.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) != 6:
        sys.exit("usage: page.py BIN CACHE DOC EXTENT CORES")
    try:
        main(*sys.argv[1:])
    except (OSError, KeyError, ValueError, csv.Error, subprocess.CalledProcessError) as error:
        sys.exit(f"tradeoff: {type(error).__name__}: {error}")
