"""What every benchmark shares: its settings, the scenes, programs whose results are kept by content, what a run takes,
errors against references, and turns."""
import functools
import hashlib
import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import threading
from collections import namedtuple
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import pages

ROOT = Path(__file__).resolve().parent.parent
TESTDATA = ROOT / "testdata"
STAGES = ("ffgraph", "mincut", "lightgrid", "portalfit")
# Names of what they write, which stand in pictures of it.
OUTPUTS = {"ffgraph": "room.max", "mincut": "room.cut", "lightgrid": "room.vdb", "portalfit": "room.portal.glb"}
CORES = os.cpu_count()
PLACES = ("SCENES", "JOBS", "REFERENCE_FOLDER", "BASELINE")  # settings that tell a reader nothing


class Stop(Exception):
    """Ends a benchmark. status: 2 wrong settings, 3 no scene, 4 a program failed, 5 something is missing."""

    def __init__(self, status, words):
        super().__init__(words)
        self.status = status


@dataclass(frozen=True)
class Setting:
    """default: its type is the setting's, a tuple is a list of words. quick: what --quick has in its place."""

    default: object
    words: str
    quick: object = None

    def read(self, name, text):
        try:
            return tuple(text.split()) if isinstance(self.default, tuple) else type(self.default)(text)
        except ValueError as error:
            raise Stop(2, f"{name}={text} is no number") from error


COMMON = {
    "SCENES": Setting(str(ROOT / "../shared/scenes"),
                      "folder of the paper's scenes, with interiors/; one that is not there is left out, with a word"),
    "ONLY": Setting((), "names of what is to be measured; default all"),
    "JOBS": Setting(len(os.sched_getaffinity(0)), "programs at a time where they have one thread each"),
}


def settings(**own):
    """Of a benchmark, a function of a Bench."""
    def decorate(function):
        function.settings = {**COMMON, **own}
        return function
    return decorate


# ---- What a run takes ----
# Its own process, since what a parent holds counts as a child's memory: about 10 MiB are the least it can tell.
LAUNCH = """import json, os, signal, sys
child = os.posix_spawnp(sys.argv[2], sys.argv[2:], os.environ)
signal.signal(signal.SIGTERM, lambda *_: os.kill(child, signal.SIGTERM))
_, status, usage = os.wait4(child, 0)
with open(sys.argv[1], "w") as file:
    json.dump({"status": os.waitstatus_to_exitcode(status), "cpu": usage.ru_utime + usage.ru_stime,
               "peak_mib": usage.ru_maxrss / 1024}, file)"""
running = set()  # processes, to be ended where a benchmark is


def measure(command, env=None):
    """A process as it went: status, cpu [s], peak_mib, said, errors. Nothing of it is kept."""
    with tempfile.NamedTemporaryFile(prefix="bench-") as told:
        child = subprocess.Popen([sys.executable, "-I", "-S", "-c", LAUNCH, told.name, *map(str, command)],
                                 stdout=subprocess.PIPE, stderr=subprocess.PIPE, env={**os.environ, **(env or {})})
        running.add(child)
        try:
            said, errors = child.communicate()
        finally:
            running.discard(child)
        facts = told.read()
    if not facts:
        raise Stop(4, f"{command[0]} cannot be run: {errors.decode(errors='replace').strip()}")
    return SimpleNamespace(**json.loads(facts), said=said.decode(), errors=errors.decode(errors="replace"))


def end_running():
    for child in list(running):
        child.terminate()


def checked(command, may_fail=(), env=None):
    """The same of a program that has to end well, or by one of the codes of may_fail."""
    run = measure(command, env)
    if run.status and run.status not in may_fail:
        words = f"{' '.join(map(str, command))}: exit code {run.status}: {run.errors.strip() or run.said[-2000:]}"
        raise Stop(run.status if run.status > 0 else 4, words)
    return run


def peers_python():
    """The Python that has other renderers: PEERS_PYTHON, what `make peers` built, or python3."""
    built = ROOT / "build/peers/venv/bin/python"
    return os.environ.get("PEERS_PYTHON") or (str(built) if built.exists() else "python3")


# ---- Results that are kept ----
# Those of the programs that obey --seed and have --quality, and what others lack of the options that all runs have.
SEEDED = ("ffgraph", "lightgrid")
LACK = {"exrdiff": ("--quiet", "--no-provenance", "--threads")}


def common_options(program, threads, provenance=True):
    """--quiet, --json and the rest, as far as the program has them. threads: 0 for all cores."""
    options = {"--quiet": (), "--json": (), **({"--threads": (threads,)} if threads else {}),
               **({} if provenance else {"--no-provenance": ()})}
    return [word for name, value in options.items() if name not in LACK.get(program, ()) for word in (name, *value)]


class Made(str):
    """An argument: a file of that name that the program writes beside its result, its path after `before`."""

    def __new__(cls, name, before=""):
        made = super().__new__(cls, name)
        made.before = before
        return made


class Run:
    """What is kept of one: out, a path; cpu [s], peak [MiB], status; said, a dictionary."""

    def __init__(self, folder):
        facts, self.folder = json.loads((folder / "run.json").read_text()), folder
        self.cpu, self.status, self.peak, self.out = facts["cpu"], facts["status"], facts["peak_mib"], folder / facts["out"]
        self.said = json.loads(facts["said"] or "{}")


class Store:
    """Runs of programs, kept by content: the key of a run is what the program is, its arguments and what is in the
    files that it reads. A run that is there is not made again; one that was cut short leaves nothing."""

    def __init__(self, folder, programs):
        self.folder, self.programs, self.lock = Path(folder), Path(programs), threading.Lock()
        self.made = self.found = 0

    @functools.cache
    def sum_of(self, path):
        """Of a file, which is read once."""
        return hashlib.sha256(Path(path).read_bytes()).hexdigest()

    def program(self, name):
        path = self.programs / name
        if not os.access(path, os.X_OK):
            raise Stop(5, f"{path} is missing")
        return path

    def run(self, program, *arguments, threads=1, output=True, provenance=False, may_fail=()):
        """Runs PROGRAM ARGUMENT... --quiet --json -o OUT, or finds what it made. Arguments: paths of files that are
        read, Made names, or what has a text. threads: 0 for all cores. Exit codes of may_fail are kept as results."""
        path = self.program(program)

        def make(folder):
            folder.mkdir()
            out = OUTPUTS.get(path.name, "out")
            run = checked([path, *(f"{a.before}{folder / a}" if isinstance(a, Made) else a for a in arguments),
                           *common_options(path.name, threads, provenance),
                           *(("-o", folder / out) if output else ())], may_fail)
            facts = {"out": out, "said": "" if run.status else run.said, "cpu": run.cpu, "status": run.status,
                     "peak_mib": run.peak_mib}
            (folder / "run.json").write_text(json.dumps(facts))

        read = ["file " + self.sum_of(a) if isinstance(a, Path) else f"word {a}" for a in arguments]
        return Run(self.keep([self.sum_of(path), f"threads {threads}", f"provenance {provenance}", *read], make, ""))

    def keep(self, words, make, suffix=".kept"):
        """A file or folder that make(path) writes. words: all that it depends on."""
        path = self.folder / (hashlib.sha256("\0".join(map(str, words)).encode()).hexdigest()[:32] + suffix)
        if path.exists():
            self.found += 1
            return path
        self.folder.mkdir(parents=True, exist_ok=True)
        half = path.with_suffix(f".half{threading.get_ident()}{suffix}")
        try:
            make(half)
            with self.lock:
                if not path.exists():  # or another thread was faster
                    half.rename(path)
        finally:
            shutil.rmtree(half, ignore_errors=True)
            half.unlink(missing_ok=True)
        self.made += 1
        return path


# ---- Errors ----
class Halves:
    """A reference in two halves A, B of different seeds. A picture x is off by (d(x,A) + d(x,B) - d(A,B)) / 2, d =
    relMSE or MSE of exrdiff: this is the mean of (x-A)(x-B), to which the noise of neither half contributes on average;
    it may come out below zero."""

    def __init__(self, bench, a, b):
        self.bench, self.a, self.b = bench, a, b
        self.ways = bench.distance(a, b), bench.distance(b, a)
        self.black, self.peak = self.ways[0]["black"], self.ways[0]["peak"]

    def both(self, *fields):
        """Mean of a field of both ways."""
        return sum(functools.reduce(dict.get, fields, way) or 0 for way in self.ways) / 2

    def off(self, picture):
        """relmse, mse, mape, mean and reference_mean of a picture."""
        to = self.bench.distance(picture, self.a), self.bench.distance(picture, self.b)
        mean = {field: sum(d[field] for d in to) / 2 for field in ("mape", "mean", "reference_mean")}
        return {**mean, **{e: (to[0][e] + to[1][e] - self.both(e)) / 2 for e in ("relmse", "mse")}}


def decibels_of(peak_squared, mse):
    return 10 * math.log10(peak_squared / mse) if mse > 0 else math.nan


def turns(seeds, methods):
    """(seed, method): every seed begins with another method, so that a machine that is busy for a while slows all."""
    methods = list(methods)
    for seed in seeds:
        yield from ((seed, method) for method in methods)
        methods.append(methods.pop(0))


# Of a scene, by the four stages. said: portalfit's summary; cpu: of all four [s]; runs: {program: Run}.
Portals = namedtuple("Portals", "file said count cpu runs")


class Bench:
    """A benchmark that is being run. settings: their values, by their names in small letters."""

    def __init__(self, name, function, programs, cache, doc, given=(), quick=False):
        self.name, self.programs, self.cache, self.doc, self.quick = name, Path(programs), Path(cache), Path(doc), quick
        self.given, self.own = dict(given), [key for key in function.settings if key not in COMMON]
        for folder in (self.cache, self.doc):
            folder.mkdir(parents=True, exist_ok=True)
        self.store = Store(self.cache / "runs", self.programs)
        values = {}
        for key, setting in function.settings.items():
            text = self.given.get(key) or os.environ.get(key, "")
            default = setting.quick if quick and setting.quick is not None else setting.default
            values[key.lower()] = setting.read(key, text) if text else default
        self.settings = SimpleNamespace(**values)
        unknown = [key for key in self.given if key not in function.settings]
        if unknown:
            raise Stop(2, f"{unknown[0]} is no setting of {name}; it has {', '.join(function.settings)}")

    def say(self, words):
        print(f"{self.name}: {words}", file=sys.stderr)

    def need(self, program):
        if not shutil.which(program):
            raise Stop(5, f"{program} is missing (cmake/packages-figures.txt)")

    def version(self, program="tdpt-render"):
        return checked([self.store.program(program), "--version"]).said.splitlines()[0]

    def find(self, scene):
        """The file of a scene, None where there is none. NAME-whole is scene NAME."""
        scenes = Path(self.settings.scenes)
        paths = (folder / f"{scene.removesuffix('-whole')}.glb"
                 for folder in (TESTDATA / "scenes", scenes, scenes / "interiors", scenes / "houses"))
        return next((path.resolve() for path in paths if path.exists()), None)

    def there(self, names):
        """Those that are wanted and there: {name: file}."""
        files = {name: self.find(name) for name in names if not self.settings.only or name in self.settings.only}
        for name in (name for name, path in files.items() if not path):
            self.say(f"{name}: there is no {name.removesuffix('-whole')}.glb in SCENES, left out")
        found = {name: path for name, path in files.items() if path}
        if not found:
            raise Stop(3, "none of the scenes is there")
        return found

    def portals(self, scene, sky=(), options=lambda program: (), threads=0):
        """By the four stages; sky: options of those that need the light; options: more of each program, or None."""
        runs, out = {}, ()
        for program in STAGES:
            inputs = (scene, *out, *sky) if program in ("ffgraph", "lightgrid") else out
            runs[program] = run = self.store.run(program, *inputs, *(options(program) or ()), threads=threads)
            out = (run.out,)
        return Portals(run.out, run.said, len(run.said.get("portals", ())), sum(r.cpu for r in runs.values()), runs)

    def render(self, scene, *options, threads=1, **more):
        return self.store.run("tdpt-render", scene, *options, threads=threads, **more)

    def fresh(self, program, *arguments, output=None, threads=1):
        """Runs it now, whatever was kept: what it took."""
        run = checked([self.store.program(program), *arguments, *common_options(program, threads),
                       *(("-o", output) if output else ())])
        run.said = json.loads(run.said or "{}")
        return run

    def distance(self, picture, reference):
        """What exrdiff says."""
        return self.store.run("exrdiff", picture, reference, output=False).said

    def halves(self, render):
        """A reference of two runs, render(seed)."""
        return Halves(self, *(render(1000000 + half).out for half in (1, 2)))

    def side_by_side(self, tasks):
        """What functions of no arguments return, in order, JOBS of them at a time; all end where one fails."""
        with ThreadPoolExecutor(self.settings.jobs) as pool:
            waiting = [pool.submit(task) for task in tasks]
            try:
                return [future.result() for future in waiting]
            except BaseException as error:
                if not isinstance(error, Exception):
                    end_running()
                pool.shutdown(cancel_futures=True)
                raise

    def measured(self, program="tdpt-render"):
        """The line of a page that says how its numbers were measured: command, version, machine."""
        values = {key: getattr(self.settings, key.lower()) for key in self.own}
        given = {"QUICK": "1"} if self.quick else {}
        given.update({k: f"{v:g}" for k, v in values.items() if isinstance(v, (int, float)) and v}, **self.given)
        command = " ".join([f"make bench-{self.name}", *(f'{k}="{v}"' if " " in v else f"{k}={v}"
                                                         for k, v in given.items() if k not in PLACES)])
        return f"*Measured by `{command}` with {self.version(program)} on {machine()}.*"

    def page(self, name, parts, program="tdpt-render"):
        """Fills DOC/NAME.md, whole or not at all: the parts between <!-- PART --> and <!-- end -->, and the line that
        tells how this benchmark measured them. All else is written by hand; where DOC lacks the page, it is copied."""
        path, half = self.doc / f"{name}.md", self.cache / f"{name}.md"
        text = (path if path.exists() else ROOT / "doc" / path.name).read_text(encoding="utf-8")
        text = pages.filled(text, parts, self.name, self.measured(program))
        half.write_text(text, encoding="utf-8")
        shutil.move(half, path)
        self.say(path)


def machine():
    """Its cores and its processor."""
    model = re.search(r"^model name\s*: (.*)$", Path("/proc/cpuinfo").read_text(encoding="utf-8"), re.M)
    return f"{CORES} cores" + (f" of {model[1]}" if model else "")
