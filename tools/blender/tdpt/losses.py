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


def layers_below(layer):
    yield layer
    for child in layer.children:
        yield from layers_below(child)


def report_layer(layer):
    for name in ("material_override", "world_override"):
        if getattr(layer, name, None):
            say(LIGHT, f"view layer {layer.name}: its {name.replace('_', ' ')} is lost")
    for part in layers_below(layer.layer_collection):
        for flag, word in (("holdout", "a holdout"), ("indirect_only", "seen indirectly alone")):
            if getattr(part, flag):
                say(LOOK, f"collection {part.name}: is {word} in Cycles; here it is as others")


def report_world(world):
    if not world:
        return
    rays = getattr(world, "cycles_visibility", None)
    for name, harm in (("camera", LOOK), ("diffuse", LIGHT), ("glossy", LOOK), ("transmission", LOOK)):
        if not getattr(rays, name, True):
            say(harm, f"world: is invisible to {name} rays in Cycles; here all see it")
    if world.use_nodes:
        output = world.node_tree.get_output_node("CYCLES")
        if output and output.inputs["Volume"].is_linked:
            say(LIGHT, "world: its volume is lost")


def report_camera(scene, alone):
    """`alone`: the programs get no options for it."""
    camera = scene.camera
    if not camera or camera.type != "CAMERA":
        return
    data, matrix = camera.data, camera.matrix_world
    dof = data.dof
    if dof.use_dof and alone:
        say(LOOK, f"camera {camera.name}: its depth of field is not in the file: give the programs --f-stop {dof.aperture_fstop:g}")
    if dof.use_dof and (dof.aperture_blades or abs(dof.aperture_ratio - 1) > 1e-3):
        say(LOOK, f"camera {camera.name}: its aperture is taken as round")
    if data.type != "PERSP":
        return
    graph, frame = bpy.context.evaluated_depsgraph_get(), data.view_frame(scene=scene)
    eye, near = matrix.translation, data.clip_start
    for corner in [*frame, sum(frame, Vector()) / 4]:
        towards = matrix.to_3x3() @ corner
        hit, *_, thing, _ = scene.ray_cast(graph, eye, towards.normalized(), distance=near * corner.length / abs(corner.z))
        if hit and not thing.hide_render:
            say(LIGHT, f"camera {camera.name}: its clipping at {near:g} m cuts {thing.name} away in Cycles; here it stands in the picture")


def report_suns(scene, alone):
    suns = [o for o in scene.objects if o.type == "LIGHT" and o.data.type == "SUN" and not o.hide_render]
    angles = {round(math.degrees(o.data.angle), 3) for o in suns}
    if len(angles) > 1:
        say(LOOK, f"suns: are as wide as the widest of them, {max(angles):g} degrees")
    elif alone and angles and max(angles) > 0:
        say(LOOK, f"suns: their width is not in the file: give the programs --sun-angle {max(angles):g}")


def report_scene(scene, layer, alone):
    report_layer(layer)
    report_world(scene.world)
    report_camera(scene, alone)
    report_suns(scene, alone)
    cycles = getattr(scene, "cycles", None)
    exposure = getattr(cycles, "film_exposure", 1)
    if exposure != 1:
        say(LIGHT, f"scene: the exposure {exposure:g} of Cycles' film is lost; Color Management has one for all renderers")
    if scene.render.film_transparent and getattr(cycles, "film_transparent_glass", False):
        say(LOOK, "scene: glass is not transparent in the film")
    if scene.render.use_motion_blur:
        say(LOOK, "scene: its motion blur is lost")
    space = getattr(getattr(bpy.data, "colorspace", None), "working_space", "Linear Rec.709")
    if space != "Linear Rec.709":
        say(LIGHT, f"scene: its colours are of {space}, and are taken as Linear Rec.709")
