"""How fast the programs are: the integrators beside Tungsten's (in doc/efficiency.md), lightgrid and tdpt-render on a
device (in doc/gpu.md), and rendering beside casting its rays and nothing else (doc/limit.md)."""
import os
import re
import shutil
import statistics
from collections import defaultdict, namedtuple
from pathlib import Path

import pages
from common import CORES, Setting, Stop, checked, settings

# Tungsten's figures on a machine of the same kind (2 cores, depth 6, box filter, no roulette).
PEERS = {("veach-ajar", "bdpt"): ("47 000", "0.20"), ("veach-ajar", "nee"): ("140 000", "0.44-0.59"),
         ("half-metre-hole", "bdpt"): ("65 000", "0.038"), ("half-metre-hole", "nee"): ("280 000", "-")}


def devices(bench, program):
    """The devices that a program sees, and the processor beside them."""
    listed = checked([bench.store.program(program), "--list-devices"]).said
    models = set(re.findall(r"^model name\s*: (.*\S)", Path("/proc/cpuinfo").read_text(), re.M))
    return (f"The devices beside {CORES} cores of {' '.join(sorted(models))}:\n\n"
            + "\n".join("    " + line for line in listed.splitlines()))


def merged(tables):
    """Tables of the same columns as one."""
    return "\n".join([*tables[0].splitlines()[:2], *(row for of in tables for row in of.splitlines()[2:])])


def register_table(text):
    """Of what device_bench --registers prints, the kernels of which fewest run side by side."""
    heads, _, *rows = ([cell.strip() for cell in line.strip("|").split("|")] for line in text.strip().splitlines())
    wanted = [heads.index(h) for h in ("kernel", "VGPRs", "Spilled VGPRs", "Scratch size", "Subgroups per SIMD")]
    return pages.table([heads[i] for i in wanted], [[row[i] for i in wanted] for row in rows
                                                    if int(row[-1].split()[0]) <= FEW_SUBGROUPS])


@settings(SECONDS_EACH=Setting(60.0, "of a picture on one core", 0.2),
          REF_SECONDS=Setting(600.0, "of a reference on all cores", 0.4))
def integrators(bench):
    """How fast nee and bdpt are, and how noisy their pictures after a minute of one core, beside Tungsten's figures;
    depth 6. Ten minutes."""
    s, rows, sizes = bench.settings, [], {"veach-ajar": (320, 180), "half-metre-hole": (256, 256)}
    for name, scene in bench.there(sizes).items():
        width, height = sizes[name]
        options = ("--portal", bench.portals(scene).file, "--max-depth", 6, "--width", width, "--height", height)
        reference = bench.render(scene, *options, "--integrator", "tdpt-org", "--seed", 1000, "--time",
                                 f"{s.ref_seconds:g}", threads=0)
        for integrator in ("nee", "bdpt"):
            run = bench.render(scene, *options, "--integrator", integrator, "--time", f"{s.seconds_each:g}")
            off, said = bench.distance(run.out, reference.out), run.said
            errors = off["relmse"], off["psnr"], off["black"]["relmse"]
            rows.append([name, integrator, round(width * height * said["spp"] / said["cpu_seconds"]),
                         *("-" if e is None else f"{round(e, 4):.12g}" for e in errors),
                         *PEERS[name, integrator]])
    bench.page("efficiency", {"tungsten": pages.table(
        ("scene", "integrator", "samples per CPU second", f"relMSE after {s.seconds_each:g} s", "PSNR", "black relMSE",
         "Tungsten: samples", "relMSE"), rows)})


# ---- Devices ----
FEW_SUBGROUPS = 6  # of 32
DEVICE = Setting("gpu", "gpu or gpu:WHICH, as --device has it")


@settings(DEVICE=DEVICE)
def grid(bench):
    """How fast each back end of lightgrid is, by lightgrid_bench. Two minutes on two quiet cores."""
    given = []
    for name, scene in bench.there(("veach-ajar", "two-rooms", "half-metre-hole")).items():
        cut = bench.cache / f"{name}.cut"
        shutil.copy(bench.store.run("mincut", bench.store.run("ffgraph", scene, threads=0).out, threads=0).out, cut)
        given += [scene, cut]
    run = checked([bench.store.program("lightgrid_bench"), bench.settings.device, 128, *given])
    bench.page("gpu", {"grid": f"{devices(bench, 'lightgrid')}\n\n{run.said.strip()}"},
               ("libcommon", "shaders", "tools/lightgrid"), "lightgrid")


@settings(DEVICE=DEVICE, ROUNDS=Setting(5, "after the one in which kernels are made", 1),
          RADV=Setting("/usr/share/vulkan/icd.d/radeon_icd.x86_64.json", "driver that tells of registers without a "
                       "device: the file that the Vulkan loader reads for Mesa's RADV"))
def device(bench):
    """How fast tdpt-render is on a device, beside the CPU, and what its kernels take, by device_bench. Ten minutes on
    two quiet cores, most of them for kernels where the device is software."""
    s, program = bench.settings, bench.store.program("device_bench")
    fresh = {"MESA_SHADER_CACHE_DISABLE": "true"}  # kernels are made, not taken from the run before
    tables = []
    for name, scene in bench.there(("veach-ajar", "two-rooms")).items():
        command = [program, "--device", s.device, "--rounds", s.rounds, scene, bench.portals(scene).file]
        told = checked(command, env=fresh).said.strip()
        (bench.cache / f"{name}.txt").write_text(told + "\n", encoding="utf-8")  # rays, time of each kernel
        tables.append(told.split("\n\n")[0])
    registers = checked([program, "--registers"], may_fail=range(1, 256),
                        env={**fresh, "VK_ICD_FILENAMES": s.radv, "RADV_FORCE_FAMILY": "navi21"})
    if registers.status:
        bench.say(registers.errors.strip())
    bench.page("gpu", {
        "device": f"{devices(bench, 'tdpt-render')}\n\n{merged(tables)}",
        "registers": "Not measured: " + (registers.errors.strip().splitlines() or [""])[-1] if registers.status else
                     register_table(registers.said)})


# ---- The limit ----
# factor: CPU time of a frame over that of its rays cast again.
Frame = namedtuple("Frame", "scene integrator threads seed samples closest shadow rays other frame_cpu raw_cpu "
                            "frame_wall raw_wall")

# What a function of the renderer is counted as: the first that fits, by its name or that of its object.
PARTS = (
    ("Embree", r"^libembree", None),
    ("sines, cosines (libm)", r"^libm\b", None),
    ("memory, files, system", r"^(?!tdpt-render)", None),
    ("weights, densities of paths", None, r"\bPath::|::weigh$|NextEventPdf|NextEvents::pdf|emission_pdf|scatter_pdf"),
    ("connections, resampling", None, r"\bconnect|connected|\bEnds?::|Resampling::|Resampling>|LightVertex|_columns|_chosen|"
                                     r"estimate_"),
    ("portals, guided walks", None, r"PortalSet|Guide::|segment|through\b|PathSampler::see"),
    ("surfaces, textures", None, r"bsdf|albedo|layered|place_on_surface|lookup|span_of|shading|base_color|towards|"
                                 r"add_lobes|\bturn|interpolated|\bnode\b|ggx|emission_at"),
    ("rays: origins, hits", None, r"Tracer|::visible|to_places"),
    ("walks", None, r"Walker|walk_from|begin_at_light|place_on_light|place_in_sky"),
    ("lights", None, r"Lights|LightSource|RectLights|WindowSky|Sky|NextEvents|CumulativeTable"),
    ("random numbers", None, r"Sequence|shader::|mix64|numbers"),
    ("film, tally", None, r"Film|Tally|FixedSum|UnitSum|to_pixel|to_film|project"),
    ("techniques", None, r"PathSampler|CpuRenderer|tbb::"),
    ("other", None, r""),
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


HOW = {"perf": "samples of the processor's time by perf (cpu-clock)",
       "callgrind": "instructions by callgrind, of a picture 32 pixels wide, loading included"}


def limit_parts(loads, frames, profiles, how):
    """loads: processes that wanted a core, before and after each scene."""
    busy = max(loads, default=0) > 1.2 and f"""The machine was not idle: up to {max(loads):.0f} processes wanted its \
{CORES} cores, so the clock tells nothing, and shared caches make all times longer."""
    parts = {key: shares(profile) for key, profile in profiles.items()}
    return {
        "factors": pages.table(("scene", "integrator", "rays of a sample", "shadow rays", "sample [ns]",
                                "ray alone [ns]", "frame over rays", "target"), factor_rows(frames)),
        "threads": pages.sections(busy, pages.table(
            ("scene", "integrator", "threads", "frame", "rays alone", "frame by the clock"), thread_rows(frames))),
        "profile": pages.sections(
            f"By {HOW[how]}:",
            pages.table(["part", *(f"{scene}, `{integrator}`" for scene, integrator in parts)],
                        [[name, *(f"{of[name]:.0f} %" if of[name] >= 0.5 else "-" for of in parts.values())]
                         for name, _, _ in PARTS]))}


@settings(INTEGRATORS=Setting("nee,bdpt,tdpt-org,tdpt-guided", "of the frames"),
          THREADS=Setting("1,2", "of the frames"), SEEDS=Setting(5, "one frame each", 1),
          WIDTH=Setting(240, "of the frames", 24), SPP=Setting(8, "of the frames", 1),
          PROFILED=Setting(("bdpt", "tdpt-guided"), "integrators with a profile"),
          PROFILE_SPP=Setting(32, "of that", 2),
          PERF=Setting("perf", "anything else than a program that works: callgrind"))
def limit(bench):
    """How far the renderer is from casting its rays and nothing else: frames of two scenes with the portals that the
    stages find, no limit of depth, by limit_bench; and a profile of what the rest is, by perf, or by callgrind of a
    small picture where perf does not work. Four minutes on two quiet cores."""
    s, record = bench.settings, bench.cache / "perf.data"
    perf = [s.perf, "record", "-q", "-e", "cpu-clock", "-o", record]
    # perf is often there and not allowed, or not made for the kernel.
    works = shutil.which(s.perf) and checked([*perf, "true"], range(1, 256)).status == 0
    if not works and not shutil.which("valgrind"):
        raise Stop(5, f"{s.perf} does not work and valgrind is missing, no profile can be made")
    loads, frames, profiles = [], [], {}

    def profile(scene, portal, integrator):
        render = [bench.store.program("tdpt-render"), "--quiet", scene, "--portal", portal, "--integrator", integrator,
                  "--threads", 1, "-o", bench.cache / "picture.exr"]
        if works:
            checked([*perf, "-F", 997, *render, "--spp", s.profile_spp, "--width", s.width])
            return profile_of(checked([s.perf, "report", "--stdio", "-q", "-i", record, "--no-children", "-F",
                                       "sample,dso,sym", "-t", "|"]).said.splitlines())
        out = bench.cache / "callgrind.out"
        checked(["valgrind", "--quiet", "--tool=callgrind",
                f"--callgrind-out-file={out}", *render, "--spp", 4, "--width", 32])
        told = checked(["callgrind_annotate", "--threshold=100", "--show-percs=no", out]).said
        found = re.findall(r"^ *([0-9][0-9,]*)  [^:\n]*:(.*) \[(.*)\]$", told, re.M)
        return profile_of(f"{count}|{module}|{name}" for count, name, module in found)

    for name, scene in bench.there(("two-rooms", "veach-ajar")).items():
        portal = bench.portals(scene).file
        loads.append(os.getloadavg()[0])
        frames += frames_of(checked([bench.store.program("limit_bench"), scene, portal, "--integrators", s.integrators,
                                     "--threads", s.threads, "--seeds", s.seeds, "--width", s.width, "--spp",
                                     s.spp]).said)
        loads.append(os.getloadavg()[0])
        for integrator in s.profiled:
            profiles[name, integrator] = profile(scene, portal, integrator)
    bench.page("limit", limit_parts(loads, frames, profiles, "perf" if works else "callgrind"))
