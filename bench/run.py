#!/usr/bin/python3
"""bench/run.py NAME [--quick] [--bin BIN] [--cache CACHE] [--doc DOC] [SETTING=VALUE ...]

Runs a benchmark of the programs in BIN (build/bin) and writes its tables into a page in DOC (doc). Pictures and results
stay in CACHE (build/NAME), so that a run that was stopped goes on where it was. `bench/run.py NAME --help` tells what
is measured and the settings, which the environment may have as well. --quick: sizes of a trial.

bench/run.py test NAME [ARGUMENT ...]: runs NAME_test.py; 77, with a word, where no Python has numpy.
Without a NAME: what there is."""
import argparse
import importlib
import os
import runpy
import signal
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BENCHMARKS = {  # name: (module, function, what it does)
    "demo": ("demo", "demo", "a room without its portals, with them, and filtered, in the same time: in demo/"),
    "before-after": ("figures", "before_after", "the README's picture, and the numbers of its caption (eight minutes)"),
    "efficiency": ("efficiency", "efficiency", "error against time of every integrator: doc/efficiency.md (an hour and a "
                   "half; BASELINE=PROGRAM BASELINE_NAME=WORDS: over that older one's)"),
    "efficiency-references": ("efficiency", "references", "its references that are missing or out of date"),
    "quality": ("cost", "quality", "what --quality draft, normal and high are worth: in doc/efficiency.md (ten minutes)"),
    "figures": ("figures", "figures", "the paper's Figs 5 to 7 from our renders: in doc/efficiency.md (five minutes)"),
    "portals": ("portals", "portals", "how right portals are in rooms with known openings: doc/portals.md (an hour)"),
    "houses": ("portals", "houses", "the same in real buildings, and what portals are worth there: in doc/portals.md (two "
               "hours; WORTH=0: half an hour)"),
    "cameras": ("portals", "cameras", "portals found for all cameras together: in doc/portals.md (half an hour)"),
    "stages": ("figures", "stages", "pictures of what each stage did: in doc/portals.md"),
    "regret": ("promises", "regret", "what auto loses, and how right it is about portals: doc/regret.md (25 minutes)"),
    "target-error": ("promises", "target_error", "whether pictures have the error that was asked for: in doc/regret.md "
                     "(ten minutes)"),
    "denoise": ("denoise", "denoise", "what the filter is worth, and what it costs: doc/denoise.md (two hours)"),
    "denoise-frames": ("denoise", "denoise_frames", "what frames before and after are worth to it (half an hour)"),
    "denoise-pictures": ("denoise", "denoise_pictures", "hard places before and after the filter (half an hour)"),
    "sky": ("sky", "sky", "what the windows found are worth under skies: doc/sky.md (a quarter of an hour)"),
    "limit": ("speed", "limit", "how far rendering is from casting its rays and nothing else: doc/limit.md (4 minutes)"),
    "gpu-speed": ("speed", "device", "samples per second on a device: in doc/limit.md (ten minutes; DEVICE=gpu:WHICH)"),
    "scale": ("cost", "scale", "time and memory against triangles: in doc/limit.md (a quarter of an hour, 5 GiB)"),
    "peers": ("peers", "peers", "beside Cycles, LuxCore and Mitsuba, by `make peers`: doc/peers.md (an hour)"),
    "paper-scenes": ("paper_scenes", "paper_scenes", "the paper's scenes out of Bitterli's archives for Mitsuba, edited and "
                     "imported (FOLDER=FOLDER OUT=FOLDER)"),
    "public-files": ("public_files", "public_files", "what becomes of every glTF file below a folder: prints the table "
                     "of doc/scenes.md"),
    "work-model": ("work_model", "work_model", "fits the tables of tools/tdpt-render/plan/work_model.h"),
}
LISTING = "\n".join(f"  {name:{max(map(len, BENCHMARKS))}}  {words}" for name, (_, _, words) in BENCHMARKS.items())


def imported(module):
    """The module; goes on with the distribution's Python where this one lacks numpy. None where no Python has it."""
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError:
        system = "/usr/bin/python3"
        if os.environ.get("BENCH_PYTHON") or not os.access(system, os.X_OK):
            return None
        os.environ["BENCH_PYTHON"] = system
        os.execv(system, [system, "-B", *sys.argv])


def run(name, function, words):
    """A benchmark by the words of its command line; its exit code."""
    import common
    parser = argparse.ArgumentParser(prog=f"bench/run.py {name}", add_help=False)
    for folder in ("bin", "cache", "doc"):
        parser.add_argument(f"--{folder}", type=Path)
    parser.add_argument("--quick", action="store_true", default=os.environ.get("QUICK", "") not in ("", "0"))
    parser.add_argument("--help", action="store_true")
    parser.add_argument("settings", nargs="*", metavar="SETTING=VALUE")
    options = parser.parse_intermixed_args(words)
    if options.help:
        print(f"{name}: {function.__doc__}\n")
        for key, setting in function.settings.items():
            default = " ".join(setting.default) if isinstance(setting.default, tuple) else setting.default
            quick = "" if setting.quick is None else f"; quick {setting.quick}"
            print(f"  {key:16} {setting.words} ({default}{quick})")
        return 0
    signal.signal(signal.SIGTERM, lambda *_: signal.raise_signal(signal.SIGINT))
    try:
        bench = common.Bench(name, function, (options.bin or ROOT / "build/bin").resolve(),
                             (options.cache or ROOT / "build" / name).resolve(),
                             (options.doc or Path(os.environ.get("DOC") or ROOT / "doc")).resolve(),
                             dict(word.partition("=")[::2] for word in options.settings), options.quick)
        function(bench)
        if bench.store.made + bench.store.found:
            bench.say(f"{bench.store.made} results made, {bench.store.found} found in {bench.cache}")
        return 0
    except common.Stop as stop:
        print(f"{name}: {stop}", file=sys.stderr)
        return stop.status
    except (OSError, KeyError, ValueError) as error:
        print(f"{name}: {type(error).__name__}: {error}", file=sys.stderr)
        return 4
    except KeyboardInterrupt:
        return 130
    finally:
        common.end_running()


def main(name="--help", *words):
    if name in ("--help", "-h"):
        print(f"{__doc__}\n\n{LISTING}")
        return 0
    if name == "test" and words:
        if not imported("numpy"):
            print("skipped: no python3 here has numpy (Debian: python3-numpy)")
            return 77
        sys.argv = [str(Path(__file__).with_name(f"{words[0]}_test.py")), *words[1:]]
        runpy.run_path(sys.argv[0], run_name="__main__")
        return 0
    if name not in BENCHMARKS:
        print(f"bench/run.py: {name} is none of the benchmarks:\n{LISTING}", file=sys.stderr)
        return 2
    module, function, _ = BENCHMARKS[name]
    found = imported(module)
    if not found:
        print(f"{name}: python3 with numpy is missing (Debian: python3-numpy)", file=sys.stderr)
        return 5
    return run(name, getattr(found, function), words)


if __name__ == "__main__":
    os.environ["LC_ALL"] = "C"
    sys.dont_write_bytecode = True
    sys.exit(main(*sys.argv[1:]))
