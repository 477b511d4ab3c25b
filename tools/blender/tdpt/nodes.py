"""What the inputs of a Principled BSDF are made of, node by node. What Blender's exporter does not read is named; where it would make something else of it, the link is cut, and the input's own value stands in."""
from losses import LIGHT, LOOK, say
from shaders import PRINCIPLED, socket_of
from trees import colour, constant, maker, upstream

HARMFUL = ("Base Color", "Metallic", "Alpha", "Transmission", "Emission Color", "Emission Strength", "Specular")
COLOURS = ("Base Color", "Emission Color", "Specular Tint", "Sheen Tint")
ATTRIBUTES = ("ShaderNodeVertexColor", "ShaderNodeAttribute")


def is_picture(node):
    return node.bl_idname == "ShaderNodeTexImage" and node.image is not None and node.image.size[0] > 0


def is_plain(socket):
    """Whether the exporter can take it as a factor."""
    node = maker(socket)
    return node is None or node.bl_idname in ("ShaderNodeRGB", "ShaderNodeValue", *ATTRIBUTES)


def multiplies(node):
    if node.bl_idname == "ShaderNodeMath":
        return node.operation == "MULTIPLY" and not node.use_clamp and any(is_plain(s) for s in node.inputs[:2])
    if node.blend_type != "MULTIPLY" or getattr(node, "data_type", "RGBA") != "RGBA" or node.inputs[0].is_linked:
        return False
    return node.inputs[0].default_value == 1 and any(is_plain(s) for s in node.inputs[1:] if s.type == "RGBA")


def always(*_):
    return True


# Nodes that the exporter reads: under which conditions, for the input `name` of a Principled BSDF.
READ = {
    "ShaderNodeUVMap": always, "ShaderNodeRGB": always, "ShaderNodeValue": always,
    "ShaderNodeTexImage": lambda node, output, name: (
        is_picture(node) and node.projection == "FLAT" and node.extension != "CLIP" and node.image.source in ("FILE", "GENERATED")),
    "ShaderNodeNormalMap": lambda node, output, name: (
        name.endswith("Normal") and node.space == "TANGENT" and not node.inputs["Strength"].is_linked),
    "ShaderNodeTexCoord": lambda node, output, name: output.name == "UV",
    "ShaderNodeMapping": lambda node, output, name: node.vector_type != "NORMAL" and not any(
        s.is_linked for s in node.inputs[1:]) and not any(node.inputs["Rotation"].default_value[:2]),
    "ShaderNodeMath": lambda node, output, name: (
        name == "Alpha" and node.operation in ("ROUND", "GREATER_THAN", "LESS_THAN") or multiplies(node)),  # a cutoff, a factor
    **dict.fromkeys(("ShaderNodeMix", "ShaderNodeMixRGB"), lambda node, output, name: multiplies(node)),
    **dict.fromkeys(ATTRIBUTES, lambda node, output, name: name in ("Base Color", "Alpha")),
    **dict.fromkeys(("ShaderNodeSeparateColor", "ShaderNodeSeparateRGB"), lambda node, output, name: getattr(node, "mode", "RGB") == "RGB"),
}


def is_read(node, output, name):
    return READ.get(node.bl_idname, lambda *_: False)(node, output, name)


def take_inputs(material, shader):
    """Of the Principled BSDF that is exported: an input's value or picture, where the exporter reads it."""
    tree = material.node_tree

    def report(harm, text):
        say(harm, f"material {material.name}: {text}")

    for name, names in PRINCIPLED.items():
        socket = socket_of(shader, *names)
        if not socket or not socket.is_linked:
            continue
        above, is_normal, is_strength = upstream(socket), name.endswith("Normal"), name == "Emission Strength"
        harm = LIGHT if name in HARMFUL else LOOK
        known = {"VALUE": constant, "RGBA": colour}.get(socket.type, lambda _: None)(socket)
        if known is not None:
            socket.default_value = known
            if any(n.bl_idname == "ShaderNodeLightPath" for n, _ in above):
                report(LOOK, f"{socket.name} differs by kind of ray (Light Path); it is taken as diffuse rays see it")
            tree.links.remove(socket.links[0])
            continue
        lost = sorted({node.bl_label for node, output in above if not is_read(node, output, name)})
        images = [node.image for node, _ in above if is_picture(node)]
        if is_strength and not lost:
            lost = [maker(socket).bl_label]  # the exporter reads a number there
        for image in images if not lost and name != "Alpha" else ():
            if (image.colorspace_settings.name == "sRGB") != (name in COLOURS):
                report(LOOK, f"{name} takes picture {image.name} as {image.colorspace_settings.name}, and glTF otherwise")
        if not lost:
            continue
        whose = f"{socket.name} hangs on {', '.join(lost)}, which is not read"
        if images and not is_strength and not is_normal:
            report(harm, f"{whose}; it is the picture {images[0].name} alone, without it")
            continue
        tree.links.remove(socket.links[0])
        value = socket.default_value
        shown = " ".join(f"{c:.3g}" for c in list(value)[:3]) if hasattr(value, "__len__") else f"{value:.3g}"
        report(harm, f"{whose}; " + ("it is lost" if is_normal else f"it is {shown} all over; bake it to an image"))
