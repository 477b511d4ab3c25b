"""The world: a colour or a latitude-longitude picture as it is, anything else baked to one."""
import math
import os

import bpy
import numpy

from losses import LIGHT, LOOK, NOTE, say
from trees import AS_IT_LIGHTS, flatten

LARGEST = 8192  # pixels across that the programs read
BAKED = (1024, 512)
BAKED_SAMPLES = 64  # of a pixel
SUN_SAMPLES = 4096  # of a pixel near a sun, which is as wide as two


def background_of(world):
    """The one node that shines; None where there is none, or a mixture."""
    output = world.node_tree.get_output_node("ALL")
    surface = output and output.inputs["Surface"]
    node = surface.links[0].from_node if surface and surface.is_linked else None
    return node if node and node.bl_idname == "ShaderNodeBackground" else None


def shines(world):
    if not world:
        return False
    if not world.use_nodes:
        return max(world.color) > 0
    output = world.node_tree.get_output_node("ALL")
    return bool(output and output.inputs["Surface"].is_linked)


def mapped_turn(picture):
    """How far a Mapping node turns the world, counter-clockwise seen from above [degrees]; None: not about the vertical alone."""
    vector = picture.inputs["Vector"]
    if not vector.is_linked:
        return 0
    node = vector.links[0].from_node
    if node.bl_idname == "ShaderNodeTexCoord":
        return 0 if vector.links[0].from_socket.name == "Generated" else None
    if node.bl_idname != "ShaderNodeMapping":
        return None
    source = node.inputs["Vector"]
    if source.is_linked:
        from_node, name = source.links[0].from_node, source.links[0].from_socket.name
        if from_node.bl_idname != "ShaderNodeTexCoord" or name != "Generated":
            return None
    if any(node.inputs[name].is_linked for name in ("Location", "Rotation", "Scale") if name in node.inputs):
        return None
    moved = [*node.inputs["Rotation"].default_value[:2], *(s - 1 for s in node.inputs["Scale"].default_value)]
    if node.vector_type in ("POINT", "TEXTURE"):
        moved += node.inputs["Location"].default_value[:]
    if any(abs(v) > 1e-4 for v in moved):
        return None
    turn = math.degrees(node.inputs["Rotation"].default_value[2])
    return turn if node.vector_type == "TEXTURE" else -turn


def plain_picture(background):
    """(image, turn [degrees]) where the colour is a latitude-longitude picture that is at most turned; else None."""
    node = background.inputs["Color"].links[0].from_node
    if node.bl_idname != "ShaderNodeTexEnvironment" or not node.image or node.projection != "EQUIRECTANGULAR":
        return None
    turn = mapped_turn(node)
    return None if turn is None else (node.image, turn)


def colour_of(colour, factor):
    light = [c * factor for c in colour[:3]]
    return {"environment": ",".join(f"{c:.6g}" for c in light)} if max(light) > 0 else {}


def of(world, path):
    """(extras, image or None) of what shines from all around; a baked picture is written to `path`."""
    if not shines(world):
        return {}, None
    if not world.use_nodes:
        return colour_of(world.color, 1), None
    flatten(world.node_tree)
    background = background_of(world)
    if background and not background.inputs["Strength"].is_linked:
        factor, colour = background.inputs["Strength"].default_value, background.inputs["Color"]
        if not factor > 0:
            return {}, None
        if not colour.is_linked:
            return colour_of(colour.default_value, factor), None
        plain = plain_picture(background)
        if plain:
            extras = {"environment_rotation": round((-90 + plain[1] + 180) % 360 - 180, 4)}
            if factor != 1:
                extras["environment_scale"] = factor
            return extras, plain[0]
    return {"environment_rotation": -90}, bake(world, path)


def as_light_sees_it(world):
    """A sky that the camera sees otherwise is baked as it lights the scene."""
    for node in [n for n in world.node_tree.nodes if n.bl_idname == "ShaderNodeLightPath"]:
        for socket in node.outputs:
            value = AS_IT_LIGHTS.get(socket.name, 0.0)
            for link in list(socket.links):
                target = link.to_socket
                world.node_tree.links.remove(link)
                if isinstance(getattr(target, "default_value", None), float):
                    target.default_value = value
        say(LOOK, "world: the camera sees another one than lights the scene; it is taken as it lights")


def rendered(scene):
    bpy.ops.render.render(write_still=True, scene=scene.name)
    image = bpy.data.images.load(scene.render.filepath)
    image.colorspace_settings.is_data = True
    return image


def pixels_of(image):
    pixels = numpy.empty(image.size[0] * image.size[1] * 4, numpy.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(image.size[1], image.size[0], 4)


def bake_sun(scene, image):
    """What is small and bright again, with more samples: its edge crosses few pixels, which must not change its power."""
    pixels, render = pixels_of(image), scene.render
    light = pixels[..., :3].mean(2)
    rows, columns = numpy.nonzero(light > 8 * light.mean())
    if not len(rows):
        return
    low = max(0, rows.min() - 2), max(0, columns.min() - 2)
    high = min(light.shape[0], rows.max() + 3), min(light.shape[1], columns.max() + 3)
    if (high[0] - low[0]) * (high[1] - low[1]) > light.size // 500:
        return
    render.use_border = render.use_crop_to_border = True
    height, width = light.shape
    render.border_min_x, render.border_max_x = ((x + 0.25) / width for x in (low[1], high[1]))
    render.border_min_y, render.border_max_y = ((y + 0.25) / height for y in (low[0], high[0]))
    scene.cycles.samples = SUN_SAMPLES
    render.filepath += ".sun.exr"
    finer = pixels_of(rendered(scene))
    pixels[low[0] : high[0], low[1] : high[1]] = finer
    image.pixels.foreach_set(pixels.ravel())


def bake(world, path):
    """The world as Cycles sees it all around, as an image."""
    scene = bpy.data.scenes.new("sky")
    scene.world = world
    if hasattr(world, "cycles_visibility"):
        world.cycles_visibility.camera = True
    elif hasattr(getattr(world, "cycles", None), "visible_camera"):
        world.cycles.visible_camera = True
    as_light_sees_it(world)
    camera = bpy.data.objects.new("sky", bpy.data.cameras.new("sky"))
    camera.data.type = "PANO"
    panorama = camera.data if hasattr(camera.data, "panorama_type") else camera.data.cycles
    panorama.panorama_type = "EQUIRECTANGULAR"
    # Looks along +X, the middle of a world's picture; its up is +Z.
    camera.rotation_euler = (math.pi / 2, 0, -math.pi / 2)
    scene.collection.objects.link(camera)
    scene.camera = camera
    render = scene.render
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y = BAKED
    render.resolution_percentage = 100
    render.filepath = path
    if hasattr(render.image_settings, "media_type"):
        render.image_settings.media_type = "IMAGE"
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_mode = "RGB"
    render.image_settings.color_depth = "32"
    scene.view_settings.view_transform = "Raw"
    scene.cycles.samples = BAKED_SAMPLES
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.sample_clamp_direct = scene.cycles.sample_clamp_indirect = 0
    image = rendered(scene)
    bake_sun(scene, image)
    bpy.data.scenes.remove(scene)
    say(NOTE, f"world: its nodes are baked to a picture of {BAKED[0]} x {BAKED[1]} pixels")
    if not max(image.pixels[:]) > 0:
        say(LIGHT, "world: its bake is black")
    return image


def is_linear(image):
    name = image.colorspace_settings.name
    return image.colorspace_settings.is_data or name == "Raw" or name.startswith(("Linear", "scene_linear"))


def suffix_of(head):
    return ".exr" if head.startswith(b"\x76\x2f\x31\x01") else ".hdr" if head.startswith(b"#?") else ""


def bytes_of(image):
    """Its file as it is, and that file's path or None; no bytes where the programs cannot read it."""
    width, height = image.size
    fits = width == 2 * height and width <= LARGEST and is_linear(image) and image.source == "FILE"
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
    pixels = pixels_of(image).ravel()
    rgb = pixels.reshape(-1, 4)[:, :3]
    if not rgb.max() > 0:
        return False
    if not image.is_float and not is_linear(image):
        rgb[:] = numpy.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    copy = bpy.data.images.new("sky", width, height, float_buffer=True, is_data=True)
    copy.pixels.foreach_set(pixels)
    wide = min(2 * height if width > 2 * height else width, LARGEST) // 2 * 2
    if (wide, wide // 2) != (width, height):
        copy.scale(wide, wide // 2)
        say(NOTE, f"world: its picture of {width} x {height} pixels became one of {wide} x {wide // 2}")
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


def keep(image, out, own):
    """(name of the sky's picture, which lies beside OUT or below from now on, whether that is a copy)."""
    folder, stem = os.path.dirname(out), os.path.splitext(out)[0]
    if not image.has_data and not len(image.pixels):
        say(LIGHT, f"world: its picture {image.name} cannot be loaded, and is lost")
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
    say(NOTE, f"world: its picture is copied to {name}")
    return name, True
