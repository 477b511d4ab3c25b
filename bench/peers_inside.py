"""What runs in a Python that has bpy, pyluxcore or mitsuba; doc/peers.md tells what is set, and why.
  peers_inside.py versions
Prints JSON: {method: version}, of those that are installed.
  peers_inside.py METHOD SCENE.npz OUT.exr [OPTIONS]
Renders the scene that peers.py wrote by one thread, and prints JSON: samples (per pixel) and cpu (seconds of rendering).

SCENE.npz, in metres, +Y up:  corners (triangles x 3 x 3), material (of each triangle), colours, emission (of each
material; radiance of the front), lamps (place, radiant intensity [W/sr]), camera (its matrix to the world; it looks
along -Z), yfov [rad]."""
import argparse
import importlib.metadata
import json
import math
import os
import sys
import tempfile
import time

import numpy as np

from formats import exr_write

LUXCORE_DEPTH = 16  # vertices of each half of a path; without Russian roulette, which makes BIDIRCPU too bright
CYCLES_DEPTH = 1024  # bounces, the most that it has
PASS = 8  # samples per pixel that Mitsuba makes at a time


class Scene:
    def __init__(self, path):
        with np.load(path) as file:
            self.__dict__.update(file)
        self.yfov = float(self.yfov)

    def meshes(self):
        """(name, corners, colour, emission) of each material."""
        for m in np.unique(self.material):
            yield f"material-{m}", self.corners[self.material == m], self.colours[m].tolist(), self.emission[m].tolist()


# ---- Cycles ----
def cycles_material(bpy, name, colour, emission):
    material = bpy.data.materials.new(name)
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    out = nodes.new("ShaderNodeOutputMaterial")
    if not any(emission):
        diffuse = nodes.new("ShaderNodeBsdfDiffuse")
        diffuse.inputs["Color"].default_value = [*colour, 1]
        diffuse.inputs["Roughness"].default_value = 0
        links.new(diffuse.outputs["BSDF"], out.inputs["Surface"])
        return material
    peak, glow = max(emission), nodes.new("ShaderNodeEmission")
    glow.inputs["Color"].default_value = [c / peak for c in emission] + [1]
    side, front = nodes.new("ShaderNodeNewGeometry"), nodes.new("ShaderNodeMath")
    front.operation = "MULTIPLY_ADD"  # strength = peak - peak * backfacing
    links.new(side.outputs["Backfacing"], front.inputs[0])
    front.inputs[1].default_value, front.inputs[2].default_value = -peak, peak
    links.new(front.outputs["Value"], glow.inputs["Strength"])
    links.new(glow.outputs["Emission"], out.inputs["Surface"])
    material.cycles.emission_sampling = "FRONT"
    return material


def cycles_scene(bpy, scene):
    """The same axes as the file's: without a sky up is no matter, and cameras look along -Z in both."""
    from mathutils import Matrix
    made = bpy.context.scene
    bpy.data.batch_remove(bpy.data.objects)  # the cube, the lamp
    made.world = None
    for name, corners, colour, emission in scene.meshes():
        mesh = bpy.data.meshes.new(name)
        mesh.from_pydata(corners.reshape(-1, 3), [], np.arange(3 * len(corners)).reshape(-1, 3))
        mesh.materials.append(cycles_material(bpy, name, colour, emission))
        made.collection.objects.link(bpy.data.objects.new(name, mesh))
    for place, intensity in scene.lamps:
        lamp = bpy.data.lights.new("lamp", "POINT")
        lamp.color, lamp.energy = intensity / intensity.max(), 4 * math.pi * intensity.max()  # energy: W
        lamp.shadow_soft_size = 0
        lamp.cycles.max_bounces = CYCLES_DEPTH
        placed = bpy.data.objects.new("lamp", lamp)
        placed.location = place
        made.collection.objects.link(placed)
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit, camera.angle, camera.clip_start, camera.clip_end = "VERTICAL", scene.yfov, 0.001, 1000
    placed = bpy.data.objects.new("camera", camera)
    placed.matrix_world = Matrix(scene.camera.tolist())
    made.collection.objects.link(placed)
    made.camera = placed
    return made


def cycles(scene, a, guided=False):
    """Like the others a function of a seed and a file, which returns samples and CPU seconds."""
    import bpy
    made = cycles_scene(bpy, scene)
    made.render.engine = "CYCLES"
    made.render.threads_mode, made.render.threads = "FIXED", 1
    made.render.use_persistent_data = True  # a second rendering builds no tree anew
    made.render.resolution_x, made.render.resolution_y, made.render.resolution_percentage = a.width, a.height, 100
    image = made.render.image_settings
    image.file_format, image.color_mode, image.color_depth, image.exr_codec = "OPEN_EXR", "RGB", "32", "ZIP"
    made.view_settings.view_transform = "Raw"
    c = made.cycles
    c.device = "CPU"
    c.use_adaptive_sampling = c.use_denoising = False
    c.pixel_filter_type = "BOX"  # one pixel wide, like ours
    c.sample_clamp_direct = c.sample_clamp_indirect = 0  # off
    c.blur_glossy = 0
    c.light_sampling_threshold = 0
    c.caustics_reflective = c.caustics_refractive = True
    c.max_bounces = c.diffuse_bounces = c.glossy_bounces = CYCLES_DEPTH
    c.use_guiding, c.use_surface_guiding, c.use_volume_guiding = guided, True, False

    def taken(samples, path):
        c.samples = samples
        made.render.filepath = os.path.abspath(path)
        before = time.process_time()
        bpy.ops.render.render(write_still=True)
        return time.process_time() - before

    trial = a.out + ".trial.exr"
    taken(1, trial)  # Data that persist are made here.
    one, samples = min(taken(1, trial) for _ in range(3)), a.spp
    if a.cpu_seconds:
        samples, more = 1, 0.0
        while more < min(1.0, a.cpu_seconds / 4):
            samples *= 4
            more = taken(samples + 1, trial) - one
        samples = max(1, round(a.cpu_seconds * samples / more))
    os.remove(trial)

    def picture(seed, path):
        c.seed = seed
        return samples, taken(samples, path) - one

    return picture


# ---- LuxCore ----
def luxcore(scene, a):
    import pyluxcore as lux
    lux.Init(lambda words: None)
    made, props = lux.Scene(), lux.Properties()

    def say(name, *values):
        props.Set(lux.Property(name, list(values)))

    for name, corners, colour, emission in scene.meshes():
        material = f"scene.materials.{name}"
        say(f"{material}.type", "matte")
        say(f"{material}.kd", *colour)
        if any(emission):
            say(f"{material}.emission", *emission)
        made.DefineMesh(name, [tuple(map(float, p)) for p in corners.reshape(-1, 3)],
                        [tuple(t) for t in np.arange(3 * len(corners)).reshape(-1, 3).tolist()], None, None, None, None)
        say(f"scene.objects.{name}.shape", name)
        say(f"scene.objects.{name}.material", name)
    for i, (place, intensity) in enumerate(scene.lamps.tolist()):
        say(f"scene.lights.lamp-{i}.type", "point")
        say(f"scene.lights.lamp-{i}.position", *place)
        say(f"scene.lights.lamp-{i}.color", 1.0, 1.0, 1.0)
        say(f"scene.lights.lamp-{i}.gain", *(4 * math.pi * c for c in intensity))
    at, up, back = (scene.camera[:3, k].tolist() for k in (3, 1, 2))
    say("scene.camera.type", "perspective")
    say("scene.camera.lookat.orig", *at)
    say("scene.camera.lookat.target", *(p - q for p, q in zip(at, back)))
    say("scene.camera.up", *up)
    half = math.tan(scene.yfov / 2) * max(1, a.width / a.height)
    say("scene.camera.fieldofview", math.degrees(2 * math.atan(half)))  # of the longer side
    say("scene.camera.autofocus.enable", False)
    made.Parse(props)

    def render(seed, path):
        config = lux.Properties()
        for name, value in {
                "renderengine.type": "BIDIRCPU", "renderengine.seed": seed, "native.threads.count": 1,
                "path.maxdepth": LUXCORE_DEPTH, "light.maxdepth": LUXCORE_DEPTH, "sampler.type": "SOBOL",
                "path.russianroulette.depth": LUXCORE_DEPTH + 1,
                "sampler.sobol.adaptive.strength": 0.0, "film.width": a.width, "film.height": a.height,
                "film.filter.type": "NONE", "film.outputs.0.type": "RGB",
                "film.outputs.0.filename": "rgb.exr", "film.imagepipelines.0.0.type": "NOP",
                "batch.haltspp": a.spp if not a.cpu_seconds else 0}.items():
            config.Set(lux.Property(name, [value]))
        session = lux.RenderSession(lux.RenderConfig(config, made))
        session.Start()
        before, told = time.process_time(), 0.0
        while not session.HasDone() and not (a.cpu_seconds and time.process_time() - before >= a.cpu_seconds):
            time.sleep(0.01)
            if not a.cpu_seconds and time.monotonic() - told > 0.5:
                session.UpdateStats()
                told = time.monotonic()
        session.UpdateStats()
        samples = session.GetStats().Get("stats.renderengine.pass").GetInt()
        session.Stop()
        cpu, picture = time.process_time() - before, np.zeros(a.width * a.height * 3, np.float32)
        session.GetFilm().GetOutputFloat(lux.FilmOutputType.RGB, picture, 0)
        exr_write(path, picture.reshape(a.height, a.width, 3)[::-1])
        return samples, cpu

    return render


# ---- Mitsuba ----
def write_ply(path, corners):
    faces = np.zeros(len(corners), [("n", "u1"), ("v", "<i4", 3)])
    faces["n"], faces["v"] = 3, np.arange(3 * len(corners)).reshape(-1, 3)
    with open(path, "wb") as file:
        file.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {3 * len(corners)}\nproperty float x\n"
                   f"property float y\nproperty float z\nelement face {len(corners)}\n"
                   "property list uchar int vertex_indices\nend_header\n".encode())
        file.write(corners.astype("<f4").tobytes() + faces.tobytes())


def mitsuba(scene, a):
    import drjit
    import mitsuba as mi
    variant = os.environ.get("MITSUBA_VARIANT", "llvm_ad_rgb")
    mi.set_variant(variant)
    drjit.set_thread_count(1)
    rgb = lambda values: {"type": "rgb", "value": [float(v) for v in values]}
    with tempfile.TemporaryDirectory() as folder:
        whole = {"type": "scene", "integrator": {"type": "path", "max_depth": -1}}
        for name, corners, colour, emission in scene.meshes():
            path = os.path.join(folder, f"{name}.ply")
            write_ply(path, corners)
            whole[name] = {"type": "ply", "filename": path, "face_normals": True,
                           "bsdf": {"type": "twosided", "inner": {"type": "diffuse", "reflectance": rgb(colour)}}}
            if any(emission):
                whole[name]["emitter"] = {"type": "area", "radiance": rgb(emission)}
        for i, (place, intensity) in enumerate(scene.lamps.tolist()):
            whole[f"lamp-{i}"] = {"type": "point", "position": place, "intensity": rgb(intensity)}
        # Looks along +Z, with +X on its left.
        whole["camera"] = {
            "type": "perspective", "fov_axis": "y", "fov": math.degrees(scene.yfov), "near_clip": 0.001,
            "to_world": mi.ScalarTransform4f(scene.camera @ np.diag([-1.0, 1, -1, 1])),
            "film": {"type": "hdrfilm", "width": a.width, "height": a.height, "rfilter": {"type": "box"},
                     "pixel_format": "rgb", "component_format": "float32"},
            "sampler": {"type": "independent"}}
        made = mi.load_dict(whole)

    def samples_of(seed):
        return np.array(mi.render(made, spp=PASS, seed=seed), np.float64)

    samples_of(0)  # Kernels are compiled here.

    def picture(seed, path):
        before, total, passes = time.process_time(), 0.0, 0
        while time.process_time() - before < a.cpu_seconds if a.cpu_seconds else passes * PASS < a.spp:
            passes += 1
            total = total + samples_of(100000 * seed + passes)
        cpu = time.process_time() - before
        exr_write(path, total[..., :3] / passes)
        return passes * PASS, cpu

    return picture


METHODS = {"cycles": ("bpy", cycles), "cycles-guided": ("bpy", lambda scene, a: cycles(scene, a, guided=True)),
           "luxcore": ("pyluxcore", luxcore), "mitsuba": ("mitsuba", mitsuba)}


def versions():
    found = {}
    for method, (package, _) in METHODS.items():
        try:
            found[method] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            pass
    return found


def main():
    if sys.argv[1:] == ["versions"]:
        return versions()
    parser = argparse.ArgumentParser(prog="peers_inside.py")
    parser.add_argument("method", choices=METHODS)
    parser.add_argument("scene")
    parser.add_argument("out")
    parser.add_argument("--cpu-seconds", type=float, default=0.0, help="as many samples as take so long, instead of --spp")
    for option, default in (("width", 160), ("height", 90), ("spp", 16), ("seed", 1)):
        parser.add_argument(f"--{option}", type=int, default=default)
    a = parser.parse_args()
    return dict(zip(("samples", "cpu"), METHODS[a.method][1](Scene(a.scene), a)(a.seed, a.out)))


if __name__ == "__main__":
    told = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # Renderers talk on standard output.
    print(json.dumps(main()), file=told, flush=True)
    os._exit(0)  # Some of them crash where they are taken down.
