"""What runs inside Blender; doc/cycles.md tells what is set, and why Blender's own reading of a file is not enough.
  blender -b --factory-startup --python-exit-code 1 --python cycles_blender.py -- render SCENE.glb OUT-%d.exr [OPTIONS]
  python3 cycles_blender.py -- ...     the same, by a Python that has bpy: Blender 3.4 to 5.0
Cycles, its path tracer, renders a diffuse glTF scene as tdpt-render means it, a picture for each seed; %d becomes the
seed. OUT has to be an absolute path or relative to the current folder.
  ... -- check PORTALS.glb PORTALS.py
Does what `portalfit --for cycles` writes set Cycles' portals where the portals are? Blender's importer reads the
portals' meshes, the script runs, and each lamp is held against its mesh."""
import argparse
import math
import os
import sys
import time

import numpy

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path.insert(0, HERE)
from readers import OF_THE_SKY, Light, complaints

# This folder has a cycles.py, and so has Blender.
sys.path = [path for path in sys.path if os.path.realpath(path) != HERE]

# The importer of Blender 3.4 still asks for numpy.bool, which numpy 1.24 no longer has.
if "bool" not in numpy.__dict__:
    numpy.bool = bool

import bpy
import bmesh  # part of bpy where that is a module

# Of `render`: name, what it is if not given, more of it.
OPTIONS = (
    ("seeds", 1, "pictures to make, seeds FIRST..FIRST+N-1"), ("first-seed", 1, None), ("spp", 256, None),
    ("cpu-seconds", 0.0, "as many samples as take so long, instead of --spp"),
    ("cpu", "", "FILE: write a line a picture: seed, samples, CPU s beyond those of one sample"),
    ("max-depth", 6, "edges of the longest path, at least 2"), ("width", 160, None), ("height", 120, None),
    ("threads", 0, "0: all cores"), ("lamp-cuts", 0, "cuts in each edge of the meshes that emit"),
    ("environment", "", "FILE|R,G,B: the world's light, as --environment of tdpt-render"),
    ("environment-rotation", 0.0, "degrees, counter-clockwise from above"),
    ("script", "", "Python run in the scene before it renders, as portalfit --for cycles writes it"))


def principled(material):
    return next(n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")


def inputs_of(material):
    """Those of its Principled BSDF, by the names that they had until Blender 4.0 renamed some."""
    inputs = {i.name: i for i in principled(material).inputs}
    renamed = {"Emission": "Emission Color", "Transmission": "Transmission Weight"}
    return {**inputs, **{old: inputs[new] for old, new in renamed.items() if new in inputs}}


def emitted(material):
    inputs = inputs_of(material)
    return [c * inputs["Emission Strength"].default_value for c in inputs["Emission"].default_value[:3]]


def cut(mesh, cuts):
    """The same surface in more triangles, all of them flat."""
    if bpy.app.version < (4, 1):
        mesh.use_auto_smooth = False
    finer = bmesh.new()
    finer.from_mesh(mesh)
    bmesh.ops.subdivide_edges(finer, edges=finer.edges[:], cuts=cuts, use_grid_fill=True)
    finer.to_mesh(mesh)
    finer.free()


def make_lambertian(material):
    """Replaces the material by a Diffuse BSDF, or, where it emits, by an Emission on the front alone."""
    nodes, links = material.node_tree.nodes, material.node_tree.links
    inputs = inputs_of(material)
    for name in ("Base Color", "Emission", "Emission Strength"):
        if inputs[name].is_linked:
            sys.exit(f"cycles_blender.py: material {material.name}: {name} has a texture, expected a factor")
    if inputs["Metallic"].default_value or inputs["Transmission"].default_value:
        sys.exit(f"cycles_blender.py: material {material.name}: metal or glass, expected a diffuse one")
    base, emission = list(inputs["Base Color"].default_value), emitted(material)

    nodes.clear()
    out = nodes.new("ShaderNodeOutputMaterial")
    diffuse = nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = base
    diffuse.inputs["Roughness"].default_value = 0
    if not any(emission):
        links.new(diffuse.outputs["BSDF"], out.inputs["Surface"])
        return
    glow = nodes.new("ShaderNodeEmission")
    peak = max(emission)
    glow.inputs["Color"].default_value = [c / peak for c in emission] + [1]
    glow.inputs["Strength"].default_value = peak
    if material.use_backface_culling:  # What the importer makes of doubleSided false.
        side, front = nodes.new("ShaderNodeNewGeometry"), nodes.new("ShaderNodeMath")
        front.operation = "MULTIPLY_ADD"  # strength = peak - peak * backfacing
        links.new(side.outputs["Backfacing"], front.inputs[0])
        front.inputs[1].default_value, front.inputs[2].default_value = -peak, peak
        links.new(front.outputs["Value"], glow.inputs["Strength"])
    both = nodes.new("ShaderNodeAddShader")
    links.new(diffuse.outputs["BSDF"], both.inputs[0])
    links.new(glow.outputs["Emission"], both.inputs[1])
    links.new(both.outputs["Shader"], out.inputs["Surface"])


def shine(scene, environment, rotation):
    """Lights the scene as `tdpt-render --environment` means it."""
    scene.world = bpy.data.worlds.new("environment")
    if bpy.app.version < (5, 0):
        scene.world.use_nodes = True
    nodes, links = scene.world.node_tree.nodes, scene.world.node_tree.links
    background = next(n for n in nodes if n.bl_idname == "ShaderNodeBackground")
    if environment.count(",") == 2:
        colour = [float(c) for c in environment.split(",")]
        background.inputs["Color"].default_value = [c / max(colour) for c in colour] + [1]
        background.inputs["Strength"].default_value = max(colour)
        return
    picture = nodes.new("ShaderNodeTexEnvironment")
    picture.image = bpy.data.images.load(os.path.abspath(environment))
    picture.image.colorspace_settings.name = "Linear" if bpy.app.version < (4, 0) else "Linear Rec.709"
    picture.interpolation = "Linear"  # In the angle to the pole, ours in its cosine: the same where texels are small.
    turn = nodes.new("ShaderNodeMapping")
    turn.vector_type = "POINT"
    # The centre of the map is +X here, and our -Z is +Y.
    turn.inputs["Rotation"].default_value = (0, 0, -math.pi / 2 - math.radians(rotation))
    place = nodes.new("ShaderNodeTexCoord")
    links.new(place.outputs["Generated"], turn.inputs["Vector"])
    links.new(turn.outputs["Vector"], picture.inputs["Vector"])
    links.new(picture.outputs["Color"], background.inputs["Color"])


def run_script(path):
    with open(path, encoding="utf-8") as script:
        exec(compile(script.read(), path, "exec"), {"__name__": "__main__"})


def prepare(a):
    bpy.ops.wm.read_factory_settings(use_empty=True)  # No cube, no lamp, no grey world.
    bpy.ops.import_scene.gltf(filepath=os.path.abspath(a.scene))
    scene = bpy.context.scene
    scene.camera = next(o for o in scene.objects if o.type == "CAMERA")
    if a.lamp_cuts:
        for mesh in bpy.data.meshes:
            if any(m and any(emitted(m)) for m in mesh.materials):
                cut(mesh, a.lamp_cuts)
    for material in bpy.data.materials if not a.keep_materials else ():
        make_lambertian(material)
    if a.environment:
        shine(scene, a.environment, a.environment_rotation)
    if a.script:
        run_script(a.script)

    render = scene.render
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y, render.resolution_percentage = a.width, a.height, 100
    render.film_transparent = False
    render.threads_mode = "FIXED" if a.threads else "AUTO"
    if a.threads:
        render.threads = a.threads
    render.use_persistent_data = True
    image = render.image_settings
    image.file_format, image.color_mode, image.color_depth = "OPEN_EXR", "RGB", "32"
    image.exr_codec = "ZIP"
    scene.view_settings.view_transform = "Raw"

    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = a.spp
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.pixel_filter_type = "BOX"  # One pixel wide, like ours.
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0  # Off.
    cycles.blur_glossy = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.light_sampling_threshold = 0
    # Bounces count the surfaces after the first: a path of k edges has k - 2.
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = a.max_depth - 2
    return scene


def render(scene, path, samples):
    """Renders and saves; CPU seconds that the process took for it, Blender's scene to Cycles' included."""
    scene.cycles.samples = samples
    scene.render.filepath = os.path.abspath(path)
    before = time.process_time()
    bpy.ops.render.render(write_still=True)
    return time.process_time() - before


def samples_in(scene, path, seconds, one):
    """How many samples take so many seconds more than one. The scene keeps one."""
    samples, taken = 1, 0
    while taken < min(0.5, seconds):
        samples *= 4
        taken = render(scene, path, samples + 1) - one
    return max(1, round(seconds * samples / taken))


def render_pictures(a):
    if a.max_depth < 2:
        sys.exit("cycles_blender.py: --max-depth: Cycles has no paths of less than 2 edges alone")
    scene = prepare(a)
    samples, one, lines = a.spp, 0, []
    if a.cpu or a.cpu_seconds:
        path = a.out.replace("%d", "one")
        render(scene, path, 1)  # Data that persist are made here.
        one = min(render(scene, path, 1) for _ in range(3))
        if a.cpu_seconds:
            samples = samples_in(scene, path, a.cpu_seconds, one)
        os.remove(os.path.abspath(path))
    for seed in range(a.first_seed, a.first_seed + a.seeds):
        scene.cycles.seed = seed
        lines.append(f"{seed} {samples} {render(scene, a.out.replace('%d', str(seed)), samples) - one:.3f}\n")
    if a.cpu:
        with open(a.cpu, "w", encoding="ascii") as file:
            file.writelines(lines)


def wrong_with(mesh, lamp):
    """What is wrong with the lamp of a portal, sentences."""
    light = lamp.data
    if light.type != "AREA" or light.shape != "RECTANGLE" or not light.cycles.is_portal:
        return ["is no rectangular area lamp that is a portal"]
    corners = [mesh.matrix_world @ v.co for v in mesh.data.vertices]
    # Light goes to the front of the mesh; an area lamp shines along its -Z.
    normal = (mesh.matrix_world.to_3x3() @ mesh.data.polygons[0].normal).normalized()
    return complaints(corners, normal, Light(lamp.matrix_world, light.size, light.size_y, -1))


def check_portals(a):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=os.path.abspath(a.glb))
    meshes = {o.name: o for o in bpy.context.scene.objects if o.type == "MESH" and o.get("sky", 1) >= OF_THE_SKY}
    for o in meshes.values():
        o.name = "mesh of " + o.name  # The lamps want these names.
    for _ in range(2):  # Run again, it replaces its lamps.
        run_script(a.script)
    bpy.context.view_layer.update()
    lamps = {o.name: o for o in bpy.context.scene.objects if o.type == "LIGHT"}
    wrong = [] if sorted(lamps) == sorted(meshes) else [f"lamps {sorted(lamps)}, expected {sorted(meshes)}"]
    for name in sorted(set(meshes) & set(lamps)):
        wrong += [f"{name} {sentence}" for sentence in wrong_with(meshes[name], lamps[name])]
    for sentence in wrong:
        print(f"cycles_blender.py: {sentence}", file=sys.stderr)
    print(f"{len(lamps)} lamps for {len(meshes)} portals")
    sys.exit(1 if wrong or not meshes else 0)


parser = argparse.ArgumentParser(prog="cycles_blender.py")
commands = parser.add_subparsers(required=True)
for command, run, files in (("render", render_pictures, ("scene", "out")), ("check", check_portals, ("glb", "script"))):
    p = commands.add_parser(command)
    p.set_defaults(run=run)
    for file in files:
        p.add_argument(file)
    for option, default, words in OPTIONS if command == "render" else ():
        p.add_argument("--" + option, type=type(default), default=default, help=words)
    if command == "render":
        p.add_argument("--keep-materials", action="store_true", help="leave the materials as imported")
given = parser.parse_args(sys.argv[sys.argv.index("--") + 1 :])
given.run(given)
