"""The scenes of the paper out of Benedikt Bitterli's archives for Mitsuba: edits their files and imports them."""
import os
import shutil
import tempfile
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np

from common import Setting, Stop, checked, settings


def child(parent, tag, **attributes):
    return ET.SubElement(parent, tag, {k: str(v) for k, v in attributes.items()})


def rectangle(scene, low, high, reflectance, radiance=None, towards=1):
    """Adds an axis-aligned rectangle, flat in one dimension, whose front is on its `towards` (+1 or -1) side."""
    low, high = np.array(low, float), np.array(high, float)
    flat = int(np.argmin(high - low))
    first, second = [(1, 2), (2, 0), (0, 1)][flat]
    half, centre = (high - low) / 2, (high + low) / 2
    axes = np.zeros((3, 3))
    axes[first, 0] = half[first]
    axes[second, 1] = half[second] * towards
    axes[flat, 2] = towards
    shape = child(scene, "shape", type="rectangle")
    matrix = np.vstack([np.column_stack([axes, centre]), [0, 0, 0, 1]])
    child(child(shape, "transform", name="toWorld"), "matrix", value=" ".join(f"{v:.9g}" for v in matrix.ravel()))
    colour = ", ".join(map(str, reflectance))
    child(child(child(shape, "bsdf", type="twosided"), "bsdf", type="diffuse"), "rgb", name="reflectance", value=colour)
    if radiance:
        child(child(shape, "emitter", type="area"), "rgb", name="radiance", value=radiance)


def wall_with_hole(scene, low, high, hole_low, hole_high, reflectance):
    """A rectangle flat in one dimension, less another one in it: four rectangles."""
    flat = int(np.argmin(np.subtract(high, low)))
    across, up = (a for a in (2, 0, 1) if a != flat)  # y last, where it is in the wall
    if across == 1:
        across, up = up, across
    for axis, end, other in ((up, 0, None), (up, 1, None), (across, 0, up), (across, 1, up)):
        a, b = np.array(low, float), np.array(high, float)
        if end == 0:
            b[axis] = hole_low[axis]
        else:
            a[axis] = hole_high[axis]
        if other is not None:
            a[other], b[other] = hole_low[other], hole_high[other]
        rectangle(scene, a, b, reflectance)


def sides(scene, low, high, reflectance, without=()):
    """The six sides of a box but those named by (axis, end)."""
    for axis in range(3):
        for end in (0, 1):
            if (axis, end) not in without:
                a, b = np.array(low, float), np.array(high, float)
                a[axis] = b[axis] = (low, high)[end][axis]
                rectangle(scene, a, b, reflectance)


def lamp_of(scene):
    """(the shape that emits, its radiance)"""
    shape = next(s for s in scene.findall("shape") if s.find("emitter") is not None)
    return shape, shape.find("emitter/rgb").get("value")


def flipped(scene):
    """The lamp shines the other way."""
    child(lamp_of(scene)[0], "boolean", name="flipNormals", value="true")


def behind_a_hole(scene):
    """A hole in the right wall leads through a jamb into a closed box, which holds the lamp."""
    white, green = (0.725, 0.71, 0.68), (0.14, 0.45, 0.091)
    lamp, radiance = lamp_of(scene)
    wall = next(s for s in scene.findall("shape") if s.find("ref") is not None and s.find("ref").get("id") == "RightWall")
    scene.remove(lamp)
    scene.remove(wall)
    hole = ((0.75, 1.25), (-0.25, 0.25))  # in y and z
    for x, colour in ((1, green), (1.02, white)):
        wall_with_hole(scene, (x, 0, -1), (x, 2, 1), (x, hole[0][0], hole[1][0]), (x, hole[0][1], hole[1][1]), colour)
    sides(scene, (1, hole[0][0], hole[1][0]), (1.02, hole[0][1], hole[1][1]), white, without=((0, 0), (0, 1)))
    sides(scene, (1.02, 0, -1), (3.02, 2, 1), white, without=((0, 0),))
    rectangle(scene, (1.78, 1.98, -0.22), (2.25, 1.98, 0.16), (0, 0, 0), radiance, towards=-1)


def behind_a_channel(scene):
    """The window's lamp hangs in an annex behind a channel, beside its mouth, and faces away from it."""
    lamp, radiance = lamp_of(scene)
    scene.remove(lamp)
    low, high = (-6.039, 16.0, -30.738), (2.692, 26.413, -22.738)
    sides(scene, low, high, (0.578596,) * 3, without=((2, 0), (2, 1)))
    near = -30.738
    wall_with_hole(scene, (-17.03, 0.11, near), (16.9, 33.61, near), (*low[:2], near), (*high[:2], near), (0.8,) * 3)
    sides(scene, (-17.03, 0.11, -60.738), (16.9, 33.61, near), (0.8,) * 3, without=((2, 1),))
    rectangle(scene, (5.287, 15.833, -30.838), (14.313, 26.526, -30.838), (0, 0, 0), radiance, towards=-1)


SCENES = {  # name: (archive, edit)
    "veach-ajar": ("veach-ajar", None),
    "veach-ajar-flip": ("veach-ajar", flipped),
    "bathroom2": ("bathroom2", None),
    "bathroom2-channel": ("bathroom2", behind_a_channel),
    "cornell-box-portal": ("cornell-box", behind_a_hole),
}


def source_of(folder, archive):
    """The scene file of an archive that was unpacked below a folder, of Mitsuba 0.6 if there is a choice."""
    found = [path for path in Path(folder).rglob("scene.xml") if path.parent.name == archive]
    return min(found, key=lambda path: (ET.parse(path).getroot().get("version", "9"), str(path)), default=None)


@settings(FOLDER=Setting("", "that of the archives, unpacked"),
          OUT=Setting("", "folder for the scenes, afterwards SCENES of other benchmarks"))
def paper_scenes(bench):
    """Writes the paper's scenes into OUT, from Benedikt Bitterli's archives veach-ajar, bathroom2 and cornell-box for
    Mitsuba 0.6, each unpacked into a folder of its name below FOLDER. One that is not there is left out, with a word."""
    if not os.path.isdir(bench.settings.folder) or not bench.settings.out:
        raise Stop(2, "FOLDER=FOLDER OUT=FOLDER: expected the folder of the archives and one for the scenes")
    out = Path(bench.settings.out)
    out.mkdir(parents=True, exist_ok=True)
    made = 0
    for name, (archive, edit) in SCENES.items():
        source = source_of(bench.settings.folder, archive)
        if not source:
            bench.say(f"{name}: there is no {archive}/scene.xml in FOLDER, left out")
            continue
        tree = ET.parse(source)
        if edit:
            edit(tree.getroot())
        with tempfile.TemporaryDirectory() as scratch:
            edited = Path(scratch) / archive
            shutil.copytree(source.parent, edited)
            tree.write(edited / "scene.xml")
            run = checked([bench.store.program("tdpt-import"), edited / "scene.xml", "-o", out / f"{name}.glb"], may_fail=(3,))
        if run.status:
            bench.say(f"{name}: {run.errors.strip().splitlines()[-1]}")
            continue
        made += 1
    if not made:
        raise Stop(3, "none of the archives is there")
