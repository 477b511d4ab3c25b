# two-rooms.py: two rooms with a door ajar, a lamp in the far one, modelled by nothing but this script.
#   blender -b --factory-startup --python-exit-code 1 -P testdata/blender/two-rooms.py -- OUT.blend
# Metres, +Z up. The camera stands in the near room (x 0..4), an area lamp hangs in the far one (x 4.1..7); brick and boards
# are images that are made here, a glass ball and a table stand in the light that comes in.

import math
import os
import sys

import bpy
import numpy
from mathutils import Matrix, Vector

DOOR = (1.0, 1.9, 2.0)  # y from, y to, height
DEPTH, HEIGHT = 3.0, 2.5  # of both rooms


def picture(name, pixels):
    height, width, _ = pixels.shape
    image = bpy.data.images.new(name, width, height)
    image.pixels[:] = numpy.dstack([pixels, numpy.ones((height, width))]).astype(numpy.float32).ravel()
    image.pack()
    return image


def bricks(n=256):
    y, x = numpy.mgrid[0:n, 0:n] / n
    row = numpy.floor(y * 8)
    along = (x * 4 + 0.5 * (row % 2)) % 1
    mortar = (numpy.minimum(along, 1 - along) < 0.025) | ((y * 8) % 1 < 0.1)
    stone = numpy.floor(x * 4 + 0.5 * (row % 2)) % 4
    tint = 0.85 + 0.15 * numpy.sin(12.9898 * row + 78.233 * stone)
    red = numpy.stack([0.66 * tint, 0.36 * tint, 0.27 * tint], axis=-1)
    return numpy.where(mortar[..., None], 0.75, red)


def boards(n=256):
    y, x = numpy.mgrid[0:n, 0:n] / n
    board = numpy.floor(y * 8)
    grain = 0.06 * numpy.sin(40 * y * 6.28 + 3 * numpy.sin(6.28 * x + board)) + 0.12 * numpy.sin(5.1 * board)
    wood = numpy.stack([0.62 + grain, 0.45 + 0.8 * grain, 0.29 + 0.6 * grain], axis=-1)
    return numpy.where((((y * 8) % 1) < 0.04)[..., None], 0.2, wood)


def material(name, colour=(0.8, 0.8, 0.8), image=None, roughness=1.0, transmission=0.0, specular=0.0):
    m = bpy.data.materials.new(name)
    m.use_nodes = True
    shader = m.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*colour, 1)
    shader.inputs["Roughness"].default_value = roughness
    shader.inputs["Specular" if "Specular" in shader.inputs else "Specular IOR Level"].default_value = specular
    shader.inputs["Transmission" if "Transmission" in shader.inputs else "Transmission Weight"].default_value = transmission
    if image:
        texture = m.node_tree.nodes.new("ShaderNodeTexImage")
        texture.image = image
        m.node_tree.links.new(texture.outputs["Color"], shader.inputs["Base Color"])
    return m


def box(name, low, high, made_of, tile=1.0):
    """A box with texture coordinates of `tile` metres."""
    low, high = Vector(low), Vector(high)
    bpy.ops.mesh.primitive_cube_add(size=1, location=(low + high) / 2)
    thing = bpy.context.object
    thing.name = name
    thing.data.transform(Matrix.Diagonal((*(high - low), 1)))
    thing.data.materials.append(made_of)
    for face in thing.data.polygons:
        axis = max(range(3), key=lambda c: abs(face.normal[c]))
        u, v = ((1, 2), (0, 2), (0, 1))[axis]
        for loop in face.loop_indices:
            p = thing.data.vertices[thing.data.loops[loop].vertex_index].co + thing.location
            thing.data.uv_layers.active.data[loop].uv = (p[u] / tile, p[v] / tile)
    return thing


def walls(brick, plaster, wood):
    t = 0.1
    box("floor", (-t, -t, -t), (7 + t, DEPTH + t, 0), wood)
    box("ceiling", (-t, -t, HEIGHT), (7 + t, DEPTH + t, HEIGHT + t), plaster)
    box("west", (-t, -t, 0), (0, DEPTH + t, HEIGHT), plaster)
    box("east", (7, -t, 0), (7 + t, DEPTH + t, HEIGHT), plaster)
    box("south", (0, -t, 0), (7, 0, HEIGHT), plaster)
    box("north", (0, DEPTH, 0), (7, DEPTH + t, HEIGHT), brick)
    low, high, top = DOOR
    box("between, left", (4, 0, 0), (4 + t, low, HEIGHT), plaster)
    box("between, right", (4, high, 0), (4 + t, DEPTH, HEIGHT), plaster)
    box("lintel", (4, low, top), (4 + t, high, HEIGHT), plaster)


def door(wood):
    """Hinged at its northern edge, ajar into the near room: the gap is 9 cm wide."""
    low, high, top = DOOR
    width = high - low - 0.02
    leaf = box("door", (-0.02, -width, 0.01), (0.02, 0, top - 0.01), wood)
    turn = bpy.data.objects.new("hinge", None)
    turn.location = (3.97, high - 0.01, 0)
    turn.rotation_euler = (0, 0, -math.radians(6))
    bpy.context.scene.collection.objects.link(turn)
    leaf.parent = turn


def furniture(wood, glass):
    box("table", (1.6, 1.2, 0.68), (2.6, 2.0, 0.72), wood)
    for x in (1.65, 2.5):
        for y in (1.25, 1.9):
            box("leg", (x, y, 0), (x + 0.05, y + 0.05, 0.68), wood)
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.14, location=(2.2, 1.5, 0.86), segments=48, ring_count=24)
    bpy.ops.object.shade_smooth()
    bpy.context.object.name = "ball"
    bpy.context.object.data.materials.append(glass)


def lamp_and_camera():
    lamp = bpy.data.lights.new("lamp", "AREA")
    lamp.shape, lamp.size, lamp.size_y, lamp.energy = "RECTANGLE", 0.8, 0.4, 200
    hung = bpy.data.objects.new("lamp", lamp)
    hung.location = (6.3, 2.3, HEIGHT - 0.01)
    camera = bpy.data.cameras.new("near room")
    camera.angle = 1.15
    stand = bpy.data.objects.new("near room", camera)
    stand.location = (0.25, 0.3, 1.5)
    stand.rotation_euler = (Vector((3.2, 1.9, 0.95)) - stand.location).to_track_quat("-Z", "Y").to_euler()
    scene = bpy.context.scene
    for thing in (hung, stand):
        scene.collection.objects.link(thing)
    scene.camera = stand
    scene.render.resolution_x, scene.render.resolution_y = 320, 240


def main():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    brick, wood = material("brick", image=picture("bricks", bricks())), material("boards", image=picture("boards", boards()))
    plaster = material("plaster", (0.78, 0.76, 0.72))
    glass = material("glass", (1, 1, 1), roughness=0, transmission=1, specular=0.5)
    walls(brick, plaster, wood)
    door(wood)
    furniture(wood, glass)
    lamp_and_camera()
    bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(sys.argv[sys.argv.index("--") + 1]))


main()
