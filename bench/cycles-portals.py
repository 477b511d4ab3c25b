# cycles-portals.py: does what `portalfit --for cycles` writes set Cycles' portals where the portals are?
#   blender -b --factory-startup --python-exit-code 1 --python cycles-portals.py -- PORTALS.glb PORTALS.py
# Blender's importer reads the portals' meshes, the script runs, and each lamp is held against its mesh.

import argparse
import os
import sys

import numpy

# The importer of Blender 3.4 still asks for numpy.bool, which numpy 1.24 no longer has.
if "bool" not in numpy.__dict__:
    numpy.bool = bool

import bpy

NEAR = 1e-5  # metres, and of a unit vector: both files come to single precision


def options():
    p = argparse.ArgumentParser(prog="cycles-portals.py")
    p.add_argument("glb")
    p.add_argument("script")
    return p.parse_args(sys.argv[sys.argv.index("--") + 1 :])


def lamps():
    return {o.name: o for o in bpy.context.scene.objects if o.type == "LIGHT"}


def complaints(mesh, lamp):
    """What is wrong with the lamp of a portal, sentences."""
    wrong = []
    light = lamp.data
    if light.type != "AREA" or light.shape != "RECTANGLE" or not light.cycles.is_portal:
        wrong.append("is no rectangular area lamp that is a portal")
    corners = numpy.array([mesh.matrix_world @ v.co for v in mesh.data.vertices])
    frame = numpy.array(lamp.matrix_world)
    x, y, z, origin = (frame[:3, i] for i in range(4))
    if not numpy.allclose(frame[:3, :3].T @ frame[:3, :3], numpy.eye(3), atol=NEAR):
        wrong.append("is scaled or sheared")
    if not numpy.isclose(numpy.linalg.det(frame), 1, atol=NEAR):
        wrong.append("is mirrored")
    # Light goes to the front of the mesh; an area lamp shines along its -Z.
    turn = mesh.matrix_world.to_3x3()
    normal = numpy.array((turn @ mesh.data.polygons[0].normal).normalized())
    if not numpy.allclose(-z, normal, atol=1e-4):
        wrong.append(f"shines along {-z}, expected {normal}")
    at = (corners - origin) @ numpy.array([x, y, z]).T
    if abs(at[:, 2]).max() > NEAR:
        wrong.append(f"lies {abs(at[:, 2]).max()} m off the plane")
    for axis, size in ((0, light.size), (1, light.size_y)):
        low, high = at[:, axis].min(), at[:, axis].max()
        if abs(low + size / 2) > NEAR or abs(high - size / 2) > NEAR:
            wrong.append(f"has side {axis} from {-size / 2} to {size / 2}, the portal from {low} to {high}")
    return wrong


def main():
    a = options()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=os.path.abspath(a.glb))
    meshes = {o.name: o for o in bpy.context.scene.objects if o.type == "MESH"}
    for o in meshes.values():
        o.name = "mesh of " + o.name  # The lamps want these names.
    with open(a.script, encoding="utf-8") as script:
        program = compile(script.read(), a.script, "exec")
    for _ in range(2):  # Run again, it replaces its lamps.
        exec(program, {"__name__": "__main__"})
    bpy.context.view_layer.update()
    wrong = []
    if sorted(lamps()) != sorted(meshes):
        wrong.append(f"lamps {sorted(lamps())}, expected {sorted(meshes)}")
    for name, mesh in meshes.items():
        if name in lamps():
            wrong += [f"{name} {sentence}" for sentence in complaints(mesh, lamps()[name])]
    for sentence in wrong:
        print(f"cycles-portals.py: {sentence}", file=sys.stderr)
    print(f"{len(lamps())} lamps for {len(meshes)} portals")
    sys.exit(1 if wrong or not meshes else 0)


main()
