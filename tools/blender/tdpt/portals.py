"""The portals of a scene: meshes in a collection, which can be moved, hidden and edited, and area lamps for Cycles."""
import math
import os

import bpy
from mathutils import Matrix, Vector
from mathutils.geometry import box_fit_2d, normal

from . import gltf_file

NAME = "Light portals"
FOR_CYCLES = "Windows for Cycles"
MARK = "tdpt_portals"  # of the collection
FOUND = "tdpt_found"  # of what was put there by us, which the next search replaces
OF_THE_SKY = 0.1  # as portalfit --for: from here on `sky` makes a window


def z_up(v):
    return Vector((v[0], -v[2], v[1]))


def lets_in_sky(figures):
    return figures.get("sky", 1.0) >= OF_THE_SKY


def collection_of(scene):
    return next((c for c in scene.collection.children_recursive if c.get(MARK) == "meshes"), None)


def make_collection(parent, name, mark):
    found = next((c for c in parent.children if c.get(MARK) == mark), None)
    if not found:
        found = bpy.data.collections.new(name)
        found[MARK] = mark
        parent.children.link(found)
    return found


def rectangle(corners):
    """(matrix, width, height) of the rectangle of least area around the corners of a polygon, in its plane, for a lamp that shines
    along its normal, which is the lamp's -Z."""
    front = normal(corners)
    turn = front.to_track_quat("-Z", "Y").to_matrix()
    turn @= Matrix.Rotation(-box_fit_2d([(turn.transposed() @ c).xy for c in corners]), 3, "Z")
    if abs(turn[2][0]) > abs(turn[2][1]):  # height along the more vertical side
        turn @= Matrix.Rotation(math.pi / 2, 3, "Z")
    sides = list(zip(*(turn.transposed() @ c for c in corners)))
    low, high = (Vector(map(end, sides)) for end in (min, max))
    matrix = Matrix.Translation(turn @ ((low + high) / 2)) @ turn.to_4x4()
    return matrix, *(high - low).xy


def remove_found(collection):
    for thing in list(collection.objects):
        if thing.get(FOUND):
            data = thing.data
            bpy.data.objects.remove(thing)
            if not data.users:
                (bpy.data.meshes if isinstance(data, bpy.types.Mesh) else bpy.data.lights).remove(data)


def mesh_of(name, corners, triangles, figures):
    middle = sum(corners, Vector((0, 0, 0))) / len(corners)
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([c - middle for c in corners], [], triangles)
    thing = bpy.data.objects.new(name, mesh)
    thing.matrix_world = Matrix.Translation(middle)
    thing.hide_render = True  # never part of a picture
    thing.display_type = "WIRE"
    thing.show_in_front = thing.show_name = True
    thing[FOUND] = True
    for key in ("area", "flux_share", "sky"):
        if key in figures:
            thing[key] = figures[key]
    return thing


def lamp_of(name, corners):
    lamp = bpy.data.lights.new(name, "AREA")
    lamp.shape = "RECTANGLE"
    matrix, lamp.size, lamp.size_y = rectangle(corners)
    lamp.energy = 0  # in renderers that do not know portals
    lamp.cycles.is_portal = True
    thing = bpy.data.objects.new(name, lamp)
    thing.matrix_world = matrix
    thing[FOUND] = True
    return thing


def place(scene, found):
    """Puts the portals of portalfit into the scene, in place of those of the last time. found: as read_portals() gives them."""
    meshes = collection_of(scene) or make_collection(scene.collection, NAME, "meshes")
    lamps = make_collection(meshes, FOR_CYCLES, "lamps")
    for collection in (meshes, lamps):
        remove_found(collection)
    for name, corners, triangles, figures in found:
        corners = [z_up(c) for c in corners]
        meshes.objects.link(mesh_of(name, corners, triangles, figures))
        if lets_in_sky(figures):
            lamps.objects.link(lamp_of(name + " for Cycles", corners))
    return meshes


def lamps_of(scene):
    meshes = collection_of(scene)
    inner = meshes and next((c for c in meshes.children if c.get(MARK) == "lamps"), None)
    return [o for o in inner.objects if o.type == "LIGHT"] if inner else []


def use_in_cycles(scene, yes):
    for lamp in lamps_of(scene):
        lamp.hide_render = not yes


def is_seen(thing, layer):
    try:
        return thing.visible_get(view_layer=layer)
    except RuntimeError:  # excluded from the layer
        return False


def write_used(scene, path, layer=0):
    """The portals as they now stand, but for those that are hidden in this view layer, for tdpt --portal; how many."""
    portals, meshes = [], collection_of(scene)
    for thing in meshes.objects if meshes else ():
        if thing.type != "MESH" or not is_seen(thing, scene.view_layers[layer]):
            continue
        mesh = thing.data
        mesh.calc_loop_triangles()
        corners = [thing.matrix_world @ v.co for v in mesh.vertices]
        triangles = [tuple(t.vertices) for t in mesh.loop_triangles]
        if thing.matrix_world.determinant() < 0:
            triangles = [(a, c, b) for a, b, c in triangles]
        if triangles:
            portals.append((thing.name, [(c.x, c.z, -c.y) for c in corners], triangles))
    if portals:
        gltf_file.write_portals(path, portals)
    elif os.path.exists(path):
        os.remove(path)
    return len(portals)


def reason_in(lines):
    """Why tdpt has found none, as it says itself; it says nothing of a search that it has kept."""
    return next((line.split(no, 1)[1] for line in lines for no in (": no bottleneck: ", ": no portal: ") if no in line), "")


def words_of(found, why):
    """What was found, in a sentence; `why`: the reason where it is nothing."""
    if not found:
        return f"No portal: {why}" if why else "No portal"
    windows = sum(lets_in_sky(figures) and figures.get("sky", 0) > 0 for *_, figures in found)
    count = f"{len(found)} portal{'s' if len(found) > 1 else ''}"
    if not windows:
        return count
    return f"{count}, of which {windows} let{'s' if windows == 1 else ''} in the sky"
