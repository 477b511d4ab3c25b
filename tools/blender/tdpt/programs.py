"""Finds the programs and runs them beside Blender, which stays usable."""
import contextlib
import glob
import json
import os
import queue
import signal
import subprocess
import sys
import threading
import time

import bpy

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT_PACKAGE = __package__


class Failure(Exception):
    """What went wrong, in a sentence."""


def preferences():
    addon = bpy.context.preferences.addons.get(ROOT_PACKAGE)
    return addon and addon.preferences


def folders():
    """Where the programs may be, the likeliest first: the preference, a tarball unpacked beside the extension or beside the
    .blend file, the PATH, the usual places."""
    own = preferences()
    given = bpy.path.abspath(own.folder) if own and own.folder else ""
    if given:
        yield from (given, os.path.join(given, "bin"))
    for beside in (HERE, os.path.dirname(HERE), bpy.path.abspath("//") if bpy.data.filepath else ""):
        if beside:
            yield from sorted(glob.glob(os.path.join(glob.escape(beside), "tdpt-*", "bin")), reverse=True)
    # As installed, this folder is share/tdpt/blender/tdpt beside bin.
    yield os.path.abspath(os.path.join(HERE, *[os.pardir] * 4, "bin"))
    yield from os.environ.get("PATH", "").split(os.pathsep)
    yield from ("/usr/local/bin", os.path.expanduser("~/.local/bin"))


def program(name="tdpt"):
    """Its path; None where it is missing."""
    for folder in folders():
        path = os.path.join(folder, name)
        if os.path.isfile(path) and os.access(path, os.X_OK):
            return path
    return None


MISSING = "The tdpt programs are missing: install them, or name their folder in the add-on's preferences"


def needed():
    path = program()
    if not path:
        raise Failure(MISSING)
    return path


def blender(script, *words):
    """A command that runs a script of this folder in a Blender of its own, without a window."""
    script = os.path.join(HERE, script)
    if bpy.app.binary_path:
        return [bpy.app.binary_path, "-b", "--factory-startup", "--python-exit-code", "1", "-P", script, "--", *words]
    return [sys.executable, script, "--", *words]  # Blender as a Python module


def environment():
    """For a program of ours: without the Python of Blender, and with Debian's before others that lack numpy."""
    env = {key: value for key, value in os.environ.items() if key not in ("PYTHONHOME", "LD_PRELOAD")}
    if bpy.app.binary_path:
        env.pop("PYTHONPATH", None)
        env["PATH"] = os.pathsep.join(["/usr/bin", env.get("PATH", "")])
    return env


def stop(process):
    """Politely first: tdpt stops its own programs."""
    if process.poll() is None:
        process.send_signal(signal.SIGTERM)
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(5)
    if process.poll() is None:
        process.kill()
        process.wait()


def running(words, accepted=(0,)):
    """A generator of lists of new lines of a program; it ends with the program, and stops it when it is closed. Raises Failure with its last line of error for any other exit code."""
    try:
        process = subprocess.Popen(
            words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=environment(),
            text=True, encoding="utf-8", errors="replace",
        )
    except OSError as error:
        raise Failure(f"{words[0]}: {error.strerror}") from error
    lines = queue.Queue()

    def read():
        for line in process.stdout:
            lines.put(line.rstrip("\n"))
        lines.put(None)

    threading.Thread(target=read, daemon=True).start()
    said = []
    try:
        ended = False
        while not ended:
            new = []
            while not lines.empty():
                new.append(lines.get_nowait())
            ended = None in new
            new = [line for line in new if line is not None]
            said += [line for line in new if not line.startswith("{")]
            yield new
        process.wait()
    finally:
        stop(process)
        process.stdout.close()
    if process.returncode not in accepted:
        name = os.path.basename(words[0])
        told = [line for line in said if line.strip()]
        faults = [line for line in told if "Error:" in line and "script failed" not in line] or told
        raise Failure(faults[-1] if faults else f"{name} ended with exit code {process.returncode}")


def progress_of(line):
    """(share done or None, words) of a progress line of tdpt; None for other lines."""
    if not line.startswith("{"):
        return None
    try:
        told = json.loads(line)
    except ValueError:
        return None
    if "progress" not in told:
        return None
    p = told["progress"]
    step, steps = p.get("step", 1), max(1, p.get("steps", 1))
    within = p["done"] / p["total"] if p.get("total") and p.get("done") else 0.0
    words = p.get("title") or p.get("what") or ""
    left = p.get("left") or 0
    if left >= 1:
        words += f", {left:.0f} s left" if left < 100 else f", {left / 60:.0f} min left"
    return (step - 1 + min(1.0, within)) / steps, words


def last_progress(lines, before):
    """The progress that the last of these lines tells; `before` where none does."""
    for line in reversed(lines):
        told = progress_of(line)
        if told:
            return told
    return before


def told_by(lines):
    """What the programs say in these lines, in the form of an export's sentences: a warning is of the light."""
    told = []
    for line in lines:
        tool, colon, sentence = line.partition(": ")
        if line.startswith("{") or not colon:
            continue
        warned = sentence.removeprefix("warning: ")
        told.append(f"light: {warned}" if warned != sentence else f"note: {tool}: {sentence}")
    return told


def wait(generator, tick=0.02, seen=None):
    """Runs a generator to its end; its result."""
    while True:
        try:
            value = next(generator)
        except StopIteration as end:
            return end.value
        if seen:
            seen(value)
        time.sleep(tick)
