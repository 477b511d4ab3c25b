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
    "--spp": 1, "--time": 1, "--target-error": 1, "--checkpoint": 1, "--set checkpoint-every": 1, "--resume": 1,
    "--add-samples": 1, "--stats": 1, "--alpha": 0, "--layers": 0, "--aov": 1, "--set nonzero": 1, "--preview": 0, "--exposure": 1,
    "--json": 0,
    "--explain": 0, "--quiet": 0, "--quality": 1, "--set progress": 1, "--width": 1, "--height": 1, "--seed": 1, "--portal": 1,
    "--integrator": 1, "--set guide-light": 1, "--set guide-camera": 1, "--set segments": 1, "--set light-walks": 1,
    "--device": 1, "--threads": 1}
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


def stage_reports(stem, known, folder):
    """What each stage told of itself when it made its result, from the files beside it."""
    for tool, end in STAGES:
        beside = f"{known}.{end}.told"
        stage = {"tool": tool, "json": None, "text": "", "picture": None, "missing": None}
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
        yield stage


class Render:
    """One of the renderings that are compared: it goes on from its checkpoint until its time is spent."""

    def __init__(self, name, command, folder):
        self.name, self.command, self.folder = name, command, folder
        self.steps, self.first, self.last, self.text, self.peak = [], None, None, "", 0
        self.picture = self.path(".exr")

    def path(self, end):
        return os.path.join(self.folder, self.name + end)

    def step(self, *more, progress=None):
        self.picture, film = self.path(f".{len(self.steps)}.exr"), self.path(".film.exr")
        _, text, peak = run([*self.command, "--checkpoint", film, "--resume", film, "--stats", self.path(".stats"), "--explain", "-o", self.picture,
                             *more], progress)
        with open(self.path(".stats"), encoding="utf-8") as stream:
            self.last = json.load(stream)
        self.last.pop("frames", None)
        if not self.steps:
            self.first, self.text = self.last, text
        self.peak = max(self.peak, peak)
        self.steps.append({"picture": self.picture, "spp": self.last["spp"], "cpu": self.last["cpu_seconds"]})

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

    def record(self):
        """Of measured.json; the last picture alone stays."""
        for step in self.steps:
            picture = step.pop("picture")
            if picture != self.picture:
                os.remove(picture)
        for end in (".film.exr", ".stats"):
            os.remove(self.path(end))
        os.replace(self.picture, self.path(".exr"))
        words = [os.path.basename(word) if os.sep in word else word for word in self.command]
        return {"command": shlex.join(words), "steps": self.steps, "first": self.first, "last": self.last, "text": self.text, "peak_bytes": self.peak}


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


def duration(seconds):
    return f"about {seconds:.0f} s" if seconds < 100 else f"about {seconds / 60:.0f} minutes"


def score(a, render, truth):
    """Adds the error of each step to it; -> that of a black picture."""
    for step in render.steps:
        scores = json.loads(run([a.exrdiff, step["picture"], truth, "--json"])[0])
        black = scores.pop("black")
        step.update(scores)
    run([a.exrdiff, render.picture, truth, "-o", render.path("-error.png")])
    return black


def show(a, renders):
    """PNGs, all exposed as the first."""
    stops = []
    for render in renders:
        out = run([os.path.join(os.path.dirname(a.exrdiff), "exrmerge"), "--quiet", "--json", render.picture, "-o", render.path(".png"), *stops])[0]
        stops = stops or [f"--exposure={json.loads(out)['exposure']}"]


def info_of(a, file):
    try:
        return {**json.loads(run([a.info, "--json", file])[0]), "file": os.path.basename(file)}
    except (Failed, ValueError) as error:
        return {"file": os.path.basename(file), "failed": str(error).strip()}


def measure(a):
    def say(words):
        if not a.quiet:
            print(f"report: {words}", file=sys.stderr, flush=True)

    def relay(line):
        sys.stderr.write(line)
        sys.stderr.flush()
    shutil.rmtree(a.folder, ignore_errors=True)
    os.makedirs(a.folder)
    stay, ours = options_of(a.command[1:])
    threads = int(a.threads or ours.get("--threads", ["0"])[-1]) or len(os.sched_getaffinity(0))
    seed = int(ours.get("--seed", ["1"])[-1])
    given = ours.get("--portal", [])
    base = [a.command[0], a.scene, *stay, *size_of(ours, a.width), "--threads", str(threads)]
    portals = [word for file in given for word in ("--portal", file)]
    for name in ("guide-light", "guide-camera", "segments", "light-walks"):
        if "--set " + name in ours:
            portals += ["--set", f"{name}={ours['--set ' + name][-1]}"]
    chosen = ours.get("--integrator", ["auto"])[-1]
    stages = list(stage_reports(a.stem, a.known or a.stem, a.folder)) if a.stem else []

    with_portals = Render("with", [*base, *portals, "--integrator", chosen, "--seed", str(seed)], a.folder)
    without = Render("without", [*base, "--integrator", "bdpt", "--seed", str(seed)], a.folder)
    say(f"renders {a.width} pixels wide, with portals and without for {a.time:g} CPU seconds each, and a reference for about "
        f"{a.reference * a.time:g}: {duration((2 + a.reference) * a.time / threads)} if nothing else runs; REPORT_TIME={a.time:g} sets it")
    for number, render, words in ((1, with_portals, f"{chosen} with the portals"), (2, without, "bdpt without portals")):
        say(f"{number} of 3: {words}, {duration(a.time / threads)}")
        began = time.monotonic()

        def so_far(cpu, began=began):
            left = (time.monotonic() - began) * max(0, a.time - cpu) / cpu if cpu > 0 else a.time
            if a.progress:
                relay(json.dumps({"progress": {"what": "measuring", "done": cpu, "total": a.time, "left": round(left, 1)}}) + "\n")
        render.until(a.time, threads, so_far)
    if not with_portals.last["nonzero"] and not without.last["nonzero"]:
        raise Failed(3, "report: both pictures are black, expected some light to compare")
    say(f"3 of 3: the reference, {duration(a.reference * (time.monotonic() - began))}")
    reference = Render("reference", [*base, *portals, "--integrator", chosen, "--seed", str(seed + 1)], a.folder)
    reference.step("--spp", str(max(1, round(a.reference * with_portals.last["spp"]))), *(["--set", "progress=json"] if a.progress else []),
                   *(["-MF", a.MF, "-MQ", a.MQ] if a.MF else []), progress=relay)

    black = [score(a, render, reference.picture) for render in (with_portals, without)][0]
    show(a, (reference, with_portals, without))
    records = {render.name: render.record() for render in (with_portals, without, reference)}
    files = [a.scene, *(f"{a.stem}.{end}" for _, end in STAGES[:3] if a.stem), *given,
             *(render.path(".exr") for render in (without, with_portals, reference))]
    result = {"scene": os.path.basename(a.scene), "factor": a.reference, "given": [os.path.basename(file) for file in given], "stages": stages,
              "integrator": chosen, **records, "black": black, "info": [info_of(a, file) for file in files],
              "version": run([a.command[0], "--version"])[0].strip().splitlines()}
    # Where files lie is nobody's business but the machine's.
    text = json.dumps(result, indent=1)
    for path in sorted({os.path.dirname(file) for file in [a.scene, a.stem, a.folder, *given] if file}, key=len, reverse=True):
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
