"""worth.py: what portals are worth to Cycles in a scene. Run by the extension in a Blender of its own:
  worth.py FILE NAME FRAME PORTALS.json RESULT.json
PORTALS: [[rows of a lamp's matrix, width, height], ...]. RESULT: {"gain": G, "low": L, "high": H}: without the portals Cycles
needs G times as long for the same noise; 90 % interval. Measured on small pictures by the scene's own settings, two seeds each
way: error is half the mean squared difference of two pictures, over the squared mean."""
import json
import os
import sys
import time

import bpy
import numpy
from mathutils import Matrix

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from export import open_scene  # noqa: E402

WIDTH = 128
SECONDS = 1.0  # of a picture, in CPU time
BLOCK = 8  # pixels


def prepare(scene):
    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    share = WIDTH / max(render.resolution_x, render.resolution_y)
    render.resolution_x = max(8, round(render.resolution_x * share))
    render.resolution_y = max(8, round(render.resolution_y * share))
    render.resolution_percentage = 100
    render.use_persistent_data = False  # Blender 5 then misses what is switched on and off
    render.use_border = render.use_compositing = render.use_sequencer = False
    if hasattr(render.image_settings, "media_type"):
        render.image_settings.media_type = "IMAGE"
    render.image_settings.file_format, render.image_settings.color_mode = "OPEN_EXR", "RGB"
    render.image_settings.color_depth = "32"
    scene.view_settings.view_transform = "Raw"
    cycles.device = "CPU"
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    if hasattr(cycles, "time_limit"):
        cycles.time_limit = 0


def picture(scene, samples, seed):
    """(pixels, CPU seconds)"""
    scene.cycles.samples, scene.cycles.seed = samples, seed
    path = os.path.join(bpy.app.tempdir or ".", "worth.exr")
    scene.render.filepath = path
    before = time.process_time()
    bpy.ops.render.render(write_still=True)
    seconds = time.process_time() - before
    image = bpy.data.images.load(path)
    pixels = numpy.empty(image.size[0] * image.size[1] * 4, numpy.float32)
    image.pixels.foreach_get(pixels)
    shape = (image.size[1], image.size[0], 4)
    bpy.data.images.remove(image)
    return pixels.reshape(shape)[..., :3].mean(2), seconds


def lamps_of(scene, portals):
    lamps = []
    for rows, width, height in portals:
        lamp = bpy.data.lights.new("portal", "AREA")
        lamp.shape = "RECTANGLE"
        lamp.size, lamp.size_y = width, height
        lamp.cycles.is_portal = True
        thing = bpy.data.objects.new("portal", lamp)
        thing.matrix_world = Matrix(rows)
        scene.collection.objects.link(thing)
        lamps.append(thing)
    return lamps


def show(lamps, yes):
    for lamp in lamps:
        lamp.hide_render = not yes


def samples_for(scene, one):
    """How many samples take SECONDS more than one."""
    samples, taken = 4, 0.0
    while True:
        taken = picture(scene, samples + 1, 9)[1] - one
        if taken > SECONDS / 4 or samples >= 4096:
            return max(2, round(samples * SECONDS / max(taken, 1e-3)))
        samples *= 4


def blocks_of(pixels):
    h, w = (side // BLOCK * BLOCK for side in pixels.shape)
    return pixels[:h, :w].reshape(h // BLOCK, BLOCK, w // BLOCK, BLOCK).mean((1, 3)).ravel()


def measure(scene, lamps):
    pictures, seconds = {}, {}
    for yes in (False, True):
        show(lamps, yes)
        one = min(picture(scene, 1, 1)[1] for _ in range(2))
        samples = samples_for(scene, one)
        made = [picture(scene, samples, seed) for seed in (1, 2)]
        pictures[yes] = [p for p, _ in made]
        seconds[yes] = max(1e-3, sum(s for _, s in made) / 2 - one)
    mean = sum(sum(pictures[yes]) for yes in (False, True)) / 4
    scale = numpy.repeat(numpy.repeat(blocks_of(mean).reshape(mean.shape[0] // BLOCK, -1), BLOCK, 0), BLOCK, 1)
    scale = scale**2 + (0.01 * mean.mean()) ** 2 + 1e-30
    h, w = scale.shape
    cost = {}
    for yes, (a, b) in pictures.items():
        cost[yes] = blocks_of((a - b)[:h, :w] ** 2 / scale) / 2 * seconds[yes]
    rng = numpy.random.default_rng(1)
    n = len(cost[True])
    gains = []
    for _ in range(400):
        pick = rng.integers(0, n, n)
        gains.append(cost[False][pick].mean() / max(cost[True][pick].mean(), 1e-30))
    low, high = numpy.quantile(gains, (0.05, 0.95))
    return {"gain": float(cost[False].mean() / max(cost[True].mean(), 1e-30)), "low": float(low), "high": float(high)}


def main():
    file, name, frame, given, result = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    open_scene(file, name)
    scene = bpy.context.scene
    scene.frame_set(int(float(frame) // 1), subframe=float(frame) % 1)
    with open(given, encoding="utf-8") as text:
        portals = json.load(text)
    for thing in scene.objects:  # the portals of the last time
        if thing.type == "LIGHT" and thing.get("tdpt_found"):
            thing.hide_render = True
    prepare(scene)
    told = measure(scene, lamps_of(scene, portals))
    with open(result, "w", encoding="utf-8") as text:
        json.dump(told, text)


main()
