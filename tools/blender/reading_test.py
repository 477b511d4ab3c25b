"""Tests of what the extension makes of shaders and lamps, and of what it says is lost; run as blender_test.py."""
import contextlib
import io
import math
import os
import subprocess
import sys
import time
import types
import unittest
from unittest import mock

import bpy
import numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import blender_test  # noqa: E402
import rooms  # noqa: E402
from blender_test import FOLDER, exported, rendered  # noqa: E402
from tdpt import engine, exr, portals, programs  # noqa: E402


def shaded(name, build):
    """A box of a material whose surface is what build(tree) returns: a node or a socket."""
    material = rooms.diffuse(name)
    tree = material.node_tree
    surface = tree.get_output_node("ALL").inputs["Surface"]
    tree.links.remove(surface.links[0])
    made = build(tree)
    if made:
        tree.links.new(made if isinstance(made, bpy.types.NodeSocket) else made.outputs[0], surface)
    return rooms.box(name, (1, 1, 1), (2, 2, 1.001), material)


def node(tree, kind, **values):
    """Values of inputs, which are links where they are nodes or sockets, or of properties."""
    made = tree.nodes.new("ShaderNode" + kind)
    for name, value in values.items():
        socket = made.inputs[int(name[1:])] if name[0] == "i" and name[1:].isdigit() else made.inputs.get(name.replace("_", " "))
        if socket is None:
            setattr(made, name, value)
        elif isinstance(value, (bpy.types.Node, bpy.types.NodeSocket)):
            tree.links.new(value.outputs[0] if isinstance(value, bpy.types.Node) else value, socket)
        else:
            socket.default_value = value
    return made


def ray(tree, name="Is Shadow Ray"):
    return node(tree, "LightPath").outputs[name]


def glass(tree, **values):
    return node(tree, "BsdfGlass", Roughness=0, **values)


def see_through(tree, **values):
    return node(tree, "BsdfTransparent", **values)


def mirror(tree):
    return node(tree, "BsdfGlossy", Roughness=0)


def mixed(tree, factor, a, b):
    return node(tree, "MixShader", i0=factor, i1=a, i2=b)


def grouped(tree):
    group = bpy.data.node_groups.new("pane", "ShaderNodeTree")
    if hasattr(group, "interface"):
        group.interface.new_socket("Surface", in_out="OUTPUT", socket_type="NodeSocketShader")
    else:
        group.outputs.new("NodeSocketShader", "Surface")
    inside = mixed(group, ray(group), glass(group), see_through(group))
    reroute = group.nodes.new("NodeReroute")
    group.links.new(inside.outputs[0], reroute.inputs[0])
    group.links.new(reroute.outputs[0], group.nodes.new("NodeGroupOutput").inputs[0])
    return node(tree, "Group", node_tree=group)


PANES = {
    "shadow": lambda t: mixed(t, ray(t), glass(t), see_through(t)),
    "kinds": lambda t: mixed(t, node(t, "Math", operation="MAXIMUM", i0=ray(t), i1=ray(t, "Is Diffuse Ray")), glass(t), see_through(t)),
    "camera": lambda t: mixed(t, ray(t, "Is Camera Ray"), see_through(t), glass(t)),
    "deep": lambda t: mixed(t, node(t, "Math", operation="GREATER_THAN", i0=ray(t, "Transparent Depth"), i1=1.0), glass(t), see_through(t)),
    "fresnel": lambda t: mixed(t, node(t, "Fresnel", IOR=1.5), see_through(t), mirror(t)),
    "layer": lambda t: mixed(t, node(t, "LayerWeight", Blend=1 / 3).outputs["Fresnel"], see_through(t), mirror(t)),
    "both": lambda t: mixed(t, ray(t), mixed(t, node(t, "Fresnel", IOR=1.5), see_through(t), mirror(t)), see_through(t)),
    "group": grouped,
    "by hand": lambda t: mixed(t, node(t, "Fresnel", IOR=1.5), node(t, "BsdfRefraction", Roughness=0, IOR=1.5), mirror(t)),
    "by hand and ray": lambda t: mixed(t, ray(t), PANES["by hand"](t), see_through(t)),
}


class Reading(unittest.TestCase):
    """Shaders other than the Principled BSDF."""

    def test_panes_by_kind_of_ray_or_angle(self):
        scene = rooms.three_rooms()
        for name, build in PANES.items():
            shaded(name, build)
        shaded("doll's wall", lambda t: mixed(t, ray(t, "Is Camera Ray"), node(t, "BsdfDiffuse"), see_through(t)))
        document, told = exported(scene)
        of = {m["name"]: m for m in document["materials"]}
        for name in PANES:
            self.assertEqual(of[name]["extensions"]["KHR_materials_transmission"]["transmissionFactor"], 1, name)
            self.assertNotIn("KHR_materials_volume", of[name]["extensions"])
            self.assertAlmostEqual(of[name]["extensions"].get("KHR_materials_ior", {"ior": 1.5})["ior"], 1.5, delta=0.06)
            self.assertEqual(of[name]["pbrMetallicRoughness"]["roughnessFactor"], 0)
            self.assertEqual("is taken as" not in "".join(l for l in told.splitlines() if f"material {name}:" in l), name == "by hand")
        self.assertNotIn("KHR_materials_transmission", of["doll's wall"]["extensions"])
        self.assertIn("light: material doll's wall: it differs by kind of ray", told)

    def test_light_passes_what_lets_it_pass(self):
        """The room behind a window that is filled, over that behind an open one: a pane lets 0.92 and at an angle less pass, a
        Mix Shader half of the light, a Transparent BSDF its colour."""
        def tint(t, value):
            return see_through(t, Color=(value, value, value, 1))

        fillings = {  # (expected, error allowed)
            "pane": (PANES["shadow"], 0.9, 0.04),
            "half": (lambda t: mixed(t, 0.5, see_through(t), node(t, "BsdfDiffuse", Color=(0, 0, 0, 1))), 0.5, 0.02),
            "tinted": (lambda t: tint(t, 0.3), 0.3, 0.02),
            "shut": (lambda t: node(t, "BsdfDiffuse", Color=(0, 0, 0, 1)), 0, 0),
        }
        means = {}
        for name in ("open", *fillings):
            scene = rooms.window_room()
            if name != "open":
                pane = shaded(name, fillings[name][0])
                pane.data = bpy.data.meshes.new("sheet")
                pane.data.from_pydata([(6.05, 0.7, 0.8), (6.05, 2.3, 0.8), (6.05, 2.3, 2.2), (6.05, 0.7, 2.2)], [], [(0, 1, 2, 3)])
                pane.data.materials.append(bpy.data.materials[name])
            path = os.path.join(FOLDER, "exported.glb")
            exported(scene)
            words = [programs.program("tdpt-render"), path, "-o", path + ".exr", "--spp", "256", "--width", "16", "--quiet",
                     "--integrator", "nee", "--max-depth", "3", "--look-from=3.2,1.5,-1.5", "--look-at=5,0,-1.5"]
            subprocess.run(words, check=True, capture_output=True)
            means[name] = exr.read(path + ".exr", {"G"})["G"].mean()
        for name, (_, expected, error) in fillings.items():
            self.assertAlmostEqual(means[name] / means["open"], expected, delta=error, msg=name)

    @unittest.skipIf(bpy.app.version < (4, 0), "the Principled BSDF was another one")
    def test_mixtures(self):
        scene = rooms.three_rooms()
        image = bpy.data.images.new("leaf", 8, 8, alpha=True)
        grey, brown = (0.5, 0.5, 0.5, 1), (0.2, 0.1, 0.05, 1)
        builders = {
            "plastic": lambda t: mixed(t, node(t, "Fresnel", IOR=1.3), node(t, "BsdfDiffuse", Color=brown), node(t, "BsdfGlossy", Roughness=0.3)),
            "bark": lambda t: node(t, "BsdfPrincipled", Base_Color=node(t, "TexNoise"), Roughness=node(t, "TexNoise"), IOR=1.2),
            "shiny": lambda t: mixed(t, 0.1, node(t, "BsdfDiffuse", Color=grey), node(t, "BsdfGlossy", Color=grey, Roughness=0.3)),
            "lampshade": lambda t: mixed(t, 0.25, node(t, "BsdfGlossy", Color=grey, Roughness=0.3), node(t, "Emission", Strength=4)),
            "sheer": lambda t: mixed(t, 0.25, see_through(t), node(t, "BsdfTranslucent", Color=grey)),
            "curtain": lambda t: mixed(t, 0.4, node(t, "BsdfDiffuse", Color=grey), node(t, "BsdfTranslucent", Color=grey)),
            "gauze": lambda t: mixed(t, 0.25, see_through(t), node(t, "BsdfDiffuse")),
            "leaf": lambda t: mixed(t, node(t, "TexImage", image=image).outputs["Alpha"], see_through(t), node(t, "BsdfDiffuse")),
            "glow": lambda t: node(t, "AddShader", i0=node(t, "BsdfDiffuse", Color=grey), i1=node(t, "Emission", Strength=3)),
            "lit": lambda t: node(t, "Emission", Strength=node(t, "Math", operation="ADD", i0=ray(t, "Is Camera Ray"), i1=2.0)),
            "slate": lambda t: node(t, "BsdfPrincipled", Specular_IOR_Level=0.25),
            "tumbler": lambda t: node(t, "BsdfPrincipled", Transmission_Weight=1, Base_Color=(0.25, 0.25, 0.25, 1)),
        }
        for name, build in builders.items():
            shaded(name, build)
        document, told = exported(scene)
        of = {m["name"]: {**m.get("extensions", {}), **m["pbrMetallicRoughness"], **m} for m in document["materials"]}
        numbers = numpy.testing.assert_allclose
        numbers(of["plastic"]["baseColorFactor"][:3], brown[:3], rtol=1e-5)
        numbers([of["plastic"]["KHR_materials_ior"]["ior"], of["plastic"]["roughnessFactor"], of["plastic"]["metallicFactor"]], [1.3, 0.3, 0], rtol=1e-5)
        numbers(of["plastic"]["KHR_materials_specular"]["specularColorFactor"], [0.8] * 3, rtol=1e-5)  # a Glossy BSDF's default
        numbers([*of["bark"]["baseColorFactor"][:3], of["bark"]["roughnessFactor"], of["bark"]["KHR_materials_ior"]["ior"]], [0.8, 0.8, 0.8, 0.5, 1.2], rtol=1e-5)
        numbers([of["shiny"]["metallicFactor"], of["shiny"]["roughnessFactor"]], [0.1, 0.3], rtol=1e-5)
        numbers([of["curtain"]["KHR_materials_transmission"]["transmissionFactor"], of["gauze"]["baseColorFactor"][3]], [0.4, 0.25], rtol=1e-5)
        self.assertEqual([of[name].get("alphaMode", "OPAQUE") for name in ("gauze", "leaf", "glow")], ["BLEND", "BLEND", "OPAQUE"])
        self.assertEqual([of[n]["KHR_materials_emissive_strength"]["emissiveStrength"] for n in ("glow", "lit")], [3, 2])
        numbers(of["glow"]["baseColorFactor"][:3], grey[:3], rtol=1e-5)
        numbers(of["lit"]["baseColorFactor"][:3], (0, 0, 0))
        numbers([of["lampshade"]["baseColorFactor"][0], of["lampshade"].get("metallicFactor", 1)], [0.375, 1])
        numbers([of["sheer"]["baseColorFactor"][3], of["sheer"]["KHR_materials_transmission"]["transmissionFactor"]], [0.25, 1])
        f0 = 0.5 * 0.2**2
        numbers(of["slate"]["KHR_materials_ior"]["ior"], (1 + f0**0.5) / (1 - f0**0.5), rtol=1e-5)
        numbers(of["tumbler"]["baseColorFactor"][:3], (0.5, 0.5, 0.5), rtol=1e-5)  # at each of two interfaces
        self.assertIn("look: material lit: Emission Strength differs by kind of ray", told)

    def test_every_node_is_read_or_named(self):
        """Whatever nodes Blender has: one that makes the base colour or the surface is read, or the export names the material."""
        scene = rooms.three_rooms()
        read = {"ShaderNodeRGB", "ShaderNodeValue", "ShaderNodeBlackbody", "ShaderNodeVertexColor", "ShaderNodeAttribute", "ShaderNodeUVMap",
                "ShaderNodeLightPath", "ShaderNodeMath", "ShaderNodeSeparateColor", "ShaderNodeMapping", "ShaderNodeMix",
                "ShaderNodeBsdfPrincipled", "ShaderNodeBsdfDiffuse", "ShaderNodeBsdfGlossy", "ShaderNodeBsdfAnisotropic", "ShaderNodeBsdfGlass",
                "ShaderNodeBsdfRefraction", "ShaderNodeBsdfTransparent", "ShaderNodeEmission", "ShaderNodeMixShader", "ShaderNodeAddShader"}
        tried = set()
        for kind in dir(bpy.types):
            if not kind.startswith("ShaderNode"):
                continue

            def build(tree, kind=kind):
                try:
                    made = tree.nodes.new(kind)
                except RuntimeError:
                    return None  # no node, but a kind of nodes
                if not made.outputs or kind in ("ShaderNodeGroup", "ShaderNodeCustomGroup"):
                    return None
                tried.add(kind)
                if made.outputs[0].type == "SHADER":
                    return made
                return node(tree, "BsdfPrincipled", Base_Color=made, Roughness=made)

            shaded(kind, build)
        _, told = exported(scene)
        self.assertGreater(len(tried), 60)
        named = {kind for kind in tried if f"material {kind}: " in told}
        self.assertEqual(tried - named - read, set())
        self.assertGreater(len(named), 40)  # twin: nothing is named because all is

    def test_what_is_lost_is_named_the_worst_first(self):
        scene = rooms.lamps_room()
        things = {o.name: o for o in scene.objects}
        things["disc"].data.spread = math.radians(40)
        things["point"].data.shadow_soft_size = 0.2
        things["point"].data.use_shadow = False
        things["north"].visible_shadow = False
        things["west"].visible_diffuse = False
        things["south"].is_holdout = True
        shaded("bumpy", lambda t: node(t, "BsdfPrincipled", Normal=node(t, "Bump", Height=node(t, "TexNoise"))))
        shaded("stained", lambda t: node(t, "BsdfPrincipled", Base_Color=node(t, "ValToRGB", Fac=node(t, "TexNoise"))))
        fog = shaded("fog", lambda t: None)
        tree = fog.active_material.node_tree
        tree.links.new(node(tree, "VolumeScatter").outputs[0], tree.get_output_node("ALL").inputs["Volume"])
        scene.collection.objects.link(bpy.data.objects.new("blob", bpy.data.metaballs.new("blob")))
        scene.cycles.film_exposure = 2
        scene.camera.data.clip_start = 3
        scene.render.use_motion_blur = True
        bpy.context.view_layer.material_override = bpy.data.materials["grey"]
        scene.world = bpy.data.worlds.new("mist")
        scene.world.use_nodes = True
        tree = scene.world.node_tree
        tree.links.new(node(tree, "VolumeScatter").outputs[0], tree.get_output_node("ALL").inputs["Volume"])
        document, told = exported(scene)
        for sentence in (
            "light: lamp disc: its spread of 40 degrees is lost", "look: lamp point: its radius is lost", "light: lamp point: it casts no shadows",
            "light: object north: casts no shadow", "light: object west: is invisible to diffuse rays", "look: object south: is a holdout",
            "light: world: its volume is lost", "light: view layer ViewLayer: its material override is lost",
            "look: material bumpy: Normal hangs on Bump, Noise Texture, which is not read; it is lost", "light: material stained: Base Color hangs on Color Ramp, Noise Texture",
            "light: material fog: its volume (Volume Scatter) is lost", "light: object blob: is of type Meta, which is lost",
            "light: scene: the exposure 2 of Cycles' film is lost", "light: camera camera: its clipping at 3 m cuts ", "look: scene: its motion blur is lost",
        ):
            self.assertIn(sentence, told)
        order = [line.split(":")[0].strip() for line in told.splitlines() if line.startswith(("  light: ", "  look: ", "  note: "))]
        self.assertEqual(order, sorted(order, key=["light", "look", "note"].index))
        fog = next(m for m in document["materials"] if m["name"] == "fog")
        self.assertEqual(fog["extensions"]["KHR_materials_transmission"]["transmissionFactor"], 1)  # not a black box

    def test_an_untouched_scene_loses_nothing(self):
        """Twin of the above."""
        scene = rooms.lamps_room()
        next(o for o in scene.objects if o.name == "sun").data.angle = 0
        shaded("plain", lambda t: node(t, "BsdfPrincipled"))
        _, told = exported(scene)
        self.assertNotIn("  light: ", told)
        self.assertNotIn("  look: ", told)

    @unittest.skipIf(bpy.app.version < (5, 0), "other skies")
    def test_a_baked_sun_keeps_its_power(self):
        """Wherever its edge crosses the pixels of the sky's picture. Baked with few samples, which do for all but the sun."""
        sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "tdpt"))
        import world

        def power(turn):
            scene = rooms.empty()
            scene.world = bpy.data.worlds.new("sky")
            tree = scene.world.node_tree
            sky = node(tree, "TexSky", sun_elevation=0.65, sun_rotation=turn)
            tree.links.new(sky.outputs[0], next(n for n in tree.nodes if n.bl_idname == "ShaderNodeBackground").inputs["Color"])
            path = os.path.join(FOLDER, "sun.exr")
            world.write_exr(world.bake(scene.world, os.path.join(FOLDER, "baked.exr")), path)
            light = exr.read(path, {"G"})["G"]
            return light[light > 100 * numpy.median(light)].sum()

        few = mock.patch.multiple(world, BAKED_SAMPLES=2)
        with few:
            powers = [power(turn) for turn in (1.0, 1.002)]
        with few, mock.patch.object(world, "bake_sun", lambda *_: None):
            twin = [power(turn) for turn in (1.0, 1.002)]
        self.assertLess(abs(powers[0] / powers[1] - 1), 0.005)
        self.assertGreater(abs(twin[0] / twin[1] - 1), 0.02)

    def test_a_spot_s_edge(self):
        """On a floor, where its cone fades: beside Cycles."""
        for blend in (0.3, 1.0):
            scene = rooms.empty()
            rooms.box("floor", (-3, -3, -0.1), (3, 3, 0), rooms.diffuse("grey"))
            rooms.lamp(scene, "SPOT", (0, 0, 2), 100, "spot", shadow_soft_size=0, spot_size=1.2, spot_blend=blend)
            scene.render.resolution_x = scene.render.resolution_y = 64
            camera_ = rooms.camera(scene, (0, 0, 6), (0, 0, 0), 60)
            camera_.rotation_euler = (0, 0, 0)
            scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.pixel_filter_type = 64, False, "BOX"
            bpy.context.view_layer.update()
            theirs = rendered(scene, engine="CYCLES")["Combined.G"]
            path = os.path.join(FOLDER, "exported.glb")
            exported(scene)
            words = [programs.program("tdpt-render"), path, "-o", path + ".exr", "--spp", "64", "--quiet", "--integrator", "nee", "--max-depth", "3"]
            subprocess.run(words, check=True, capture_output=True)
            ours = exr.read(path + ".exr", {"G"})["G"]
            y, x = numpy.mgrid[0:64, 0:64] + 0.5 - 32
            angle = numpy.arctan(numpy.hypot(x, y) * (6 * 36 / 60 / 64) / 2)
            cosine = (numpy.cos(angle) - numpy.cos(0.6)) / ((1 - numpy.cos(0.6)) * blend)
            edge = (cosine > 0.2) & (cosine < 0.8)
            self.assertGreater(edge.sum(), 50)
            self.assertAlmostEqual(ours[edge].mean() / theirs[edge].mean(), 1, delta=0.02)
            # Twin: glTF's own curve, the square, between the angles that Blender's exporter writes.
            inner = numpy.cos(0.6 * (1 - blend))
            gltf = numpy.clip((numpy.cos(angle) - numpy.cos(0.6)) / (inner - numpy.cos(0.6)), 0, 1) ** 2
            smooth = numpy.clip(cosine, 0, 1) ** 2 * (3 - 2 * numpy.clip(cosine, 0, 1))
            self.assertGreater(abs(gltf[edge].mean() / smooth[edge].mean() - 1), 0.1)


class Telling(unittest.TestCase):
    def test_all_is_printed_and_the_worst_is_a_warning(self):
        warned = []
        teller = types.SimpleNamespace(report=lambda kind, text: warned.append((kind, text)))
        engine.Rendered.sentences = []
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            engine.TdptEngine.report_all(teller, ["light: material a: b", "look: lamp c: d", "note: e"])
            engine.TdptEngine.report_all(teller, ["note: f"])
        self.assertEqual(printed.getvalue().splitlines(), ["tdpt: light: material a: b", "tdpt: look: lamp c: d", "tdpt: note: e", "tdpt: note: f"])
        self.assertEqual(len(warned), 1)
        self.assertEqual(warned[0][0], {"WARNING"})
        self.assertTrue(warned[0][1].startswith("material a: b, and 1 more"), warned)
        self.assertEqual(len(engine.Rendered.sentences), 4)

    def test_a_line_a_second(self):
        shown = []
        teller = types.SimpleNamespace(next_words=0.0, words_shown="", update_progress=lambda _: None,
                                       update_stats=lambda _, words: shown.append(words))
        began = time.monotonic()
        with mock.patch.object(engine.time, "monotonic", lambda: clock):
            for tick in range(500):  # ten seconds
                clock = began + tick * 0.02
                engine.TdptEngine.show(teller, (tick / 500, f"rendering {tick}"))
        self.assertEqual(len(shown), 10)
        with mock.patch.object(engine.time, "monotonic", lambda: clock + 100):
            engine.TdptEngine.show(teller, (1, shown[-1]))
        self.assertEqual(len(shown), 10)  # what is the same is not said again

    def test_what_the_programs_say(self):
        lines = ["tdpt-render: warning: no sample found light", "portalfit: 1 portal", ""]
        self.assertEqual(programs.sentences_in(lines), ["light: no sample found light", "note: portalfit: 1 portal"])

    def test_why_there_is_no_portal(self):
        """The panel shows the reason that the programs give, not one of its own."""
        lines = ["ffgraph: x", "mincut: no bottleneck: is its door shut?"]
        self.assertEqual(portals.words_of([], portals.reason_in(lines)), "No portal: is its door shut?")

    def test_a_dark_room(self):
        """What the programs warn of reaches the console and the panel."""
        scene = rooms.three_rooms()
        rooms.box("shut", (2.8, 1.1, 0), (3.2, 2.1, 2.1), rooms.diffuse("oak"))
        bpy.context.view_layer.update()
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            rendered(scene, samples=1, denoise=False)
        self.assertIn("tdpt: note: area lamp lamp", printed.getvalue())
        self.assertIn("tdpt: light: ", printed.getvalue())
        self.assertTrue(any(line.startswith("light: ") for line in engine.Rendered.sentences), engine.Rendered.sentences)


if __name__ == "__main__":
    blender_test.main(sys.modules[__name__])
