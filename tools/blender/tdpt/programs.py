"""Finds the programs and runs them beside Blender, which stays usable. A generator that runs one gives (share done, words) until
the program has ended, and stops it when it is closed."""
import contextlib
import importlib
import json
import os
import subprocess
import sys
import tempfile
import threading
import time

import bpy

HERE = os.path.dirname(os.path.abspath(__file__))
MISSING = "The tdpt programs are missing: install them, or name their folder in the add-on's preferences"


class Failure(Exception):
    """What went wrong, in a sentence."""


def folders():
    """Where the programs may be, the likeliest first: the preference, the wheel that a zip for one platform brings, beside this
    folder, the PATH, the usual places."""
    addon = bpy.context.preferences.addons.get(__package__)
    given = bpy.path.abspath(addon.preferences.folder) if addon and addon.preferences and addon.preferences.folder else ""
    if given:
        yield from (given, os.path.join(given, "bin"))
    with contextlib.suppress(ImportError, AttributeError, OSError):  # before Blender 4.2 this extension is itself called tdpt
        yield importlib.import_module("tdpt").bundled()
    # As installed, this folder is share/tdpt/blender/tdpt beside bin.
    yield os.path.abspath(os.path.join(HERE, *[os.pardir] * 4, "bin"))
    yield from os.environ.get("PATH", "").split(os.pathsep)
    yield from ("/usr/local/bin", os.path.expanduser("~/.local/bin"))


def program(name="tdpt"):
    """Its path; None where it is missing."""
    paths = (os.path.join(folder, name) for folder in folders())
    return next((path for path in paths if os.path.isfile(path) and os.access(path, os.X_OK)), None)


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
    """For a program of ours: without the Python of Blender, and with Debian's before others that lack numpy. A Blender with factory
    settings would remove the wheels of this one's extensions."""
    env = {key: value for key, value in os.environ.items() if key not in ("PYTHONHOME", "LD_PRELOAD")}
    env["BLENDER_USER_EXTENSIONS"] = os.path.join(session_folder(), "extensions")
    if bpy.app.binary_path:
        env.pop("PYTHONPATH", None)
        env["PATH"] = os.pathsep.join(["/usr/bin", env.get("PATH", "")])
    return env


def stop(process):
    """Politely first: tdpt stops its own programs."""
    process.terminate()
    try:
        process.wait(5)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def running(words, title="", low=0.0, high=1.0, accepted=(0,)):
    """Runs a program whose work is from `low` to `high` of all; the result is the lines that it says. Raises Failure with its last
    error for any other exit code."""
    try:
        process = subprocess.Popen(
            words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=environment(),
            text=True, encoding="utf-8", errors="replace",
        )
    except OSError as error:
        raise Failure(f"{words[0]}: {error.strerror}") from error
    progress, lines = [(0.0, title)], []

    def read():
        for line in process.stdout:
            told = progress_of(line)
            progress.append(told) if told else lines.append(line.rstrip("\n"))

    reader = threading.Thread(target=read, daemon=True)
    reader.start()
    try:
        while reader.is_alive():
            share, shown = progress[-1]
            yield low + (high - low) * share, shown
        process.wait()
    finally:
        stop(process)
        reader.join()
        process.stdout.close()
    if process.returncode not in accepted:
        said = [line for line in lines if line.strip()]
        faults = [line for line in said if "Error:" in line and "script failed" not in line] or said
        raise Failure(faults[-1] if faults else f"{os.path.basename(words[0])} ended with exit code {process.returncode}")
    return lines


def progress_of(line):
    """(share done, words) of a progress line of tdpt; None for other lines."""
    try:
        p = json.loads(line)["progress"] if line.startswith("{") else None
    except (ValueError, KeyError):
        return None
    if not p:
        return None
    step, steps = p.get("step", 1), max(1, p.get("steps", 1))
    within = p["done"] / p["total"] if p.get("total") and p.get("done") else 0.0
    words = p.get("title") or p.get("what") or ""
    left = p.get("left") or 0
    if left >= 1:
        words += f", {left:.0f} s left" if left < 100 else f", {left / 60:.0f} min left"
    return (step - 1 + min(1.0, within)) / steps, words


def sentences_in(lines):
    """What the programs say, in the form of an export's sentences: a warning is of the light."""
    found = []
    for tool, colon, sentence in (line.partition(": ") for line in lines):
        warned = sentence.removeprefix("warning: ")
        if colon:
            found.append(f"light: {warned}" if warned != sentence else f"note: {tool}: {sentence}")
    return found


def wait(generator):
    """Runs a generator to its end; its result."""
    while True:
        try:
            next(generator)
        except StopIteration as end:
            return end.value
        time.sleep(0.02)


# The scene as glTF, by a Blender of its own: the one with the window goes on, and its scene stays as it is.


def session_folder():
    path = os.path.join(bpy.app.tempdir or tempfile.gettempdir(), f"tdpt-{os.getpid()}")
    os.makedirs(path, exist_ok=True)
    return path


def save(scene, name):
    """The scene with all that belongs to it, as it is now, as a library file; `name`: what it is for."""
    if scene.library:
        raise Failure(f"Scene {scene.name} is linked from another file: make it local first")
    for thing in scene.objects:
        if thing.mode == "EDIT":
            thing.update_from_editmode()
    path = os.path.join(session_folder(), name + ".blend")
    bpy.data.libraries.write(path, {scene}, path_remap="ABSOLUTE", fake_user=True)
    return path


def exporting(saved, scene_name, frame, out, layer="", high=1.0):
    """A generator that writes the glTF file `out`; its result: what the export loses and does, sentences."""
    words = blender("export.py", out, "--file=" + saved, "--scene=" + scene_name, f"--frame={frame!r}")
    words += ["--view-layer=" + layer] if layer else []
    lines = yield from running(words, "exporting the scene", high=high)
    # Pixels that are in no file do not reach the process that exports.
    unsaved = [i for i in bpy.data.images if i.is_dirty and i.users and i.type == "IMAGE"]
    return [f"light: image {i.name}: is not saved, its changes are lost; save or pack it" for i in unsaved] + [
        line.strip() for line in lines if line.startswith(("  light: ", "  look: ", "  note: "))]
