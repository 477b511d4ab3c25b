# cycles-table.py: do two sets of pictures, one picture for each seed, agree in the mean?
#   blender -b --factory-startup --python-exit-code 1 --python cycles-table.py -- A-%d.exr B-%d.exr [OPTIONS]
# Prints, for each channel and for luminance, both means with their standard errors over the seeds and
# the difference in standard errors; then the same for every block of the picture. Blender is here
# because it reads OpenEXR. Exit code 1 if a mean differs by more than 4 standard errors.

import argparse
import os
import sys

import bpy
import numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from intervals import in_errors, mean_and_error, percent

LUMINANCE = numpy.array([0.2126, 0.7152, 0.0722], numpy.float64)  # Rec.709
LIMIT = 4.0  # standard errors; by chance once in about 3000 comparisons of 16 with 16 seeds


def options():
    p = argparse.ArgumentParser(prog="cycles-table.py")
    p.add_argument("a")
    p.add_argument("b")
    p.add_argument("--names", default="Cycles,nee")
    p.add_argument("--seeds", type=int, required=True, help="pictures in each set, at least 2")
    p.add_argument("--blocks", default="8x6", help="columns x rows")
    p.add_argument("--scale", type=float, default=1, help="plants a fault: multiplies the second set")
    p.add_argument("--averages", help="folder for the averages of both sets, as NAME.exr")
    a = p.parse_args(sys.argv[sys.argv.index("--") + 1 :])
    if a.seeds < 2:
        p.error("--seeds: expected at least 2")
    return a


def read(path):
    """Linear RGB, rows from the bottom: height x width x 3."""
    image = bpy.data.images.load(os.path.abspath(path))
    width, height = image.size
    if not width or not image.is_float:
        sys.exit(f"cycles-table.py: {path}: not readable, expected an OpenEXR picture")
    pixels = numpy.empty(width * height * 4, numpy.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return pixels.reshape(height, width, 4)[:, :, :3].astype(numpy.float64)


def write(path, rgb):
    height, width, _ = rgb.shape
    image = bpy.data.images.new("average", width, height, float_buffer=True)
    rgba = numpy.ones((height, width, 4), numpy.float32)
    rgba[:, :, :3] = rgb
    image.pixels.foreach_set(rgba.ravel())
    scene = bpy.context.scene
    scene.view_settings.view_transform = "Raw"
    settings = scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGB", "32"
    image.save_render(os.path.abspath(path), scene=scene)


def main():
    a = options()
    columns, rows = (int(n) for n in a.blocks.split("x"))
    sets = [
        numpy.array([read(pattern.replace("%d", str(s))) for s in range(1, a.seeds + 1)])
        for pattern in (a.a, a.b)
    ]
    if sets[0].shape != sets[1].shape:
        sys.exit(f"cycles-table.py: {a.b}: {sets[1].shape[1:3]} pixels, expected {sets[0].shape[1:3]}")
    names = a.names.split(",")
    if a.averages:
        for name, pictures in zip(names, sets):
            write(os.path.join(a.averages, name + ".exr"), pictures.mean(0))
    sets[1] *= a.scale

    print(f"          {names[0]:>24} {names[1]:>24}   difference")
    worst = 0.0
    for label, weights in [*zip("RGB", numpy.eye(3)), ("luminance", LUMINANCE)]:
        one, two = (mean_and_error((p @ weights).mean((1, 2))) for p in sets)
        z = float(in_errors(one, two))
        worst = max(worst, abs(z))
        cells = " ".join(f"{m:.7f} +- {percent(e, m):.2f} %".rjust(24) for m, e in (one, two))
        print(f"{label:9} {cells}   {percent(one[0] - two[0], two[0]):+.2f} % = {z:+.2f} s.e.")

    height, width = sets[0].shape[1:3]
    ys, xs = numpy.arange(height) * rows // height, numpy.arange(width) * columns // width
    index = (ys[:, None] * columns + xs[None, :]).ravel()
    count = numpy.bincount(index)

    def block_means(pictures):
        return numpy.array([numpy.bincount(index, (p @ LUMINANCE).ravel()) / count for p in pictures])

    z = in_errors(*(mean_and_error(block_means(p)) for p in sets))
    lit = int(numpy.count_nonzero(z))
    print(f"blocks    {columns} x {rows}, {lit} not black: mean z {z.sum() / max(lit, 1):+.2f}, "
          f"rms z {numpy.sqrt((z**2).sum() / max(lit, 1)):.2f}, largest {numpy.abs(z).max():.2f}")
    sys.exit(1 if worst > LIMIT else 0)


main()
