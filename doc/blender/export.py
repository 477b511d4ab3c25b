# export.py: a Blender scene as glTF for tdpt, without losing its light.
#   blender -b SCENE.blend --python-exit-code 1 -P doc/blender/export.py -- OUT.glb [--thin-glass]
# What the picture shows at the frame that SCENE was saved at: no object or collection that is not rendered, no motion.
# Blender's exporter leaves area lamps, worlds, the picture's size and the thickness of glass out. Here area lamps become
# emitting planes and closed glass gets a thickness (--thin-glass: none). World, size and active camera go into the extras of
# the glTF scene [gltf-scene(5)], the world's picture beside OUT; custom properties of the scene called tdpt_... go before
# them. What is lost all the same is told at the end.

import argparse
import json
import math
import os
import struct
import sys

import bmesh
import bpy
import numpy

KEYS = ("environment", "environment_rotation", "environment_scale", "width", "height", "camera")
LARGEST_SKY = 8192  # pixels across that the programs read


def options():
    p = argparse.ArgumentParser(prog="export.py")
    p.add_argument("out")
    p.add_argument("--thin-glass", action="store_true", help="leave closed glass hollow")
    a = p.parse_args(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else [])
    if not a.out.endswith((".glb", ".gltf")):
        p.error(f"{a.out}: neither .glb nor .gltf")
    return a


SAID = []


def say(text):
    """Told at the end: the exporter has hundreds of lines."""
    SAID.append(text)


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
    """Cycles has the radiance P/(pi A) [W/m2/sr] of an area lamp, before Blender 4.0 P/(4 A), not normalized without A."""
    lamp = lamp_object.data
    corners = outline(lamp)
    scale = lamp_object.matrix_world.to_scale()
    area = area_of(corners) * abs(scale.x * scale.y) if getattr(lamp, "normalize", True) else 1
    power = lamp.energy * 2 ** getattr(lamp, "exposure", 0)
    radiance = power / ((math.pi if bpy.app.version >= (4, 0) else 4) * area)
    mesh = bpy.data.meshes.new(lamp_object.name)
    mesh.from_pydata(corners, [], [tuple(range(len(corners)))])
    colour = lamp.color[:]
    if getattr(lamp, "use_temperature", False):
        colour = [a * b for a, b in zip(colour, lamp.temperature_color)]
    mesh.materials.append(emitting(lamp_object.name, colour, radiance))
    plane = bpy.data.objects.new(lamp_object.name + " plane", mesh)
    plane.matrix_world = lamp_object.matrix_world
    for collection in lamp_object.users_collection:
        collection.objects.link(plane)
    say(f"area lamp {lamp_object.name}: {power:g} W as a plane of radiance {radiance:.4g} W/m2/sr")


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


def background_of(world):
    """The node that shines; None where there is none."""
    output = world.node_tree.get_output_node("ALL")
    surface = output and output.inputs["Surface"]
    if not surface or not surface.is_linked:
        return None
    node = surface.links[0].from_node
    if node.bl_idname == "ShaderNodeBackground":
        return node
    first = next((n for n in world.node_tree.nodes if n.bl_idname == "ShaderNodeBackground"), None)
    if first:
        say(f"world: is a mixture, of which {first.name} alone is taken")
    return first


def mapped_turn(picture):
    """How far a Mapping node turns the world, counter-clockwise seen from above [degrees]."""
    vector = picture.inputs["Vector"]
    node = vector.links[0].from_node if vector.is_linked else None
    if not node or node.bl_idname != "ShaderNodeMapping":
        return 0
    moved = [node.inputs["Rotation"].default_value[:2], [s - 1 for s in node.inputs["Scale"].default_value]]
    if any(abs(v) > 1e-4 for values in moved for v in values):
        say("world: its picture is turned about the vertical alone, the rest of its Mapping is lost")
    turn = math.degrees(node.inputs["Rotation"].default_value[2])
    return turn if node.vector_type == "TEXTURE" else -turn


def world_of(world):
    """(extras, picture or None) of what shines from all around."""
    if not world:
        return {}, None
    if not world.use_nodes:
        return colour_of(world.color, 1), None
    background = background_of(world)
    if not background:
        return {}, None
    strength, colour = background.inputs["Strength"], background.inputs["Color"]
    if strength.is_linked:
        say("world: its strength is made by nodes; taken as 1")
    factor = 1 if strength.is_linked else strength.default_value
    if not factor > 0:
        return {}, None
    if not colour.is_linked:
        return colour_of(colour.default_value, factor), None
    picture = colour.links[0].from_node
    if picture.bl_idname != "ShaderNodeTexEnvironment" or not picture.image or picture.projection != "EQUIRECTANGULAR":
        say("world: is no latitude-longitude picture and is lost; bake it to one (doc/scenes.md)")
        return {}, None
    turn = (-90 + mapped_turn(picture) + 180) % 360 - 180
    extras = {"environment_rotation": round(turn, 4)}
    if factor != 1:
        extras["environment_scale"] = factor
    return extras, picture.image


def colour_of(colour, factor):
    light = [c * factor for c in colour[:3]]
    return {"environment": ",".join(f"{c:.6g}" for c in light)} if max(light) > 0 else {}


def is_linear(image):
    name = image.colorspace_settings.name
    return image.colorspace_settings.is_data or name == "Raw" or name.startswith(("Linear", "scene_linear"))


def suffix_of(head):
    return ".exr" if head.startswith(b"\x76\x2f\x31\x01") else ".hdr" if head.startswith(b"#?") else ""


def bytes_of(image):
    """Its file as it is, and that file's path or None; no bytes where the programs cannot read it."""
    width, height = image.size
    fits = width == 2 * height and width <= LARGEST_SKY and is_linear(image) and image.source == "FILE"
    if not fits or image.is_dirty:
        return b"", None
    if image.packed_file:
        data = image.packed_file.data
        return (data if suffix_of(data) else b""), None
    path = bpy.path.abspath(image.filepath, library=image.library)
    if not os.path.isfile(path):
        return b"", None
    with open(path, "rb") as file:
        data = file.read()
    return (data, os.path.realpath(path)) if suffix_of(data) else (b"", None)


def write_exr(image, path):
    """Linear, twice as wide as high, and no larger than is read. False, and no file, where it is black."""
    width, height = image.size
    pixels = numpy.empty(width * height * 4, numpy.float32)
    image.pixels.foreach_get(pixels)
    rgb = pixels.reshape(-1, 4)[:, :3]
    if not rgb.max() > 0:
        return False
    if not image.is_float and not is_linear(image):
        rgb[:] = numpy.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    copy = bpy.data.images.new("sky", width, height, float_buffer=True, is_data=True)
    copy.pixels.foreach_set(pixels)
    wide = min(2 * height if width > 2 * height else width, LARGEST_SKY) // 2 * 2
    if (wide, wide // 2) != (width, height):
        copy.scale(wide, wide // 2)
        say(f"world: its picture of {width} x {height} pixels became one of {wide} x {wide // 2}")
    copy.filepath_raw = path
    copy.file_format = "OPEN_EXR"
    copy.save()
    bpy.data.images.remove(copy)
    return True


def free_name(stem, suffix, data, own):
    """Beside OUT, of no file that is there, but for one of the same bytes, and for `own`, which the last export wrote."""
    number = 1
    while True:
        path = f"{stem}.sky{'' if number == 1 else f'-{number}'}{suffix}"
        if not os.path.lexists(path) or os.path.basename(path) == own:
            return path
        with open(path, "rb") as file:
            if data and file.read() == data:
                return path
        number += 1


def keep_sky(image, out, own):
    """(name of the sky's picture, which lies beside OUT or below from now on, whether that is a copy)."""
    folder, stem = os.path.dirname(out), os.path.splitext(out)[0]
    if not image.has_data and not len(image.pixels):
        say(f"world: its picture {image.name} cannot be loaded, and is lost")
        return None, False
    data, source = bytes_of(image)
    real = os.path.realpath(folder) + os.sep
    if source and source.startswith(real) and os.path.splitext(source)[0] != os.path.realpath(stem):
        return source[len(real) :].replace(os.sep, "/"), False
    path = free_name(stem, suffix_of(data) or ".exr", data, own)
    name = os.path.basename(path)
    if os.path.lexists(path) and name != own:
        return name, False
    if not data:
        if not write_exr(image, path):
            return None, False
    else:
        with open(path, "wb") as file:
            file.write(data)
    say(f"world: its picture is copied to {name}")
    return name, True


def tell_of_textures():
    for material in bpy.data.materials:
        shader = principled(material)
        for socket in shader.inputs if shader else []:
            made = socket.is_linked and socket.links[0].from_node.bl_idname
            if made and made.startswith("ShaderNodeTex") and made != "ShaderNodeTexImage":
                say(f"material {material.name}: {socket.name} is procedural and lost; bake it to an image")


def prepare_camera():
    """The active camera is rendered through also where it is hidden; a name belongs to one camera."""
    active = bpy.context.scene.camera
    if not active or active.type != "CAMERA":
        return None
    active.hide_render = False
    if active.data.users > 1:
        active.data = active.data.copy()
    if active.data.shift_x or active.data.shift_y:
        say(f"camera {active.name}: its shift is lost")
    return active.data.name


def camera_of(document, name):
    """Whether the programs can take it."""
    cameras = [c.get("name") for c in document.get("cameras", []) if c["type"] == "perspective"]
    if cameras.count(name) == 1:
        return {"camera": name}
    if not cameras:
        say("the scene has no perspective camera: give the programs --frame, or --look-from and --look-at")
    elif name:
        say(f'the active camera {name} is not perspective, or not in the file: the programs take "{cameras[0]}"')
    return {}


def typed():
    """Custom properties of the scene, which an artist set."""
    scene = bpy.context.scene
    values = {key: scene.get("tdpt_" + key) for key in KEYS}
    return {k: list(v) if hasattr(v, "to_list") else v for k, v in values.items() if v is not None}


def read_document(path):
    """The JSON of a glTF file, and the rest of its bytes."""
    with open(path, "rb") as file:
        data = file.read()
    if not path.endswith(".glb"):
        return json.loads(data), b""
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20 : 20 + length]), data[20 + length :]


def write_document(path, document, rest):
    if not path.endswith(".glb"):
        text = json.dumps(document, indent="\t").encode()
    else:
        text = json.dumps(document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        text = b"glTF" + struct.pack("<IIII", 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A) + text + rest
    with open(path + ".new", "wb") as file:
        file.write(text)
    os.replace(path + ".new", path)


def last_copy(path):
    """The sky's picture that an export to this file copied before."""
    try:
        return read_document(path)[0]["asset"]["extras"]["tdpt_copy"]
    except (OSError, ValueError, KeyError, TypeError, struct.error):
        return None


def add_extras(path, camera, own):
    document, rest = read_document(path)
    render = bpy.context.scene.render
    size = [max(1, side * render.resolution_percentage // 100) for side in (render.resolution_x, render.resolution_y)]
    extras = {"width": size[0], "height": size[1], **camera_of(document, camera)}
    given = typed()
    if "environment" not in given:
        world, picture = world_of(bpy.context.scene.world)
        if picture:
            world["environment"], copied = keep_sky(picture, path, own)
            if copied:
                document["asset"].setdefault("extras", {})["tdpt_copy"] = world["environment"]
        if world.get("environment"):
            extras.update(world)
    extras.update(given)
    ours = {"tdpt_" + key: extras[key] for key in KEYS if key in extras}
    shown = document["scenes"][document.get("scene", 0)]
    shown["extras"] = {**shown.get("extras", {}), **ours}
    write_document(path, document, rest)


def export(path):
    bpy.ops.export_scene.gltf(
        filepath=path,
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
    out = os.path.abspath(a.out)
    bpy.ops.preferences.addon_enable(module="io_scene_gltf2")
    drop_excluded(bpy.context.view_layer.layer_collection)
    for thing in [o for o in placed() if o.type == "LIGHT" and o.data.type == "AREA" and not o.hide_render]:
        plane_for(thing)
    if not a.thin_glass:
        fill_glass()
    tell_of_textures()
    tell_of_shaders()
    camera, own = prepare_camera(), last_copy(out)
    export(out)
    add_extras(out, camera, own)
    print("\n".join([f"export.py: {a.out} written"] + ["  " + line for line in SAID]), flush=True)


main()
