"""Node trees of materials: flat, so that each link leads to the node that makes the value, and what is known of a value."""
import contextlib

import bpy

PLACE = {"name", "label", "location", "location_absolute", "parent", "width", "height", "select", "mute", "node_tree"}
# What the nodes of a material see by: diffuse rays, which carry the light of a room.
AS_IT_LIGHTS = {"Is Diffuse Ray": 1.0, "Ray Length": 1e10, "Ray Depth": 1.0, "Diffuse Depth": 1.0}
MATH = {
    "ADD": lambda a, b: a + b,
    "SUBTRACT": lambda a, b: a - b,
    "MULTIPLY": lambda a, b: a * b,
    "DIVIDE": lambda a, b: a / b if b else 0.0,
    "MAXIMUM": max,
    "MINIMUM": min,
    "GREATER_THAN": lambda a, b: float(a > b),
    "LESS_THAN": lambda a, b: float(a < b),
}


def connect_value(source, target):
    """Gives a socket the value that another has of itself."""
    if hasattr(source, "default_value"):
        with contextlib.suppress(AttributeError, TypeError, ValueError):  # a colour for a number
            target.default_value = source.default_value


def connect(tree, source, target):
    """Gives an input what another input has: its link, or its value."""
    if source.is_linked:
        tree.links.new(source.links[0].from_socket, target)
    else:
        connect_value(source, target)


def bypass(tree, node):
    """Takes a node out; `node`: a reroute, or one that is muted."""
    pairs = [(node.inputs[0], node.outputs[0])] if node.bl_idname == "NodeReroute" else [
        (link.from_socket, link.to_socket) for link in node.internal_links]
    for before, after in pairs:
        for target in [link.to_socket for link in after.links]:
            connect(tree, before, target)
    tree.nodes.remove(node)


def copy_of(tree, node):
    new = tree.nodes.new(node.bl_idname)
    new.mute = node.mute
    for known in node.bl_rna.properties:
        if not known.is_readonly and known.identifier not in PLACE:
            with contextlib.suppress(AttributeError, TypeError):
                setattr(new, known.identifier, getattr(node, known.identifier))
    if getattr(node, "node_tree", None):
        new.node_tree = node.node_tree
    for old, fresh in [*zip(node.inputs, new.inputs), *zip(node.outputs, new.outputs)]:
        connect_value(old, fresh)
    return new


def index_of(sockets, socket):
    return next(i for i, s in enumerate(sockets) if s.identifier == socket.identifier)


def unpack(tree, group):
    """Puts the nodes of a group in its place."""
    inside = group.node_tree
    ends = ("NodeGroupInput", "NodeGroupOutput", "NodeFrame")
    made = {node: copy_of(tree, node) for node in inside.nodes if node.bl_idname not in ends}

    def feed(link, target):
        if link.from_node.bl_idname == "NodeGroupInput":
            connect(tree, group.inputs[index_of(link.from_node.outputs, link.from_socket)], target)
        else:
            source = made[link.from_node]
            tree.links.new(source.outputs[index_of(link.from_node.outputs, link.from_socket)], target)

    for link in inside.links:
        if link.to_node in made:
            feed(link, made[link.to_node].inputs[index_of(link.to_node.inputs, link.to_socket)])
    end = next((n for n in inside.nodes if n.bl_idname == "NodeGroupOutput" and n.is_active_output), None)
    for number, output in enumerate(group.outputs):
        for target in [link.to_socket for link in output.links]:
            result = end and end.inputs[number]
            if result and result.is_linked:
                feed(result.links[0], target)
            elif result:
                connect(tree, result, target)
    tree.nodes.remove(group)


def flatten(tree):
    """Without groups, reroutes and muted nodes."""
    while True:
        node = next((n for n in tree.nodes if n.mute or n.bl_idname == "NodeReroute"
                     or n.bl_idname == "ShaderNodeGroup" and n.node_tree and not n.node_tree.name.startswith("glTF")), None)
        if not node:
            return
        bypass(tree, node) if node.mute or node.bl_idname == "NodeReroute" else unpack(tree, node)


def maker(socket):
    """The node that makes the value of an input; None."""
    return socket.links[0].from_node if socket.is_linked else None


def upstream(socket):
    """The nodes that the value of an input hangs on, and by which output; the nearest first."""
    found = [(link.from_node, link.from_socket) for link in socket.links]
    for node, _ in found:
        found += [pair for s in node.inputs for pair in ((link.from_node, link.from_socket) for link in s.links) if pair not in found]
    return found


def constant(socket):
    """A number that an input always has, seen by diffuse rays; None."""
    node = maker(socket)
    if not node:
        return float(socket.default_value)
    if node.bl_idname == "ShaderNodeValue":
        return float(node.outputs[0].default_value)
    if node.bl_idname == "ShaderNodeLightPath":
        return AS_IT_LIGHTS.get(socket.links[0].from_socket.name, 0.0)
    if node.bl_idname == "ShaderNodeMath" and node.operation in MATH:
        values = [constant(s) for s in node.inputs[:2]]
        return None if None in values else MATH[node.operation](*values)
    return None


def colour(socket):
    """A colour that an input always has; None."""
    node = maker(socket)
    if not node:
        return tuple(socket.default_value)
    if node.bl_idname == "ShaderNodeRGB":
        return tuple(node.outputs[0].default_value)
    if node.bl_idname == "ShaderNodeBlackbody" and "temperature_color" in bpy.types.Light.bl_rna.properties:
        kelvin = constant(node.inputs["Temperature"])
        lamp = bpy.data.lights.new("kelvin", "POINT")
        lamp.use_temperature, lamp.temperature = True, kelvin or 6500
        made = (*lamp.temperature_color, 1.0)
        bpy.data.lights.remove(lamp)
        return made if kelvin else None
    return None
