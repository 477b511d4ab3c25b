# export.py: a grey floor under a lamp of each kind, as Blender exports it in each of its lighting modes, and as Cycles sees it.
#   blender -b --factory-startup --python-exit-code 1 -P export.py -- FOLDER

import math
import os
import sys

import bpy
from mathutils import Vector

MODES = {"standard": "SPEC", "unitless": "COMPAT", "raw": "RAW"}


def grey(name, colour=0.8, **inputs):
    m = bpy.data.materials.new(name)
    m.use_nodes = True
    shader = m.node_tree.nodes["Principled BSDF"].inputs
    for key, value in {"Base Color": (colour, colour, colour, 1), "Specular": 0, "Roughness": 1, **inputs}.items():
        shader[key].default_value = value
    return m


def scene_with(add_light):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for addon in ("io_scene_gltf2", "cycles"):
        bpy.ops.preferences.addon_enable(module=addon)
    bpy.ops.mesh.primitive_plane_add(size=10)
    bpy.context.object.data.materials.append(grey("floor"))
    eye, aim = Vector((3, 0, 3)), Vector((0, 0, 0))
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.angle = 0.3
    camera.location = eye
    camera.rotation_euler = (aim - eye).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    add_light()


def lamp(kind, energy, **settings):
    def add():
        data = bpy.data.lights.new("lamp", kind)
        data.energy = energy
        for key, value in settings.items():
            setattr(data, key, value)
        thing = bpy.data.objects.new("lamp", data)
        thing.location = (0, 0, 2)
        bpy.context.scene.collection.objects.link(thing)

    return add


def panel():
    bpy.ops.mesh.primitive_plane_add(size=0.2, location=(0, 0, 2), rotation=(math.pi, 0, 0))
    shine = {"Emission": (1, 1, 1, 1), "Emission Strength": 20}
    bpy.context.object.data.materials.append(grey("panel", 0, **shine))


def ball():
    lamp("POINT", 100, shadow_soft_size=0)()
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.4, location=(0, 0, 0.5), segments=16, ring_count=8)
    bpy.context.object.data.materials.append(grey("glass", 1, Transmission=1, Roughness=0))


def both():
    panel()
    lamp("POINT", 100, shadow_soft_size=0)()


LIGHTS = {
    "point": lamp("POINT", 100, shadow_soft_size=0),
    "spot": lamp("SPOT", 100, shadow_soft_size=0, spot_size=1.2, spot_blend=0),
    "sun": lamp("SUN", 3, angle=0),
    "panel": panel,
    "both": both,
    "ball": ball,
}


def by_cycles(path):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.use_adaptive_sampling = 256, False, False
    scene.render.resolution_x, scene.render.resolution_y = 16, 12
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.filepath = path
    for stamp in [s for s in dir(scene.render) if s.startswith("use_stamp_")]:  # no dates, no names of folders
        setattr(scene.render, stamp, False)
    bpy.ops.render.render(write_still=True)


def export(path, mode):
    bpy.ops.export_scene.gltf(
        filepath=path, export_cameras=True, export_lights=True, export_texcoords=False, convert_lighting_mode=mode
    )


def main():
    folder = os.path.abspath(sys.argv[sys.argv.index("--") + 1])
    for name, light in LIGHTS.items():
        scene_with(light)
        if name not in ("ball", "both"):
            by_cycles(os.path.join(folder, name + ".cycles.exr"))
        lamps = name in ("point", "spot", "sun")
        for word, mode in MODES.items() if lamps else [("", "SPEC")]:
            export(os.path.join(folder, name + (f"-{word}" if word else "") + ".glb"), mode)


main()
