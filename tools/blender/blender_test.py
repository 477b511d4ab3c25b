"""Tests of the extension, in a Blender without a window: blender -b --factory-startup -P blender_test.py [-- TEST ...], or by a
Python that has the module bpy. TDPT_BIN: the folder of the programs."""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
from unittest import mock

import bpy
import numpy
from mathutils import Matrix, Vector

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "testing")]

import rooms  # noqa: E402
import tdpt  # noqa: E402
from tdpt import camera, engine, exr, gltf_file, portals, programs  # noqa: E402

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
    saved = programs.save(scene, "test")
    lines = programs.wait(programs.running(programs.blender("export.py", path, "--file=" + saved, "--scene=" + scene.name, *words)))
    return gltf_file.read(path)[0], "\n".join(lines)


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

    def test_a_scene_in_centimetres_of_names_with_blanks_and_umlauts(self):
        scene = rooms.three_rooms()
        scene.name = "Küche: \"neu\" 1"
        for thing in scene.objects:
            thing.name = "Möbel & " + thing.name
        folder = os.path.join(FOLDER, "Räume mit Leerzeichen")
        os.makedirs(folder, exist_ok=True)
        bpy.ops.wm.save_as_mainfile(filepath=os.path.join(folder, "Haus ß.blend"))
        scene.unit_settings.scale_length = 0.01
        for thing in scene.objects:
            thing.matrix_world = Matrix.Scale(100, 4) @ thing.matrix_world
        scene.camera.data.clip_end = 10000
        bpy.context.view_layer.update()
        find()
        near, far = meshes()
        self.assertLess((near.matrix_world.translation - Vector((300, 160, 100))).length, 10)
        self.assertLess((far.matrix_world.translation - Vector((600, 115, 100))).length, 10)

    def test_what_cannot_be_done_is_said(self):
        scene = rooms.three_rooms()
        with mock.patch.object(programs, "folders", lambda: ()):
            self.assertRaisesRegex(RuntimeError, "The tdpt programs are missing: install them", find)
        scene.camera.data.type = "ORTHO"
        self.assertRaisesRegex(RuntimeError, "Camera camera is ortho: tdpt renders perspective cameras alone", find)


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
        self.assertIn("portal.2: area_m2 2", told)


class Rendering(unittest.TestCase):
    def test_passes(self):
        scene = rooms.three_rooms()
        layer = bpy.context.view_layer
        layer.use_pass_z = layer.use_pass_normal = True
        picture = rendered(scene, samples=4, denoise=True, denoiser="regression")
        self.assertEqual(picture["Combined.R"].shape, (64, 96))
        self.assertGreater(picture["Combined.G"].mean(), 1e-3)
        self.assertGreater(numpy.abs(picture["Combined.G"] - picture["Noisy Image.G"]).max(), 0)
        self.assertAlmostEqual(picture["Noisy Image.G"].mean() / picture["Combined.G"].mean(), 1, delta=0.3)
        self.assertAlmostEqual(picture["Denoising Albedo.R"].mean(), 0.7, delta=0.02)
        length = numpy.sqrt(sum(picture[f"Normal.{c}"] ** 2 for c in "XYZ"))
        self.assertAlmostEqual(numpy.median(length), 1, delta=1e-3)
        self.assertGreater(picture["Normal.Z"][-1].mean(), 0.8)  # of the floor, below

    def test_the_denoiser_is_named_where_it_is_chosen(self):
        scene = rooms.three_rooms()
        for denoise, denoiser, named in ((True, "auto", ["--denoise"]), (True, "oidn", ["--denoiser=oidn"]), (False, "oidn", [])):
            scene.tdpt.denoise, scene.tdpt.denoiser = denoise, denoiser
            words = engine.options_of(scene.tdpt, scene, camera.Film(scene, scene.camera), "")
            self.assertEqual([word for word in words if word.startswith("--denoise")], named)

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
        steps = programs.running(words, accepted=(0, 6))
        began = time.time()
        while time.time() - began < 60:
            if "rendering" in next(steps)[1]:
                break
            time.sleep(0.02)
        steps.close()
        left = subprocess.run(["pgrep", "-f", out], capture_output=True, text=True).stdout.split()
        self.assertEqual(left, [])

    def test_an_error_is_said(self):
        scene = rooms.three_rooms()
        scene.tdpt.device = "CPU"
        with mock.patch.object(engine, "CHECKPOINT", "soon"):
            self.assertRaisesRegex(RuntimeError, "checkpoint-every", lambda: rendered(scene, samples=1))


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
        # Seams do not open a body: each face has corners of its own.
        block = rooms.box("block", (1, 1, 0.9), (2, 2, 1.2), glass)
        mesh = bpy.data.meshes.new("split")
        mesh.from_pydata([tuple(block.data.vertices[i].co) for face in block.data.polygons for i in face.vertices], [],
                         [tuple(range(4 * i, 4 * i + 4)) for i in range(6)])
        mesh.materials.append(glass)
        block.data = mesh
        document, told = exported(scene)
        solid = {m["name"] for m in document["materials"] if "KHR_materials_volume" in m.get("extensions", {})}
        thin = {m["name"] for m in document["materials"] if "KHR_materials_transmission" in m.get("extensions", {})} - solid
        self.assertEqual((solid, thin), ({"glass solid"}, {"glass"}))
        of = {n["name"]: document["meshes"][n["mesh"]]["primitives"][0]["material"] for n in document["nodes"] if "mesh" in n}
        self.assertEqual({document["materials"][of[name]]["name"] for name in ("table", "block")}, {"glass solid"})
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

    def test_instances_and_modifiers(self):
        scene = rooms.lamps_room()
        document, told = exported(scene)
        names = [n["name"] for n in document["nodes"]]
        self.assertEqual(sum(n.startswith("chair") for n in names), 2)
        self.assertEqual(sum(n.startswith("base ") for n in names), 8)
        post = document["meshes"][next(n["mesh"] for n in document["nodes"] if n["name"] == "post")]
        self.assertEqual(document["accessors"][post["primitives"][0]["indices"]]["count"], 3 * 6 * 2 * 3)
        self.assertIn("object base: 8 instances became objects", told)

    def test_particles(self):
        """Of an object that is rendered itself or not, on a ground that is not."""
        scene = rooms.three_rooms()
        for hidden in (True, False):
            blade = rooms.box(f"blade {hidden}", (0, 0, 0), (0.1, 0.1, 0.4), rooms.diffuse("green"))
            ground = rooms.box(f"ground {hidden}", (1, 1, 0), (2, 2, 0.1), rooms.diffuse("brown"))
            ground.modifiers.new("grass", "PARTICLE_SYSTEM")
            grass = ground.particle_systems[0].settings
            grass.type, grass.count, grass.render_type, grass.instance_object = "HAIR", 7, "OBJECT", blade
            blade.hide_render, ground.show_instancer_for_render = hidden, not hidden
        bpy.context.view_layer.update()
        document, told = exported(scene)
        names = [n["name"] for n in document["nodes"]]
        self.assertEqual([sum(n.startswith(f"ground {h} ") for n in names) for h in (True, False)], [7, 7])
        self.assertEqual([n for n in ("blade True", "blade False", "ground True", "ground False") if n in names], ["blade False", "ground False"])
        self.assertIn("object ground True: 7 instances became objects", told)

    def test_area_lamps(self):
        """Squares, rectangles and disks, stretched or not, are lights; an ellipse is a disk."""
        scene = rooms.three_rooms()
        lamp = next(o for o in scene.objects if o.type == "LIGHT")
        lamp.hide_set(True)  # the eye, which pictures do not know
        means = {}
        for shape, scale in (("RECTANGLE", (2, 2, 2)), ("RECTANGLE", (2, 2, 1)), ("DISK", (1, 1, 1)), ("ELLIPSE", (1, 1, 1))):
            lamp.data.shape, lamp.scale = shape, scale
            lamp.data.size_y = 0.8 if shape == "RECTANGLE" else lamp.data.size
            bpy.context.view_layer.update()
            document, told = exported(scene)
            lights = document.get("extensions", {}).get("EXT_lights_area", {}).get("lights", [])
            self.assertEqual(len(lights), 1)
            self.assertEqual(told.count("area lamp"), 1)
            path = os.path.join(FOLDER, "exported.glb")
            words = [programs.program("tdpt-render"), path, "-o", path + ".exr", "--spp", "256", "--width", "32", "--quiet",
                     "--integrator", "nee", "--max-depth", "3", "--look-from=8.9,1.2,-2.9", "--look-at=7.5,0,-1.5"]
            subprocess.run(words, check=True, capture_output=True)
            means[shape, scale] = exr.read(path + ".exr", {"G"})["G"].mean()
        self.assertAlmostEqual(means["RECTANGLE", (2, 2, 2)] / means["RECTANGLE", (2, 2, 1)], 1, delta=0.01)
        self.assertAlmostEqual(means["DISK", (1, 1, 1)] / means["ELLIPSE", (1, 1, 1)], 1, delta=0.01)
        self.assertGreater(means["DISK", (1, 1, 1)], 0)

    def test_instanced_lamps(self):
        """Area lamps and smooth spots of a collection that stands twice."""
        scene = rooms.three_rooms()
        fixture = bpy.data.collections.new("fixture")
        for thing in (next(o for o in scene.objects if o.type == "LIGHT"), rooms.lamp(scene, "SPOT", (0, 0, 2), 10, "spot", spot_blend=0.5)):
            scene.collection.objects.unlink(thing)
            fixture.objects.link(thing)
        for x in (0.5, 1.5):
            empty = bpy.data.objects.new("stand", None)
            empty.instance_type, empty.instance_collection, empty.location = "COLLECTION", fixture, (x, 0, 0)
            scene.collection.objects.link(empty)
        document, _ = exported(scene)
        self.assertEqual([len(document["extensions"][name]["lights"]) for name in ("EXT_lights_area", "EXT_lights_ies")], [2, 2])
        places = sorted(n["matrix"][12] for n in document["nodes"] if "EXT_lights_area" in n.get("extensions", {}))
        self.assertEqual([round(x, 4) for x in places], [8.0, 9.0])

    def test_lamps_with_exposure_angle_and_nodes(self):
        scene = rooms.lamps_room()
        of = {o.name: o.data for o in scene.objects if o.type == "LIGHT"}
        before, _ = exported(scene)
        if hasattr(of["point"], "exposure"):
            of["point"].exposure = 1
        else:
            of["point"].energy *= 2
        of["point"].shadow_soft_size = 0.1
        of["point"].use_nodes = True
        emission = next(n for n in of["point"].node_tree.nodes if n.bl_idname == "ShaderNodeEmission")
        emission.inputs["Strength"].default_value = 5
        emission.inputs["Color"].default_value = (1, 0.5, 0.25, 1)
        of["sun"].angle = 0.1
        after, told = exported(scene)
        lights = [{l["name"]: l for l in d["extensions"]["KHR_lights_punctual"]["lights"]} for d in (before, after)]
        self.assertAlmostEqual(lights[1]["point"]["intensity"] / lights[0]["point"]["intensity"], 10, places=4)
        self.assertAlmostEqual(lights[1]["point"]["color"][1], 0.5, places=4)
        self.assertNotIn("nodes are lost", told)
        self.assertEqual(lights[1]["spot"]["intensity"], lights[0]["spot"]["intensity"])
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


def main(module=None):
    """Runs the tests of a module, this one by default, or those that are named."""
    module = module or sys.modules[__name__]
    words = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else [] if bpy.app.binary_path else sys.argv[1:]
    if os.environ.get("TDPT_BIN"):
        os.environ["PATH"] = os.environ["TDPT_BIN"] + os.pathsep + os.environ["PATH"]
    os.environ["XDG_CACHE_HOME"] = os.path.join(FOLDER, "cache")
    tdpt.register()
    loader = unittest.TestLoader()
    suite = loader.loadTestsFromNames(words, module) if words else loader.loadTestsFromModule(module)
    result = unittest.TextTestRunner(verbosity=2).run(suite)
    shutil.rmtree(FOLDER, ignore_errors=True)
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0 if result.wasSuccessful() else 1)  # Blender as a module may crash when Python ends


if __name__ == "__main__":
    main()
