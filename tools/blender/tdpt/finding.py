"""Find portals: the operator, and what it does step by step."""
import json
import os

import bpy

from . import camera, gltf_file, portals, programs


class Search:
    """The one that goes on, for the panel."""

    share, words = 0.0, ""
    running = placed = False


LEAST_GAIN = 1.1  # of the lower end of the interval, for portals of Cycles to be switched on


def measuring(scene, frame):
    """A generator that measures what the portals of a scene are worth to Cycles; its result: the dict of worth.py."""
    result = os.path.join(programs.session_folder(), "worth.json")
    words = programs.blender("worth.py", programs.save(scene, "worth"), scene.name, repr(frame), result)
    yield from programs.running(words, "measuring what they are worth to Cycles", low=0.7)
    with open(result, encoding="utf-8") as text:
        return json.load(text)


def finding(scene, layer, measure=True, quality="normal"):
    """A generator of (share, words). The portals are placed when they are found; those of Cycles are switched on when they were
    measured to pay. Its result: sentences about what was found."""
    program = programs.needed()
    film = camera.Film(scene, scene.camera)
    saved, folder = programs.save(scene, "search"), programs.session_folder()
    exported, result = os.path.join(folder, "scene.glb"), os.path.join(folder, "portals.glb")
    options = [*camera.sun(scene), *(o for o in film.options() if not o.startswith(("--width", "--height")))]
    name, frame = scene.name, scene.frame_current_final
    lost = yield from programs.exporting(saved, name, frame, exported, layer, high=0.1)
    words = [program, exported, "-o", result, "--force", "--set", "progress=json", "--quality", quality, *options]
    lines = yield from programs.running(words, "looking for portals", 0.1, 0.7)
    found = gltf_file.read_portals(result)
    sentences = [portals.words_of(found, portals.reason_in(lines))]
    scene = bpy.data.scenes[name]  # another object after an undo
    portals.place(scene, found)
    portals.use_in_cycles(scene, False)
    scene.tdpt.found, scene.tdpt.lost = sentences[0], "\n".join(lost + programs.sentences_in(lines))
    Search.placed = True
    if measure and any(portals.lets_in_sky(p[3]) and p[3].get("sky", 0) > 0 for p in found):
        worth = yield from measuring(scene, frame)
        scene = bpy.data.scenes[name]
        pays = worth["low"] > LEAST_GAIN
        portals.use_in_cycles(scene, pays)
        figures = f"{worth['gain']:.2g} times as fast ({worth['low']:.2g} to {worth['high']:.2g})"
        sentences.append(f"Cycles is {figures} with the windows as portals" + ("" if pays else ": they are left off"))
        scene.tdpt.found = "\n".join(sentences)
    return sentences


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
        return not Search.running and context.scene.camera is not None

    def start(self, context):
        self.steps = finding(context.scene, context.view_layer.name, self.measure, context.scene.tdpt.quality)
        Search.running, Search.placed, Search.share, Search.words = True, False, 0.0, "exporting the scene"

    def finish(self, context, kind, sentences, result):
        """Ends the search, whatever it came to: the button has to work again."""
        self.steps.close()
        Search.running = False
        if getattr(self, "timer", None):
            context.window_manager.event_timer_remove(self.timer)
            context.window_manager.progress_end()
            context.workspace.status_text_set(None)
        redraw(context)
        for sentence in sentences:
            self.report({kind}, sentence)
        return {result}

    def execute(self, context):
        self.start(context)
        try:
            return self.finish(context, "INFO", programs.wait(self.steps), "FINISHED")
        except Exception as failure:
            return self.finish(context, "ERROR", [str(failure) or type(failure).__name__], "CANCELLED")

    def invoke(self, context, event):
        self.start(context)
        self.timer = context.window_manager.event_timer_add(0.1, window=context.window)
        context.window_manager.progress_begin(0, 100)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def cancel(self, context):
        """Blender ends it, as when another file is opened."""
        self.steps.close()
        Search.running = False

    def modal(self, context, event):
        if event.type == "ESC":
            if Search.placed:  # what they are worth is not known then
                return self.finish(context, "INFO", ["Portals of Cycles are left off: they were not measured"], "FINISHED")
            return self.finish(context, "INFO", ["Cancelled"], "CANCELLED")
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        try:
            Search.share, Search.words = next(self.steps)
        except StopIteration as end:
            return self.finish(context, "INFO", end.value, "FINISHED")
        except Exception as failure:
            return self.finish(context, "ERROR", [str(failure) or type(failure).__name__], "CANCELLED")
        context.window_manager.progress_update(int(100 * Search.share))
        context.workspace.status_text_set(f"tdpt: {Search.words} (Esc cancels)")
        redraw(context)
        return {"RUNNING_MODAL"}


def redraw(context):
    for area in context.screen.areas if context.screen else ():
        if area.type == "PROPERTIES":
            area.tag_redraw()


CLASSES = (TDPT_OT_find_portals,)
