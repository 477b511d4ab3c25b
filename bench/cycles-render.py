# cycles-render.py: Cycles, Blender's path tracer, renders a diffuse glTF scene as tdpt-render means it.
#   blender -b --factory-startup --python-exit-code 1 --python cycles-render.py -- SCENE.glb OUT-%d.exr [OPTIONS]
# One picture for each seed; %d becomes the seed. OUT has to be an absolute path or relative to the
# current folder. What is set, and why Blender's own reading of the file is not enough: doc/cycles.md.

import argparse
import math
import os
import sys
import time

import numpy

# The importer of Blender 3.4 still asks for numpy.bool, which numpy 1.24 no longer has.
if "bool" not in numpy.__dict__:
    numpy.bool = bool

import bmesh
import bpy


def options():
    p = argparse.ArgumentParser(prog="cycles-render.py")
    p.add_argument("scene")
    p.add_argument("out")
    p.add_argument("--seeds", type=int, default=1, help="pictures to make, seeds FIRST..FIRST+N-1")
    p.add_argument("--first-seed", type=int, default=1, metavar="FIRST")
    p.add_argument("--spp", type=int, default=256)
    p.add_argument("--cpu-seconds", type=float, metavar="S", help="as many samples as take so long, instead of --spp")
    p.add_argument("--cpu", metavar="FILE", help="write a line a picture: seed, samples, CPU s beyond those of one sample")
    p.add_argument("--max-depth", type=int, default=6, help="edges of the longest path, at least 2")
    p.add_argument("--width", type=int, default=160)
    p.add_argument("--height", type=int, default=120)
    p.add_argument("--threads", type=int, default=0, help="0: all cores")
    p.add_argument("--lamp-cuts", type=int, default=0, help="cuts in each edge of the meshes that emit")
    p.add_argument("--keep-materials", action="store_true", help="leave the materials as imported")
    p.add_argument("--environment", metavar="FILE|R,G,B", help="the world's light, as --environment of tdpt-render")
    p.add_argument("--environment-rotation", type=float, default=0, help="degrees, counter-clockwise from above")
    p.add_argument("--script", help="Python run in the scene before it renders, as portalfit --for cycles writes it")
    a = p.parse_args(sys.argv[sys.argv.index("--") + 1 :])
    if a.max_depth < 2:
        p.error("--max-depth: Cycles has no paths of less than 2 edges alone")
    return a


def principled(material):
    return next(n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")


def glows(material):
    inputs = principled(material).inputs
    return inputs["Emission Strength"].default_value and any(inputs["Emission"].default_value[:3])


def cut(mesh, cuts):
    """The same surface in more triangles, all of them flat."""
    mesh.use_auto_smooth = False
    finer = bmesh.new()
    finer.from_mesh(mesh)
    bmesh.ops.subdivide_edges(finer, edges=finer.edges[:], cuts=cuts, use_grid_fill=True)
    finer.to_mesh(mesh)
    finer.free()


def make_lambertian(material):
    """Replaces the material by a Diffuse BSDF, or, where it emits, by an Emission on the front alone."""
    nodes, links = material.node_tree.nodes, material.node_tree.links
    source = principled(material)
    for name in ("Base Color", "Emission", "Emission Strength"):
        if source.inputs[name].is_linked:
            sys.exit(f"cycles-render.py: material {material.name}: {name} has a texture, expected a factor")
    if source.inputs["Metallic"].default_value or source.inputs["Transmission"].default_value:
        sys.exit(f"cycles-render.py: material {material.name}: metal or glass, expected a diffuse one")
    base = list(source.inputs["Base Color"].default_value)
    strength = source.inputs["Emission Strength"].default_value
    emission = [c * strength for c in source.inputs["Emission"].default_value[:3]]
    one_sided = material.use_backface_culling  # What the importer makes of doubleSided false.

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
    if one_sided:
        side = nodes.new("ShaderNodeNewGeometry")
        front = nodes.new("ShaderNodeMath")
        front.operation = "MULTIPLY_ADD"  # strength = peak - peak * backfacing
        links.new(side.outputs["Backfacing"], front.inputs[0])
        front.inputs[1].default_value = -peak
        front.inputs[2].default_value = peak
        links.new(front.outputs["Value"], glow.inputs["Strength"])
    both = nodes.new("ShaderNodeAddShader")
    links.new(diffuse.outputs["BSDF"], both.inputs[0])
    links.new(glow.outputs["Emission"], both.inputs[1])
    links.new(both.outputs["Shader"], out.inputs["Surface"])


def shine(scene, environment, rotation):
    """Lights the scene as `tdpt-render --environment` means it."""
    scene.world = bpy.data.worlds.new("environment")
    scene.world.use_nodes = True
    nodes, links = scene.world.node_tree.nodes, scene.world.node_tree.links
    background = next(n for n in nodes if n.bl_idname == "ShaderNodeBackground")
    try:
        colour = [float(c) for c in environment.split(",")]
    except ValueError:
        colour = None
    if colour:
        background.inputs["Color"].default_value = [c / max(colour) for c in colour] + [1]
        background.inputs["Strength"].default_value = max(colour)
        return
    picture = nodes.new("ShaderNodeTexEnvironment")
    picture.image = bpy.data.images.load(os.path.abspath(environment))
    picture.image.colorspace_settings.name = "Linear"
    picture.interpolation = "Linear"  # In the angle to the pole, ours in its cosine: the same where texels are small.
    turn = nodes.new("ShaderNodeMapping")
    turn.vector_type = "POINT"
    # The centre of the map is +X here, and our -Z is +Y.
    turn.inputs["Rotation"].default_value = (0, 0, -math.pi / 2 - math.radians(rotation))
    place = nodes.new("ShaderNodeTexCoord")
    links.new(place.outputs["Generated"], turn.inputs["Vector"])
    links.new(turn.outputs["Vector"], picture.inputs["Vector"])
    links.new(picture.outputs["Color"], background.inputs["Color"])


def prepare(a):
    bpy.ops.wm.read_factory_settings(use_empty=True)  # No cube, no lamp, no grey world.
    bpy.ops.import_scene.gltf(filepath=os.path.abspath(a.scene))
    scene = bpy.context.scene
    scene.camera = next(o for o in scene.objects if o.type == "CAMERA")
    if a.lamp_cuts:
        for mesh in bpy.data.meshes:
            if any(m and glows(m) for m in mesh.materials):
                cut(mesh, a.lamp_cuts)
    if not a.keep_materials:
        for material in bpy.data.materials:
            make_lambertian(material)

    if a.environment:
        shine(scene, a.environment, a.environment_rotation)
    if a.script:
        with open(a.script, encoding="utf-8") as script:
            exec(compile(script.read(), a.script, "exec"), {"__name__": "__main__"})

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


def main():
    a = options()
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


main()
