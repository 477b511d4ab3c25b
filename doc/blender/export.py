# export.py: a Blender scene as glTF for tdpt, without losing its light.
#   blender -b SCENE.blend --python-exit-code 1 -P doc/blender/export.py -- OUT.glb [--thin-glass]
# What the picture shows at the frame that SCENE was saved at: no object or collection that is not rendered, no motion.
# Blender's exporter leaves area lamps, worlds and the thickness of glass out. Here area lamps become emitting planes, closed
# glass gets a thickness (--thin-glass: none), and what else is lost is told, with the options that say it to the programs.

import argparse
import math
import os
import sys

import bmesh
import bpy


def options():
    p = argparse.ArgumentParser(prog="export.py")
    p.add_argument("out")
    p.add_argument("--thin-glass", action="store_true", help="leave closed glass hollow")
    a = p.parse_args(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else [])
    if not a.out.endswith((".glb", ".gltf")):
        p.error(f"{a.out}: neither .glb nor .gltf")
    return a


def say(text):
    print("export.py: " + text)


def principled(material):
    nodes = material.node_tree.nodes if material and material.use_nodes else []
    return next((n for n in nodes if n.bl_idname == "ShaderNodeBsdfPrincipled"), None)


def emitting(name, colour, radiance):
    """A black material that emits on its front."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.use_backface_culling = True
    inputs = principled(material).inputs
    inputs["Base Color"].default_value = (0, 0, 0, 1)
    inputs["Specular" if "Specular" in inputs else "Specular IOR Level"].default_value = 0
    inputs["Emission" if "Emission" in inputs else "Emission Color"].default_value = (*colour, 1)
    inputs["Emission Strength"].default_value = radiance
    return material


def outline(lamp):
    """Corners of the lamp in its own frame, counter-clockwise seen from where it shines to, which is -Z."""
    x = lamp.size / 2
    y = (lamp.size_y if lamp.shape in ("RECTANGLE", "ELLIPSE") else lamp.size) / 2
    if lamp.shape in ("SQUARE", "RECTANGLE"):
        return [(-x, -y, 0), (-x, y, 0), (x, y, 0), (x, -y, 0)]
    turns = [-2 * math.pi * i / 32 for i in range(32)]
    return [(x * math.cos(t), y * math.sin(t), 0) for t in turns]


def area_of(corners):
    pairs = zip(corners, corners[1:] + corners[:1])
    return abs(sum(a[0] * b[1] - a[1] * b[0] for a, b in pairs)) / 2


def plane_for(lamp_object):
    """Cycles has P/4 for each square metre and steradian of an area lamp, as P/(4 A) [W/m2/sr]."""
    lamp = lamp_object.data
    corners = outline(lamp)
    scale = lamp_object.matrix_world.to_scale()
    area = area_of(corners) * abs(scale.x * scale.y)
    radiance = lamp.energy / (4 * area)
    mesh = bpy.data.meshes.new(lamp_object.name)
    mesh.from_pydata(corners, [], [tuple(range(len(corners)))])
    mesh.materials.append(emitting(lamp_object.name, lamp.color[:], radiance))
    plane = bpy.data.objects.new(lamp_object.name + " plane", mesh)
    plane.matrix_world = lamp_object.matrix_world
    for collection in lamp_object.users_collection:
        collection.objects.link(plane)
    say(f"area lamp {lamp_object.name}: {lamp.energy:g} W as a plane of radiance {radiance:.4g} W/m2/sr")


def is_solid(mesh):
    """Closed, and thicker than a pane: of a ball V / A^1.5 is 0.09, of a box a hundredth as thick as wide 0.003."""
    form = bmesh.new()
    form.from_mesh(mesh)
    closed = bool(form.faces) and all(e.is_manifold for e in form.edges)
    area = sum(f.calc_area() for f in form.faces)
    volume = abs(form.calc_volume())
    form.free()
    return closed and volume > 0.01 * area**1.5


def give_thickness(material):
    """The group by whose name the exporter finds the thickness; any above 0 means solid."""
    name = "glTF Material Output"
    group = bpy.data.node_groups.get(name) or bpy.data.node_groups.new(name, "ShaderNodeTree")
    if hasattr(group, "interface"):
        if "Thickness" not in group.interface.items_tree:
            group.interface.new_socket("Thickness", socket_type="NodeSocketFloat")
    elif "Thickness" not in group.inputs:
        group.inputs.new("NodeSocketFloat", "Thickness")
    nodes = material.node_tree.nodes
    if any(n.bl_idname == "ShaderNodeGroup" and n.node_tree == group for n in nodes):
        return
    node = nodes.new("ShaderNodeGroup")
    node.node_tree = group
    node.inputs["Thickness"].default_value = 1
    say(f"material {material.name}: solid glass")


def is_glass(material):
    shader = principled(material)
    socket = shader and (shader.inputs.get("Transmission") or shader.inputs.get("Transmission Weight"))
    return bool(socket) and socket.default_value > 0


def drop_excluded(layer):
    """Collections that the view layer leaves out are no part of the picture; their instances are."""
    for child in layer.children:
        if child.exclude:
            layer.collection.children.unlink(child.collection)
        else:
            drop_excluded(child)


def placed():
    """All objects, those of instanced collections too."""
    found = set(bpy.context.scene.objects)
    for thing in list(found):
        if thing.instance_collection:
            found.update(thing.instance_collection.all_objects)
    return sorted(found, key=lambda o: o.name)


def tell_of_shaders():
    """Principled and Emission alone come over."""
    for material in {s.material for o in placed() for s in o.material_slots if s.material and s.material.use_nodes}:
        output = material.node_tree.get_output_node("ALL")
        surface = output and output.inputs["Surface"]
        kind = surface and surface.is_linked and surface.links[0].from_node
        if kind and kind.bl_idname not in ("ShaderNodeBsdfPrincipled", "ShaderNodeEmission", "ShaderNodeBackground"):
            say(
                f"material {material.name}: of its {kind.name} the exporter makes white metal, or a part; "
                "use a Principled BSDF"
            )


def fill_glass():
    for thing in placed():
        if thing.type != "MESH" or not is_solid(thing.data):
            continue
        for slot in thing.material_slots:
            if is_glass(slot.material):
                give_thickness(slot.material)


def tell_of_world(world):
    if not world or not world.use_nodes:
        return
    background = next((n for n in world.node_tree.nodes if n.bl_idname == "ShaderNodeBackground"), None)
    if not background:
        return
    strength = background.inputs["Strength"].default_value
    colour = background.inputs["Color"]
    if not colour.is_linked:
        light = [c * strength for c in colour.default_value[:3]]
        if max(light) > 0:
            say("world: give the programs --environment " + ",".join(f"{c:.6g}" for c in light))
        return
    picture = colour.links[0].from_node
    if picture.bl_idname != "ShaderNodeTexEnvironment" or not picture.image:
        say("world: is no picture; bake it to one (doc/scenes.md)")
        return
    file = bpy.path.abspath(picture.image.filepath)
    if picture.image.packed_file or not file.lower().endswith((".exr", ".hdr")):
        say(f"world: save its picture {picture.image.name} as .exr or .hdr first, which the programs read")
        return
    turn = 0
    if picture.inputs["Vector"].is_linked and picture.inputs["Vector"].links[0].from_node.bl_idname == "ShaderNodeMapping":
        turn = picture.inputs["Vector"].links[0].from_node.inputs["Rotation"].default_value[2]
    degrees = (-90 - math.degrees(turn) + 180) % 360 - 180
    say(
        f"world: give the programs --environment {file} "
        f"--environment-rotation {degrees:g}" + (f" --environment-scale {strength:g}" if strength != 1 else "")
    )


def tell_of_textures():
    for material in bpy.data.materials:
        shader = principled(material)
        for socket in shader.inputs if shader else []:
            made = socket.is_linked and socket.links[0].from_node.bl_idname
            if made and made.startswith("ShaderNodeTex") and made != "ShaderNodeTexImage":
                say(f"material {material.name}: {socket.name} is procedural and lost; bake it to an image")


def tell_of_cameras():
    cameras = [o.name for o in bpy.context.scene.objects if o.type == "CAMERA"]
    active = bpy.context.scene.camera
    if not cameras:
        say("the scene has no camera: give the programs --frame, or --look-from and --look-at")
    elif len(cameras) > 1 and active:
        say(f'of {len(cameras)} cameras {active.name} is the active one: give the programs --camera "{active.data.name}"')


def export(path):
    bpy.ops.export_scene.gltf(
        filepath=os.path.abspath(path),
        export_format="GLB" if path.endswith(".glb") else "GLTF_SEPARATE",
        export_cameras=True,
        export_lights=True,
        export_apply=True,
        use_renderable=True,
        export_animations=False,
        export_current_frame=True,
    )


def main():
    a = options()
    bpy.ops.preferences.addon_enable(module="io_scene_gltf2")
    drop_excluded(bpy.context.view_layer.layer_collection)
    for thing in [o for o in placed() if o.type == "LIGHT" and o.data.type == "AREA" and not o.hide_render]:
        plane_for(thing)
    if not a.thin_glass:
        fill_glass()
    tell_of_world(bpy.context.scene.world)
    tell_of_textures()
    tell_of_shaders()
    tell_of_cameras()
    export(a.out)


main()
