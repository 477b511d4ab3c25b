"""Tests of the extension, in a Blender without a window: blender -b --factory-startup -P blender_test.py [-- TEST ...], or by a
Python that has the module bpy. TDPT_BIN: the folder of the programs."""
import contextlib
import io
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import time
import types
import unittest
from unittest import mock

import bpy
import numpy
from mathutils import Matrix, Vector

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)

import rooms  # noqa: E402
import tdpt  # noqa: E402
from tdpt import camera, engine, exr, gltf_file, portals, programs, scene_file  # noqa: E402

FOLDER = tempfile.mkdtemp(prefix="tdpt blender-test ö ")


def find(measure=False):
    bpy.context.scene.tdpt.quality = "draft"
    return bpy.ops.tdpt.find_portals(measure=measure)


def meshes():
    collection = portals.collection_of(bpy.context.scene)
    return sorted((o for o in collection.objects if o.type == "MESH"), key=lambda o: o.matrix_world.translation.x)


def rendered(scene, name="picture", **settings):
    """The channels of a multilayer picture, without the name of the layer."""
    scene.render.engine = settings.pop("engine", "TDPT")
    for key, value in settings.items():
        setattr(scene.tdpt, key, value)
    path = os.path.join(FOLDER, name + ".exr")
    scene.render.filepath = path
    image = scene.render.image_settings
    if hasattr(image, "media_type"):
        image.media_type = "MULTI_LAYER_IMAGE"
    image.file_format, image.color_depth, image.exr_codec = "OPEN_EXR_MULTILAYER", "32", "ZIP"
    if hasattr(image, "use_exr_interleave"):
        image.use_exr_interleave = True  # one part
    bpy.ops.render.render(write_still=True)
    with open(path, "rb") as file:
        names = [n for n, _ in exr.channels_in(exr.header(file.read())[0]["channels"])]
    return {n.split(".", 1)[1]: a for n, a in exr.read(path, set(names)).items()}


def exported(scene, *words):
    """(JSON, told) of an export in a process of its own."""
    path = os.path.join(FOLDER, "exported.glb")
    lines = programs.running(programs.blender("export.py", path, "--file=" + scene_file.save(scene, "test"), "--scene=" + scene.name, *words))
    told = []
    try:
        while True:
            told += next(lines)
            time.sleep(0.01)
    except StopIteration:
        pass
    return gltf_file.read(path)[0], "\n".join(told)


class Finding(unittest.TestCase):
    def test_doors_between_rooms(self):
        scene = rooms.three_rooms()
        self.assertEqual(find(), {"FINISHED"})
        near, far = meshes()
        self.assertLess((near.matrix_world.translation - Vector((3, 1.6, 1))).length, 0.1)
        self.assertLess((far.matrix_world.translation - Vector((6, 1.15, 1))).length, 0.1)
        for door in (near, far):
            self.assertTrue(door.hide_render)
            normal = door.matrix_world.to_3x3() @ door.data.polygons[0].normal
            self.assertLess(normal.x, -0.99)  # the way the light goes
        self.assertEqual(portals.lamps_of(scene), [])
        self.assertIn("2 portals", scene.tdpt.found)
        self.assertIn("area lamp lamp", scene.tdpt.lost)
        self.assertEqual(scene.render.engine, rooms.empty().render.engine)

    def test_a_window_is_for_cycles_where_it_pays(self):
        scene = rooms.window_room()
        self.assertEqual(find(measure=True), {"FINISHED"})
        (lamp,) = portals.lamps_of(scene)
        self.assertTrue(lamp.data.cycles.is_portal)
        gain = float(scene.tdpt.found.split("Cycles is ")[1].split()[0])
        self.assertGreater(gain, 2, scene.tdpt.found)  # 8 to 11
        # On a busy machine the interval may be too wide to tell.
        self.assertEqual(lamp.hide_render, "left off" in scene.tdpt.found)
        self.assertLess((lamp.matrix_world.translation - Vector((6.05, 1.5, 1.5))).length, 0.1)
        self.assertLess((lamp.matrix_world.to_3x3() @ Vector((0, 0, -1)) - Vector((-1, 0, 0))).length, 0.05)
        self.assertAlmostEqual(lamp.data.size, 1.4, delta=0.1)
        self.assertAlmostEqual(lamp.data.size_y, 1.2, delta=0.1)
        self.assertIn("Cycles is", scene.tdpt.found)
        self.assertIn("1 lets in the sky", scene.tdpt.found)

    def test_a_second_run_replaces_what_the_first_found(self):
        scene = rooms.three_rooms()
        find()
        mine = bpy.data.objects.new("mine", meshes()[0].data.copy())
        portals.collection_of(scene).objects.link(mine)
        before = len(bpy.data.meshes)
        began = time.time()
        find()
        self.assertLess(time.time() - began, 20)
        self.assertEqual(len(meshes()), 3)
        self.assertIn(mine, meshes())
        self.assertEqual(len(bpy.data.meshes), before)

    def test_it_can_be_undone(self):
        rooms.three_rooms()
        bpy.ops.ed.undo_push(message="rooms")
        find()
        bpy.ops.ed.undo_push(message="portals")
        self.assertIsNotNone(portals.collection_of(bpy.context.scene))
        bpy.ops.ed.undo()
        self.assertIsNone(portals.collection_of(bpy.context.scene))

    def test_names_with_blanks_and_umlauts(self):
        scene = rooms.three_rooms()
        scene.name = "Küche: \"neu\" 1"
        for thing in scene.objects:
            thing.name = "Möbel & " + thing.name
        folder = os.path.join(FOLDER, "Räume mit Leerzeichen")
        os.makedirs(folder, exist_ok=True)
        bpy.ops.wm.save_as_mainfile(filepath=os.path.join(folder, "Haus ß.blend"))
        self.assertEqual(find(), {"FINISHED"})
        self.assertEqual(len(meshes()), 2)

    def test_a_scene_in_centimetres(self):
        scene = rooms.three_rooms()
        scene.unit_settings.scale_length = 0.01
        for thing in scene.objects:
            thing.matrix_world = Matrix.Scale(100, 4) @ thing.matrix_world
        scene.camera.data.clip_end = 10000
        bpy.context.view_layer.update()
        find()
        near, far = meshes()
        self.assertLess((near.matrix_world.translation - Vector((300, 160, 100))).length, 10)
        self.assertLess((far.matrix_world.translation - Vector((600, 115, 100))).length, 10)

    def test_without_programs(self):
        rooms.three_rooms()
        kept, programs.folders = programs.folders, lambda: ()
        try:
            with self.assertRaises(RuntimeError) as caught:
                find()
        finally:
            programs.folders = kept
        self.assertIn("The tdpt programs are missing: install them", str(caught.exception))

    def test_without_a_camera(self):
        scene = rooms.three_rooms()
        scene.camera.data.type = "ORTHO"
        with self.assertRaises(RuntimeError) as caught:
            find()
        self.assertIn("Camera camera is ortho: tdpt renders perspective cameras alone", str(caught.exception))


class Using(unittest.TestCase):
    def setUp(self):
        self.scene = rooms.three_rooms()
        square = [(0, 0, 0), (0, 1, 0), (0, 1, 2), (0, 0, 2)]
        portals.place(self.scene, [(f"portal.{i}", [(x + 3 * i, z, -y) for x, y, z in square], [(0, 1, 2), (0, 2, 3)], {"sky": 0.0})
                                   for i in (1, 2)])
        bpy.context.view_layer.update()
        self.path = os.path.join(FOLDER, "used.glb")

    def test_portals_are_used_as_they_stand(self):
        meshes()[0].location.y += 0.5
        meshes()[1].hide_set(True)
        bpy.context.view_layer.update()
        self.assertEqual(portals.write_used(self.scene, self.path), 1)
        (name, corners, triangles, _), = gltf_file.read_portals(self.path)
        self.assertEqual((name, len(triangles)), ("portal.1", 2))
        low = [min(c[i] for c in corners) for i in range(3)]
        self.assertLess(numpy.abs(numpy.array(low) - (3, 0, -1.5)).max(), 1e-6)

    def test_mirrored_portals_keep_their_front(self):
        first = meshes()[0]
        first.scale.y = -1
        meshes()[1].hide_viewport = True
        bpy.context.view_layer.update()
        portals.write_used(self.scene, self.path)
        (_, corners, triangles, _), = gltf_file.read_portals(self.path)
        a, b, c = (Vector(corners[i]) for i in triangles[0])
        front = first.data.polygons[0].normal  # along x, which is not mirrored
        self.assertGreater((b - a).cross(c - a).normalized().dot(Vector((front.x, front.z, -front.y))), 0.99)

    def test_none(self):
        bpy.context.view_layer.layer_collection.children[portals.NAME].hide_viewport = True  # the eye
        bpy.context.view_layer.update()
        self.assertEqual(portals.write_used(self.scene, self.path), 0)
        self.assertFalse(os.path.exists(self.path))

    def test_tdpt_reads_them(self):
        portals.write_used(self.scene, self.path)
        told = subprocess.run([programs.program("tdpt-info"), self.path], capture_output=True, text=True, check=True).stdout
        self.assertIn("portals", told.splitlines()[0])
        self.assertIn('"name":"portal.2"', told)


class Rendering(unittest.TestCase):
    def test_passes(self):
        scene = rooms.three_rooms()
        layer = bpy.context.view_layer
        layer.use_pass_z = layer.use_pass_normal = True
        picture = rendered(scene, samples=4, denoise=True)
        self.assertEqual(picture["Combined.R"].shape, (64, 96))
        self.assertGreater(picture["Combined.G"].mean(), 1e-3)
        self.assertGreater(numpy.abs(picture["Combined.G"] - picture["Noisy Image.G"]).max(), 0)
        self.assertAlmostEqual(picture["Noisy Image.G"].mean() / picture["Combined.G"].mean(), 1, delta=0.3)
        self.assertAlmostEqual(picture["Denoising Albedo.R"].mean(), 0.7, delta=0.02)
        length = numpy.sqrt(sum(picture[f"Normal.{c}"] ** 2 for c in "XYZ"))
        self.assertAlmostEqual(numpy.median(length), 1, delta=1e-3)
        self.assertGreater(picture["Normal.Z"][-1].mean(), 0.8)  # of the floor, below

    def test_the_camera_is_blender_s(self):
        """Depths beside those of Cycles: lens, sensor, shift, turned picture, percentage, region."""
        scene = rooms.three_rooms()
        layer = bpy.context.view_layer
        layer.use_pass_z = True
        scene.cycles.samples = 1
        scene.cycles.use_denoising = False
        data, render = scene.camera.data, scene.render
        for case, change in {
            "shift": lambda: (setattr(data, "shift_x", 0.17), setattr(data, "shift_y", -0.1)),
            "tall": lambda: (setattr(render, "resolution_x", 50), setattr(data, "sensor_fit", "HORIZONTAL")),
            "half": lambda: (setattr(render, "resolution_percentage", 50), setattr(data, "sensor_width", 20)),
            "region": lambda: (setattr(render, "use_border", True), setattr(render, "use_crop_to_border", True),
                               setattr(render, "border_min_x", 0.25), setattr(render, "border_max_y", 0.7)),
        }.items():
            change()
            ours = rendered(scene, samples=1, denoise=False)["Depth.Z"]
            theirs = rendered(scene, engine="CYCLES")["Depth.Z"]
            self.assertEqual(ours.shape, theirs.shape, case)
            off = numpy.abs(ours / theirs - 1)
            self.assertLess(numpy.median(off), 0.01, case)
            # Twin: a picture that is one pixel off.
            self.assertGreater(numpy.median(numpy.abs(numpy.roll(ours, 2, 1) / theirs - 1)), 2 * numpy.median(off), case)

    def test_depth_of_field(self):
        scene = rooms.three_rooms()
        data = scene.camera.data
        data.dof.use_dof, data.dof.aperture_fstop, data.lens, data.sensor_width = True, 2.0, 50, 18
        focus = bpy.data.objects.new("focus", None)
        focus.location = scene.camera.matrix_world @ Vector((0.5, 0, -3))
        scene.collection.objects.link(focus)
        data.dof.focus_object = focus
        bpy.context.view_layer.update()
        words = camera.Film(scene, scene.camera).lens()
        f_stop, distance = (float(w.split("=")[1]) for w in words)
        self.assertAlmostEqual(f_stop, 4, places=4)  # half the film: half the focal length there
        self.assertAlmostEqual(distance, 3, places=4)

    def test_an_animation(self):
        """A door that closes: the frames differ, by what Blender says."""
        scene = rooms.three_rooms()
        lamp = next(o for o in scene.objects if o.type == "LIGHT")
        lamp.data.energy = 100
        lamp.data.keyframe_insert("energy", frame=1)
        lamp.data.energy = 400
        lamp.data.keyframe_insert("energy", frame=2)
        means = []
        for frame in (1, 2):
            scene.frame_set(frame)
            means.append(rendered(scene, samples=4, denoise=False, animate_seed=False)["Combined.R"].mean())
        self.assertAlmostEqual(means[1] / means[0], 4, delta=0.2)

    def test_transparent_film(self):
        scene = rooms.window_room()
        scene.camera.location = (-4, -1.5, 3)
        bpy.context.view_layer.update()
        scene.render.film_transparent = True
        alpha = rendered(scene, samples=1, denoise=False)["Combined.A"]
        self.assertEqual((alpha.min(), alpha.max()), (0, 1))

    @unittest.skipUnless(bpy.app.version < (5, 0), "scenes of Blender 5 have no tree of their own")
    def test_the_compositor(self):
        """An exposure of one stop, by nodes: twice as bright."""
        means = []
        for nodes in (False, True):
            scene = rooms.three_rooms()
            scene.view_settings.view_transform = "Raw"
            scene.render.engine, scene.tdpt.samples, scene.tdpt.denoise = "TDPT", 4, False
            if nodes:
                scene.use_nodes = True
                tree = scene.node_tree
                tree.nodes.clear()
                layers, exposure, out = (tree.nodes.new("CompositorNode" + n) for n in ("RLayers", "Exposure", "Composite"))
                exposure.inputs["Exposure"].default_value = 1
                tree.links.new(layers.outputs["Image"], exposure.inputs["Image"])
                tree.links.new(exposure.outputs["Image"], out.inputs["Image"])
            path = os.path.join(FOLDER, "composite.exr")
            scene.render.filepath = path
            scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
            bpy.ops.render.render(write_still=True)
            means.append(exr.read(path, {"G"})["G"].mean())
        self.assertAlmostEqual(means[1] / means[0], 2, delta=1e-3)

    def test_closing_stops_all_programs(self):
        scene = rooms.three_rooms()
        exported(scene)
        path, out = os.path.join(FOLDER, "exported.glb"), os.path.join(FOLDER, "long.exr")
        words = [programs.program(), path, "-o", out, "--force", "--spp", "100000", "--set", "progress=json"]
        lines = programs.running(words, accepted=(0, 6))
        began = time.time()
        while time.time() - began < 60:
            if "rendering" in programs.last_progress(next(lines), (0, ""))[1]:
                break
            time.sleep(0.02)
        lines.close()
        left = subprocess.run(["pgrep", "-f", out], capture_output=True, text=True).stdout.split()
        self.assertEqual(left, [])

    def test_an_error_is_said(self):
        scene = rooms.three_rooms()
        scene.tdpt.device = "CPU"
        kept, engine.CHECKPOINT = engine.CHECKPOINT, "soon"
        try:
            with self.assertRaises(RuntimeError) as caught:
                rendered(scene, samples=1)
        finally:
            engine.CHECKPOINT = kept
        self.assertIn("checkpoint-every", str(caught.exception))


class Exporting(unittest.TestCase):
    def test_a_pane_stays_thin_beside_a_table_of_its_glass(self):
        scene = rooms.three_rooms()
        glass = bpy.data.materials.new("glass")
        glass.use_nodes = True
        shader = next(n for n in glass.node_tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")
        shader.inputs["Transmission Weight" if "Transmission Weight" in shader.inputs else "Transmission"].default_value = 1
        rooms.box("table", (1, 1, 0.7), (2, 2, 0.8), glass)
        rooms.box("pane", (0.2, 1, 1), (0.2001, 2, 2), glass)
        rooms.box("bowl", (1.2, 1.2, 0.8), (1.4, 1.4, 1.0), glass, holes=("+z",))
        document, told = exported(scene)
        solid = {m["name"] for m in document["materials"] if "KHR_materials_volume" in m.get("extensions", {})}
        thin = {m["name"] for m in document["materials"] if "KHR_materials_transmission" in m.get("extensions", {})} - solid
        self.assertEqual((solid, thin), ({"glass solid"}, {"glass"}))
        of = {n["name"]: document["meshes"][n["mesh"]]["primitives"][0]["material"] for n in document["nodes"] if "mesh" in n}
        self.assertEqual(document["materials"][of["table"]]["name"], "glass solid")
        self.assertEqual(document["materials"][of["pane"]]["name"], "glass")
        self.assertIn("object bowl: its glass is not closed, so it is taken as thin", told)
        self.assertNotIn("object pane", told)

    def test_what_is_rendered_counts(self):
        """Not what the viewport shows: levels, switches; nested instances; lamps in collections that are not rendered."""
        scene = rooms.three_rooms()
        ball = rooms.box("ball", (1, 1, 1), (2, 2, 2), rooms.diffuse("red"))
        modifier = ball.modifiers.new("fine", "SUBSURF")
        modifier.levels, modifier.render_levels = 0, 2
        ball.hide_viewport = True
        dark = bpy.data.collections.new("dark")
        dark.hide_render = True
        scene.collection.children.link(dark)
        lamp = next(o for o in scene.objects if o.type == "LIGHT")
        scene.collection.objects.unlink(lamp)
        dark.objects.link(lamp)
        inner, outer = bpy.data.collections.new("inner"), bpy.data.collections.new("outer")
        rooms.box("deep", (0, 0, 0), (1, 1, 1), rooms.diffuse("deep"), inner)
        for collection, parent in ((inner, outer), (outer, scene.collection)):
            empty = bpy.data.objects.new("of " + collection.name, None)
            empty.instance_type, empty.instance_collection = "COLLECTION", collection
            parent.objects.link(empty)
        document, told = exported(scene)
        mesh = document["meshes"][next(n["mesh"] for n in document["nodes"] if n["name"] == "ball")]
        self.assertEqual(document["accessors"][mesh["primitives"][0]["indices"]]["count"], 6 * 16 * 2 * 3)
        deep = next(m for m in document["materials"] if m["name"] == "deep")
        self.assertEqual(deep["extensions"]["KHR_materials_specular"]["specularFactor"], 0)
        self.assertNotIn("area lamp", told)

    def test_nodes_of_lamps(self):
        scene = rooms.lamps_room()
        before, _ = exported(scene)
        point = next(o.data for o in scene.objects if o.name == "point")
        point.use_nodes = True
        emission = next(n for n in point.node_tree.nodes if n.bl_idname == "ShaderNodeEmission")
        emission.inputs["Strength"].default_value = 5
        emission.inputs["Color"].default_value = (1, 0.5, 0.25, 1)
        after, told = exported(scene)
        lights = [{l["name"]: l for l in d["extensions"]["KHR_lights_punctual"]["lights"]} for d in (before, after)]
        self.assertAlmostEqual(lights[1]["point"]["intensity"] / lights[0]["point"]["intensity"], 5, places=4)
        self.assertAlmostEqual(lights[1]["point"]["color"][1], 0.5, places=4)
        self.assertNotIn("nodes are lost", told)

    def test_seams_do_not_open_a_body(self):
        scene = rooms.three_rooms()
        glass = rooms.diffuse("glass")
        tree = glass.node_tree
        tree.links.new(tree.nodes.new("ShaderNodeBsdfGlass").outputs[0], tree.get_output_node("ALL").inputs["Surface"])
        block = rooms.box("block", (1, 1, 0.7), (2, 2, 1.2), glass)
        corners = [tuple(block.data.vertices[i].co) for face in block.data.polygons for i in face.vertices]
        mesh = bpy.data.meshes.new("split")
        mesh.from_pydata(corners, [], [tuple(range(4 * i, 4 * i + 4)) for i in range(6)])
        mesh.materials.append(glass)
        block.data = mesh
        document, told = exported(scene)
        self.assertIn("KHR_materials_volume", next(m for m in document["materials"] if m["name"] == "glass solid")["extensions"])
        self.assertNotIn("not closed", told)

    def test_simple_shaders(self):
        scene = rooms.three_rooms()
        for kind in ("Glossy", "Glass"):
            material = rooms.diffuse(kind)
            tree = material.node_tree
            shader = tree.nodes.new(f"ShaderNodeBsdf{kind}")
            shader.inputs["Roughness"].default_value = 0.25
            tree.links.new(shader.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
            rooms.box(kind, (1, 1, 0), (2, 2, 1), material)
        toon = rooms.diffuse("toon")
        tree = toon.node_tree
        tree.links.new(tree.nodes.new("ShaderNodeBsdfToon").outputs[0], tree.get_output_node("ALL").inputs["Surface"])
        rooms.box("toon", (1, 1, 0), (2, 2, 1), toon)
        document, told = exported(scene)
        of = {m["name"]: m for m in document["materials"]}
        self.assertEqual(of["grey"]["extensions"]["KHR_materials_specular"]["specularFactor"], 0)
        self.assertAlmostEqual(of["grey"]["pbrMetallicRoughness"]["baseColorFactor"][0], 0.7, places=5)
        self.assertEqual(of["Glossy"]["pbrMetallicRoughness"].get("metallicFactor", 1), 1)
        self.assertAlmostEqual(of["Glossy"]["pbrMetallicRoughness"]["roughnessFactor"], 0.25, places=5)
        self.assertEqual(of["Glass solid"]["extensions"]["KHR_materials_transmission"]["transmissionFactor"], 1)
        self.assertIn("light: material toon: its Toon BSDF is not read; it is taken as diffuse", told)

    def test_instances_and_modifiers(self):
        scene = rooms.lamps_room()
        document, told = exported(scene)
        names = [n["name"] for n in document["nodes"]]
        self.assertEqual(sum(n.startswith("chair") for n in names), 2)
        self.assertEqual(sum(n.startswith("base ") for n in names), 8)
        post = document["meshes"][next(n["mesh"] for n in document["nodes"] if n["name"] == "post")]
        self.assertEqual(document["accessors"][post["primitives"][0]["indices"]]["count"], 3 * 6 * 2 * 3)
        self.assertIn("object base: 8 instances became objects", told)

    def test_area_lamps(self):
        """Squares, rectangles and disks are lights; what the extension has no words for is a plane. tdpt reads both alike."""
        scene = rooms.three_rooms()
        lamp = next(o for o in scene.objects if o.type == "LIGHT")
        means = {}
        for shape, scale in (("RECTANGLE", (2, 2, 2)), ("RECTANGLE", (2, 2, 1)), ("DISK", (1, 1, 1)), ("ELLIPSE", (1, 1, 1))):
            lamp.data.shape, lamp.scale = shape, scale
            lamp.data.size_y = 0.8 if shape == "RECTANGLE" else lamp.data.size
            bpy.context.view_layer.update()
            document, told = exported(scene)
            lights = document.get("extensions", {}).get("EXT_lights_area", {}).get("lights", [])
            self.assertEqual(len(lights), int(shape == "DISK" or scale == (2, 2, 2)))
            self.assertEqual(told.count("area lamp"), 1)
            path = os.path.join(FOLDER, "exported.glb")
            words = [programs.program("tdpt-render"), path, "-o", path + ".exr", "--spp", "256", "--width", "32", "--quiet",
                     "--integrator", "nee", "--max-depth", "3", "--look-from=8.9,1.2,-2.9", "--look-at=7.5,0,-1.5"]
            subprocess.run(words, check=True, capture_output=True)
            means[shape, scale] = exr.read(path + ".exr", {"G"})["G"].mean()
        self.assertAlmostEqual(means["RECTANGLE", (2, 2, 2)] / means["RECTANGLE", (2, 2, 1)], 1, delta=0.01)
        self.assertAlmostEqual(means["DISK", (1, 1, 1)] / means["ELLIPSE", (1, 1, 1)], 1, delta=0.01)
        self.assertGreater(means["DISK", (1, 1, 1)], 0)

    def test_lamps_with_exposure_temperature_and_angle(self):
        scene = rooms.lamps_room()
        of = {o.name: o.data for o in scene.objects if o.type == "LIGHT"}
        before, _ = exported(scene)
        if hasattr(of["point"], "exposure"):
            of["point"].exposure = 1
        else:
            of["point"].energy *= 2
        of["point"].shadow_soft_size = 0.1
        of["sun"].angle = 0.1
        after, told = exported(scene)
        strength = [{l["name"]: l["intensity"] for l in d["extensions"]["KHR_lights_punctual"]["lights"]} for d in (before, after)]
        self.assertAlmostEqual(strength[1]["point"] / strength[0]["point"], 2, places=4)
        self.assertEqual(strength[1]["spot"], strength[0]["spot"])
        self.assertIn("lamp point: its radius is lost", told)
        self.assertEqual([w.split("=")[0] for w in camera.sun(scene)], ["--sun-angle"])
        self.assertAlmostEqual(float(camera.sun(scene)[0].split("=")[1]), 5.7296, places=3)

    def test_what_cycles_has_as_portals_is_no_light(self):
        scene = rooms.three_rooms()
        for thing in scene.objects:
            if thing.type == "LIGHT":
                thing.data.cycles.is_portal = True
        document, told = exported(scene)
        self.assertFalse(any("emissiveFactor" in m for m in document["materials"]))
        self.assertNotIn("EXT_lights_area", document.get("extensionsUsed", []))
        self.assertNotIn("area lamp", told)

    def test_a_world_of_nodes_is_baked(self):
        """The same sky as a picture, and by way of a node that changes nothing: pictures of the room are alike."""
        means = []
        for baked in (False, True):
            scene = rooms.window_room()
            tree = scene.world.node_tree
            picture = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeTexEnvironment")
            if baked:
                gamma = tree.nodes.new("ShaderNodeGamma")
                background = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeBackground")
                tree.links.new(picture.outputs["Color"], gamma.inputs["Color"])
                tree.links.new(gamma.outputs["Color"], background.inputs["Color"])
            document, told = exported(scene)
            self.assertEqual("are baked" in told, baked)
            self.assertIn("tdpt_environment", document["scenes"][0]["extras"])
            pixels = rendered(scene, samples=16, denoise=False)
            means.append([pixels[f"Combined.{c}"].mean() for c in "RGB"])
        ratio = numpy.array(means[1]) / means[0]
        self.assertLess(numpy.abs(ratio - 1).max(), 0.03)
        self.assertGreater(means[0][2] / means[0][0], 1.5)  # a sky that is turned has another colour


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
            self.assertIn(f"note: material {name}: ", told)
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
            "shiny": lambda t: mixed(t, 0.1, node(t, "BsdfDiffuse", Color=grey), node(t, "BsdfGlossy", Color=grey, Roughness=0.3)),
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
        numbers([of["shiny"]["metallicFactor"], of["shiny"]["roughnessFactor"]], [0.1, 0.3], rtol=1e-5)
        numbers([of["curtain"]["KHR_materials_transmission"]["transmissionFactor"], of["gauze"]["baseColorFactor"][3]], [0.4, 0.25], rtol=1e-5)
        self.assertEqual([of[name].get("alphaMode", "OPAQUE") for name in ("gauze", "leaf", "glow")], ["BLEND", "BLEND", "OPAQUE"])
        self.assertEqual([of[n]["KHR_materials_emissive_strength"]["emissiveStrength"] for n in ("glow", "lit")], [3, 2])
        numbers(of["glow"]["baseColorFactor"][:3], grey[:3], rtol=1e-5)
        numbers(of["lit"]["baseColorFactor"][:3], (0, 0, 0))
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
        document, told = exported(scene)
        for sentence in (
            "light: lamp disc: its spread of 40 degrees is lost", "look: lamp point: its radius is lost", "light: lamp point: it casts no shadows",
            "light: object north: casts no shadow", "light: object west: is invisible to diffuse rays", "look: object south: is a holdout",
            "look: material bumpy: its Bump is lost", "light: material stained: Base Color hangs on Color Ramp, Noise Texture",
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
        engine.Told.lines = []
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            engine.TdptEngine.tell(teller, ["light: material a: b", "look: lamp c: d", "note: e"])
            engine.TdptEngine.tell(teller, ["note: f"])
        self.assertEqual(printed.getvalue().splitlines(), ["tdpt: light: material a: b", "tdpt: look: lamp c: d", "tdpt: note: e", "tdpt: note: f"])
        self.assertEqual(len(warned), 1)
        self.assertEqual(warned[0][0], {"WARNING"})
        self.assertTrue(warned[0][1].startswith("material a: b, and 1 more"), warned)
        self.assertEqual(len(engine.Told.lines), 4)

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
        lines = ["tdpt-render: warning: no sample found light", "portalfit: 1 portal", '{"progress":{"step":1}}', ""]
        self.assertEqual(programs.told_by(lines), ["light: no sample found light", "note: portalfit: 1 portal"])

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
        self.assertTrue(any(line.startswith("light: ") for line in engine.Told.lines), engine.Told.lines)


class Files(unittest.TestCase):
    def test_pictures_are_read_as_blender_reads_them(self):
        scene = rooms.three_rooms()
        exported(scene)
        for compression in ("zip", "none"):
            path = os.path.join(FOLDER, "read.exr")
            words = [programs.program("tdpt-render"), os.path.join(FOLDER, "exported.glb"), "-o", path, "--spp", "1", "--width", "37",
                     "--quiet", "--integrator", "pt"]
            subprocess.run(words, check=True, capture_output=True)
            mine = exr.read(path, {"R", "G", "B"})
            image = bpy.data.images.load(path)
            pixels = numpy.array(image.pixels[:]).reshape(image.size[1], image.size[0], 4)[::-1]
            bpy.data.images.remove(image)
            for c, name in enumerate("RGB"):
                numpy.testing.assert_array_equal(mine[name], pixels[..., c].astype(numpy.float32))

    def test_other_files_are_refused(self):
        path = os.path.join(FOLDER, "no.exr")
        for data in (b"", b"hello", b"\x76\x2f\x31\x01"):
            with open(path, "wb") as file:
                file.write(data)
            with self.assertRaises(ValueError):
                exr.read(path, {"R"})

    def test_progress(self):
        line = json.dumps({"progress": {"what": "rendering", "title": "rendering", "step": 5, "steps": 5, "done": 1, "total": 4, "left": 8.2}})
        self.assertEqual(programs.progress_of(line), (0.85, "rendering, 8 s left"))
        for other in ("", "tdpt: a note", "{", '{"integrator": "pt"}'):
            self.assertIsNone(programs.progress_of(other))


def main():
    words = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else [] if bpy.app.binary_path else sys.argv[1:]
    if os.environ.get("TDPT_BIN"):
        os.environ["PATH"] = os.environ["TDPT_BIN"] + os.pathsep + os.environ["PATH"]
    os.environ["XDG_CACHE_HOME"] = os.path.join(FOLDER, "cache")
    tdpt.register()
    loader = unittest.TestLoader()
    suite = loader.loadTestsFromNames(words, sys.modules[__name__]) if words else loader.loadTestsFromModule(sys.modules[__name__])
    result = unittest.TextTestRunner(verbosity=2).run(suite)
    shutil.rmtree(FOLDER, ignore_errors=True)
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0 if result.wasSuccessful() else 1)  # Blender as a module may crash when Python ends


if __name__ == "__main__":
    main()
