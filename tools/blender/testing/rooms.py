"""Scenes for blender_test.py, modelled by script: diffuse rooms with every kind of light. Metres, +Z up."""
import math

import bpy
from mathutils import Vector


def empty():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = 96, 64
    scene.render.resolution_percentage = 100
    return scene


def diffuse(name, colour=(0.7, 0.7, 0.7)):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    shader, output = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeOutputMaterial")
    shader.inputs["Color"].default_value = (*colour, 1)
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return material


def box(name, low, high, material=None, collection=None, holes=()):
    """A box; holes: of its sides, "-x" and so on."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    corners = [(x, y, z) for x in (x0, x1) for y in (y0, y1) for z in (z0, z1)]
    sides = {"-x": (0, 1, 3, 2), "+x": (4, 6, 7, 5), "-y": (0, 4, 5, 1), "+y": (2, 3, 7, 6), "-z": (0, 2, 6, 4), "+z": (1, 5, 7, 3)}
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners, [], [face for side, face in sides.items() if side not in holes])
    if material:
        mesh.materials.append(material)
    thing = bpy.data.objects.new(name, mesh)
    (collection or bpy.context.scene.collection).objects.link(thing)
    return thing


def wall(name, axis, at, low, high, hole, material, thick=0.1):
    """Across `axis` (0 or 1) from `low` to `high` (along the other axis) and from the floor to 2.5 m, with a hole (low, high,
    bottom, top)."""
    a, b, bottom, top = hole
    parts = [(low, a, 0, 2.5), (b, high, 0, 2.5), (a, b, 0, bottom), (a, b, top, 2.5)]
    for number, (c, d, z0, z1) in enumerate(parts):
        if d - c > 1e-6 and z1 - z0 > 1e-6:
            near, far = [c, c, z0], [d, d, z1]
            near[axis], far[axis] = at, at + thick
            box(f"{name} {number}", near, far, material)


def camera(scene, eye, target, lens=24.0):
    data = bpy.data.cameras.new("camera")
    data.lens = lens
    thing = bpy.data.objects.new("camera", data)
    thing.location = eye
    thing.rotation_euler = (Vector(target) - Vector(eye)).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(thing)
    scene.camera = thing
    return thing


def lamp(scene, kind, at, energy, name="lamp", **more):
    data = bpy.data.lights.new(name, kind)
    data.energy = energy
    for key, value in more.items():
        setattr(data, key, value)
    thing = bpy.data.objects.new(name, data)
    thing.location = at
    scene.collection.objects.link(thing)
    return thing


def three_rooms():
    """In a row along x; the doors are 0.8 m and 0.3 m wide, the lamp hangs in the last."""
    scene = empty()
    grey = diffuse("grey")
    box("floor", (0, 0, -0.1), (9, 3, 0), grey)
    box("ceiling", (0, 0, 2.5), (9, 3, 2.6), grey)
    for name, low, high in (("west", (-0.1, 0, 0), (0, 3, 2.5)), ("east", (9, 0, 0), (9.1, 3, 2.5)),
                            ("south", (0, -0.1, 0), (9, 0, 2.5)), ("north", (0, 3, 0), (9, 3.1, 2.5))):
        box(name, low, high, grey)
    wall("first", 0, 2.95, 0, 3, (1.2, 2.0, 0, 2.0), grey)
    wall("second", 0, 5.95, 0, 3, (1.0, 1.3, 0, 2.0), grey)
    lamp(scene, "AREA", (7.5, 1.5, 2.3), 100, shape="RECTANGLE", size=0.5, size_y=0.8)
    camera(scene, (0.5, 0.5, 1.5), (3, 2, 1))
    bpy.context.view_layer.update()
    return scene


def sky(scene, image):
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    tree = scene.world.node_tree
    background = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeBackground")
    picture = tree.nodes.new("ShaderNodeTexEnvironment")
    picture.image = image
    tree.links.new(picture.outputs["Color"], background.inputs["Color"])
    return picture


def quarters():
    """A sky whose quarters differ: what is turned or mirrored shows."""
    import numpy

    image = bpy.data.images.new("quarters", 64, 32, float_buffer=True, is_data=True)
    pixels = numpy.zeros((32, 64, 4), numpy.float32)
    for quarter, colour in enumerate(((4, 1, 1), (1, 4, 1), (1, 1, 4), (3, 3, 1))):
        pixels[16:, 16 * quarter : 16 * (quarter + 1), :3] = colour
    pixels[:16, :, :3] = 0.2
    pixels[..., 3] = 1
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    return image


def window_room(image=None):
    """A room with a window to a sky in +x, and a door in -x to a room where the camera stands."""
    scene = empty()
    grey = diffuse("grey")
    box("floor", (0, 0, -0.1), (6, 3, 0), grey)
    box("ceiling", (0, 0, 2.5), (6, 3, 2.6), grey)
    box("west", (-0.1, 0, 0), (0, 3, 2.5), grey)
    box("south", (0, -0.1, 0), (6, 0, 2.5), grey)
    box("north", (0, 3, 0), (6, 3.1, 2.5), grey)
    wall("outer", 0, 6, 0, 3, (0.8, 2.2, 0.9, 2.1), grey)
    wall("inner", 0, 2.95, 0, 3, (1.2, 2.0, 0, 2.0), grey)
    sky(scene, image or quarters())
    camera(scene, (0.4, 0.4, 1.6), (2.5, 2, 1))
    bpy.context.view_layer.update()
    return scene


def lamps_room():
    """One room with a point, a spot, a sun through a skylight, an instanced collection, particles of geometry nodes or
    vertices, and a modifier."""
    scene = empty()
    grey, red = diffuse("grey"), diffuse("red", (0.8, 0.2, 0.1))
    box("floor", (0, 0, -0.1), (4, 4, 0), grey)
    box("west", (-0.1, 0, 0), (0, 4, 2.5), grey)
    box("south", (0, -0.1, 0), (4, 0, 2.5), grey)
    box("north", (0, 4, 0), (4, 4.1, 2.5), red)
    lamp(scene, "POINT", (1, 1, 2), 60, "point", shadow_soft_size=0)
    spot = lamp(scene, "SPOT", (3, 1, 2.4), 80, "spot", shadow_soft_size=0, spot_size=1.2, spot_blend=0)
    spot.rotation_euler = (0, 0, 0)
    sun = lamp(scene, "SUN", (0, 0, 5), 1.5, "sun", angle=0)
    sun.rotation_euler = (0.5, 0.2, 0)
    disc = lamp(scene, "AREA", (2, 0.02, 1.5), 30, "disc", shape="DISK", size=0.4)  # at the wall behind the camera
    disc.rotation_euler, disc.scale = (math.pi / 2, 0, 0), (1.5, 1.5, 1.5)
    chairs = bpy.data.collections.new("chairs")
    box("seat", (-0.2, -0.2, 0), (0.2, 0.2, 0.5), red, chairs)
    for number in range(2):
        thing = bpy.data.objects.new(f"chair {number}", None)
        thing.instance_type, thing.instance_collection = "COLLECTION", chairs
        thing.location = (1.2 + number, 2, 0)
        scene.collection.objects.link(thing)
    row = box("post", (2.9, 2.4, 0), (3.0, 2.5, 1), grey)
    array = row.modifiers.new("array", "ARRAY")
    array.count, array.relative_offset_displace = 3, (2.0, 0, 0)
    base = box("base", (0.2, 3.2, 0), (0.8, 3.6, 0.001), grey)
    base.instance_type = "VERTS"
    ball = box("ball", (-0.05, -0.05, 0), (0.05, 0.05, 0.3), red)
    ball.parent = base
    camera(scene, (3.8, 0.3, 1.7), (1, 3, 0.6), 22)
    bpy.context.view_layer.update()
    return scene


SCENES = {"three rooms": three_rooms, "window": window_room, "lamps": lamps_room}
