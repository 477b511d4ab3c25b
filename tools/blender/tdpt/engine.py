"""Render with tdpt: F12, animations and the compositor."""
import os
import time

import bpy
import numpy

from . import camera, exr, portals, programs, scene_file

CHANNELS = ("R", "G", "B", "A")
EXTRA = {  # pass of Blender: (its channels, those of the picture)
    "Depth": ("Z", ("depth.Z",)),
    "Normal": ("XYZ", ("normal.X", "normal.Y", "normal.Z")),
    "Denoising Albedo": ("RGB", ("albedo.R", "albedo.G", "albedo.B")),
    "Noisy Image": ("RGB", ("noisy.R", "noisy.G", "noisy.B")),
}
CHECKPOINT = 3  # seconds between pictures that are shown


class Told:
    """What the last rendering had to tell, for the panel: a rendering may not write to the scene."""

    lines = []  # of the export, the worst first, and then of the programs


def options_of(settings, scene, film, portal_file):
    words = [f"--seed={(settings.seed + (scene.frame_current if settings.animate_seed else 0)) % 2**32}"]
    if settings.samples:
        words.append(f"--spp={settings.samples}")
    if settings.time:
        words.append(f"--time={settings.time:g}")
    if settings.noise:
        words.append(f"--target-error={settings.noise:g}")
    if settings.max_depth:
        words.append(f"--max-depth={settings.max_depth}")
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
        scene = depsgraph.scene
        self.failure, self.saved = "", ""
        self.next_words, self.words_shown = 0.0, ""
        try:
            self.program = programs.needed()
            seen = scene.camera.evaluated_get(depsgraph) if scene.camera else None
            self.film = camera.Film(scene, seen)
            self.scene_name, self.frame = scene.original.name, scene.frame_current_final
            self.saved = scene_file.save(scene.original, "render")
            self.words = options_of(scene.tdpt, scene, self.film, self.portals_of(scene.original, depsgraph.view_layer.name))
        except Exception as failure:  # told by render(), which may fail
            self.failure = str(failure) or type(failure).__name__

    def portals_of(self, scene, layer):
        path = os.path.join(scene_file.folder(), "used.portal.glb")
        return path if portals.write_used(scene, path, layer) else ""

    def render(self, depsgraph):
        if self.failure:
            self.fail(self.failure)
            return
        steps = self.rendering(depsgraph)
        try:
            programs.wait(steps, seen=self.show)
        except Exception as failure:
            self.fail(str(failure) or type(failure).__name__)
        finally:
            steps.close()

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

    def rendering(self, depsgraph):
        """A generator of (share, words): exports, renders, and shows what there is."""
        folder = scene_file.folder()
        exported, made, film = (os.path.join(folder, name) for name in ("render.glb", "render.exr", "film.exr"))
        for path in (made, film):
            if os.path.exists(path):
                os.remove(path)
        steps = scene_file.exporting(self.saved, self.scene_name, self.frame, exported, depsgraph.view_layer.name)
        Told.lines = []
        told = yield from self.until_stopped(steps)
        if told is None:
            return
        self.tell(told)
        words = [self.program, exported, "-o", made, "--force", "--set", "progress=json", "--checkpoint", film, "--resume", film]
        words += ["--set", f"checkpoint-every={CHECKPOINT}", *self.words]
        now, shown = (0.0, "rendering"), None
        lines = programs.running(words, accepted=(0, 6))
        try:
            for new in lines:
                if self.test_break():
                    break
                now = programs.last_progress(new, now)
                self.tell(programs.told_by(new))
                shown = self.show_film(film, shown, depsgraph)
                yield now
        finally:
            lines.close()
        if os.path.exists(made):
            self.deliver(made, depsgraph)
        elif os.path.exists(film):
            self.show_film(film, None, depsgraph)

    def until_stopped(self, steps):
        """The same generator; its result is None where the rendering is stopped."""
        try:
            while not self.test_break():
                try:
                    yield next(steps)
                except StopIteration as end:
                    return end.value
            return None
        finally:
            steps.close()

    def tell(self, lines):
        """All of it on the console, where a rendering without a window is read; the worst as a warning."""
        Told.lines += lines
        for line in lines:
            print("tdpt: " + line, flush=True)
        bad = [line for line in lines if not line.startswith("note: ")]
        if bad:
            more = f", and {len(bad) - 1} more: see Light Portals in the render properties" if len(bad) > 1 else ""
            self.report({"WARNING"}, bad[0].split(": ", 1)[1] + more)

    def show_film(self, film, shown, depsgraph):
        """Shows the picture of the samples so far, where it has changed; when it did."""
        try:
            when = os.stat(film).st_mtime_ns
        except OSError:
            return shown
        if when != shown:
            try:
                self.deliver(film, depsgraph)
            except (OSError, ValueError):
                pass  # it is being replaced
        return when

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
