"""Lamps that Blender's glTF exporter leaves out or changes: area lamps become lights of EXT_lights_area, spots with a smooth edge
profiles of EXT_lights_ies."""
import base64
import math

import bpy
from mathutils import Matrix

from losses import LIGHT, LOOK, NOTE, say, say_all
from trees import colour, constant, flatten, maker


def is_portal(lamp):
    """Cycles' own portals shine on nothing."""
    return lamp.type == "AREA" and bool(getattr(getattr(lamp, "cycles", None), "is_portal", False))


def fold(lamp):
    """Exposure and temperature, which Blender 4.5 has, into power and colour."""
    if getattr(lamp, "exposure", 0):
        lamp.energy *= 2**lamp.exposure
        lamp.exposure = 0
    if getattr(lamp, "use_temperature", False):
        lamp.color = [a * b for a, b in zip(lamp.color, lamp.temperature_color)]
        lamp.use_temperature = False


Y_UP = Matrix(((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1)))
LIGHTS = []  # that the exporter has not: (extension, light, what its node says of it, matrix in the axes of glTF)
LUMENS_PER_WATT = 683  # as Blender's exporter converts the other lamps


def is_uniform(matrix):
    scale = [abs(s) for s in matrix.to_scale()]
    return matrix.determinant() > 0 and max(scale) - min(scale) < 1e-4 * max(scale)


def radiance_of(lamp, area):
    """Cycles has the radiance P/(pi A) [W/m2/sr] of an area lamp, before Blender 4.0 P/(4 A), not normalized without A."""
    if not getattr(lamp, "normalize", True):
        area = 1
    return lamp.energy / ((math.pi if bpy.app.version >= (4, 0) else 4) * area) if area > 0 else 0


def light_for(thing, matrix):
    """A rectangle or disk of EXT_lights_area; an ellipse is a disk of the same area."""
    lamp, (right, up, _) = thing.data, (axis.length for axis in matrix.to_3x3().transposed())
    wide, high = lamp.size * right, (lamp.size_y if lamp.shape in ("RECTANGLE", "ELLIPSE") else lamp.size) * up
    is_round = lamp.shape in ("DISK", "ELLIPSE")
    radiance = radiance_of(lamp, wide * high * (math.pi / 4 if is_round else 1))
    if not radiance > 0:
        return
    light = {"name": thing.name, "color": lamp.color[:], "intensity": radiance * LUMENS_PER_WATT}
    light.update({"type": "disk", "size": math.sqrt(wide * high)} if is_round else {"type": "rect", "size": high, "rect": {"aspect": wide / high}})
    place, turn, _ = matrix.decompose()
    LIGHTS.append(("EXT_lights_area", light, {}, Y_UP @ Matrix.LocRotScale(place, turn, None)))
    if is_round and abs(wide - high) > 1e-4 * high:
        say(LOOK, f"area lamp {thing.name}: is an ellipse, and is taken as a disk of the same area")
    say(
        NOTE, f"area lamp {thing.name}: {lamp.energy:g} W as a surface of radiance {radiance:.4g} W/m2/sr, which shows and stops "
        "light; in Cycles it does neither"
    )


def add_lights(document):
    """Puts them into the JSON of a glTF file."""
    nodes, shown = document.setdefault("nodes", []), document["scenes"][document.get("scene", 0)].setdefault("nodes", [])
    for extension, light, reference, matrix in LIGHTS:
        lights = document.setdefault("extensions", {}).setdefault(extension, {}).setdefault("lights", [])
        used = document.setdefault("extensionsUsed", [])
        used += [extension] if extension not in used else []
        shown.append(len(nodes))
        flat = [value for column in matrix.transposed() for value in column]
        nodes.append({"name": light["name"], "matrix": flat, "extensions": {extension: {"light": len(lights), **reference}}})
        lights.append(light)


def fold_nodes(lamp):
    """The one Emission that a lamp with nodes has, into power and colour."""
    tree = lamp.node_tree
    flatten(tree)
    output = tree.get_output_node("CYCLES")
    node = output and maker(output.inputs["Surface"])
    plain = node and node.bl_idname == "ShaderNodeEmission"
    tint, strength = (colour(node.inputs["Color"]), constant(node.inputs["Strength"])) if plain else (None, None)
    if tint is None or strength is None:
        say(LIGHT, f"lamp {lamp.name}: its nodes are lost")
        return
    lamp.energy *= strength
    lamp.color = [a * b for a, b in zip(lamp.color, tint)]
    lamp.use_nodes = False


def intensity_of(lamp, cosine):
    """Of a spot in Cycles, over that on its axis; the edge is smooth in the cosine."""
    edge = math.cos(lamp.spot_size / 2)
    x = (cosine - edge) / max(1e-6, (1 - edge) * lamp.spot_blend)
    x = min(max(x, 0.0), 1.0)
    return x * x * (3 - 2 * x) * (1 if bpy.app.version >= (4, 0) else cosine)


PROFILE_STEPS = 64  # across the smooth edge


def profile_of(lamp):
    """The text of an IES profile that is linear between so many angles."""
    edge = math.cos(lamp.spot_size / 2)
    full = edge + (1 - edge) * lamp.spot_blend
    angles = [math.acos(min(1.0, full + (edge - full) * i / PROFILE_STEPS)) for i in range(PROFILE_STEPS + 1)]
    angles = sorted({0.0, *(a * i / 8 for i in range(8) for a in angles[:1]), *angles, math.pi})
    degrees = [f"{math.degrees(a):.7g}" for a in angles]
    values = [f"{intensity_of(lamp, math.cos(a)):.7g}" for a in angles]
    head = f"IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 {len(angles)} 1 1 2 0 0 0\n1 1 0\n"
    return head + "\n".join([*degrees, "0", *values]) + "\n"


def profile_for(thing, matrix):
    """A spot with a smooth edge, for which glTF's own spots have another curve."""
    lamp, greatest = thing.data, max(thing.data.color)
    text = base64.b64encode(profile_of(lamp).encode()).decode()
    candela = lamp.energy / (4 * math.pi) * LUMENS_PER_WATT
    light = {"name": thing.name, "uri": "data:application/octet-stream;base64," + text}
    reference = {"multiplier": candela * greatest, "color": [c / greatest for c in lamp.color]}
    LIGHTS.append(("EXT_lights_ies", light, reference, Y_UP @ matrix))
    thing.hide_render = True


def report_lamp(thing, matrix):
    """What glTF or the programs have no words for."""
    lamp, spread = thing.data, getattr(thing.data, "spread", math.pi)
    say_all(f"lamp {thing.name}", [
        (lamp.type in ("POINT", "SPOT") and lamp.shadow_soft_size > 0, LOOK, "its radius is lost, so its shadows are sharp"),
        (lamp.type == "AREA" and spread < math.pi - 1e-4, LIGHT,
         f"its spread of {math.degrees(spread):.0f} degrees is lost: it shines to all sides of its front"),
        (lamp.type == "SPOT" and not is_uniform(matrix), LIGHT, "it is stretched; its cone is taken as round"),
        (not getattr(lamp, "use_shadow", True), LIGHT, "it casts no shadows in Cycles; here it does")])


def prepare(placed):
    """placed: [(lamp, matrix)] of the picture, instances too."""
    for lamp in {thing.data for thing, _ in placed}:
        fold(lamp)
        if lamp.type in ("POINT", "SPOT") and not getattr(lamp, "normalize", True):
            lamp.normalize = True
            say(LIGHT, f"lamp {lamp.name}: is taken as normalised, so its brightness is lost")
        if lamp.use_nodes and lamp.node_tree:
            fold_nodes(lamp)
    for thing, matrix in placed:
        lamp = thing.data
        if is_portal(lamp):
            thing.hide_render = True  # so that an export is the same with and without them
            continue
        report_lamp(thing, matrix)
        if lamp.type == "AREA" and lamp.size > 0 and lamp.size_y > 0:
            light_for(thing, matrix)
        elif lamp.type == "SPOT" and lamp.spot_blend > 0 and max(lamp.color) > 0:
            profile_for(thing, matrix)
