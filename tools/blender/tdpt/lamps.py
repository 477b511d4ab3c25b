"""Area lamps, which Blender's glTF exporter leaves out: lights of EXT_lights_area, or emitting planes."""
import math

import bpy
from mathutils import Matrix

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
    """An emitting plane, for what EXT_lights_area has no words for: ellipses, stretched lamps, lamps in instances."""
    lamp = thing.data
    corners = outline(lamp)
    scale = thing.matrix_world.to_scale()
    radiance = radiance_of(lamp, area_of(corners) * abs(scale.x * scale.y))
    if not radiance > 0:
        return
    mesh = bpy.data.meshes.new(thing.name)
    mesh.from_pydata(corners, [], [tuple(range(len(corners)))])
    mesh.materials.append(emitting(thing.name, lamp.color[:], radiance))
    plane = bpy.data.objects.new(thing.name + " plane", mesh)
    plane.matrix_world = thing.matrix_world
    for collection in thing.users_collection:
        collection.objects.link(plane)
    tell(thing, radiance)


def fold(lamp):
    """Exposure and temperature, which Blender 4.5 has, into power and colour."""
    if getattr(lamp, "exposure", 0):
        lamp.energy *= 2**lamp.exposure
        lamp.exposure = 0
    if getattr(lamp, "use_temperature", False):
        lamp.color = [a * b for a, b in zip(lamp.color, lamp.temperature_color)]
        lamp.use_temperature = False


Y_UP = Matrix(((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1)))
LIGHTS = []  # of EXT_lights_area: (light, matrix in the axes of glTF)
LUMENS_PER_WATT = 683  # as Blender's exporter converts the other lamps


def is_uniform(matrix):
    scale = [abs(s) for s in matrix.to_scale()]
    return matrix.determinant() > 0 and max(scale) - min(scale) < 1e-4 * max(scale)


def radiance_of(lamp, area):
    """Cycles has the radiance P/(pi A) [W/m2/sr] of an area lamp, before Blender 4.0 P/(4 A), not normalized without A."""
    if not getattr(lamp, "normalize", True):
        area = 1
    return lamp.energy / ((math.pi if bpy.app.version >= (4, 0) else 4) * area) if area > 0 else 0


def light_for(thing):
    """A square, rectangle or disk of EXT_lights_area."""
    lamp, matrix = thing.data, thing.matrix_world
    high = lamp.size_y if lamp.shape == "RECTANGLE" else lamp.size
    scale = max(matrix.to_scale())
    radiance = radiance_of(lamp, (math.pi / 4 if lamp.shape == "DISK" else lamp.size / high) * (high * scale) ** 2)
    if not radiance > 0:
        return
    light = {"name": thing.name, "color": lamp.color[:], "intensity": radiance * LUMENS_PER_WATT, "size": high}
    light.update({"type": "disk"} if lamp.shape == "DISK" else {"type": "rect", "rect": {"aspect": lamp.size / high}})
    LIGHTS.append((light, Y_UP @ matrix))
    tell(thing, radiance)


def tell(thing, radiance):
    say(
        f"area lamp {thing.name}: {thing.data.energy:g} W as a surface of radiance {radiance:.4g} W/m2/sr, which shows and stops "
        "light; in Cycles it does neither"
    )


def add_lights(document):
    """Puts them into the JSON of a glTF file."""
    if not LIGHTS:
        return
    name = "EXT_lights_area"
    document.setdefault("extensions", {})[name] = {"lights": [light for light, _ in LIGHTS]}
    document.setdefault("extensionsUsed", []).append(name)
    nodes, shown = document.setdefault("nodes", []), document["scenes"][document.get("scene", 0)].setdefault("nodes", [])
    for number, (light, matrix) in enumerate(LIGHTS):
        shown.append(len(nodes))
        flat = [value for column in matrix.transposed() for value in column]
        nodes.append({"name": light["name"], "matrix": flat, "extensions": {name: {"light": number}}})


def fold_nodes(lamp):
    """The one Emission that a lamp with nodes has, into power and colour."""
    output = lamp.node_tree.get_output_node("ALL") if hasattr(lamp.node_tree, "get_output_node") else None
    surface = output and output.inputs["Surface"]
    node = surface.links[0].from_node if surface and surface.is_linked else None
    plain = node and node.bl_idname == "ShaderNodeEmission" and not any(s.is_linked for s in node.inputs)
    if not plain:
        say(f"lamp {lamp.name}: its nodes are lost")
        return
    lamp.energy *= node.inputs["Strength"].default_value
    lamp.color = [a * b for a, b in zip(lamp.color, node.inputs["Color"].default_value)]
    lamp.use_nodes = False


def prepare(things):
    instanced = {o for t in things if t.instance_collection for o in t.instance_collection.all_objects}
    alone = set(bpy.context.scene.objects) - instanced
    for lamp in {t.data for t in things if t.type == "LIGHT"}:
        fold(lamp)
        if lamp.type in ("POINT", "SPOT") and not getattr(lamp, "normalize", True):
            lamp.normalize = True
            say(f"lamp {lamp.name}: is taken as normalised, so its brightness is lost")
        if lamp.use_nodes and lamp.node_tree:
            fold_nodes(lamp)
    for thing in things:
        if thing.type != "LIGHT" or thing.hide_render:
            continue
        lamp = thing.data
        if is_portal(lamp):
            thing.hide_render = True  # so that an export is the same with and without them
            continue
        if lamp.type in ("POINT", "SPOT") and lamp.shadow_soft_size > 0:
            say(f"lamp {thing.name}: its radius is lost, so its shadows are sharp")
        if lamp.type == "AREA" and lamp.size > 0:
            plain = lamp.shape != "ELLIPSE" and thing in alone and is_uniform(thing.matrix_world)
            light_for(thing) if plain and lamp.size_y > 0 else plane_for(thing)
