"""Materials: Blender's exporter knows the Principled BSDF alone, so every shader becomes one; what is lost is told."""
import bmesh
import bpy

from losses import LIGHT, LOOK, NOTE, say
from nodes import take_inputs
from shaders import BLACK, PRINCIPLED, THIN, ShaderReader, socket_of
from trees import connect_value, flatten, maker

THIN_ONES = set()  # materials through which light passes undeflected, in bodies too


def principled(material):
    nodes = material.node_tree.nodes if material and material.use_nodes else []
    return next((n for n in nodes if n.bl_idname == "ShaderNodeBsdfPrincipled"), None)


def ior_of(material):
    """Of a Principled BSDF, where it is not glTF's own; before Blender 4.0 reflections did not hang on it."""
    shader = principled(material)
    ior = shader and shader.inputs["IOR"]
    if not ior or ior.is_linked or bpy.app.version < (4, 0) or abs(ior.default_value - 1.5) < 1e-6:
        return None
    return ior.default_value


def output_of(material):
    """The output that Cycles shows, which the exporter then takes, too."""
    tree = material.node_tree
    output = tree.get_output_node("CYCLES") or tree.nodes.new("ShaderNodeOutputMaterial")
    output.is_active_output = True
    return output


def as_principled(material, look, surface):
    """A Principled BSDF that looks so, in place of the shaders."""
    tree = material.node_tree
    node = tree.nodes.new("ShaderNodeBsdfPrincipled")
    node.inputs["Roughness"].default_value = 1
    if look["Base Color"] == BLACK:
        look = {"Specular": 0.0, **look}
    for name, value in look.items():
        socket = socket_of(node, *PRINCIPLED.get(name, ()))
        if not socket:
            continue
        if isinstance(value, bpy.types.NodeSocket):
            connect_value(value, socket)
            tree.links.new(value.links[0].from_socket, socket)
        else:
            socket.default_value = value
    if look.get(THIN):
        THIN_ONES.add(material)
    tree.links.new(node.outputs["BSDF"], surface)
    return node


def materials_of(things):
    """All materials with nodes of these objects, once each."""
    found = {s.material for o in things for s in o.material_slots if s.material and s.material.use_nodes}
    return sorted(found, key=lambda m: m.name)


def prepare(things):
    for material in materials_of(things):
        tree = material.node_tree
        flatten(tree)
        output, reader = output_of(material), ShaderReader(material)
        surface, volume = output.inputs["Surface"], maker(output.inputs["Volume"])
        if volume and not surface.is_linked:
            tree.links.new(tree.nodes.new("ShaderNodeBsdfTransparent").outputs[0], surface)
        shader = as_principled(material, reader.read(surface), surface)
        for node in [n for n in tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled" and n != shader]:
            tree.nodes.remove(node)
        take_inputs(material, shader)
        alpha = shader.inputs["Alpha"]
        if alpha.is_linked or alpha.default_value < 1:
            material.blend_method = "BLEND"  # for exporters before Blender 4.2
        if volume and volume.bl_idname != "ShaderNodeVolumeAbsorption":  # the exporter knows that
            reader.say(LIGHT, f"its volume ({volume.bl_label}) is lost")
        if not getattr(material, "use_transparent_shadow", True):
            reader.say(LIGHT, "its shadow is opaque in Cycles; here light passes as it does elsewhere")
        if output.inputs["Displacement"].is_linked:
            reader.say(LOOK, "its displacement is lost")


def shape_of(mesh):
    """Of a body: "solid", "pane" where it is closed and thin, "open". Of a ball V / A^1.5 is 0.09, of a box a hundredth as
    thick as wide 0.003."""
    form = bmesh.new()
    form.from_mesh(mesh)
    size = max((v.co.length for v in form.verts), default=0)
    bmesh.ops.remove_doubles(form, verts=form.verts, dist=1e-6 * size)  # seams, which importers of glTF cut open
    closed = bool(form.faces) and all(e.is_manifold for e in form.edges)
    area = sum(f.calc_area() for f in form.faces)
    volume = abs(form.calc_volume())
    flat = len({tuple(round(abs(c), 3) for c in f.normal) for f in form.faces}) < 2
    form.free()
    if not closed:
        return "pane" if flat else "open"
    return "solid" if volume > 0.01 * area**1.5 else "pane"


def is_glass(material):
    shader = principled(material)
    return bool(shader) and material not in THIN_ONES and socket_of(shader, "Transmission Weight", "Transmission").default_value > 0


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
    say(NOTE, f"material {material.name}: solid glass")


def fill_glass(things):
    """Closed bodies of glass get a material with a thickness of their own: panes may share theirs."""
    solids = {}
    for thing in things:
        slots = [s for s in thing.material_slots if s.material and is_glass(s.material)]
        if thing.type != "MESH" or not slots:
            continue
        shape = shape_of(thing.data)
        if shape == "open":
            say(LOOK, f"object {thing.name}: its glass is not closed, so it is taken as thin")
        for slot in slots if shape == "solid" else ():
            glass = slot.material
            if glass not in solids and glass not in solids.values():
                solids[glass] = glass.copy()
                solids[glass].name = glass.name + " solid"
                give_thickness(solids[glass])
            slot.material = solids.get(glass, glass)
