"""report_measure.py: measures what the page of a scene tells, into a folder, and writes the page.

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

import report_page

# What a command of tdpt-render may say and a measurement says for itself: options with a value, flags, settings.
VALUES = ("spp", "time", "target-error", "checkpoint", "resume", "add-samples", "stats", "aov", "exposure", "quality", "width", "height",
          "seed", "portal", "integrator", "device", "threads")
FLAGS = ("alpha", "layers", "preview", "json", "explain", "quiet")
SETTINGS = ("checkpoint-every", "nonzero", "progress")
WITH_PORTALS = ("guide-light", "guide-camera", "segments", "light-walks")  # settings of the rendering with portals alone
STAGES = (("ffgraph", "max"), ("mincut", "cut"), ("lightgrid", "vdb"), ("portalfit", "portal.glb"))


class Failed(Exception):
    """A program that failed: its exit code and what it said."""

    def __init__(self, code, text):
        super().__init__(text)
        self.code = code


def taken_apart(words):
    """The options of a command of tdpt-render: what the measurement needs of them, the words that stay in all of its commands, and
    those of the rendering with portals."""
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    for name in VALUES:
        parser.add_argument("--" + name, action="append" if name == "portal" else "store", default=[] if name == "portal" else None)
    for name in FLAGS:
        parser.add_argument("--" + name, action="store_true")
    parser.add_argument("--set", action="append", default=[])
    ours, stay = parser.parse_known_args(words)
    with_portals = [word for file in ours.portal for word in ("--portal", file)]
    for setting in ours.set:
        name = setting.partition("=")[0]
        if name not in SETTINGS:
            (with_portals if name in WITH_PORTALS else stay).extend(["--set", setting])
    return ours, stay, with_portals


def size_of(ours, width):
    """Options of a picture of that width, of the shape that the command gives it."""
    height = max(1, round(width * int(ours.height) / int(ours.width))) if ours.width and ours.height else 0
    return ["--width", str(width), *(["--height", str(height)] if height else [])]


def die_with_parent():
    """Before a program starts: that it is killed when this one is, by SIGKILL too. On Linux alone."""
    if sys.platform == "linux":
        PR_SET_PDEATHSIG = 1
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


def run(command):
    """-> standard output, standard error without progress, which is passed on; ends what it started when it is ended itself."""
    with tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as out, subprocess.Popen(
            command, stdout=out, stderr=subprocess.PIPE, encoding="utf-8", errors="replace", preexec_fn=die_with_parent) as child:
        err = ""
        try:
            for line in child.stderr:
                if line.startswith('{"progress"'):
                    print(line, end="", file=sys.stderr, flush=True)
                else:
                    err += line
            code = child.wait()
        finally:
            child.terminate()
        if code != 0:
            raise Failed(code if code > 0 else 6, err)
        out.seek(0)
        return out.read(), err


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

    def __init__(self, name, command, folder, progress):
        self.name, self.command, self.folder = name, command, folder
        self.progress = ["--set", "progress=json"] if progress else []
        self.steps, self.first, self.last, self.text = [], None, None, ""
        self.picture = self.path(".exr")

    def path(self, end):
        return os.path.join(self.folder, self.name + end)

    def step(self, *more):
        self.picture, film = self.path(f".{len(self.steps)}.exr"), self.path(".film.exr")
        _, text = run([*self.command, "--checkpoint", film, "--resume", film, "--stats", self.path(".stats"), "--explain", "-o", self.picture,
                       *self.progress, *more])
        with open(self.path(".stats"), encoding="utf-8") as stream:
            self.last = json.load(stream)
        self.last.pop("frames", None)
        if not self.steps:
            self.first, self.text = self.last, text
        self.steps.append({"picture": self.picture, "spp": self.last["spp"], "cpu": self.last["cpu_seconds"]})

    def until(self, seconds, threads):
        """About that many CPU seconds; 16 steps at the most."""
        self.step("--time", f"{seconds / threads / 4:g}")
        while len(self.steps) < 16:
            spp, cpu = self.steps[-1]["spp"], self.steps[-1]["cpu"]
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
        return {"command": shlex.join(words), "steps": self.steps, "first": self.first, "last": self.last, "text": self.text}


def options():
    parser = argparse.ArgumentParser(prog="report_measure.py")
    parser.add_argument("--scene", required=True)
    parser.add_argument("--folder", required=True, help="receives what is measured; emptied first")
    parser.add_argument("--page", required=True, help="receives the page")
    usual = {name: os.environ.get("REPORT_" + name.upper()) or value for name, value in (("time", "10"), ("reference", "8"), ("width", "320"))}
    parser.add_argument("--time", type=float, default=usual["time"], help="CPU seconds of each rendering")
    parser.add_argument("--reference", type=float, default=usual["reference"],
                        help="samples of the reference, in those of the longest with portals")
    parser.add_argument("--width", type=int, default=usual["width"])
    parser.add_argument("--exrdiff", help="default beside the renderer, as --info")
    parser.add_argument("--info")
    parser.add_argument("--stem", default="", help="of the stages' results; empty where no stage found the portals")
    parser.add_argument("--known", default="", help="where the stages told of themselves; default beside their results")
    parser.add_argument("--threads", default="")
    parser.add_argument("--quiet", action="store_true")
    parser.add_argument("--progress", action="store_true", help="tell it in objects of JSON on standard error")
    parser.add_argument("-MF", default="")
    parser.add_argument("-MQ", default="")
    parser.add_argument("command", nargs="+", help="of tdpt-render, as for the picture")
    a = parser.parse_args()
    programs = os.path.dirname(a.command[0])
    a.exrdiff, a.info = a.exrdiff or os.path.join(programs, "exrdiff"), a.info or os.path.join(programs, "tdpt-info")
    for name, value, least, most in (("time", a.time, 0.1, 1e6), ("reference", a.reference, 1, 1e4), ("width", a.width, 16, 4096)):
        if not least <= value <= most:
            parser.error(f"--{name}: {value:g} given, expected {least:g} to {most:g}")
    return a


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


def write_pngs(a, renders):
    """All exposed as the first."""
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

    shutil.rmtree(a.folder, ignore_errors=True)
    os.makedirs(a.folder)
    ours, stay, with_portals = taken_apart(a.command[1:])
    threads = int(a.threads or ours.threads or 0) or len(os.sched_getaffinity(0))
    seed, chosen = int(ours.seed or 1), ours.integrator or "auto"
    base = [a.command[0], a.scene, *stay, *size_of(ours, a.width), "--threads", str(threads)]
    ways = {"with": [*base, *with_portals, "--integrator", chosen, "--seed", str(seed)],
            "without": [*base, "--integrator", "bdpt", "--seed", str(seed)],
            "reference": [*base, *with_portals, "--integrator", chosen, "--seed", str(seed + 1)]}
    renders = {name: Render(name, command, a.folder, a.progress) for name, command in ways.items()}
    say(f"renders {a.width} pixels wide, with portals and without for {a.time:g} CPU seconds each, and a reference for about "
        f"{a.reference * a.time:g}: {duration((2 + a.reference) * a.time / threads)} if nothing else runs; REPORT_TIME={a.time:g} sets it")
    for number, name, words in ((1, "with", f"{chosen} with the portals"), (2, "without", "bdpt without portals")):
        say(f"{number} of 3: {words}, {duration(a.time / threads)}")
        began = time.monotonic()
        renders[name].until(a.time, threads)
    if not renders["with"].last["nonzero"] and not renders["without"].last["nonzero"]:
        raise Failed(3, "report: both pictures are black, expected some light to compare")
    say(f"3 of 3: the reference, {duration(a.reference * (time.monotonic() - began))}")
    reference = renders["reference"]
    reference.step("--spp", str(max(1, round(a.reference * renders["with"].last["spp"]))), *(["-MF", a.MF, "-MQ", a.MQ] if a.MF else []))

    black = [score(a, renders[name], reference.picture) for name in ("with", "without")][0]
    write_pngs(a, (reference, renders["with"], renders["without"]))
    records = {name: render.record() for name, render in renders.items()}
    files = [a.scene, *(f"{a.stem}.{end}" for _, end in STAGES[:3] if a.stem), *ours.portal, *(render.path(".exr") for render in renders.values())]
    result = {"scene": os.path.basename(a.scene), "factor": a.reference, "given": [os.path.basename(file) for file in ours.portal],
              "stages": list(stage_reports(a.stem, a.known or a.stem, a.folder)) if a.stem else [], "integrator": chosen, **records, "black": black,
              "info": [info_of(a, file) for file in files], "version": run([a.command[0], "--version"])[0].strip().splitlines()}
    # Where files lie is nobody's business but the machine's.
    text = json.dumps(result, indent=1)
    for path in sorted({os.path.dirname(file) for file in [a.scene, a.stem, a.folder, *ours.portal] if file}, key=len, reverse=True):
        if len(path) > 1:
            text = re.sub("(?<![\\w/.])" + re.escape(json.dumps(path + "/")[1:-1]), "", text)
    with open(os.path.join(a.folder, "measured.json"), "w", encoding="utf-8") as stream:
        stream.write(text + "\n")
    with open(a.page, "w", encoding="utf-8", errors="replace") as stream:
        stream.write(report_page.page(a.folder))


def main():
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(6))
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
