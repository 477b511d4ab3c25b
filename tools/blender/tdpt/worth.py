"""worth.py: what portals are worth to Cycles in a scene. Run by the extension in a Blender of its own:
  worth.py FILE NAME FRAME RESULT.json
The portals are the lamps that the search has placed. RESULT: {"gain": G, "low": L, "high": H}: without them Cycles needs G times
as long for the same noise; 90 % interval. Measured on small pictures by the scene's own settings, three pairs of seeds each way:
error is half the mean squared difference of two pictures, over the squared mean."""
import json
import os
import sys
import time

import bpy
import numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from export import open_scene  # noqa: E402
from world import linear_exr, pixels_of  # noqa: E402

WIDTH = 128
SECONDS = 0.6  # of a picture, in CPU time
BLOCK = 8  # pixels
PAIRS = 3


def prepare(scene):
    render, cycles = scene.render, scene.cycles
    linear_exr(scene)
    share = WIDTH / max(render.resolution_x, render.resolution_y)
    render.resolution_x = max(8, round(render.resolution_x * share))
    render.resolution_y = max(8, round(render.resolution_y * share))
    render.use_persistent_data = False  # Blender 5 then misses what is switched on and off
    render.use_border = render.use_compositing = render.use_sequencer = False
    render.filepath = os.path.join(bpy.app.tempdir or ".", "worth.exr")
    cycles.device, cycles.time_limit = "CPU", 0


def picture(scene, samples, seed):
    """(brightness of pixels, CPU seconds)"""
    scene.cycles.samples, scene.cycles.seed = samples, seed
    before = time.process_time()
    bpy.ops.render.render(write_still=True)
    seconds = time.process_time() - before
    image = bpy.data.images.load(scene.render.filepath)
    pixels = pixels_of(image)[..., :3].mean(2)
    bpy.data.images.remove(image)
    return pixels, seconds


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


def block_means(pixels):
    """Of whole blocks, as a table."""
    h, w = (side // BLOCK for side in pixels.shape)
    return pixels[: h * BLOCK, : w * BLOCK].reshape(h, BLOCK, w, BLOCK).mean((1, 3))


def measure(scene, lamps):
    """Both ways take turns, with the same seeds and as many samples, so that errors differ by the portals alone. Cost is
    variance times CPU time beyond that of one sample. The blocks of the picture and the turns, whose times differ on a busy
    machine, are both resampled for the interval."""
    for yes in (True, False):
        show(lamps, yes)
        picture(scene, 32, 9)  # warms up: the first pictures of a process take longer
    samples = samples_for(scene, min(picture(scene, 1, 1)[1] for _ in range(2)))
    pairs, seconds = {False: [], True: []}, {False: [], True: []}  # seconds: of one sample, and of both pictures
    for turn in range(PAIRS):
        for yes in (False, True) if turn % 2 == 0 else (True, False):
            show(lamps, yes)
            first = picture(scene, 1, 1)[1]
            (a, time_a), (b, time_b) = (picture(scene, samples, 2 * turn + k) for k in (1, 2))
            pairs[yes].append((a, b))
            seconds[yes].append((first, (time_a + time_b) / 2))
    mean = block_means(sum(a + b for yes in pairs for a, b in pairs[yes]) / (4 * PAIRS))
    scale = mean**2 + (0.01 * mean.mean()) ** 2 + 1e-30
    errors = {yes: numpy.array([(block_means((a - b) ** 2) / scale).ravel() for a, b in pairs[yes]]) for yes in pairs}

    def gain(turns, blocks):
        cost = {}
        for yes in errors:
            first, whole = numpy.median(numpy.array(seconds[yes])[turns], 0)
            cost[yes] = errors[yes][turns][:, blocks].mean() * max(1e-3, whole - first)
        return float(cost[False] / max(cost[True], 1e-30))

    rng, n = numpy.random.default_rng(1), scale.size
    low, high = numpy.quantile([gain(rng.integers(0, PAIRS, PAIRS), rng.integers(0, n, n)) for _ in range(400)], (0.05, 0.95))
    return {"gain": gain(numpy.arange(PAIRS), numpy.arange(n)), "low": float(low), "high": float(high)}


def main():
    file, name, frame, result = sys.argv[sys.argv.index("--") + 1 :]
    open_scene(file, name)
    scene = bpy.context.scene
    scene.frame_set(int(float(frame) // 1), subframe=float(frame) % 1)
    prepare(scene)
    worth = measure(scene, [o for o in scene.objects if o.type == "LIGHT" and o.get("tdpt_found")])
    with open(result, "w", encoding="utf-8") as text:
        json.dump(worth, text)


main()
