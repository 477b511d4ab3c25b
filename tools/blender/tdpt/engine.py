"""Render with tdpt: F12, animations and the compositor."""
import contextlib
import os
import time

import bpy
import numpy

from . import camera, exr, portals, programs

CHANNELS = ("R", "G", "B", "A")
EXTRA = {  # pass of Blender: (its channels, those of the picture)
    "Depth": ("Z", ("depth.Z",)),
    "Normal": ("XYZ", ("normal.X", "normal.Y", "normal.Z")),
    "Denoising Albedo": ("RGB", ("albedo.R", "albedo.G", "albedo.B")),
    "Noisy Image": ("RGB", ("noisy.R", "noisy.G", "noisy.B")),
}
CHECKPOINT = 3  # seconds between pictures that are shown


class Rendered:
    """The last rendering, for the panel: a rendering may not write to the scene."""

    sentences = []  # of the export, the worst first, and then of the programs


def options_of(settings, scene, film, portal_file):
    words = [f"--seed={(settings.seed + (scene.frame_current if settings.animate_seed else 0)) % 2**32}"]
    for name, option in (("samples", "spp"), ("time", "time"), ("noise", "target-error"), ("max_depth", "max-depth")):
        if getattr(settings, name):
            words.append(f"--{option}={getattr(settings, name)!r}")
    if settings.device == "GPU":
        words.append("--device=gpu")
    if settings.denoise:
        words.append("--denoise" if settings.denoiser == "auto" else f"--denoiser={settings.denoiser}")
    else:
        words.append("--aov=albedo,normal,depth")
    if scene.render.film_transparent:
        words.append("--alpha")
    if portal_file:
        words += ["--portal", portal_file]
    if scene.render.threads_mode == "FIXED":
        words.append(f"--threads={scene.render.threads}")
    return [*words, *camera.sun(scene), *film.options(), *film.lens()]


class TdptEngine(bpy.types.RenderEngine):
    bl_idname = "TDPT"
    bl_label = "tdpt"
    bl_use_preview = False
    bl_use_postprocess = True
    bl_use_shading_nodes_custom = False
    bl_use_eevee_viewport = True

    def update(self, data, depsgraph):
        """Keeps the scene as it is now. Cameras and the like are those of the depsgraph, which knows the frame."""
        scene, layer = depsgraph.scene, depsgraph.view_layer.name
        self.failure, self.next_words, self.words_shown, self.film_time = "", 0.0, "", None
        try:
            self.film = camera.Film(scene, scene.camera.evaluated_get(depsgraph) if scene.camera else None)
            folder = programs.session_folder()
            self.scene_glb, self.picture, self.checkpoint, portal_file = (
                os.path.join(folder, name) for name in ("render.glb", "render.exr", "film.exr", "used.portal.glb"))
            self.steps = self.rendering(programs.needed(), programs.save(scene.original, "render"), scene.original.name,
                                        scene.frame_current_final, layer, options_of(
                scene.tdpt, scene, self.film, portal_file if portals.write_used(scene.original, portal_file, layer) else ""))
        except Exception as failure:  # reported by render(), which may fail
            self.failure = str(failure) or type(failure).__name__

    def rendering(self, program, saved, scene_name, frame, layer, options):
        """A generator of (share, words): exports and renders."""
        self.report_all((yield from programs.exporting(saved, scene_name, frame, self.scene_glb, layer)))
        words = [program, self.scene_glb, "-o", self.picture, "--force", "--set", "progress=json", "--checkpoint", self.checkpoint,
                 "--resume", self.checkpoint, "--set", f"checkpoint-every={CHECKPOINT}", *options]
        self.report_all(programs.sentences_in((yield from programs.running(words, "rendering", accepted=(0, 6)))))

    def render(self, depsgraph):
        if self.failure:
            self.fail(self.failure)
            return
        Rendered.sentences = []
        for path in (self.picture, self.checkpoint):
            if os.path.exists(path):
                os.remove(path)
        try:
            for progress in self.steps:
                if self.test_break():
                    break
                self.show(progress)
                self.show_film(depsgraph)
                time.sleep(0.02)
            self.steps.close()
            last = next((path for path in (self.picture, self.checkpoint) if os.path.exists(path)), None)
            if last:
                self.deliver(last, depsgraph)
        except Exception as failure:
            self.fail(str(failure) or type(failure).__name__)
        finally:
            self.steps.close()

    def fail(self, sentence):
        self.report({"ERROR"}, sentence)
        self.error_set(sentence)

    def show(self, progress):
        """At most once a second: without a window Blender prints a line each time."""
        share, words = progress
        now = time.monotonic()
        if now >= self.next_words and words != self.words_shown:
            self.next_words, self.words_shown = now + 1, words
            self.update_progress(share)
            self.update_stats("", words)

    def report_all(self, sentences):
        """All of it on the console, where a rendering without a window is read; the worst as a warning."""
        Rendered.sentences += sentences
        for line in sentences:
            print("tdpt: " + line, flush=True)
        bad = [line for line in sentences if not line.startswith("note: ")]
        if bad:
            more = f", and {len(bad) - 1} more: see Light Portals in the render properties" if len(bad) > 1 else ""
            self.report({"WARNING"}, bad[0].split(": ", 1)[1] + more)

    def show_film(self, depsgraph):
        """Shows the picture of the samples so far, where it has changed."""
        with contextlib.suppress(OSError, ValueError):  # it is not there yet, or is being replaced
            changed = os.stat(self.checkpoint).st_mtime_ns
            if changed != self.film_time:
                self.film_time = changed
                self.deliver(self.checkpoint, depsgraph)

    def window(self, scene):
        """Rows and columns of the rendered picture that Blender wants, from the top left."""
        film, render = self.film, scene.render
        left, top, right, bottom = 0, 0, film.width, film.height
        if render.use_border:
            left, right = (pixels(x, film.width) for x in (render.border_min_x, render.border_max_x))
            top, bottom = (film.height - pixels(y, film.height) for y in (render.border_max_y, render.border_min_y))
        rows = slice(film.cut_y + top, film.cut_y + bottom)
        return rows, slice(film.cut_x + left, film.cut_x + right)

    def deliver(self, path, depsgraph):
        wanted = {*CHANNELS, *(name for _, names in EXTRA.values() for name in names)}
        found = exr.read(path, wanted)
        rows, columns = self.window(depsgraph.scene)
        cut = {name: array[rows, columns][::-1].astype(numpy.float32) for name, array in found.items()}
        height, width = cut["R"].shape
        if "normal.Y" in cut:  # +Z is up in Blender
            cut["normal.Y"], cut["normal.Z"] = -cut["normal.Z"], cut["normal.Y"]
        cut.setdefault("A", numpy.ones((height, width), numpy.float32))
        result = self.begin_result(0, 0, width, height, layer=depsgraph.view_layer.name)
        passes = result.layers[0].passes
        fill(passes["Combined"], cut, CHANNELS)
        for name, (_, names) in EXTRA.items():
            there = passes.get(name)
            if there and all(n in cut for n in names):
                fill(there, cut, names)
        self.end_result(result)

    def update_render_passes(self, scene=None, renderlayer=None):
        self.register_pass(scene, renderlayer, "Combined", 4, "RGBA", "COLOR")
        for name, (channels, _) in EXTRA.items():
            kind = "VALUE" if len(channels) == 1 else "VECTOR" if channels == "XYZ" else "COLOR"
            self.register_pass(scene, renderlayer, name, len(channels), channels, kind)


def pixels(share, side):
    """In single precision, as Blender has it."""
    return int(numpy.float32(share) * numpy.float32(side))


def fill(target, channels, names):
    values = numpy.stack([channels[name] for name in names], -1)
    try:
        target.rect.foreach_set(values.ravel())
    except TypeError:  # before Blender 4
        target.rect = values.reshape(-1, len(names)).tolist()


CLASSES = (TdptEngine,)
