"""Find portals: the operator, and what it does step by step."""
import json
import os

import bpy

from . import camera, gltf_file, portals, programs, scene_file


class Now:
    """The search that goes on, for the panel."""

    share, words, cancelled = 0.0, "", False
    running = placed = False


LEAST_GAIN = 1.1  # of the lower end of the interval, for portals of Cycles to be switched on
MEASURED = {}  # what portals are worth to Cycles, by scene and portals


def scaled(generator, low, high):
    """The same generator with its share of progress between low and high; its result."""
    try:
        while True:
            try:
                share, words = next(generator)
            except StopIteration as end:
                return end.value
            yield low + (high - low) * share, words
    finally:
        generator.close()


def searching(words):
    """A generator that runs tdpt: (share, words); its result: what the programs say."""
    now, told = (0.0, "looking for portals"), []
    for lines in programs.running(words):
        now = programs.last_progress(lines, now)
        told += programs.told_by(lines)
        yield now
    return told


def measuring(name, frame, saved, found):
    """A generator that measures what the portals are worth to Cycles; its result: the dict of worth.py."""
    lamps = []
    for _, corners, triangles, figures in found:
        if portals.lets_in_sky(figures):
            corners = [portals.z_up(c) for c in corners]
            matrix, width, height = portals.rectangle(corners, portals.normal_of(corners, triangles))
            lamps.append([[list(row) for row in matrix], width, height])
    folder = scene_file.folder()
    given, result = os.path.join(folder, "portals.json"), os.path.join(folder, "worth.json")
    with open(given, "w", encoding="utf-8") as text:
        json.dump(lamps, text)
    words = programs.blender("worth.py", saved, name, repr(frame), given, result)
    for _ in programs.running(words):
        yield 0.5, "measuring what they are worth to Cycles"
    with open(result, encoding="utf-8") as text:
        return json.load(text)


def alive(name):
    """The scene, which may be gone, or another object after an undo."""
    scene = bpy.data.scenes.get(name)
    if not scene:
        raise programs.Failure(f"Scene {name} is gone")
    return scene


def finding(scene, layer, measure=True, quality="normal"):
    """A generator of (share, words). The portals are placed when they are found; those of Cycles are switched on when they were
    measured to pay. Its result: sentences about what was found."""
    program = programs.needed()
    film = camera.Film(scene, scene.camera)
    saved, folder = scene_file.save(scene, "search"), scene_file.folder()
    exported, result = os.path.join(folder, "scene.glb"), os.path.join(folder, "portals.glb")
    options = [*camera.sun(scene), *(o for o in film.options() if not o.startswith(("--width", "--height")))]
    name, frame = scene.name, scene.frame_current_final
    lost = yield from scaled(scene_file.exporting(saved, name, frame, exported, layer), 0, 0.1)
    words = [program, exported, "-o", result, "--force", "--set", "progress=json", "--quality", quality, *options]
    said = yield from scaled(searching(words), 0.1, 0.7)
    found = gltf_file.read_portals(result)
    why = next((line.split(no, 1)[1] for line in said for no in (": no bottleneck: ", ": no portal: ") if no in line), "")
    told = [portals.words_of(found, why)]
    scene = alive(name)
    portals.place(scene, found)
    portals.use_in_cycles(scene, False)
    scene.tdpt.found, scene.tdpt.lost = told[0], "\n".join(lost + said)
    Now.placed = True
    worth = None
    windows = [p for p in found if portals.lets_in_sky(p[3]) and p[3].get("sky", 0) > 0]
    if measure and windows:
        key = (scene_file.digest(exported), scene_file.digest(result))
        if key not in MEASURED:
            MEASURED[key] = yield from scaled(measuring(name, frame, saved, found), 0.7, 1)
        worth = MEASURED[key]
        scene = alive(name)
    pays = bool(worth) and worth["low"] > LEAST_GAIN
    portals.use_in_cycles(scene, pays)
    if worth:
        figures = f"{worth['gain']:.2g} times as fast ({worth['low']:.2g} to {worth['high']:.2g})"
        told.append(f"Cycles is {figures} with the windows as portals" + ("" if pays else ": they are left off"))
    scene.tdpt.found = "\n".join(told)
    return told


class TDPT_OT_find_portals(bpy.types.Operator):
    """Find the doors and windows through which light reaches the camera"""

    bl_idname = "tdpt.find_portals"
    bl_label = "Find Portals"
    bl_options = {"REGISTER", "UNDO"}

    measure: bpy.props.BoolProperty(
        name="Measure for Cycles",
        description="Measure whether portals make Cycles faster in this scene; switch them on only where they do",
        default=True,
    )

    @classmethod
    def poll(cls, context):
        return not Now.running and context.scene.camera is not None

    def start(self, context):
        self.steps = finding(context.scene, context.view_layer.name, self.measure, context.scene.tdpt.quality)
        Now.placed = False
        Now.running, Now.cancelled, Now.share, Now.words = True, False, 0.0, "exporting the scene"

    def finish(self, context):
        Now.running = False
        if getattr(self, "timer", None):
            context.window_manager.event_timer_remove(self.timer)
            context.window_manager.progress_end()
            context.workspace.status_text_set(None)
        redraw(context)

    def step(self):
        """Whether there is more to do."""
        try:
            Now.share, Now.words = next(self.steps)
            return True
        except StopIteration as end:
            for sentence in end.value:
                self.report({"INFO"}, sentence)
            return False

    def execute(self, context):
        try:
            self.start(context)
            self.told = programs.wait(self.steps)
        except programs.Failure as failure:
            self.report({"ERROR"}, str(failure))
            return {"CANCELLED"}
        finally:
            self.finish(context)
        for sentence in self.told:
            self.report({"INFO"}, sentence)
        return {"FINISHED"}

    def invoke(self, context, event):
        self.start(context)
        self.timer = context.window_manager.event_timer_add(0.1, window=context.window)
        context.window_manager.progress_begin(0, 100)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def cancel(self, context):
        """Blender ends it, as when another file is opened."""
        self.steps.close()
        Now.running = False

    def modal(self, context, event):
        if event.type == "ESC" or Now.cancelled:
            self.steps.close()
            self.finish(context)
            if Now.placed:  # what they are worth is not known then
                self.report({"INFO"}, "Portals of Cycles are left off: they were not measured")
                return {"FINISHED"}
            self.report({"INFO"}, "Cancelled")
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        try:
            more = self.step()
        except Exception as failure:  # whatever it is, the button has to work again
            self.finish(context)
            self.report({"ERROR"}, str(failure) or type(failure).__name__)
            return {"CANCELLED"}
        if more:
            context.window_manager.progress_update(int(100 * Now.share))
            context.workspace.status_text_set(f"tdpt: {Now.words} (Esc cancels)")
            redraw(context)
            return {"RUNNING_MODAL"}
        self.finish(context)
        return {"FINISHED"}


class TDPT_OT_cancel(bpy.types.Operator):
    """Stop the search for portals"""

    bl_idname = "tdpt.cancel"
    bl_label = "Cancel"

    def execute(self, context):
        Now.cancelled = True
        return {"FINISHED"}


def redraw(context):
    for area in context.screen.areas if context.screen else ():
        if area.type == "PROPERTIES":
            area.tag_redraw()


CLASSES = (TDPT_OT_find_portals, TDPT_OT_cancel)
