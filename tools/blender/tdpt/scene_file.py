"""The scene as glTF, by a Blender of its own: the one with the window goes on, and its scene stays as it is."""
import hashlib
import os
import tempfile

import bpy

from . import programs

WRITTEN = "export.py: "


def folder():
    """For files of this session."""
    base = bpy.app.tempdir or tempfile.gettempdir()
    path = os.path.join(base, f"tdpt-{os.getpid()}")
    os.makedirs(path, exist_ok=True)
    return path


def save(scene, name):
    """The scene with all that belongs to it, as it is now, as a library file; `name`: what it is for."""
    if scene.library:
        raise programs.Failure(f"Scene {scene.name} is linked from another file: make it local first")
    for thing in scene.objects:
        if thing.mode == "EDIT":
            thing.update_from_editmode()
    path = os.path.join(folder(), name + ".blend")
    bpy.data.libraries.write(path, {scene}, path_remap="ABSOLUTE", fake_user=True)
    return path


def exporting(saved, scene_name, frame, out, layer=""):
    """A generator that writes the glTF file `out`; its result: what the export has to tell, sentences."""
    told = None
    words = programs.blender("export.py", out, "--file=" + saved, "--scene=" + scene_name, f"--frame={frame!r}")
    words += ["--view-layer=" + layer] if layer else []
    for lines in programs.running(words):
        for line in lines:
            if told is not None and line.startswith("  "):
                told.append(line.strip())
            elif line.startswith(WRITTEN):
                told = []
        yield (0.0, "exporting the scene")
    return unsaved() + (told or [])


def unsaved():
    """Pixels that are in no file do not reach the process that exports."""
    images = [i for i in bpy.data.images if i.is_dirty and i.users and i.type == "IMAGE"]
    return [f"image {i.name}: is not saved, its changes are lost; save or pack it" for i in images]


def digest(path):
    with open(path, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()
