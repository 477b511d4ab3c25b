"""How efficient the integrators are: doc/efficiency.{csv,md,png}, by the tables of efficiency_tables.py."""
import dataclasses
import functools
import json
import os
from pathlib import Path

import pages
from common import TESTDATA, Halves, Setting, Stop, decibels_of, settings, turns
from efficiency_tables import BEFORE, Measurements, Scene
from formats import exr_read, exr_write

SCENES = (
    *(Scene(name, 128, 96, "door", target) for name, target in (
        ("two-rooms", 40), ("small-hole", 60), ("door-ajar", 15), ("half-metre-hole", None), ("three-rooms", 60),
        ("window", 2))),
    Scene("veach-ajar", 320, 180, "door", 6, 12), Scene("veach-ajar-flip", 320, 180, "door", 12, 25),
    Scene("bathroom2-channel", 128, 72, "door", 5), Scene("cornell-box-portal", 96, 96, "door"),
    *(Scene(name, 128, height, "interior", 1) for name, height in (
        ("kitchen", 72), ("bathroom", 128), ("living-room-lamps", 72), ("classroom-lamps", 72))),
    Scene("bathroom2", 128, 72, "open"), Scene("cornell-box", 128, 128, "open"),
    *(Scene(f"{name}-whole", 128, height, "whole") for name, height in (
        ("veach-ajar", 72), ("two-rooms", 96), ("kitchen", 72), ("bathroom2", 72))),
)
WITHOUT_PORTALS = ("pt", "nee", "bdpt")

with_settings = settings(
    BASELINE=Setting("", "another tdpt-render, of an older commit: gains are over its bdpt and nee, which take turns "
                     "with the others as bdpt-before and nee-before"),
    BASELINE_NAME=Setting("an older program", "what the page calls it"),
    INTEGRATORS=Setting(("nee", "bdpt", "tdpt-org", "tdpt", "tdpt-guided", "auto"),
                        "without a limit of depth only the last two and bdpt"),
    SECONDS_EACH=Setting(4.0, "CPU seconds of a picture; also a quarter and a sixteenth of it", 0.1),
    SEEDS=Setting(8, "pictures of each kind", 2),
    DEPTH=Setting("6", "edges of the longest path, as the paper's figures have it; none: no limit, in all scenes"),
    REFERENCE_FOLDER=Setting(str(TESTDATA / "references/efficiency"), "of those that are stored; they are used where "
                             "they fit, others are rendered"),
    REF_INTEGRATOR=Setting("tdpt-guided", "of the references"),
    REF_SECONDS=Setting(100.0, "CPU seconds of a reference, in two halves; half of it without an aim, eight times it "
                        "at 320 x 180, so that its relMSE is a tenth of what it judges", 1.0),
    WIDTH=Setting(0, "of all pictures, for trials", 32), HEIGHT=Setting(0, "the same", 24))


class Efficiency:
    """A run of the benchmark: scenes that are there, their portals, references, pictures."""

    def __init__(self, bench):
        self.bench, self.s = bench, bench.settings
        s, known = self.s, [scene.name for scene in SCENES]
        for wrong, words in (
                *((name not in known, f"{name} is none of the scenes") for name in s.only),
                (s.depth != "none" and not s.depth.isdigit(), f"DEPTH={s.depth} is neither a number nor none"),
                (s.baseline and not os.access(s.baseline, os.X_OK), f"BASELINE: {s.baseline} is no program"),
                (s.baseline and s.depth == "none", "BASELINE is for a limited DEPTH")):
            if wrong:
                raise Stop(2, words)
        self.integrators = [*(("nee" + BEFORE, "bdpt" + BEFORE) if s.baseline else ()), *s.integrators]
        wanted = [scene for scene in SCENES if not (s.depth == "none" and scene.kind == "whole")]
        self.files = bench.there([scene.name for scene in wanted])
        self.scenes = [dataclasses.replace(scene) for scene in wanted if scene.name in self.files]
        self.stored = Path(s.reference_folder)

    def portal(self, scene):
        return self.bench.portals(self.files[scene.name])

    def depth(self, scene):
        """None: no limit."""
        return None if self.s.depth == "none" or scene.kind == "whole" else int(self.s.depth)

    def options(self, scene):
        """Of every picture of it: size and depth."""
        own = (self.s.width, self.s.height) if self.s.width or self.s.height else (scene.width, scene.height)
        values = zip(("--width", "--height", "--max-depth"), (*own, self.depth(scene)))
        return [word for name, value in values if value for word in (name, value)]

    def render(self, scene, integrator, seed, seconds, **more):
        plain = integrator.removesuffix(BEFORE)
        program = Path(self.s.baseline).resolve() if integrator != plain else "tdpt-render"
        portal = () if plain in WITHOUT_PORTALS else ("--portal", self.portal(scene).file)
        return self.bench.store.run(program, self.files[scene.name], "--integrator", plain, "--time", f"{seconds:g}",
                                    "--seed", seed, *portal, *self.options(scene), **more)

    # ---- References ----
    def half_seconds(self, scene):
        share = (8 if scene.width >= 320 else 1) / (2 if scene.target is None else 1)
        return self.s.ref_seconds * share / 2

    def stored_fits(self, scene):
        """What is known of a stored one of this scene, depth and size, by whatever program, or None."""
        path = self.stored / f"{scene.name}.json"
        if not path.exists():
            return None
        about = pages.read_json(path)
        size = ["--width", about["width"], "--height", about["height"]]
        depth = [] if about["max_depth"] is None else ["--max-depth", about["max_depth"]]
        fits = about["scene"] == self.bench.store.sum_of(self.files[scene.name]) and size + depth == self.options(scene)
        return about if fits else None

    def rendered_halves(self, scene):
        return [self.render(scene, self.s.ref_integrator, 1000000 + half, self.half_seconds(scene), provenance=True)
                for half in (1, 2)]

    def reference(self, scene):
        """(Halves, what is known of both)."""
        if self.stored_fits(scene):
            pictures = [self.stored / f"{scene.name}-{half}.exr" for half in (1, 2)]
        else:
            pictures = [run.out for run in self.rendered_halves(scene)]
        halves = Halves(self.bench, *pictures)
        return halves, {"means": [way["mean"] for way in halves.ways], "relmse": halves.both("relmse") / 4,
                        "black": {field: halves.both("black", field) for field in ("relmse", "psnr", "mape")}}

    # ---- Pictures ----
    def row(self, scene, halves, integrator, seed, seconds):
        """Of the CSV, of six digits."""
        run = self.render(scene, integrator, seed, seconds)
        off, peak = halves.off(run.out), halves.both("peak")
        numbers = {"seconds": seconds, **{k: run.said[k] for k in ("spp", "cpu_seconds")}, "relmse": off["relmse"],
                   "psnr": decibels_of(peak * peak, off["mse"]) if off["mse"] > 0 else None,
                   **{k: off[k] for k in ("mape", "mean", "mse")}, "peak_mib": round(run.peak, 1)}
        numbers = {k: None if v is None else float("%.6g" % v) for k, v in numbers.items()}
        return {"scene": scene.name, "integrator": integrator, "seed": seed, **numbers}

    def measured(self, wanted):
        """Rows of (scene, integrator, seed, seconds): all are rendered, by turns, before any is judged."""
        self.bench.side_by_side([functools.partial(self.render, *key) for key in wanted])
        return [self.row(key[0], self.halves[key[0].name], *key[1:]) for key in wanted]

    def all_rows(self):
        s, wanted = self.s, []
        for scene in self.scenes:
            whole = scene.kind == "whole"
            measured = [i for i in self.integrators if not whole or i in ("bdpt", "tdpt-guided", "auto")]
            # Pictures of one seed begin with the same samples: each length has its own seeds.
            for k, part in enumerate((1,) if whole else (1, 4, 16)):
                seconds = float("%.6g" % (s.seconds_each / part))
                wanted += [(scene, i, 1000 * k + seed, seconds) for seed, i in turns(range(1, s.seeds + 1), measured)]
        return self.measured(wanted)

    def measure(self):
        for scene in self.scenes:
            self.portal(scene)
        missing = [scene for scene in self.scenes if not self.stored_fits(scene)]
        self.bench.side_by_side([functools.partial(self.rendered_halves, scene) for scene in missing])
        self.halves = {}
        for scene in self.scenes:
            self.halves[scene.name], scene.reference = self.reference(scene)
        return Measurements(self.scenes, self.all_rows(), self.s.seconds_each)


# ---- Page ----
STYLES = {"bdpt-before": 'dt 2 lc rgb "#000000" pt 1', "nee-before": 'dt 2 lc rgb "#8c8c8c" pt 2',
          "bdpt": 'lc rgb "#000000" pt 7', "nee": 'lc rgb "#8c8c8c" pt 5', "tdpt-org": 'lc rgb "#0072b2" pt 9',
          "tdpt": 'lc rgb "#56b4e9" pt 11', "tdpt-guided": 'lc rgb "#d55e00" pt 13', "auto": 'lc rgb "#009e73" pt 6'}


def plot(m):
    """relMSE against CPU seconds, a panel for each scene that was rendered for several lengths of time."""
    shown = [s for s in m.scenes.values() if s.kind != "whole"] or list(m.scenes.values())
    points = {key: of for key, of in m.points().items() if m.scenes[key[0]] in shown}
    figure = pages.Figure(min(4, len(shown) + 1), 400, 340)
    times = [t for of in points.values() for t, _, _, _ in of] or [0.1, 1]
    span = f"[{min(times) / 1.4:.4g}:{max(times) * 1.4:.4g}]"  # the same in every panel
    black = 'with lines dt 3 lw 1.2 lc rgb "#666666"'
    for scene in shown:
        drawn = [f"{span} {scene.reference['black']['relmse']} {black} notitle"]
        for i in (i for i in m.integrators if (scene.name, i) in points):
            style, block = STYLES.get(i, 'lc rgb "#cc79a7" pt 4'), figure.block(points[scene.name, i])
            drawn += [f"{block} using 1:2:3:4 with yerrorbars lw 1 {style} notitle",
                      f"{block} using 1:2 with lines lw 2 {style.split(' pt ')[0]} notitle"]
        figure.panel(scene.name, "CPU seconds", "relMSE", drawn,
                     ("set logscale xy", 'set format y "10^{%T}"', "set xtics in (0.1, 0.3, 1, 3, 10, 30, 100)"))
    figure.key([*(f'NaN with linespoints lw 2 {STYLES.get(i, "pt 4")} title "{i}"' for i in m.integrators),
                f'NaN {black} title "all black"'])
    return figure.script("efficiency.png")


def part(words, text):
    return f"{words}\n\n{text}" if text else ""


def parts(run, m):
    """Of the page, by their names there."""
    over = "bdpt" + (f" of {run.s.baseline_name}" if run.s.baseline else "")
    better = over.replace("bdpt", "the better of bdpt and nee", 1)
    return {"doors": part(f"Gain over {over}:", m.gains("doors")),
            "rooms": part(f"Gain over {better}:", m.gains("rooms")),
            "whole": part("Gain over bdpt of this program:", m.gains("whole")),
            "checks": pages.sections(m.agreement(), m.noisy(), m.busy())}


@with_settings
def efficiency(bench):
    """1 / (relMSE x CPU seconds) of every integrator, with portals that the four stages find. An hour and a half of CPU
    time, with BASELINE two, and 25 minutes more (50 with both of Veach, Ajar) for references that are not stored.
    --time is time on the clock: a busy machine makes pictures that are worse than they might be, which the page
    tells."""
    bench.need("gnuplot")
    run = Efficiency(bench)
    m = run.measure()
    pages.write_csv(bench.doc / "efficiency.csv", [row for rows in m.rows.values() for row in rows])
    pages.draw(plot(m), bench.doc)
    bench.page("efficiency", parts(run, m))


# ---- Stored references ----
@with_settings
def references(bench):
    """References of efficiency that are missing or do not fit, rendered and stored in REFERENCE_FOLDER: NAME-1.exr, NAME-2.exr
    and NAME.json. Rounding to half floats is off by at most 2^-11 of a value: relMSE 2.4e-7 at most."""
    run = Efficiency(bench)
    run.stored.mkdir(parents=True, exist_ok=True)
    missing = [scene for scene in run.scenes if not run.stored_fits(scene)]
    for scene, runs in zip(missing, bench.side_by_side([functools.partial(run.rendered_halves, s) for s in missing])):
        for half, of in enumerate(runs, 1):
            exr_write(run.stored / f"{scene.name}-{half}.exr", exr_read(of.out))
        about = {"scene": bench.store.sum_of(run.files[scene.name]),
                 **{k: runs[0].said[k] for k in ("max_depth", "width", "height", "integrator")}, "program": bench.version(),
                 "seeds": [1000001, 1000002], "spp": [of.said["spp"] for of in runs],
                 "cpu_seconds": [round(of.said["cpu_seconds"], 1) for of in runs]}
        (run.stored / f"{scene.name}.json").write_text(json.dumps(about, indent=1) + "\n", encoding="utf-8")
        bench.say(f"{scene.name}: stored")
