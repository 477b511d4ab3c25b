"""How right the portals are in generated rooms whose openings are known and in real buildings, and what they are worth there
beside portals drawn into the openings: doc/portals.md."""
import json
import math
from collections import namedtuple
from pathlib import Path

import numpy as np

import pages
import stats
from common import ROOT, STAGES, Halves, Setting, Stop, checked, settings, turns
from formats import Builder, glb_parse

# ---- Generated rooms ----
UNDER_SKY = ("sky-window,sky-windows,corner-windows,skylight,sky-blinds,colonnade,room-behind,deep-facade,landscape,"
             "deep-room")


def not_all_right(text):
    """What portals_bench prints, without the kinds of which every room is right; these are counted."""
    kept, right = [], 0
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) > 2 and cells[1].isdigit() and cells[1] == cells[2] and "together" not in cells[0]:
            right += 1
        else:
            kept.append(line)
    return "\n".join(kept) + f"\n\nEvery room is right in {right} other kinds."


@settings(ROOMS=Setting(20, "of each kind", 1),
          SEED=Setting(0, "of the first; if not set, the first seven digits of the commit's hash, so that nobody "
                       "chooses it"))
def portals(bench):
    """How right the portals are, on generated rooms whose openings are known. An hour on two quiet cores. Rows room by
    room stay in the cache."""
    s, seed, whence = bench.settings, bench.settings.seed, ""
    if not seed:
        head = checked(["git", "-C", ROOT, "rev-parse", "HEAD"]).said[:7]
        seed, whence = int(head, 16), f", the first digits of the commit that was measured, {head}"
    few = (s.rooms + 6) // 7  # rooms of each kind in the other tables
    program = bench.store.program("portals_bench")

    def table(name, count, *arguments):
        """Of portals_bench."""
        run = checked([program, bench.programs, "--seed", seed, "--rooms", count, "--jobs", s.jobs, *arguments],
                      may_fail=(1,))
        (bench.cache / f"{name}.rooms").write_text(run.errors, encoding="utf-8")
        return run.said.strip()

    invariance = checked([bench.store.program("invariance_bench"), bench.programs, few])
    (bench.cache / "invariance.rooms").write_text(invariance.errors, encoding="utf-8")
    bench.page("portals", {
        "kinds": f"The first seed of each kind is {seed}{whence}.\n\n{not_all_right(table('kinds', s.rooms))}",
        "skies": not_all_right(table("skies", few, "--kinds", UNDER_SKY)),
        "invariance": invariance.said.strip()}, "portalfit")


# ---- Real buildings ----
HOUSES = ("renga-house", "institute-floor", "jasmin-night", "niedri-house", "sample-house-night", "five-zone-office")
LEAST = 0.02  # of the camera's light: openings that count
USELESS = 0.01
COVERED = 0.9
# name: of scene and camera; openings: a path; sky: words of options
View = namedtuple("View", "name scene camera openings sky")


def views_of(bench):
    """Those of ONLY, or of all houses: a house or HOUSE.CAMERA."""
    only, views = bench.settings.only, []
    folder = Path(bench.settings.scenes) / "houses"
    for house in HOUSES:
        scene, sky = folder / f"{house}.glb", folder / f"{house}.env.exr"
        if not scene.exists():
            bench.say(f"{house}: there is no {scene}, left out")
            continue
        document, _ = glb_parse(scene.read_bytes())
        for node in (node for node in document["nodes"] if "camera" in node):
            camera = document["cameras"][node["camera"]].get("name", node.get("name"))
            name = f"{house}.{camera}"
            if not only or house in only or name in only:
                views.append(View(name, scene, camera, folder / f"{house}.openings.json",
                                  ("--environment", sky) if sky.exists() else ()))
    if not views:
        raise Stop(3, "none of the houses is there")
    return views


def found(bench, view, threads=1, options=None):
    """options: more of each program."""
    own = {"ffgraph": ("--camera", view.camera), **(options or {})}
    return bench.portals(view.scene, view.sky, own.get, threads)


class Truth:
    """What light passes a view's openings, by light paths that are drawn once."""

    def __init__(self, bench, view):
        self.bench, self.view, self.program = bench, view, bench.store.program("houses_bench")
        sky = view.sky[1] if view.sky else "-"
        self.paths = bench.store.keep(
            ["light paths 1", bench.store.sum_of(view.scene), view.camera, sky if sky == "-" else bench.store.sum_of(sky)],
            lambda out: checked([self.program, "paths", view.scene, view.camera, sky, out]), ".paths")

    def score(self, *portals):
        """Of each portal file; of none where none is given."""
        run = checked([self.program, "score", self.view.scene, self.view.camera, self.view.openings, self.paths, *portals])
        return [json.loads(line) for line in run.said.splitlines()]

    def draw(self, out):
        """A portal in each opening that LEAST of the light passes, facing the way that most of it goes."""
        polygons = {o["name"]: o["polygon"] for o in json.loads(self.view.openings.read_text(encoding="utf-8"))}
        builder = Builder()
        for drawn, opening in enumerate(o for o in self.score()[0]["openings"] if o["light"] >= LEAST):
            corners = np.array(polygons[opening["name"]], float)
            normal = sum(np.cross(a - corners[0], b - corners[0]) for a, b in zip(corners[1:], corners[2:]))
            builder.polygon(corners[:: 1 if normal @ opening["towards"] >= 0 else -1], f"portal.{drawn}")
        Path(out).write_bytes(builder.content())


# ---- Right ----
def right_table(bench, views, portals):
    rows = []
    for view, found_here in zip(views, portals):
        score = Truth(bench, view).score(found_here.file)[0]
        (bench.cache / f"{view.name}.score.json").write_text(json.dumps(score, indent=1), encoding="utf-8")
        cpu = [found_here.runs[stage].cpu for stage in STAGES]
        big = [o for o in score["openings"] if o["light"] >= LEAST]
        rows.append([view.name, len(big), sum(o["right"] for o in big), sum(o["coverage"] >= COVERED for o in big),
                     len(score["portals"]), sum(not p["openings"] for p in score["portals"]),
                     sum(p["light"] < USELESS for p in score["portals"]), *("%.1f" % c for c in (*cpu, sum(cpu)))])
    sums = [sum(row[k] for row in rows) for k in range(1, 7)]
    cpu = ["%.1f" % (sum(float(row[k]) for row in rows) / len(rows)) for k in range(7, 12)]
    heads = ("view", "openings that count", "right", "covered", "portals", "in no opening", "of next to no light",
             *(f"{stage} s" for stage in STAGES), "CPU s")
    return pages.sections(
        pages.table(heads, [*rows, ["all; mean time", *sums, *cpu]]),
        f"Right are {sums[1]} of {sums[0]} openings ({100 * sums[1] / max(1, sums[0]):.0f} %), covered {sums[2]} "
        f"({100 * sums[2] / max(1, sums[0]):.0f} %); {sums[4]} of {sums[3]} portals lie in no opening, {sums[5]} bring "
        f"less than {100 * USELESS:g} % of the light.")


# ---- Worth ----
WAYS = ("found", "drawn", "without")


def costs_of(bench, view, portals, references):
    """({way: samples of relMSE x CPU seconds} of pictures by auto that take turns, the black picture's relMSE). portals:
    {way: options}; references: the ways whose portals make the two halves of the reference."""
    s, costs = bench.settings, {way: [] for way in portals}
    common = (view.scene, "--camera", view.camera, *view.sky, "--width", s.width, "--height", s.width * 9 // 16,
              "--integrator", "auto")
    reference = Halves(bench, *(bench.render(*common, *portals[way], "--time", f"{s.reference / 2:g}", "--seed",
                                             1000000 + half).out for half, way in enumerate(references, 1)))
    for seed, way in turns(range(1, s.seeds + 1), portals):
        run = bench.render(*common, *portals[way], "--time", f"{s.seconds_each:g}", "--seed", seed)
        costs[way].append(reference.off(run.out)["relmse"] * run.said["cpu_seconds"])
    bench.say(f"{view.name}: " + ", ".join(f"{way} {np.mean(c):.3g}" for way, c in costs.items()))
    return costs, reference.black["relmse"]


def worth_rows(bench, views, portals):
    """(view, *costs_of) of each."""
    for view, found_here in zip(views, portals):
        drawn = bench.cache / f"{view.name}.drawn.glb"
        Truth(bench, view).draw(drawn)
        with_portals = {"found": ("--portal", found_here.file) if found_here.count else (), "drawn": ("--portal", drawn),
                        "without": ()}
        yield view, *costs_of(bench, view, with_portals, ("drawn", "drawn"))


def worth_table(rows):
    table, over_drawn, over_none = [], [], []
    for view, costs, black in rows:
        to_drawn = stats.ratio(costs["drawn"], costs["found"])
        to_none = stats.ratio(costs["without"], costs["found"])
        drawn_to_none = stats.ratio(costs["without"], costs["drawn"])
        over_drawn.append(to_drawn.value), over_none.append(to_none.value)
        table.append([view.name, *("%.3g" % np.mean(costs[way]) for way in WAYS), to_drawn.text(pages.hundredths),
                      to_none.text(pages.hundredths), drawn_to_none.text(pages.hundredths),
                      pages.three(black)])
    mean = lambda values: pages.hundredths(math.exp(np.mean(np.log([v for v in values if v > 0]))))
    return pages.sections(
        pages.table(("view", *(f"{way}, relMSE x CPU s" for way in WAYS), "found over drawn", "found over without",
                     "drawn over without", "black picture's relMSE"), table),
        f"Geometric means: {mean(over_drawn)} over portals drawn into the openings, least "
        f"{pages.hundredths(min(over_drawn))}; {mean(over_none)} over none.")


@settings(WIDTH=Setting(160, "of the pictures that tell what portals are worth", 96),
          SECONDS_EACH=Setting(5.0, "CPU seconds of a picture", 0.5), SEEDS=Setting(4, "pictures of each kind", 2),
          REFERENCE=Setting(120.0, "CPU seconds of a reference, in two halves", 2.0),
          QUALITY=Setting("normal", "of the stages: draft, normal or high; doc/portals.md takes normal alone"),
          WORTH=Setting((), "names of views whose portals' worth is measured, too; default all; 0: none"))
def houses(bench):
    """Real buildings with known openings. Light paths drawn by plain path tracing say how much of a camera's light
    passes each opening; portals are right that cover those of 2 % of it. Then pictures by auto through the portals
    found, through such drawn into the openings, and without any. Two hours on two cores; WORTH=0: twenty minutes."""
    views = views_of(bench)
    quality = ("--quality", bench.settings.quality)
    portals = [found(bench, view, options={"ffgraph": ("--camera", view.camera, *quality), "lightgrid": quality})
               for view in views]
    parts = {"right": right_table(bench, views, portals)}
    print(parts["right"])
    worth = [(v, p) for v, p in zip(views, portals) if not bench.settings.worth or v.name in bench.settings.worth]
    if worth:
        parts["worth"] = worth_table(worth_rows(bench, *zip(*worth)))
        print(parts["worth"])
    if bench.settings.quality == "normal":
        bench.page("portals", parts, "portalfit")


# ---- Several cameras ----
def cameras_row(bench, views):
    """Of one house, portals found for all cameras together beside those that each finds alone."""
    together = found(bench, views[0]._replace(camera="all"))
    alone, ratios = [found(bench, view) for view in views], []
    for view, own in zip(views, alone):
        ways = {"together": together, "alone": own}
        portals = {way: ("--portal", of.file) if of.count else () for way, of in ways.items()}
        costs, _ = costs_of(bench, view, portals, ways)  # neither way's portals make both halves of the reference
        ratios.append(stats.ratio(costs["alone"], costs["together"]))
    cpu = [own.cpu for own in alone]
    return [views[0].name.split(".")[0], len(views), *("%.1f" % c for c in (together.cpu, max(cpu), sum(cpu))),
            "%.1f" % (together.cpu / max(cpu)), pages.hundredths(math.exp(np.mean(np.log([r.value for r in ratios])))),
            " ".join(f"{v.camera} {r.text(pages.hundredths)}" for v, r in zip(views, ratios))]


@settings(WIDTH=Setting(160, "of the pictures", 96), SECONDS_EACH=Setting(3.0, "CPU seconds of a picture", 0.5),
          SEEDS=Setting(4, "pictures of each kind", 2),
          REFERENCE=Setting(24.0, "CPU seconds of a reference, in two halves", 2.0))
def cameras(bench):
    """Real buildings through all their cameras: what the four stages take for all together and for each alone, and the
    efficiency of auto with the portals found together over that with a camera's own. A house takes five minutes."""
    houses_of = {}
    for view in views_of(bench):
        houses_of.setdefault(view.scene, []).append(view)
    heads = ("building", "cameras", "together, CPU s", "slowest alone", "all alone", "together / slowest",
             "efficiency over own portals", "camera by camera")
    table = pages.table(heads, [cameras_row(bench, views) for views in houses_of.values()])
    print(table)
    bench.page("portals", {"cameras": table}, "portalfit")
