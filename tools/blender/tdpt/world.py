"""The world: a colour or a latitude-longitude picture as it is, anything else baked to one."""
import math
import os

import bpy
import numpy

from losses import LIGHT, LOOK, NOTE, say
from trees import AS_IT_LIGHTS, flatten, maker

LARGEST = 8192  # pixels across that the programs read
BAKED = (1024, 512)
BAKED_SAMPLES = 64  # of a pixel
SUN_SAMPLES = 4096  # of a pixel near a sun, which is as wide as two


def turn_of(picture):
    """How far its Mapping node turns the world, counter-clockwise seen from above [degrees]; None: not about the vertical alone."""
    node, sign = maker(picture.inputs["Vector"]), -1
    if node and node.bl_idname == "ShaderNodeMapping":
        turn, source = node.inputs["Rotation"].default_value, node.inputs["Vector"]
        moved = [*turn[:2], *(s - 1 for s in node.inputs["Scale"].default_value)]
        if node.vector_type in ("POINT", "TEXTURE"):
            moved += node.inputs["Location"].default_value[:]
        if any(abs(v) > 1e-4 for v in moved) or any(s.is_linked for s in node.inputs if s != source):
            return None
        sign, turn, node = 1 if node.vector_type == "TEXTURE" else -1, math.degrees(turn[2]), maker(source)
    else:
        turn, source = 0, picture.inputs["Vector"]
    plain = not node or node.bl_idname == "ShaderNodeTexCoord" and source.links[0].from_socket.name == "Generated"
    return sign * turn if plain else None


def colour_of(colour, factor):
    light = [c * factor for c in colour[:3]]
    return {"environment": ",".join(f"{c:.6g}" for c in light)} if max(light) > 0 else {}


def extras_of(world, out):
    """What shines from all around, for the extras of the scene in the file OUT; a picture is written beside it."""
    if not world or not world.use_nodes:
        return colour_of(world.color, 1) if world else {}
    flatten(world.node_tree)
    output = world.node_tree.get_output_node("ALL")
    background, image, extras = output and maker(output.inputs["Surface"]), None, {"environment_rotation": -90}
    if not background:
        return {}
    if background.bl_idname == "ShaderNodeBackground" and not background.inputs["Strength"].is_linked:
        factor, colour = background.inputs["Strength"].default_value, background.inputs["Color"]
        if not factor > 0 or not colour.is_linked:
            return colour_of(colour.default_value, factor)
        node = colour.links[0].from_node
        turn = turn_of(node) if node.bl_idname == "ShaderNodeTexEnvironment" and node.projection == "EQUIRECTANGULAR" else None
        if turn is not None and node.image:
            image = node.image
            extras = {"environment_rotation": round((-90 + turn + 180) % 360 - 180, 4), "environment_scale": factor}
    path = os.path.splitext(out)[0] + ".sky.exr"
    if not write_exr(image or bake(world, os.path.join(bpy.app.tempdir or os.path.dirname(path), "baked-sky.exr")), path):
        return {}
    return {"environment": os.path.basename(path), **extras}


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


def linear_exr(scene):
    """Lets Cycles render what it sees: linear, as it is sampled."""
    render = scene.render
    render.engine = "CYCLES"
    render.resolution_percentage = 100
    image = render.image_settings
    if hasattr(image, "media_type"):
        image.media_type = "IMAGE"
    image.file_format, image.color_mode, image.color_depth = "OPEN_EXR", "RGB", "32"
    scene.view_settings.view_transform = "Raw"
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False


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
    linear_exr(scene)
    scene.render.resolution_x, scene.render.resolution_y = BAKED
    scene.render.filepath = path
    scene.cycles.samples = BAKED_SAMPLES
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


def write_exr(image, path):
    """Linear, twice as wide as high, and no larger than is read. False, and no file, where it is black or cannot be loaded."""
    if not image.has_data and not len(image.pixels):
        say(LIGHT, f"world: its picture {image.name} cannot be loaded, and is lost")
        return False
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
    say(NOTE, f"world: its picture is {os.path.basename(path)}")
    return True
