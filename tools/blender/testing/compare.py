"""compare.py OUT.json [SCENE ...]: brightness of Blender scenes by tdpt and by Cycles, both through Blender's own F12. Exit code
1 where a colour differs by more than 1 % beyond 3 standard errors, or where a fault of 5 % would not show.
Run in Blender (-P) or with the Python module bpy; the programs are found as by the extension."""
import json
import math
import os
import sys

import bpy
import numpy

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.dirname(HERE)]

import rooms  # noqa: E402
import tdpt  # noqa: E402

SEEDS = 4


def rendered(scene, path, seed):
    """Mean luminance of blocks of 8 x 8 pixels."""
    scene.render.filepath = path
    image_settings = scene.render.image_settings
    if hasattr(image_settings, "media_type"):
        image_settings.media_type = "IMAGE"
    image_settings.file_format, image_settings.color_mode, image_settings.color_depth = "OPEN_EXR", "RGB", "32"
    scene.cycles.seed = scene.tdpt.seed = seed
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(path)
    pixels = numpy.empty(image.size[0] * image.size[1] * 4, numpy.float32)
    image.pixels.foreach_get(pixels)
    shape = image.size[1], image.size[0], 4
    bpy.data.images.remove(image)
    return pixels.reshape(shape)[..., :3].astype(float)


def ask_the_same(scene):
    """The same question to both: bounces without end, no clamping, no filter but a box."""
    scene.view_settings.view_transform = "Raw"
    cycles = scene.cycles
    cycles.samples, cycles.device = 256, "CPU"
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.pixel_filter_type = "BOX"
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.light_sampling_threshold = 0
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = 32
    cycles.blur_glossy = 0
    scene.tdpt.denoise, scene.tdpt.samples, scene.tdpt.animate_seed = False, 64, False


def compare(name):
    scene = rooms.SCENES[name]()
    ask_the_same(scene)
    sums = {}
    for engine in ("CYCLES", "TDPT"):
        scene.render.engine = engine
        made = [rendered(scene, os.path.join(bpy.app.tempdir or "/tmp", f"{engine} {seed}.exr"), seed) for seed in range(1, SEEDS + 1)]
        means = numpy.array([p.mean((0, 1)) for p in made])
        sums[engine] = (means.mean(0), means.std(0, ddof=1) / math.sqrt(SEEDS), sum(made) / SEEDS)
    (a, da, pa), (b, db, pb) = sums["TDPT"], sums["CYCLES"]
    halves = [float(pa[s].mean() / pb[s].mean()) for s in (numpy.s_[:, :48], numpy.s_[:, 48:], numpy.s_[:32], numpy.s_[32:])]
    return {"scene": name, "ratio": (a / b).tolist(), "error": numpy.hypot(da / a, db / b).tolist(), "parts": halves,
            "tdpt": a.tolist(), "cycles": b.tolist()}


def differs(ratio, error):
    return any(abs(r - 1) > 0.01 + 3 * e for r, e in zip(ratio, error))


def main():
    words = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    tdpt.register()
    told = [compare(name) for name in words[1:] or rooms.SCENES]
    for line in told:
        print(line)
    with open(words[0], "w", encoding="utf-8") as file:
        json.dump(told, file)
    wrong = [line["scene"] for line in told if differs(line["ratio"], line["error"])]
    blind = [line["scene"] for line in told if not differs([1.05 * r for r in line["ratio"]], line["error"])]
    print(f"differ: {wrong}; would not notice 5 %: {blind}", flush=True)
    os._exit(1 if wrong or blind else 0)


main()
