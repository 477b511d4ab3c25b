"""How far rendering is from casting its rays and nothing else, and how fast it is on a device: doc/limit.md."""
import os
import re
import shutil
import statistics
from collections import defaultdict, namedtuple

import pages
from common import CORES, Setting, checked, settings

# factor: CPU time of a frame over that of its rays cast again.
Frame = namedtuple("Frame", "scene integrator threads seed samples closest shadow rays other frame_cpu raw_cpu "
                            "frame_wall raw_wall")

# What a function of the renderer is counted as: the first that fits, by its name or that of its object.
PARTS = (
    ("Embree", r"^libembree", None),
    ("sines, cosines (libm)", r"^libm\b", None),
    ("memory, files, system", r"^(?!tdpt-render)", None),
    ("weights, densities of paths", None, r"\bPath::|::weigh$|NextEventPdf|NextEvents::pdf|emission_pdf|scatter_pdf"),
    ("connections, resampling", None, r"\bconnect|connected|\bEnds?::|Resampling|LightVertex|_columns|_chosen|estimate_"),
    ("portals, guided walks", None, r"PortalSet|Guide::|segment|through\b|PathSampler::see"),
    ("surfaces, textures", None, r"bsdf|albedo|layered|place_on_surface|lookup|span_of|shading|base_color|towards|"
                                 r"add_lobes|\bturn|interpolated|\bnode\b|ggx|emission_at"),
    ("rays: origins, hits", None, r"Tracer|::visible|to_places"),
    ("walks, lights", None, r"Walker|walk_from|begin_at_light|place_on_light|place_in_sky|Light|Sky|NextEvents|CumulativeTable"),
    ("random numbers", None, r"Sequence|shader::|mix64|numbers"),
    ("techniques, film, other", None, r""),
)
WANTED = {"bdpt": 1.6, "tdpt-guided": 2.2}  # of a frame over its rays


def shares(profile):
    """Percentages of the parts of [(count, object, function)]."""
    parts = dict.fromkeys((name for name, _, _ in PARTS), 0.0)
    for count, module, function in profile:
        part = next(name for name, of_module, of_function in PARTS
                    if (of_module and re.search(of_module, module)) or
                    (of_function is not None and re.search(of_function, function)))
        parts[part] += 100 * count / sum(count for count, _, _ in profile)
    return parts


def frames_of(text):
    """Of what limit_bench prints."""
    frames = []
    for line in text.splitlines():
        scene, *fields = line.split("\t")
        if not scene.strip() or scene == "scene":
            continue
        f = Frame(scene.rsplit("/", 1)[-1].removesuffix(".glb"), fields[0], *map(int, fields[1:8]),
                  *map(float, fields[8:]))
        if f.other:
            raise ValueError(f"{f.scene}, {f.integrator}: {f.other} rays ended otherwise when they were cast again")
        if f.rays < f.closest + f.shadow:
            raise ValueError(f"{f.scene}, {f.integrator}: rays are missing from the record")
        frames.append(f)
    return frames


def profile_of(lines):
    """[(count, object, function)] of lines COUNT|OBJECT|FUNCTION."""
    parts = [line.split("|", 2) for line in lines if line.count("|") >= 2]
    return [(int(count.replace(",", "")), module.strip().rsplit("/", 1)[-1], re.sub(r"^\[[.k]\] *", "", name.strip()))
            for count, module, name in parts]


def spread(values):
    """Median, and the least and the largest."""
    return f"{statistics.median(values):.2f} ({min(values):.2f} to {max(values):.2f})"


def groups(frames):
    """(scene, integrator, {threads: [frames]}) in the order of the scenes, of what was rendered by one thread, too."""
    found = {}
    for f in frames:
        found.setdefault((f.scene, f.integrator), defaultdict(list))[f.threads].append(f)
    scenes = [f.scene for f in frames]
    return [(*key, of) for key, of in sorted(found.items(), key=lambda item: scenes.index(item[0][0])) if 1 in of]


def factor_rows(frames):
    rows = []
    for scene, integrator, by_threads in groups(frames):
        middle = lambda value, of=by_threads[1]: statistics.median(map(value, of))
        factors, aim = [f.frame_cpu / f.raw_cpu for f in by_threads[1]], WANTED.get(integrator)
        met = "met" if aim and statistics.median(factors) <= aim else "**missed**"
        rows.append((scene, f"`{integrator}`", f"{middle(lambda f: f.rays / f.samples):.1f}",
                     f"{100 * middle(lambda f: f.shadow / f.rays):.0f} %",
                     f"{1e9 * middle(lambda f: f.frame_cpu / f.samples):.0f}",
                     f"{1e9 * middle(lambda f: f.raw_cpu / f.rays):.0f}", spread(factors),
                     f"{aim}: {met}" if aim else "-"))
    return rows


def thread_rows(frames):
    """Of n threads over one: how many times as fast if every thread had a core, and by the clock."""
    rows = []
    for scene, integrator, by_threads in groups(frames):
        for n in sorted(set(by_threads) - {1}):
            pairs = [(a, b) for a in by_threads[1] for b in by_threads[n] if a.seed == b.seed]
            rows.append((scene, f"`{integrator}`", str(n), spread([n * a.frame_cpu / b.frame_cpu for a, b in pairs]),
                         spread([n * a.raw_cpu / b.raw_cpu for a, b in pairs]),
                         spread([a.frame_wall / b.frame_wall for a, b in pairs])))
    return rows


def limit_parts(loads, frames, profiles):
    """loads: processes that wanted a core, before and after each scene."""
    busy = max(loads, default=0) > 1.2 and f"""The machine was not idle: up to {max(loads):.0f} processes wanted its \
{CORES} cores, so the clock tells nothing, and shared caches make all times longer."""
    parts = {key: shares(profile) for key, profile in profiles.items()}
    return {
        "factors": pages.table(("scene", "integrator", "rays of a sample", "shadow rays", "sample [ns]",
                                "ray alone [ns]", "frame over rays", "target"), factor_rows(frames)),
        "threads": pages.sections(busy, pages.table(
            ("scene", "integrator", "threads", "frame", "rays alone", "frame by the clock"), thread_rows(frames))),
        "profile": pages.table(["part", *(f"{scene}, `{integrator}`" for scene, integrator in parts)],
                               [[name, *(f"{of[name]:.0f} %" if of[name] >= 0.5 else "-" for of in parts.values())]
                                for name, _, _ in PARTS]) if parts else "Not measured: perf does not work there."}


@settings(INTEGRATORS=Setting("nee,bdpt,tdpt-org,tdpt-guided", "of the frames"),
          THREADS=Setting("1,2", "of the frames"), SEEDS=Setting(5, "one frame each", 1),
          WIDTH=Setting(240, "of the frames", 24), SPP=Setting(8, "of the frames", 1),
          PROFILED=Setting(("bdpt", "tdpt-guided"), "integrators with a profile"),
          PROFILE_SPP=Setting(32, "of that", 2))
def limit(bench):
    """How far the renderer is from casting its rays and nothing else: frames of two scenes with the portals that the
    stages find, no limit of depth, by limit_bench; and a profile of what the rest is, where perf works. Four minutes on
    two quiet cores."""
    s, record = bench.settings, bench.cache / "perf.data"
    perf = ["perf", "record", "-q", "-e", "cpu-clock", "-o", record]
    # perf is often there and not allowed, or not made for the kernel.
    works = shutil.which("perf") and checked([*perf, "true"], range(1, 256)).status == 0
    loads, frames, profiles = [], [], {}
    for name, scene in bench.there(("two-rooms", "veach-ajar")).items():
        portal = bench.portals(scene).file
        loads.append(os.getloadavg()[0])
        frames += frames_of(checked([bench.store.program("limit_bench"), scene, portal, "--integrators", s.integrators,
                                     "--threads", s.threads, "--seeds", s.seeds, "--width", s.width, "--spp",
                                     s.spp]).said)
        loads.append(os.getloadavg()[0])
        for integrator in s.profiled if works else ():
            checked([*perf, "-F", 997, bench.store.program("tdpt-render"), "--quiet", scene, "--portal", portal,
                     "--integrator", integrator, "--threads", 1, "--spp", s.profile_spp, "--width", s.width, "-o",
                     bench.cache / "picture.exr"])
            profiles[name, integrator] = profile_of(checked(
                ["perf", "report", "--stdio", "-q", "-i", record, "--no-children", "-F", "sample,dso,sym", "-t",
                 "|"]).said.splitlines())
    bench.page("limit", limit_parts(loads, frames, profiles))


# ---- Devices ----
@settings(DEVICE=Setting("gpu", "gpu or gpu:WHICH, as --device has it"),
          ROUNDS=Setting(5, "after the one in which kernels are made", 1))
def device(bench):
    """How fast tdpt-render is on a device, beside the CPU, by device_bench. Rays, bytes and time of each kernel stay in
    the cache. Ten minutes on two quiet cores, most of them for kernels where the device is software."""
    listed, tables = checked([bench.store.program("tdpt-render"), "--list-devices"]).said, []
    for name, scene in bench.there(("veach-ajar", "two-rooms")).items():
        command = [bench.store.program("device_bench"), "--device", bench.settings.device, "--rounds",
                   bench.settings.rounds, scene, bench.portals(scene).file]
        # Kernels are made, not taken from the run before.
        told = checked(command, env={"MESA_SHADER_CACHE_DISABLE": "true"}).said.strip()
        (bench.cache / f"{name}.txt").write_text(told + "\n", encoding="utf-8")
        tables.append(told.split("\n\n")[0].splitlines())
    rows = [*tables[0], *(row for of in tables[1:] for row in of[2:])]
    bench.page("limit", {"device": pages.sections("\n".join("    " + line for line in listed.splitlines()),
                                                  "\n".join(rows))})
