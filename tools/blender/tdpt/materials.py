"""Materials: Blender's exporter has the Principled BSDF alone. Simple shaders become one; what is lost is told."""
import bmesh
import bpy

from said import say


def principled(material):
    nodes = material.node_tree.nodes if material and material.use_nodes else []
    return next((n for n in nodes if n.bl_idname == "ShaderNodeBsdfPrincipled"), None)


def socket_of(shader, *names):
    """The first of these inputs that this version of Blender has."""
    return next(shader.inputs[name] for name in names if name in shader.inputs)


# Of light that meets a lamp's plane. Cycles' lamps let it pass; what a black plane keeps made a room 2.5 % too dark.
LAMP_ALBEDO = 0.8


def emitting(name, colour, radiance):
    """A diffuse material that emits on its front."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.use_backface_culling = True
    shader = principled(material)
    shader.inputs["Base Color"].default_value = (LAMP_ALBEDO, LAMP_ALBEDO, LAMP_ALBEDO, 1)
    shader.inputs["Roughness"].default_value = 1
    socket_of(shader, "Specular IOR Level", "Specular").default_value = 0
    socket_of(shader, "Emission Color", "Emission").default_value = (*colour, 1)
    shader.inputs["Emission Strength"].default_value = radiance
    return material


def surface_of(material):
    """The shader that the surface shows; None."""
    output = material.node_tree.get_output_node("ALL")
    surface = output and output.inputs["Surface"]
    return surface.links[0].from_node if surface and surface.is_linked else None


def copy_input(tree, source, target):
    if source.is_linked:
        tree.links.new(source.links[0].from_socket, target)
    elif hasattr(source, "default_value"):
        target.default_value = source.default_value


def set_value(shader, value, *names):
    socket_of(shader, *names).default_value = value


def as_principled(material, shader):
    """Replaces a Diffuse, Glossy or Glass BSDF by a Principled BSDF of the same meaning."""
    tree = material.node_tree
    node = tree.nodes.new("ShaderNodeBsdfPrincipled")
    copy_input(tree, shader.inputs["Color"], node.inputs["Base Color"])
    if shader.inputs["Normal"].is_linked:
        copy_input(tree, shader.inputs["Normal"], node.inputs["Normal"])
    if shader.bl_idname == "ShaderNodeBsdfDiffuse":
        set_value(node, 0, "Specular IOR Level", "Specular")
        set_value(node, 1, "Roughness")
        if shader.inputs["Roughness"].is_linked or shader.inputs["Roughness"].default_value > 0:
            say(f"material {material.name}: is taken as Lambertian, its roughness is lost")
    else:
        copy_input(tree, shader.inputs["Roughness"], node.inputs["Roughness"])
    if shader.bl_idname in ("ShaderNodeBsdfGlossy", "ShaderNodeBsdfAnisotropic"):
        set_value(node, 1, "Metallic")
    if shader.bl_idname == "ShaderNodeBsdfGlass":
        set_value(node, 1, "Transmission Weight", "Transmission")
        copy_input(tree, shader.inputs["IOR"], node.inputs["IOR"])
    output = tree.get_output_node("ALL")
    tree.links.new(node.outputs["BSDF"], output.inputs["Surface"])
    tree.nodes.remove(shader)


SIMPLE = ("ShaderNodeBsdfDiffuse", "ShaderNodeBsdfGlossy", "ShaderNodeBsdfAnisotropic", "ShaderNodeBsdfGlass")
KNOWN = ("ShaderNodeBsdfPrincipled", "ShaderNodeEmission", "ShaderNodeBackground")
# Inputs of the Principled BSDF that glTF or the programs have no words for, by their names in all versions.
LOST = ("Subsurface", "Subsurface Weight", "Anisotropic", "Thin Film Thickness")


def tell_of_inputs(material, shader):
    for name in LOST:
        socket = shader.inputs.get(name)
        if socket and (socket.is_linked or socket.default_value > 0):
            say(f"material {material.name}: {name} is lost")
    for socket in shader.inputs:
        made = socket.is_linked and socket.links[0].from_node.bl_idname
        if made and made.startswith("ShaderNodeTex") and made != "ShaderNodeTexImage":
            say(f"material {material.name}: {socket.name} is procedural and lost; bake it to an image")


def of_things(things):
    """All materials with nodes of these objects, once each."""
    found = {s.material for o in things for s in o.material_slots if s.material and s.material.use_nodes}
    return sorted(found, key=lambda m: m.name)


def prepare(things):
    for material in of_things(things):
        shader = surface_of(material)
        if shader and shader.bl_idname in SIMPLE:
            as_principled(material, shader)
        elif shader and shader.bl_idname not in KNOWN:
            say(
                f"material {material.name}: of its {shader.name} the exporter makes white metal, or a part; "
                "use a Principled BSDF"
            )
        shader = principled(material)
        if shader:
            tell_of_inputs(material, shader)
        output = material.node_tree.get_output_node("ALL")
        for name in ("Volume", "Displacement") if output else ():
            links = output.inputs[name].links
            if links and links[0].from_node.bl_idname != "ShaderNodeVolumeAbsorption":  # the exporter knows that
                say(f"material {material.name}: its {name.lower()} is lost")


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
    return bool(shader) and socket_of(shader, "Transmission Weight", "Transmission").default_value > 0


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


def fill_glass(things):
    """Closed bodies of glass get a material with a thickness of their own: panes may share theirs."""
    solids = {}
    for thing in things:
        slots = [s for s in thing.material_slots if s.material and is_glass(s.material)]
        if thing.type != "MESH" or not slots:
            continue
        shape = shape_of(thing.data)
        if shape == "open":
            say(f"object {thing.name}: its glass is not closed, so it is taken as thin")
        for slot in slots if shape == "solid" else ():
            glass = slot.material
            if glass not in solids and glass not in solids.values():
                solids[glass] = glass.copy()
                solids[glass].name = glass.name + " solid"
                give_thickness(solids[glass])
            slot.material = solids.get(glass, glass)
