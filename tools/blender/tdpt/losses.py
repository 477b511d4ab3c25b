"""What an export loses, the worst first: of the light, or of the look of one thing; and what was merely done. Blender's exporter prints
hundreds of lines, so these are kept and come at the end. Here too: settings of the scene, its view layer, world and camera that
change a picture of Cycles and that the export has no words for."""
import math

import bpy
from mathutils import Vector

LIGHT, LOOK, NOTE = "light", "look", "note"  # the light of the whole picture differs; one thing looks otherwise; nothing is lost
LINES = {LIGHT: [], LOOK: [], NOTE: []}


def say(harm, text):
    if text not in LINES[harm]:
        LINES[harm].append(text)


def lines():
    return [f"{harm}: {text}" for harm, texts in LINES.items() for text in texts]


def say_all(about, facts):
    """facts: (whether it is so, the harm, words)"""
    for so, harm, words in facts:
        if so:
            say(harm, f"{about}: {words}")


def report_layer(layer):
    say_all(f"view layer {layer.name}", [(getattr(layer, name + "_override", None), LIGHT, f"its {name} override is lost") for name in ("material", "world")])
    parts = [layer.layer_collection]
    for part in parts:
        parts += part.children
        say_all(f"collection {part.name}", [(part.holdout, LOOK, "is a holdout in Cycles; here it is as others"),
                                            (part.indirect_only, LOOK, "is seen indirectly alone in Cycles; here it is as others")])


def report_world(world):
    rays = getattr(world, "cycles_visibility", None)
    output = world and world.use_nodes and world.node_tree.get_output_node("CYCLES")
    say_all("world", [
        *((not getattr(rays, name, True), harm, f"is invisible to {name} rays in Cycles; here all see it") for name, harm in (
            ("camera", LOOK), ("diffuse", LIGHT), ("glossy", LOOK), ("transmission", LOOK))),
        (output and output.inputs["Volume"].is_linked, LIGHT, "its volume is lost")])


def report_camera(scene, alone):
    """`alone`: the programs get no options for it."""
    camera = scene.camera
    if not camera or camera.type != "CAMERA":
        return
    data, matrix, dof = camera.data, camera.matrix_world, camera.data.dof
    round_ = not dof.aperture_blades and abs(dof.aperture_ratio - 1) < 1e-3
    say_all(f"camera {camera.name}", [
        (dof.use_dof and alone, LOOK, f"its depth of field is not in the file: give the programs --f-stop {dof.aperture_fstop:g}"),
        (dof.use_dof and not round_, LOOK, "its aperture is taken as round")])
    if data.type != "PERSP":
        return
    graph, frame, near = bpy.context.evaluated_depsgraph_get(), data.view_frame(scene=scene), data.clip_start
    for corner in [*frame, sum(frame, Vector()) / 4]:
        towards = (matrix.to_3x3() @ corner).normalized()
        hit, *_, thing, _ = scene.ray_cast(graph, matrix.translation, towards, distance=near * corner.length / abs(corner.z))
        if hit and not thing.hide_render:
            say(LIGHT, f"camera {camera.name}: its clipping at {near:g} m cuts {thing.name} away in Cycles; here it stands in the picture")


def report_scene(scene, layer, alone):
    report_layer(layer)
    report_world(scene.world)
    report_camera(scene, alone)
    suns = [o for o in scene.objects if o.type == "LIGHT" and o.data.type == "SUN" and not o.hide_render]
    angles = {round(math.degrees(o.data.angle), 3) for o in suns} or {0}
    say_all("suns", [
        (len(angles) > 1, LOOK, f"are as wide as the widest of them, {max(angles):g} degrees"),
        (alone and max(angles) > 0, LOOK, f"their width is not in the file: give the programs --sun-angle {max(angles):g}")])
    cycles = getattr(scene, "cycles", None)
    exposure = getattr(cycles, "film_exposure", 1)
    space = getattr(getattr(bpy.data, "colorspace", None), "working_space", "Linear Rec.709")
    say_all("scene", [
        (exposure != 1, LIGHT, f"the exposure {exposure:g} of Cycles' film is lost; Color Management has one for all renderers"),
        (space != "Linear Rec.709", LIGHT, f"its colours are of {space}, and are taken as Linear Rec.709"),
        (scene.render.film_transparent and getattr(cycles, "film_transparent_glass", False), LOOK, "glass is not transparent in the film"),
        (scene.render.use_motion_blur, LOOK, "its motion blur is lost")])
