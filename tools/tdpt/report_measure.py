"""report_measure.py: measures what the page of a scene tells, into a folder, for report_page.py.

Renders the scene twice, each for as many CPU seconds: by bdpt without portals, and by `auto` (or what the command says)
with them. A rendering begins with a quarter of its time, in which it decides what renders, and goes on from its own
checkpoint in doublings, so that no sample is drawn twice; every step is held against a reference of another seed, which
is rendered last and longer. What the stages told of themselves is read where it lies beside their results. CPU seconds,
because they are the same on a busy machine. Standard library alone.
"""

import argparse
import ctypes
import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time

# What a command of tdpt-render may say and a measurement says for itself, with the number of values.
OURS = {
    "--spp": 1, "--time": 1, "--target-error": 1, "--set retry": 1, "--checkpoint": 1, "--set checkpoint-every": 1, "--resume": 1,
    "--add-samples": 1, "--stats": 1, "--alpha": 0, "--layers": 0, "--aov": 1, "--set nonzero": 1, "--preview": 0, "--exposure": 1,
    "--set pixels": 1, "--set compression": 1, "--json": 0,
    "--explain": 0, "--quiet": 0, "--quality": 1, "--set progress": 1, "--width": 1, "--height": 1, "--seed": 1, "--portal": 1,
    "--integrator": 1, "--set guide-light": 1, "--set guide-camera": 1, "--set segments": 1, "--set light-walks": 1,
    "--device": 1}
STAGES = (("ffgraph", "max"), ("mincut", "cut"), ("lightgrid", "vdb"), ("portalfit", "portal.glb"))


class Failed(Exception):
    """A program that failed: its exit code and what it said."""

    def __init__(self, code, text):
        super().__init__(text)
        self.code = code


def options_of(words):
    """The words of a command of tdpt-render after the program -> (the words that stay, {option of OURS: its values})."""
    stay, ours = [], {}
    words = list(words)
    while words:
        taken = words.pop(0).split("=", 1) if words[0].startswith("--set=") else [words.pop(0)]
        if taken == ["--set"] and words:
            taken.append(words.pop(0))
        name, equals, value = " ".join(taken).partition("=")
        if name not in OURS:
            stay += taken
        elif equals:
            ours.setdefault(name, []).append(value)
        else:
            ours.setdefault(name, []).append(" ".join(words[:OURS[name]]))
            del words[:OURS[name]]
    return stay, ours


def size_of(ours, width):
    """Options of a picture of that width, of the shape that the command gives it."""
    if "--width" in ours and "--height" in ours:
        height = round(width * int(ours["--height"][-1]) / int(ours["--width"][-1]))
        return ["--width", str(width), "--height", str(max(1, height))]
    return ["--width", str(width)]


def die_with_parent():
    """Before a program starts: that it is killed when this one is, by SIGKILL too. On Linux alone."""
    if sys.platform == "linux":
        PR_SET_PDEATHSIG = 1
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


def run(command, progress=None):
    """-> standard output, standard error, largest memory [bytes]; ends what it started when it is ended itself. `progress` takes
    the lines of progress among the errors."""
    with tempfile.TemporaryFile() as out:
        child = subprocess.Popen(command, stdout=out, stderr=subprocess.PIPE, preexec_fn=die_with_parent)
        try:
            err = ""
            for line in child.stderr:
                line = line.decode("utf-8", "replace")
                if progress and line.startswith('{"progress"'):
                    progress(line)
                else:
                    err += line
            _, status, usage = os.wait4(child.pid, 0)
            child.returncode = os.waitstatus_to_exitcode(status)
        finally:
            if child.returncode is None:
                child.terminate()
                child.wait()
            child.stderr.close()
        if child.returncode != 0:
            raise Failed(child.returncode if child.returncode > 0 else 6, err)
        out.seek(0)
        return out.read().decode("utf-8", "replace"), err, usage.ru_maxrss * 1024


def told(stem, known, folder):
    """What each stage told of itself when it made its result, from the files beside it."""
    stages = []
    for tool, end in STAGES:
        result, beside = f"{stem}.{end}", f"{known}.{end}.told"
        stage = {"tool": tool, "file": os.path.basename(result), "json": None, "text": "", "picture": None, "missing": None}
        stages.append(stage)
        try:
            with open(f"{beside}.json", encoding="utf-8", errors="replace") as stream:
                stage["json"] = json.load(stream)
            with open(f"{beside}.txt", encoding="utf-8", errors="replace") as stream:
                stage["text"] = stream.read()
            picture = f"{tool}.{'svg' if os.path.exists(f'{beside}.svg') else 'png'}"
            shutil.copyfile(f"{beside}.{picture[-3:]}", os.path.join(folder, picture))
            stage["picture"] = picture
        except (OSError, ValueError) as error:
            stage["missing"] = f"what it told of itself cannot be read ({error.__class__.__name__})"
    return stages


def threads_of(words):
    """As many as a program uses that is given these."""
    given = [word.partition("=")[2] or after for word, after in zip(words, [*words[1:], ""]) if word.partition("=")[0] == "--threads"]
    return int(given[-1] if given else 0) or len(os.sched_getaffinity(0))


def with_more(told, later):
    """Decisions that were told, and those later ones that are of something else."""
    def what(line):
        return ": ".join(line.split(": ")[:2])
    known = {what(line) for line in told.splitlines()}
    return told + "".join(line + "\n" for line in later.splitlines() if ", because " in line and what(line) not in known)


class Render:
    """One of the renderings that are compared: it goes on from its checkpoint until its time is spent."""

    def __init__(self, name, command, folder):
        self.name, self.command, self.folder = name, command, folder
        self.steps, self.first, self.last, self.text, self.later, self.peak = [], None, None, "", "", 0

    def step(self, *more, progress=None):
        picture = os.path.join(self.folder, f"{self.name}.{len(self.steps)}.exr")
        film, stats = (os.path.join(self.folder, f"{self.name}.{end}") for end in ("film.exr", "stats"))
        _, self.later, peak = run([*self.command, "--checkpoint", film, "--resume", film, "--stats", stats, "--explain", "-o", picture, *more],
                               progress=progress)
        with open(stats, encoding="utf-8") as stream:
            self.last = json.load(stream)
        self.last.pop("frames", None)
        if not self.steps:
            self.first, self.text = self.last, self.later
        self.peak = max(self.peak, peak)
        self.steps.append({"picture": picture, "spp": self.last["spp"], "cpu": self.last["cpu_seconds"],
                           "wall": self.last["seconds"]})

    def until(self, seconds, threads, progress):
        """About that many CPU seconds; 16 steps at the most. `progress` takes how many there are."""
        self.step("--time", f"{seconds / threads / 4:g}")
        while len(self.steps) < 16:
            spp, cpu = self.steps[-1]["spp"], self.steps[-1]["cpu"]
            progress(cpu)
            more = min(spp, int((seconds - cpu) / cpu * spp + 0.5)) if cpu > 0 else spp
            if more < 1:
                break
            self.step("--add-samples", str(more))


def options():
    parser = argparse.ArgumentParser(prog="report_measure.py")
    parser.add_argument("--scene", required=True)
    parser.add_argument("--folder", required=True, help="receives what is measured; emptied first")
    parser.add_argument("--time", type=float, default=10, help="CPU seconds of each rendering")
    parser.add_argument("--reference", type=float, default=8, help="samples of the reference, in those of the longest with portals")
    parser.add_argument("--width", type=int, default=320)
    parser.add_argument("--exrdiff", required=True)
    parser.add_argument("--info", required=True)
    parser.add_argument("--stem", default="", help="of the stages' results; empty where no stage found the portals")
    parser.add_argument("--known", default="", help="where the stages told of themselves; default beside their results")
    parser.add_argument("--threads", default="")
    parser.add_argument("--quiet", action="store_true")
    parser.add_argument("--progress", action="store_true", help="tell it in objects of JSON on standard error")
    parser.add_argument("-MF", default="")
    parser.add_argument("-MQ", default="")
    parser.add_argument("command", nargs="+", help="of tdpt-render, as for the picture")
    options = parser.parse_args()
    if not 0.1 <= options.time <= 1e6:
        parser.error("--time is in CPU seconds, 0.1 to 1000000")
    if not 1 <= options.reference <= 1e4:
        parser.error("--reference is a factor, 1 to 10000")
    if not 16 <= options.width <= 4096:
        parser.error("--width is in pixels, 16 to 4096")
    return options


def measure(a):
    def say(words):
        if not a.quiet:
            print(f"report: {words}", file=sys.stderr, flush=True)
    def about(seconds):
        return f"about {seconds:.0f} s" if seconds < 100 else f"about {seconds / 60:.0f} minutes"

    def so_far(done, total, began):
        """Of a rendering; in CPU seconds, and what is left by the clock."""
        if a.progress and done > 0:
            left = (time.monotonic() - began) * max(0, total - done) / done
            sys.stderr.write(json.dumps({"progress": {"what": "measuring", "done": done, "total": total, "left": round(left, 1)}}) + "\n")
            sys.stderr.flush()
    shutil.rmtree(a.folder, ignore_errors=True)
    os.makedirs(a.folder)
    stay, ours = options_of(a.command[1:])
    threads = ["--threads", a.threads] if a.threads else []
    seed = int(ours.get("--seed", ["1"])[-1])
    base = [a.command[0], a.scene, *stay, *size_of(ours, a.width), *threads, "--quiet"]
    loud = [word for word in base if word != "--quiet"]
    portals = [word for file in ours.get("--portal", []) for word in ("--portal", file)]
    for name in ("guide-light", "guide-camera", "segments", "light-walks"):
        if "--set " + name in ours:
            portals += ["--set", f"{name}={ours['--set ' + name][-1]}"]
    chosen = ours.get("--integrator", ["auto"])[-1]

    stages = told(a.stem, a.known or a.stem, a.folder) if a.stem else []

    with_portals = Render("with", [*loud, *portals, "--integrator", chosen, "--seed", str(seed)], a.folder)
    without = Render("without", [*loud, "--integrator", "bdpt", "--seed", str(seed)], a.folder)
    at_once = threads_of(loud)
    say(f"renders {a.width} pixels wide, with portals and without for {a.time:g} CPU seconds each, and a reference for about "
        f"{a.reference * a.time:g}: {about((2 + a.reference) * a.time / at_once)} if nothing else runs; REPORT_TIME={a.time:g} sets it")
    for number, render, words in ((1, with_portals, f"{chosen} with the portals"), (2, without, "bdpt without portals")):
        say(f"{number} of 3: {words}, {about(a.time / at_once)}")
        began = time.monotonic()
        render.until(a.time, at_once, lambda cpu, began=began: so_far(cpu, a.time, began))
        took = time.monotonic() - began
    if not with_portals.last["nonzero"] and not without.last["nonzero"]:
        raise Failed(3, "report: both pictures are black, expected some light to compare")
    spp = max(1, round(a.reference * with_portals.last["spp"]))
    say(f"3 of 3: the reference, {about(a.reference * took)}")
    reference = Render("reference", [*(loud if a.progress else base), *portals, "--integrator", chosen, "--seed", str(seed + 1)], a.folder)
    reference.step("--spp", str(spp), *(["--set", "progress=json"] if a.progress else []), *(["-MF", a.MF, "-MQ", a.MQ] if a.MF else []),
                   progress=lambda line: (sys.stderr.write(line), sys.stderr.flush()))
    truth = reference.steps[-1]["picture"]

    black = None
    for render in (with_portals, without):
        for step in render.steps:
            out, _, _ = run([a.exrdiff, step["picture"], truth, "--json"])
            score = json.loads(out)
            black = score["black"]
            step.update({key: score[key] for key in ("relmse", "relmse_trimmed", "psnr", "mape", "mean", "reference_mean",
                                                     "nonzero")})
        run([a.exrdiff, render.steps[-1]["picture"], truth, "-o", os.path.join(a.folder, f"{render.name}-error.png")])
    # All are exposed as the reference.
    show = [os.path.join(os.path.dirname(a.exrdiff), "exrmerge"), "--quiet"]
    stops = json.loads(run([*show, truth, "-o", os.path.join(a.folder, "reference.png"), "--json"])[0])["exposure"]
    for render in (with_portals, without):
        run([*show, render.steps[-1]["picture"], "-o", os.path.join(a.folder, f"{render.name}.png"), f"--exposure={stops}"])

    files = [a.scene, *(f"{a.stem}.{end}" for _, end in STAGES[:3] if a.stem), *ours.get("--portal", []),
             without.steps[-1]["picture"], with_portals.steps[-1]["picture"], truth]
    info = []
    for file in dict.fromkeys(files):
        try:
            info.append(json.loads(run([a.info, "--json", file])[0]))
        except (Failed, ValueError) as error:
            info.append({"file": file, "failed": str(error).strip()})
    version = run([a.command[0], "--version"])[0].strip().splitlines()

    def shown(command):
        return shlex.join(os.path.basename(word) if os.sep in word else word for word in command if word != "--quiet")
    for render, name in ((without, "without.exr"), (with_portals, "with.exr"), (reference, "reference.exr")):
        kept = os.path.join(a.folder, name)
        os.replace(render.steps[-1]["picture"], kept)
        for entry in info:
            if entry["file"] == render.steps[-1]["picture"]:
                entry["file"] = name
        for step in render.steps[:-1]:
            os.remove(step["picture"])
        for end in ("film.exr", "stats"):
            os.remove(os.path.join(a.folder, f"{render.name}.{end}"))
    for entry in info:
        entry["file"] = os.path.basename(entry["file"])

    def plain(render):
        steps = [{key: value for key, value in step.items() if key != "picture"} for step in render.steps]
        return {"command": shown(render.command), "steps": steps, "first": render.first, "last": render.last,
                "text": with_more(render.text, render.later), "peak_bytes": render.peak}
    result = {"scene": os.path.basename(a.scene), "seconds": a.time, "factor": a.reference, "seed": seed,
              "given": [os.path.basename(file) for file in ours.get("--portal", [])], "stages": stages,
              "integrator": chosen, "with": plain(with_portals), "without": plain(without), "reference": plain(reference),
              "black": black, "info": info, "version": version}
    # Where files lie is nobody's business but the machine's.
    text = json.dumps(result, indent=1)
    for path in sorted({os.path.dirname(file) for file in [a.scene, a.stem, a.folder, *ours.get("--portal", [])] if file},
                       key=len, reverse=True):
        if len(path) > 1:
            text = re.sub("(?<![\\w/.])" + re.escape(json.dumps(path + "/")[1:-1]), "", text)
    with open(os.path.join(a.folder, "measured.json"), "w", encoding="utf-8") as stream:
        stream.write(text + "\n")


def main():
    def stopped(number, _frame):
        sys.exit(6 if number == signal.SIGTERM else 130)
    signal.signal(signal.SIGTERM, stopped)
    try:
        measure(options())
    except Failed as error:
        sys.stderr.write("".join(line + "\n" for line in str(error).splitlines() if ", because " not in line))
        return error.code
    except KeyboardInterrupt:
        return 6
    return 0


if __name__ == "__main__":
    sys.exit(main())
