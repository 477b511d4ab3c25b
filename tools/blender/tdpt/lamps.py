"""Area lamps, which Blender's glTF exporter leaves out: emitting planes for them."""
import math

import bpy

from materials import emitting
from said import say


def is_portal(lamp):
    """Cycles' own portals shine on nothing."""
    return lamp.type == "AREA" and bool(getattr(getattr(lamp, "cycles", None), "is_portal", False))


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


def plane_for(thing):
    """Cycles has the radiance P/(pi A) [W/m2/sr] of an area lamp, before Blender 4.0 P/(4 A), not normalized without A."""
    lamp = thing.data
    corners = outline(lamp)
    scale = thing.matrix_world.to_scale()
    area = area_of(corners) * abs(scale.x * scale.y) if getattr(lamp, "normalize", True) else 1
    radiance = lamp.energy / ((math.pi if bpy.app.version >= (4, 0) else 4) * area) if area > 0 else 0
    if not radiance > 0:
        return
    mesh = bpy.data.meshes.new(thing.name)
    mesh.from_pydata(corners, [], [tuple(range(len(corners)))])
    mesh.materials.append(emitting(thing.name, lamp.color[:], radiance))
    plane = bpy.data.objects.new(thing.name + " plane", mesh)
    plane.matrix_world = thing.matrix_world
    for collection in thing.users_collection:
        collection.objects.link(plane)
    say(
        f"area lamp {thing.name}: {lamp.energy:g} W as a plane of radiance {radiance:.4g} W/m2/sr, which shows and stops light; "
        "in Cycles it does neither"
    )


def fold(lamp):
    """Exposure and temperature, which Blender 4.5 has, into power and colour."""
    if getattr(lamp, "exposure", 0):
        lamp.energy *= 2**lamp.exposure
        lamp.exposure = 0
    if getattr(lamp, "use_temperature", False):
        lamp.color = [a * b for a, b in zip(lamp.color, lamp.temperature_color)]
        lamp.use_temperature = False


def prepare(things):
    for lamp in {t.data for t in things if t.type == "LIGHT"}:
        fold(lamp)
    for thing in things:
        if thing.type != "LIGHT" or thing.hide_render:
            continue
        lamp = thing.data
        if is_portal(lamp):
            thing.hide_render = True  # so that an export is the same with and without them
            continue
        if lamp.type in ("POINT", "SPOT") and lamp.shadow_soft_size > 0:
            say(f"lamp {thing.name}: its radius is lost, so its shadows are sharp")
        if lamp.type == "AREA":
            plane_for(thing)
        if lamp.use_nodes and any(n.bl_idname not in ("ShaderNodeOutputLight", "ShaderNodeEmission") for n in lamp.node_tree.nodes):
            say(f"lamp {thing.name}: its nodes are lost")
