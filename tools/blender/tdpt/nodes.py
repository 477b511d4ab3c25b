"""The account of a Principled BSDF: what its inputs are made of, node by node. What Blender's exporter does not read is
named; where it would make something else of it, the link is cut, and the input's own value stands in."""
from losses import LIGHT, LOOK, say
from shaders import PRINCIPLED, Reader, socket_of
from trees import colour, constant, maker, upstream

HARMFUL = ("Base Color", "Metallic", "Alpha", "Transmission", "Emission Color", "Emission Strength", "Specular")
COLOURS = ("Base Color", "Emission Color", "Specular Tint", "Sheen Tint")
MIXES = ("ShaderNodeMix", "ShaderNodeMixRGB")
ATTRIBUTES = ("ShaderNodeVertexColor", "ShaderNodeAttribute")


def is_picture(node):
    return node.bl_idname == "ShaderNodeTexImage" and node.image is not None and node.image.size[0] > 0


def is_plain(socket):
    """Whether the exporter can take it as a factor."""
    node = maker(socket)
    return node is None or node.bl_idname in ("ShaderNodeRGB", "ShaderNodeValue", *ATTRIBUTES)


def maps_plainly(node):
    return node.vector_type != "NORMAL" and not any(s.is_linked for s in node.inputs[1:]) and not any(
        node.inputs["Rotation"].default_value[:2])


def multiplies(node):
    if node.bl_idname == "ShaderNodeMath":
        return node.operation == "MULTIPLY" and not node.use_clamp and any(is_plain(s) for s in node.inputs[:2])
    if node.blend_type != "MULTIPLY" or getattr(node, "data_type", "RGBA") != "RGBA" or node.inputs[0].is_linked:
        return False
    sides = [s for s in node.inputs[1:] if s.type == "RGBA"]
    return node.inputs[0].default_value == 1 and any(is_plain(s) for s in sides)


def is_read(node, output, name):
    """Whether the exporter reads what this node makes, for the input `name` of a Principled BSDF."""
    kind = node.bl_idname
    if kind == "ShaderNodeTexImage":
        flat = is_picture(node) and node.projection == "FLAT" and node.extension != "CLIP"
        return flat and node.image.source in ("FILE", "GENERATED")
    if kind == "ShaderNodeNormalMap":
        return name.endswith("Normal") and node.space == "TANGENT" and not node.inputs["Strength"].is_linked
    if kind == "ShaderNodeTexCoord":
        return output.name == "UV"
    if kind == "ShaderNodeMapping":
        return maps_plainly(node)
    if kind in ATTRIBUTES:
        return name in ("Base Color", "Alpha")
    if kind in ("ShaderNodeSeparateColor", "ShaderNodeSeparateRGB"):
        return getattr(node, "mode", "RGB") == "RGB"
    if kind == "ShaderNodeMath" and name == "Alpha" and node.operation in ("ROUND", "GREATER_THAN", "LESS_THAN"):
        return True  # a cutoff
    if kind == "ShaderNodeMath" or kind in MIXES:
        return multiplies(node)
    return kind in ("ShaderNodeUVMap", "ShaderNodeRGB", "ShaderNodeValue")


def pass_bump(tree, socket):
    """A normal map below a bump stays."""
    node, bumps = maker(socket), False
    while node and node.bl_idname == "ShaderNodeBump":
        bumps = True
        below = node.inputs["Normal"]
        tree.links.remove(socket.links[0])
        if below.is_linked:
            tree.links.new(below.links[0].from_socket, socket)
        node = maker(socket)
    return bumps


class Account(Reader):
    def take(self, shader):
        """Of all inputs of the Principled BSDF that is exported."""
        tree = self.material.node_tree
        for name, names in PRINCIPLED.items():
            socket = socket_of(shader, *names)
            if socket and socket.is_linked:
                if name.endswith("Normal") and pass_bump(tree, socket):
                    self.say(LOOK, "its Bump is lost; bake it to a normal map")
                self.take_input(tree, socket, name)

    def take_input(self, tree, socket, name):
        above = upstream(socket)
        harm = LIGHT if name in HARMFUL else LOOK
        always = {"VALUE": constant, "RGBA": colour}.get(socket.type, lambda _: None)(socket)
        if always is not None:
            socket.default_value = always
            if any(n.bl_idname == "ShaderNodeLightPath" for n, _ in above):
                self.say(LOOK, f"{socket.name} differs by kind of ray (Light Path); it is taken as diffuse rays see it")
            tree.links.remove(socket.links[0])
            return
        lost = sorted({node.bl_label for node, output in above if not is_read(node, output, name)})
        pictures = [node.image for node, _ in above if is_picture(node)]
        if name == "Emission Strength" and not lost:
            lost = [maker(socket).bl_label]  # the exporter reads a number there
        if not lost:
            self.report_colour_space(pictures, name)
            return
        whose = f"{socket.name} hangs on {', '.join(lost)}, which is not read"
        if pictures and name != "Emission Strength" and not name.endswith("Normal"):
            self.say(harm, f"{whose}; it is the picture {pictures[0].name} alone, without it")
            return
        tree.links.remove(socket.links[0])
        value = socket.default_value
        shown = " ".join(f"{c:.3g}" for c in list(value)[:3]) if hasattr(value, "__len__") else f"{value:.3g}"
        self.say(harm, f"{whose}; " + ("it is lost" if name.endswith("Normal") else f"it is {shown} all over; bake it to an image"))

    def report_colour_space(self, pictures, name):
        for image in pictures:
            if (image.colorspace_settings.name == "sRGB") != (name in COLOURS) and not (name == "Alpha"):
                self.say(LOOK, f"{name} takes picture {image.name} as {image.colorspace_settings.name}, and glTF otherwise")
