"""What the shaders of a material mean, as inputs of one Principled BSDF: the only one that Blender's exporter knows.

A look is {input: number, colour or linked socket}; what is missing in it has no part in it. Its THIN says that light passes
undeflected, whatever the body's thickness. Closures that are mixed become one look between theirs."""
import math

import bpy

from losses import LIGHT, LOOK, NOTE, say
from trees import constant, maker, upstream

THIN = "thin"
BLACK = (0.0, 0.0, 0.0, 1.0)
WHITE = (1.0, 1.0, 1.0, 1.0)
TRANSLUCENT = 0.5  # roughness: rougher sheets of ours lose light, of which 0.91 is left here, 0.32 at 1
MATTE = {"Color": "Base Color", "Normal": "Normal"}
COMMON = {**MATTE, "Roughness": "Roughness", "IOR": "IOR"}
# shader: (what it always is, {input that is read: what it is of the look})
CLOSURES = {
    "ShaderNodeBsdfDiffuse": ({"Specular": 0.0}, MATTE),
    "ShaderNodeBsdfGlossy": ({"Metallic": 1.0}, COMMON),
    "ShaderNodeBsdfAnisotropic": ({"Metallic": 1.0}, COMMON),
    "ShaderNodeBsdfGlass": ({"Transmission": 1.0}, COMMON),
    "ShaderNodeBsdfRefraction": ({"Transmission": 1.0, "Specular": 0.0}, COMMON),
    "ShaderNodeBsdfTransparent": ({"Transmission": 1.0, "Roughness": 0.0, "IOR": 1.0, THIN: True}, {"Color": "Base Color"}),
    "ShaderNodeBsdfTranslucent": ({"Transmission": 1.0, "Roughness": TRANSLUCENT, "IOR": 1.0, THIN: True}, MATTE),
    "ShaderNodeEmission": ({"Base Color": BLACK}, {"Color": "Emission Color", "Strength": "Emission Strength"}),
}
# Inputs of the Principled BSDF that are exported and read, by all names that they have had.
PRINCIPLED = {
    "Base Color": ("Base Color",), "Metallic": ("Metallic",), "Roughness": ("Roughness",), "IOR": ("IOR",), "Alpha": ("Alpha",),
    "Normal": ("Normal",), "Specular": ("Specular IOR Level", "Specular"), "Specular Tint": ("Specular Tint",),
    "Transmission": ("Transmission Weight", "Transmission"), "Emission Color": ("Emission Color", "Emission"),
    "Emission Strength": ("Emission Strength",), "Coat": ("Coat Weight", "Clearcoat"),
    "Coat Roughness": ("Coat Roughness", "Clearcoat Roughness"), "Coat Normal": ("Coat Normal", "Clearcoat Normal"),
    "Sheen": ("Sheen Weight", "Sheen"), "Sheen Roughness": ("Sheen Roughness",), "Sheen Tint": ("Sheen Tint",),
}


def socket_of(shader, *names):
    """The first of these inputs that this version of Blender has; None."""
    return next((shader.inputs[name] for name in names if name in shader.inputs), None)


def value_of(socket):
    if socket.is_linked:
        return socket
    value = socket.default_value
    return tuple(value) if hasattr(value, "__len__") else value


def f0_of(ior):
    return ((ior - 1) / (ior + 1)) ** 2


def see_through(look):
    """Whether it is a Transparent BSDF."""
    return look.get("IOR") == 1.0 and look.get("Roughness") == 0.0 and look.get("Transmission") == 1.0


def is_glass(look):
    return look.get("Transmission", 0) != 0 and not see_through(look)


def is_mirror(look):
    return look.get("Metallic") == 1.0


def blend(share, x, y):
    """Of two values of an input; the greater part of what changes from place to place."""
    if isinstance(x, float) and isinstance(y, float):
        return x * (1 - share) + y * share
    if isinstance(x, tuple) and isinstance(y, tuple):
        return tuple(p * (1 - share) + q * share for p, q in zip(x, y))
    return y if share > 0.5 else x


def with_amounts(look, names):
    """It has nothing of what only the other has; what is black reflects nothing, so there the other's kind counts."""
    amounts = ("Emission Strength",) if look["Base Color"] == BLACK else ("Metallic", "Transmission", "Emission Strength")
    return {**{name: 0.0 for name in amounts if name in names}, **look}


class ShaderReader:
    """Reads the shaders of one material."""

    def __init__(self, material):
        self.material = material

    def say(self, harm, text):
        say(harm, f"material {self.material.name}: {text}")

    def read(self, socket):
        """The look of a shader input."""
        node = maker(socket)
        if not node:
            return {"Base Color": BLACK}
        kind = node.bl_idname
        if kind == "ShaderNodeBsdfPrincipled":
            return self.principled(node)
        if kind == "ShaderNodeMixShader":
            return self.mixed(node.inputs[0], self.read(node.inputs[1]), self.read(node.inputs[2]))
        if kind == "ShaderNodeAddShader":
            return self.added(self.read(node.inputs[0]), self.read(node.inputs[1]))
        if kind in CLOSURES:
            return self.closure(node)
        self.say(LIGHT, f"its {node.bl_label} is not read; it is taken as diffuse")
        colour = socket_of(node, "Color", "Base Color")
        return {"Base Color": value_of(colour) if colour else (0.5, 0.5, 0.5, 1.0), "Specular": 0.0}

    def principled(self, node):
        self.report_inputs(node, [name for names in PRINCIPLED.values() for name in names])
        found = {name: socket_of(node, *names) for name, names in PRINCIPLED.items()}
        look = {name: value_of(s) for name, s in found.items() if s and (s.is_linked or not name.endswith("Normal"))}
        tint, level, ior = look["Base Color"], look["Specular"], look["IOR"]
        if look["Transmission"] == 0 and isinstance(ior, float) and level not in (0, 0.5) and bpy.app.version >= (4, 0):
            if isinstance(level, float):  # it scales the reflectance at normal incidence, but not at grazing angles
                root = math.sqrt(min(2 * level, 1 / max(f0_of(ior), 1e-9)) * f0_of(ior))
                look["IOR"], look["Specular"] = (1 + root) / max(1 - root, 1e-3), 0.5
        if look["Transmission"] == 1.0 and bpy.app.version >= (4, 0):  # each of two interfaces has a part of the tint
            if isinstance(tint, tuple):
                look["Base Color"] = tuple(math.sqrt(max(0.0, c)) for c in tint)
            else:
                self.say(LOOK, "its glass is tinted by nodes; Cycles takes the square root of that")
        return look

    def closure(self, node):
        always, inputs = CLOSURES[node.bl_idname]
        look = dict(always)
        for name, part in inputs.items():
            socket = node.inputs.get(name)
            if socket and (socket.is_linked or name != "Normal"):
                look[part] = value_of(socket)
        if getattr(node, "distribution", "") == "SHARP":
            look["Roughness"] = 0.0
        if node.bl_idname == "ShaderNodeBsdfTranslucent":
            self.say(LIGHT, "its translucence is taken as rough transmission, which scatters forwards")
        self.report_inputs(node, inputs)
        return look

    def report_inputs(self, node, inputs):
        """Names what is set at a shader and not read: what differs from a fresh one. What belongs to a weight of 0 counts not."""
        nodes = self.material.node_tree.nodes
        fresh = nodes.new(node.bl_idname)
        lost = [socket for socket, default in zip(node.inputs, fresh.inputs)
                if socket.name not in inputs and socket.name != "Weight" and hasattr(socket, "default_value")
                and (socket.is_linked or value_of(socket) != value_of(default))]
        nodes.remove(fresh)
        for socket in lost:
            family = socket.name.split()[0].replace("Tangent", "Anisotropic")
            weight = next((s for s in node.inputs if s.name in (family, family + " Weight", family + " Film Thickness")), None)
            if weight in (None, socket) or weight.is_linked or weight.default_value > 0:
                self.say(LIGHT if family == "Subsurface" else LOOK, f"{socket.name} of its {node.bl_label} is lost")

    def added(self, a, b):
        for one, other in ((a, b), (b, a)):
            if one["Base Color"] == BLACK and "Emission Strength" in one and other.get("Emission Strength", 0.0) == 0.0:
                return {**other, **{name: one[name] for name in ("Emission Color", "Emission Strength")}}
        if see_through(a) or see_through(b):
            self.say(LIGHT, "its Add Shader with a Transparent BSDF is taken as half of each")
        both = self.between(0.5, a, b)
        for name in ("Base Color", "Emission Strength"):
            value = both.get(name)
            if isinstance(value, tuple):
                both[name] = tuple(min(1.0, 2 * c) for c in value)
            elif isinstance(value, float):
                both[name] = 2 * value
        return both

    def mixed(self, factor, a, b):
        """Of a share 1 - factor of `a` and a share of `b`."""
        nodes = upstream(factor)
        kinds = {node.bl_idname for node, _ in nodes}
        share = constant(factor)
        if "ShaderNodeLightPath" in kinds:
            return self.by_kind_of_ray(share, a, b)
        if share is not None:
            return self.between(min(max(share, 0.0), 1.0), a, b)
        angular = next((pair for pair in nodes if pair[0].bl_idname in ("ShaderNodeFresnel", "ShaderNodeLayerWeight")), None)
        if angular:
            return self.layered(*angular, len(nodes) > 1, a, b)
        if see_through(a) and not see_through(b):
            self.report_tint(a)
            return {**b, "Alpha": factor}
        self.say(LIGHT, "its Mix Shader changes from place to place; it is taken as half of each")
        return self.between(0.5, a, b)

    def by_kind_of_ray(self, share, a, b):
        """A pane that lets light straight through, but looks like glass; or what looks otherwise than it lights."""
        for one, other in ((a, b), (b, a)):
            if see_through(one) and is_glass(other):
                if one["Base Color"] != other["Base Color"]:
                    self.say(LOOK, "it has one colour for the camera, another for the light that passes; it is taken as light passes")
                self.say(NOTE, "it lets light pass by kind of ray (Light Path); it is taken as glass, which does")
                return {**other, "Base Color": one["Base Color"]}
        if share is None:
            share = 1.0 if see_through(a) else 0.0
        harm = LIGHT if see_through(a) or see_through(b) else LOOK
        self.say(harm, "it differs by kind of ray (Light Path); it is taken as diffuse rays see it")
        return self.between(min(max(share, 0.0), 1.0), a, b)

    def layered(self, node, output, bent, under, top):
        """A reflection that grows towards grazing angles by a Fresnel or Layer Weight node; `bent`: and by others."""
        of_weight = node.bl_idname == "ShaderNodeLayerWeight"
        ior = constant(node.inputs["Blend" if of_weight else "IOR"])
        if of_weight and ior is not None:
            ior = 1 / max(1 - ior, 1e-3)
        plain = not bent and output.name != "Facing" and ior is not None and ior >= 1
        if not plain:
            ior = 1.5
            self.say(LOOK, f"its reflection by angle is taken as that of IOR {ior:.3g}")
        if is_mirror(under) and not is_mirror(top):
            under, top = top, under
            self.say(LOOK, "its reflection is taken as growing towards grazing angles")
        if not is_mirror(top) and not (is_glass(top) and see_through(under)):
            self.say(LIGHT, "its Mix Shader changes with the angle; it is taken as its first part")
            return under
        look = {**under, "IOR": ior, "Specular": 0.5}
        if is_mirror(top) and bpy.app.version >= (4, 0):  # a number before
            look["Specular Tint"] = top["Base Color"]
        if "Roughness" in top and (see_through(under) or "Roughness" not in under):
            look["Roughness"] = top["Roughness"]
        if see_through(under):
            self.say(LIGHT, "its Transparent BSDF under a reflection is taken as thin glass; on back faces Cycles keeps up to half of the light back")
        return look

    def report_tint(self, look):
        if look["Base Color"] != WHITE:
            self.say(LIGHT, "the colour of its Transparent BSDF is lost")

    def between(self, share, a, b):
        if share in (0.0, 1.0):
            return b if share else a
        for one, other, part in ((a, b, share), (b, a, 1 - share)):
            if see_through(one) and not see_through(other):
                self.report_tint(one)
                alpha = other.get("Alpha", 1.0)
                if isinstance(alpha, float):
                    return {**other, "Alpha": alpha * part}
        if BLACK not in (a["Base Color"], b["Base Color"]) and a["Base Color"] != b["Base Color"]:
            self.say(LOOK, "its shaders are taken as one between them")
        a, b = (with_amounts(look, {**a, **b}) for look in (a, b))
        return {name: blend(share, a.get(name, b.get(name)), b.get(name, a.get(name))) for name in {**a, **b}}
