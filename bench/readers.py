"""Do other programs read in a text of `portalfit --for` what the portals are? In the Python of `make peers`, or a Blender:
  readers.py cycles|mitsuba|usd PORTALS.glb TEXT
  blender -b --factory-startup --python-exit-code 1 --python readers.py -- cycles PORTALS.glb TEXT
Prints what they have read; exit code 1, with a sentence for each fault, where it is something else.

cycles   Blender runs the script; each lamp is held against its portal.
usd      usd-core: its validators, and its API, as a sublayer of a stage that has a dome light.
mitsuba  Its parser. Version 3.9.1 has no emitter `portal`: a stand-in takes its place and tells where it was put."""
import os
import sys
import tempfile
from collections import namedtuple
from pathlib import Path

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))  # Blender does not
from formats import glb_parse, gltf_array, placed

NEAR = 1e-5  # metres, and of a unit vector: files and readers have single precision

# frame: a matrix to the world whose x and y are along width and height; light: which way along its z the light goes
Light = namedtuple("Light", "frame width height light")
OF_THE_SKY = 0.1  # least figure `sky` of a portal that is written as a light; others are left out


def complaints(corners, normal, light):
    """What is wrong with a rectangle of another program for the portal with these corners, whose light goes to `normal`:
    sentences."""
    frame = np.array(light.frame, float)
    axes, origin = frame[:3, :3], frame[:3, 3]
    at = (np.asarray(corners) - origin) @ axes
    found = [(not np.allclose(axes.T @ axes, np.eye(3), atol=NEAR), "is scaled or sheared"),
             (not np.isclose(np.linalg.det(axes), 1, atol=NEAR), "is mirrored"),
             (not np.allclose(light.light * axes[:, 2], normal, atol=1e-4),
              f"sends light along {light.light * axes[:, 2]}, expected {normal}"),
             (abs(at[:, 2]).max() > NEAR, f"lies {abs(at[:, 2]).max()} m off the plane")]
    for axis, size in ((0, light.width), (1, light.height)):
        low, high = at[:, axis].min(), at[:, axis].max()
        found.append((abs(low + size / 2) > NEAR or abs(high - size / 2) > NEAR,
                      f"has side {axis} from {-size / 2} to {size / 2}, the portal from {low} to {high}"))
    return [words for wrong, words in found if wrong]


def portals_of(path):
    """{name: (corners, the way of the light)} of portals as glTF that let in the sky."""
    document, binary = glb_parse(Path(path).read_bytes())
    portals = {}
    for node, matrix in placed(document, document["scenes"][0]["nodes"], np.eye(4)):
        if "mesh" not in node or node["extras"].get("sky", 1) < OF_THE_SKY:
            continue
        for primitive in document["meshes"][node["mesh"]]["primitives"]:
            at = gltf_array(document, binary, primitive["attributes"]["POSITION"]) @ matrix[:3, :3].T + matrix[:3, 3]
            a, b, c = at[gltf_array(document, binary, primitive["indices"]).ravel()[:3]]
            normal = np.cross(b - a, c - a)
            portals[node["name"].replace(".", "_")] = at, normal / np.linalg.norm(normal)
    return portals


def cycles(path):
    """({name: Light}, sentences, what was run). An area lamp shines along its -Z; Blender's x, y, z are x, -z, y."""
    import bpy
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for _ in range(2):  # run again, it replaces its lamps
        exec(compile(Path(path).read_text(encoding="utf-8"), path, "exec"), {"__name__": "__main__"})
    bpy.context.view_layer.update()
    upright = np.array([(1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, 0, 0, 1)], float)
    lamps = {o.name: o for o in bpy.context.scene.objects if o.type == "LIGHT"}
    wrong = [f"{name} is no rectangular area lamp that is a portal" for name, o in lamps.items() if
             o.data.type != "AREA" or o.data.shape != "RECTANGLE" or not o.data.cycles.is_portal]
    return {name.replace(".", "_"): Light(upright @ np.array(o.matrix_world), o.data.size, o.data.size_y, -1)
            for name, o in lamps.items() if not wrong}, wrong, f"Blender {bpy.app.version_string}"


def mitsuba(path):
    """The same."""
    import mitsuba as mi
    mi.set_variant("scalar_rgb")
    lights = {}

    class Portal(mi.Emitter):
        def __init__(self, properties):
            mi.Emitter.__init__(self, properties)
            matrix = np.array(properties["to_world"].matrix, float)
            half = np.linalg.norm(matrix[:3, :2], axis=0)  # The square has sides of 2.
            lights[properties.id()] = Light(matrix / [*half, 1, 1], *(2 * half), 1)

    mi.register_emitter("portal", Portal)
    mi.load_string('<scene version="3.0.0"><emitter type="constant"/><include filename="$text"/></scene>',
                   text=os.path.abspath(path))
    return lights, [], f"Mitsuba {mi.__version__}"


ROOM = """#usda 1.0
(
    defaultPrim = "Sky"
    metersPerUnit = 1
    upAxis = "Y"
    subLayers = [@%s@]
)
def DomeLight "Sky"
{
}
"""


def usd(path):
    """The same."""
    from pxr import Usd, UsdGeom, UsdLux, UsdValidation
    with tempfile.TemporaryDirectory() as folder:
        room, text = os.path.join(folder, "room.usda"), os.path.join(folder, "portals.usda")
        for name, content in ((room, ROOM % "./portals.usda"), (text, Path(path).read_text(encoding="utf-8"))):
            Path(name).write_text(content, encoding="utf-8")
        validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
        wrong = [f"{error.GetName()}: {error.GetMessage()}" for name in (text, room)
                 for error in UsdValidation.ValidationContext(validators).Validate(Usd.Stage.Open(name))]
        stage = Usd.Stage.Open(room)
        lights, paths = {}, []
        for prim in stage.Traverse():
            if prim.IsA(UsdLux.PortalLight):
                portal = UsdLux.PortalLight(prim)
                matrix = UsdGeom.XformCache().GetLocalToWorldTransform(prim)
                size = portal.GetWidthAttr().Get(), portal.GetHeightAttr().Get()
                lights[prim.GetName()] = Light(np.array(matrix).T, *size, -1)
                paths.append(prim.GetPath())
        named = UsdLux.DomeLight(stage.GetPrimAtPath("/Sky")).GetPortalsRel().GetTargets()
        if sorted(named) != sorted(paths):
            wrong.append(f"the dome light names {named}, expected {paths}")
    return lights, wrong, f"USD {'.'.join(map(str, Usd.GetVersion()[1:]))}, {len(validators)} validators"


def main(reader, glb, text):
    portals = portals_of(glb)
    lights, wrong, said = {"cycles": cycles, "mitsuba": mitsuba, "usd": usd}[reader](text)
    if sorted(lights) != sorted(portals):
        wrong.append(f"lights {sorted(lights)}, expected {sorted(portals)}")
    for name in sorted(set(lights) & set(portals)):
        wrong += [f"{name} {sentence}" for sentence in complaints(*portals[name], lights[name])]
    for sentence in wrong:
        print(f"readers.py: {sentence}", file=sys.stderr)
    print(f"{len(lights)} lights for {len(portals)} portals, read by {said}")
    return 1 if wrong or not portals else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[-3:]))
