"""What portals are worth where a sky shines in through windows: doc/sky.md."""
import functools
import math
import re
import shutil
from collections import defaultdict, namedtuple
from pathlib import Path

import numpy as np

import pages
import stats
from common import STAGES, TESTDATA, Setting, Stop, checked, decibels_of, settings, turns
from pages import hundredths

SEED = 20260717
MAPS = TESTDATA / "environments"
SKIES = {"overcast": "1,1,1", "clear": MAPS / "clear.exr", "sun": MAPS / "clear-sun.exr"}
WITHOUT = ("bdpt", "nee")
WITH = {"windows": "`nee` + portals", "aimed": "`nee` 0.4", "guided": "`tdpt-guided`", "auto": "`auto`"}
GUIDED = ("--integrator", "tdpt-guided")
OPTIONS = {"bdpt": ("--integrator", "bdpt"), "nee": ("--integrator", "nee"), "windows": ("--integrator", "nee"),
           "aimed": ("--integrator", "nee", "--set", "guide-camera=0.4"), "guided": GUIDED, "auto": ()}
GROUPS = {"windows": "ordinary windows", "interiors": "interiors", "second": "through a second room"}
# Name: group, and what it is: the N-th room of a kind, or an interior.
ROOMS = {"window": ("windows", "sky-window", 1), "windows": ("windows", "sky-windows", 1),
         "corner": ("windows", "corner-windows", 1), "skylight": ("windows", "skylight", 1),
         "blinds": ("windows", "sky-blinds", 1), "facade": ("windows", "deep-facade", 1),
         "behind": ("second", "room-behind", 1), "behind-2": ("second", "room-behind", 2),
         "living-room": ("interiors", "", 0), "classroom": ("interiors", "", 0)}
Picture = namedtuple("Picture", "cpu relmse mse spp", defaults=(0,))


class Cell:
    """Pictures of a room under a sky by several methods, in the order of their seeds, and the black one. peak: that of
    PSNR; base_of: methods, of which the better is what gains are over; more: what else is known of it.

    cost of a method   mean over its seeds of CPU s x relMSE
    gain of a method   cost of the base over its own"""

    def __init__(self, black, peak, base_of=WITHOUT, seed=SEED, **more):
        self.black, self.peak, self.base_of, self.seed = black, peak, base_of, seed
        self.pictures = defaultdict(list)
        self.__dict__.update(more)

    def costs(self, method):
        return np.array([p.cpu * p.relmse for p in self.pictures[method]])

    def base(self):
        return min(self.base_of, key=lambda m: self.costs(m).mean())

    def gain(self, method):
        """nan where an error hides in the noise of the reference."""
        return stats.ratio(self.costs(self.base()), self.costs(method), self.seed)

    def error(self, method):
        """relMSE and PSNR."""
        relmse, mse = (np.mean([getattr(p, e) for p in self.pictures[method]]) for e in ("relmse", "mse"))
        return relmse, decibels_of(self.peak**2, mse)


def geometric_mean(cells, method):
    """Of the gains that are known, its interval over seeds; the rooms are what they are."""
    return stats.geometric([(cell.costs(cell.base()), cell.costs(method)) for cell in cells
                            if not math.isnan(cell.gain(method).value)], SEED)


def select(cells, group, sky=None):
    """cells: {(room, sky): Cell}"""
    return [c for (_, s), c in cells.items() if c.group == group and sky in (None, s)]


def sky_parts(cells):
    groups = [(words, sky, select(cells, group, sky)) for group, words in GROUPS.items()
              for sky in (*dict.fromkeys(sky for _, sky in cells), None)]
    return {
        "gains": pages.table(("lit through", "sky", "rooms", *WITH.values()),
                             [[words, sky or "**all**", len(of), *(geometric_mean(of, m).text(hundredths) for m in WITH)]
                              for words, sky, of in groups if of]),
        "rooms": pages.table(("room", "sky", "portals", "without", *WITH.values()), [
            [*key, c.portals or "none found", c.base(), *(c.gain(m).text(hundredths) for m in WITH)]
            for key, c in cells.items()])}


def generated(bench, name, kind, number):
    """The N-th generated room of that kind which has no lamp and stands upright, in metres: half of them are turned,
    where no map's sky would be above. Stages that fail at once leave the room alone."""
    program, failing = bench.store.program("portals_bench"), bench.cache / "none"
    failing.mkdir(exist_ok=True)
    for stage in (s for s in STAGES if not (failing / s).is_symlink()):
        (failing / stage).symlink_to(shutil.which("false"))

    def make(path):
        folder = path.with_suffix(".rooms")
        told = checked([program, failing, "--rooms", 40, "--kinds", kind, "--jobs", 1, "--keep", folder], may_fail=(1,))
        seeds = [re.search(r"(\d+)\s+portals ", line).group(1) for line in told.errors.splitlines()
                 if " lamp sky " in line and " scale 1 " in line and " turned " not in line]
        if len(seeds) < number:
            raise Stop(4, f"of 40 rooms {kind} fewer than {number} have a sky and no placement")
        shutil.copy(folder / f"{kind}-{seeds[number - 1]}.glb", path)
        shutil.rmtree(folder)
    kept = bench.store.keep([bench.store.sum_of(program), kind, number], make, ".glb")
    return Path(shutil.copy(kept, bench.cache / f"{name}.glb"))


@settings(ROOMS=Setting(tuple(ROOMS), "names of the rooms to measure"),
          SKIES=Setting(tuple(SKIES), "of: overcast clear sun (sun: an interior has its own map instead)"),
          SPP=Setting(32, "samples per pixel", 4), SEEDS=Setting(4, "pictures of each kind", 2),
          REF_SPP=Setting(96, "samples per pixel of each half of a reference", 16),
          REF_INTEGRATOR=Setting("auto", "of the references, with the portals found"),
          WIDTH=Setting(72, "of the pictures of rooms; those of interiors are a third wider", 24),
          HEIGHT=Setting(54, "", 18))
def sky(bench):
    """What the windows that the stages find are worth under a sky. Rooms x skies; in each, pictures of equally many
    samples by `bdpt` and `nee` without portals and by what can be done with the portals found, several seeds, taking
    turns, one thread each; efficiency 1 / (relMSE x CPU s) over the better of the two without. A quarter of an hour."""
    s, places, interiors = bench.settings, [], Path(bench.settings.scenes) / "interiors"
    for name in s.rooms:
        if name not in ROOMS or set(s.skies) - set(SKIES):
            raise Stop(2, f"there is no room {name}, or one of {s.skies} is none of {', '.join(SKIES)}")
        group, kind, number = ROOMS[name]
        scene = generated(bench, name, kind, number) if kind else bench.find(name)
        if scene:
            own = interiors / f"{name}.env.exr"
            places += [(name, light, group, scene, own if light == "sun" and own.exists() else SKIES[light])
                       for light in s.skies]
        else:
            bench.say(f"there is no {interiors}/{name}.glb: left out")
    if not places:
        raise Stop(3, "none of the rooms is there")

    def cell(name, light, group, scene, environment):
        shines = ("--environment", environment)
        portals = bench.portals(scene, shines, threads=1)
        portal, width = ("--portal", portals.file), s.width * 4 // 3 if group == "interiors" else s.width

        def render(options, spp, seed):
            return bench.render(scene, *shines, "--width", width, "--height", s.height, *options, "--spp", spp,
                                "--seed", seed)

        halves = bench.halves(lambda seed: render((*portal, "--integrator", s.ref_integrator), s.ref_spp, seed))
        made = Cell(halves.black, halves.peak, group=group, portals=portals.count)
        for seed, method in turns(range(1, s.seeds + 1), OPTIONS):
            run = render((*(() if method in WITHOUT else portal), *OPTIONS[method]), s.spp, seed)
            off = halves.off(run.out)
            made.pictures[method].append(Picture(run.said["cpu_seconds"], off["relmse"], off["mse"]))
        return made

    cells = bench.side_by_side([functools.partial(cell, *place) for place in places])
    bench.page("sky", sky_parts({(name, light): c for (name, light, *_), c in zip(places, cells)}))
