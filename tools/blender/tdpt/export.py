"""export.py: a Blender scene as glTF for tdpt, without losing its light.
  blender -b SCENE.blend --python-exit-code 1 -P export.py -- OUT.glb [--thin-glass]
What the picture shows at the frame that SCENE was saved at: no object or collection that is not rendered, no motion.
Blender's exporter leaves area lamps, worlds, the picture's size and the thickness of glass out. Here area lamps become
lights of EXT_lights_area, smooth spots profiles of EXT_lights_ies, every shader a Principled BSDF,
instances objects, and closed glass gets a thickness (--thin-glass: none). World, size and active camera go into the extras
of the glTF scene [gltf-scene(5)], the world's picture beside OUT; custom properties of the scene called tdpt_... go before
them. What is lost all the same is told at the end, the worst first: "light:" changes the light of the whole picture,
"look:" the look of one thing, "note:" nothing.

The extension runs it in a process of its own, on a copy of the scene: it changes what it exports."""
import argparse
import os
import sys

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import gltf_file  # noqa: E402
import instances  # noqa: E402
import lamps  # noqa: E402
import losses  # noqa: E402
import materials  # noqa: E402
import world  # noqa: E402

KEYS = ("environment", "environment_rotation", "environment_scale", "width", "height", "camera")


def options():
    p = argparse.ArgumentParser(prog="export.py")
    p.add_argument("out")
    p.add_argument("--thin-glass", action="store_true", help="leave closed glass hollow")
    p.add_argument("--file", default="", help="a library with the scene, in place of the file that is open")
    p.add_argument("--scene", default="", help="its name there")
    p.add_argument("--view-layer", default="", help="in place of the scene's first")
    p.add_argument("--frame", type=float, help="in place of the frame that it was saved at")
    a = p.parse_args(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else [])
    if not a.out.endswith(".glb"):
        p.error(f"{a.out}: is no name of a .glb")
    return a


def open_scene(file, name):
    """One scene of a library, which has no windows."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(file) as (_, here):
        here.scenes = [name]
    bpy.context.window.scene = here.scenes[0]
    for other in [s for s in bpy.data.scenes if s != here.scenes[0]]:
        bpy.data.scenes.remove(other)


def prepare_camera(shift_counts):
    """The active camera is rendered through also where it is hidden; a name belongs to one camera."""
    active = bpy.context.scene.camera
    if not active or active.type != "CAMERA":
        return None
    active.hide_render = False
    if active.data.users > 1:
        active.data = active.data.copy()
    if shift_counts and (active.data.shift_x or active.data.shift_y):
        losses.say(losses.LOOK, f"camera {active.name}: its shift is lost")
    return active.data.name


def camera_of(document, name):
    """Whether the programs can take it."""
    cameras = [c.get("name") for c in document.get("cameras", []) if c["type"] == "perspective"]
    if cameras.count(name) == 1:
        return {"camera": name}
    if not cameras:
        losses.say(losses.LIGHT, "the scene has no perspective camera: give the programs --frame, or --look-from and --look-at")
    elif name:
        losses.say(losses.LIGHT, f'the active camera {name} is not perspective, or not in the file: the programs take "{cameras[0]}"')
    return {}


def typed():
    """Custom properties of the scene, which an artist set."""
    scene = bpy.context.scene
    values = {key: scene.get("tdpt_" + key) for key in KEYS}
    return {k: list(v) if hasattr(v, "to_list") else v for k, v in values.items() if v is not None}


def complete_gloss(document):
    """What Blender's exporter leaves out of reflections: the index of refraction of what is opaque. A specular of 0 is none
    at all; Blender 3's exporter writes a black colour for it, which still reflects at grazing angles."""
    for material in document.get("materials", []):
        extensions = material.get("extensions", {})
        specular = extensions.get("KHR_materials_specular")
        if specular and specular.get("specularColorFactor") == [0, 0, 0]:
            specular.setdefault("specularFactor", 0)
        ior = materials.ior_of(bpy.data.materials.get(material.get("name", "")))
        if ior is not None and "KHR_materials_ior" not in extensions:
            material["extensions"] = {**extensions, "KHR_materials_ior": {"ior": ior}}
            document["extensionsUsed"] = sorted({*document.get("extensionsUsed", []), "KHR_materials_ior"})


def add_extras(path, camera):
    document, rest = gltf_file.read(path)
    complete_gloss(document)
    lamps.add_lights(document)
    render, given = bpy.context.scene.render, typed()
    size = [max(1, side * render.resolution_percentage // 100) for side in (render.resolution_x, render.resolution_y)]
    sky = {} if "environment" in given else world.extras_of(bpy.context.scene.world, path)
    extras = {**sky, "width": size[0], "height": size[1], **camera_of(document, camera), **given}
    shown = document["scenes"][document.get("scene", 0)]
    shown["extras"] = {**shown.get("extras", {}), **{"tdpt_" + key: extras[key] for key in KEYS if key in extras}}
    gltf_file.write(path, document, rest)


def export(path):
    bpy.ops.export_scene.gltf(
        filepath=path,
        export_format="GLB",
        export_cameras=True,
        export_lights=True,
        export_apply=True,
        use_renderable=True,
        use_active_scene=True,
        export_animations=False,
        export_current_frame=True,
    )


def main():
    a = options()
    out = os.path.abspath(a.out)
    if a.file:
        open_scene(a.file, a.scene)
    bpy.ops.preferences.addon_enable(module="io_scene_gltf2")
    scene = bpy.context.scene
    instances.as_rendered()
    if a.view_layer:
        bpy.context.window.view_layer = scene.view_layers[a.view_layer]
    if a.frame is not None:
        scene.frame_set(int(a.frame // 1), subframe=a.frame % 1)
    instances.drop_excluded(bpy.context.view_layer.layer_collection)
    placed_lamps = instances.make_real()
    things = instances.placed()
    instances.report_objects(things)
    losses.report_scene(scene, bpy.context.view_layer, not a.file)
    lamps.prepare(placed_lamps)
    materials.prepare(things)
    if not a.thin_glass:
        materials.fill_glass(things)
    camera = prepare_camera(not a.file)  # the extension cuts shifted pictures
    export(out)
    add_extras(out, camera)
    print("\n".join([f"export.py: {a.out} written", *("  " + line for line in losses.lines())]), flush=True)


if __name__ == "__main__":
    main()
