"""measure.py BIN CACHE SCENES: runs whatever curves need and writes CACHE/{portals,pictures,rooms,simplified}.csv. What
is in CACHE is not run again; a run that is stopped goes on where it was. The environment may set

  QUICK   1: fewer seeds, scenes, values and rooms: three quarters of an hour on two cores, a night's work else
  SEEDS   of each setting
  ROOMS   of each kind
  ONLY    the name of one table: portals, pictures, rooms, simplified
  JOBS    programs at a time, one thread each (all cores)

Every number is one run's: `cpu` seconds of the process; errors against references (error.py)."""
import csv
import itertools
import json
import math
import os
import random
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

import exr_file
import glb
import knobs
from error import Reference
from store import Failed, Store

HERE = Path(__file__).resolve().parent.parent.parent
REFERENCES = HERE / "testdata/references/efficiency"
SAMPLES = 200_000  # of a picture, about


class Extent:
    """How much is measured."""

    def __init__(self, environment):
        self.quick = environment.get("QUICK", "") not in ("", "0")
        self.seeds = int(environment.get("SEEDS", 2 if self.quick else 5))
        self.jobs = int(environment.get("JOBS", len(os.sched_getaffinity(0))))
        self.samples = SAMPLES // 4 if self.quick else SAMPLES
        self.rooms = int(environment.get("ROOMS", 1 if self.quick else 3))

    def values(self, knob):
        if not self.quick:
            return knob.values
        default = knob.values.index(knob.default)
        return tuple(v for i, v in enumerate(knob.values) if abs(i - default) == 1 or i in (default, 0))

    def scenes(self, scenes):
        return tuple(s for s in scenes if s.name not in ("bathroom2-channel", "half-metre-hole", "kitchen", "cornell-box")) if self.quick else scenes

    def lengths(self):
        return knobs.LENGTHS[1::2] if self.quick else knobs.LENGTHS


class Bench:
    def __init__(self, programs, cache, scenes, extent):
        self.store, self.cache, self.folder, self.extent = Store(cache / "runs", programs), cache, scenes, extent
        self.references = {}
        for scene in self.extent.scenes(knobs.SCENES + knobs.OPEN):
            if self.path(scene.name) is None:
                print(f"tradeoff: {scene.name}: there is no {scene.name}.glb in SCENES, left out", file=sys.stderr)

    def scenes(self, scenes):
        return tuple(s for s in self.extent.scenes(scenes) if self.path(s.name))

    def path(self, scene):
        name = scene.removesuffix("-whole")
        for folder in (HERE / "testdata/scenes", self.folder, self.folder / "interiors"):
            if (folder / f"{name}.glb").exists():
                return folder / f"{name}.glb"
        return None

    def reference(self, scene):
        """(Reference, width, height, depth)"""
        if scene not in self.references:
            with open(REFERENCES / f"{scene}.json", encoding="utf-8") as file:
                about = json.load(file)
            self.references[scene] = (Reference.read(REFERENCES / scene), about["width"], about["height"],
                                      about["max_depth"])
        return self.references[scene]

    def samples_of(self, scene):
        """Samples per pixel of its pictures: a power of two."""
        _, width, height, _ = self.reference(scene)
        return max(1, 2 ** round(math.log2(self.extent.samples / (width * height))))

    def portal(self, path, seed, settings):
        """Portals of a scene by the four stages; settings: {program: options}. (file, CPU seconds, how many)"""
        cpu, given = 0, {"ffgraph": (path,), "lightgrid": (path,)}
        out = None
        for program in knobs.STAGES:
            inputs = given.get(program, ()) + ((out,) if out else ())
            run = self.store.run(program, *inputs, "--seed", str(seed), *settings.get(program, ()))
            cpu, out = cpu + run.cpu, run.out
        return out, cpu, len(run.said.get("portals", ()))

    def picture(self, scene, seed, options, spp, portal=None):
        """A row of what a picture is, `options` of the renderer."""
        reference, width, height, depth = self.reference(scene)
        limit = () if depth is None or "--max-depth" in options else ("--max-depth", str(depth))
        options = tuple(o for o in options if o not in ("--max-depth=none",))
        given = ("--portal", portal) if portal else ()
        run = self.store.run(knobs.RENDERER, self.path(scene), *given, *options, *limit, "--spp", str(spp), "--seed",
                             str(seed), "--width", str(width), "--height", str(height))
        rgb = exr_file.read(run.out)[0]
        return {"scene": scene, "seed": seed, "spp": spp, "cpu": run.said["cpu_seconds"], **reference.measures(rgb)}

    def true_portal(self, scene):
        """Where it is known, that, or a file of none; else what the most accurate settings find."""
        if scene.openings != "":
            data = glb.portals(scene.apertures)
            return self.store.keep(("portals", repr(scene.apertures)), lambda path: path.write_bytes(data))
        settings = {program: knobs.accurate(program) for program in knobs.STAGES}
        return self.portal(self.path(scene.name), 1, settings)[0]


# ---- What each table needs: functions of no arguments, each a list of rows ----
def through(bench, scene, seed, portal, **words):
    """The row of a picture through these portals."""
    row = bench.picture(scene.name, 100 + seed, ("--integrator", "tdpt-guided"), bench.samples_of(scene.name), portal)
    return {**words, **row}


def stage_settings(extent):
    """(knob's name, value, {program: options}) of all curves of the four stages; the default once."""
    yield "default", "", {}
    for knob in knobs.KNOBS:
        if knob.program == knobs.RENDERER:
            continue
        for value in extent.values(knob):
            if value != knob.default:
                yield knob.name, value, knob.settings(value)


def portal_tasks(bench):
    """The true ones take their turn among the settings: what else the machine does slows all alike."""
    settings_of = [("true", "", None), *stage_settings(bench.extent)]
    for seed, (knob, value, settings), scene in itertools.product(
            range(1, bench.extent.seeds + 1), settings_of, bench.scenes(knobs.SCENES)):
        def task(seed=seed, knob=knob, value=value, settings=settings, scene=scene):
            if settings is None:
                portal, cpu, count = bench.true_portal(scene), 0, scene.openings
            else:
                portal, cpu, count = bench.portal(bench.path(scene.name), seed, settings)
            return [through(bench, scene, seed, portal, knob=knob, value=value, chain_cpu=cpu, portals=count)]
        yield task


def simplified_tasks(bench):
    """The four stages on scenes without their smallest triangles; the portal is used in the whole one."""
    shares = (0.01, 0.1, 0.5) if bench.extent.quick else knobs.SIMPLIFIED
    for seed, share, scene in itertools.product(range(1, bench.extent.seeds + 1), shares,
                                                bench.scenes(knobs.SCENES)):
        def task(seed=seed, share=share, scene=scene):
            data, gone, of = glb.simplified(bench.path(scene.name).read_bytes(), share)
            path = bench.store.keep(("simplified", bench.store.sum_of(bench.path(scene.name)), str(share)),
                                    lambda p: p.write_bytes(data), ".glb")
            portal, cpu, count = bench.portal(path, seed, {})
            row = through(bench, scene, seed, portal, share=share, dropped=gone, triangles=of, chain_cpu=cpu, portals=count)
            return [row]
        yield task


def picture_tasks(bench):
    """Curves of the renderer: error against time by integrator, what its knobs do at one length, and depth."""
    extent = bench.extent
    scenes = bench.scenes(knobs.SCENES + knobs.OPEN)

    def found(scene):
        return bench.portal(bench.path(scene.name), 1, {})[0] if scene.aperture else None

    def task_of(scene, seed, options, spp, knob, value, with_portals=True):
        def task():
            portal = found(scene) if with_portals else None
            return [{"knob": knob, "value": value, **bench.picture(scene.name, seed, options, spp, portal)}]
        return task

    def black_of(scene):
        nothing = {"scene": scene.name, "seed": 0, "spp": 0, "cpu": 0}
        return lambda: [{"knob": "black", "value": "", **nothing, **bench.reference(scene.name)[0].black()}]

    yield from map(black_of, scenes)
    for seed in range(1, extent.seeds + 1):
        for length, integrator, scene in itertools.product(extent.lengths(), knobs.INTEGRATORS, scenes):
            spp = bench.samples_of(scene.name) * length / 8
            if spp >= 1 and (scene.aperture or not integrator.startswith("tdpt")):
                # Pictures of one seed begin with the same samples: each length has its own.
                yield task_of(scene, 1000 * length + seed, ("--integrator", integrator), int(spp), "integrator", integrator,
                              integrator not in knobs.WITHOUT_PORTALS)
        for knob in knobs.KNOBS:
            if knob.program != knobs.RENDERER:
                continue
            for value, scene in itertools.product(extent.values(knob), scenes):
                if scene.aperture:
                    options = ("--integrator", "tdpt-guided", *(knob.arguments(value) if value != knob.default else ()))
                    yield task_of(scene, 500 + seed, options, bench.samples_of(scene.name), knob.name, value)
        for depth, name in itertools.product(knobs.DEPTHS, knobs.WHOLE[:: 2 if extent.quick else 1]):
            scene = knobs.Scene(name, aperture=not name.startswith(("kitchen", "bathroom2")))
            if bench.path(name):
                limit = ("--max-depth=none",) if depth == "none" else ("--max-depth", depth)
                yield task_of(scene, 700 + seed, ("--integrator", "auto", *limit), bench.samples_of(name),
                              "tdpt-render --max-depth", depth)


ROOM = re.compile(r"(ok|MISS)\s+(\S+)\s+(\d+)\s+portals (\d+)/(\d+)\s+coverage (\S+)\s+tightness (\S+)\s+angle\s+(\S+)\s+"
                  r"strays (\d+) .* (\S+) s(?:  FAILED)?$")


def rooms_of(text):
    """Rows of what portals_bench says room by room."""
    fields = ("verdict", "kind", "seed", "portals", "openings", "coverage", "tightness", "angle", "strays", "cpu")
    return [dict(zip(fields, match.groups())) for match in map(ROOM.match, text.splitlines()) if match]


def room_tasks(bench):
    programs = bench.store.programs
    sums = [bench.store.sum_of(programs / p) for p in ("portals_bench", *knobs.STAGES)]
    for (knob, value, settings), kind in itertools.product(list(stage_settings(bench.extent)), knobs.KINDS):
        def task(knob=knob, value=value, settings=settings, kind=kind):
            command = [str(programs / "portals_bench"), str(programs), "--rooms", str(bench.extent.rooms), "--seed", "1801",
                       "--jobs", "1", "--kinds", kind]
            for program, options in settings.items():
                command += [f"--{program}", " ".join(options)]

            def make(path):
                path.write_text(subprocess.run(command, check=True, text=True, stdout=subprocess.DEVNULL,
                                               stderr=subprocess.PIPE).stderr)
            text = bench.store.keep((*sums, *command[2:]), make).read_text()
            return [{"knob": knob, "value": value, **row} for row in rooms_of(text)]
        yield task


TABLES = {"portals": portal_tasks, "pictures": picture_tasks, "rooms": room_tasks, "simplified": simplified_tasks}


def write(path, rows):
    with open(path, "w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        table.writeheader()
        table.writerows({k: "%.6g" % v if isinstance(v, float) else v for k, v in row.items()} for row in rows)


def main(programs, cache, scenes):
    bench = Bench(Path(programs).resolve(), Path(cache), Path(scenes), Extent(os.environ))
    for name, tasks in TABLES.items():
        if os.environ.get("ONLY", name) == name:
            write(bench.cache / f"{name}.csv", run_all(bench, name, list(tasks(bench))))


def run_all(bench, name, tasks):
    """Their rows in order. They are run in another one, always the same, so that settings that are compared are not measured
    one after the other. What fails first ends them all."""
    order = list(range(len(tasks)))
    random.Random(name).shuffle(order)
    with ThreadPoolExecutor(bench.extent.jobs) as pool:
        waiting, rows = [pool.submit(tasks[i]) for i in order], [[] for _ in tasks]
        try:
            for done, (i, future) in enumerate(zip(order, waiting), 1):
                rows[i] = future.result()
                if sys.stderr.isatty() or done % 50 == 0 or done == len(waiting):
                    print(f"tradeoff: {name}: {done} of {len(waiting)}, {bench.store.made} programs run, "
                          f"{bench.store.found} found", file=sys.stderr)
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    return [row for of_task in rows for row in of_task]


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit("usage: measure.py BIN CACHE SCENES")
    try:
        main(*sys.argv[1:])
    except Failed as error:
        print(f"tradeoff: {error}", file=sys.stderr)
        sys.exit(error.status)
    except KeyboardInterrupt:
        sys.exit(130)
    except (OSError, KeyError, ValueError, subprocess.CalledProcessError) as error:
        sys.exit(f"tradeoff: {type(error).__name__}: {error}")
