"""Objects as the picture shows them: without what is not rendered, and instances that the exporter does not know."""
import bpy

from said import say

LOST = {"VOLUME": "volume", "GPENCIL": "grease pencil", "GREASEPENCIL": "grease pencil", "CURVES": "hair", "POINTCLOUD": "points"}


def as_rendered():
    """What the viewport shows otherwise than the picture."""
    for collection in bpy.data.collections:
        collection.hide_viewport = False
    for thing in bpy.data.objects:
        thing.hide_viewport = False
        for modifier in thing.modifiers:
            modifier.show_viewport = modifier.show_render
            if modifier.type in ("SUBSURF", "MULTIRES"):
                modifier.levels = modifier.render_levels
        for system in thing.particle_systems:
            system.settings.display_percentage = 100
    for curve in bpy.data.curves:
        curve.resolution_u = curve.render_resolution_u or curve.resolution_u


def drop_excluded(layer):
    """Collections that the view layer leaves out, or that are not rendered, are no part of the picture; their instances are."""
    for child in layer.children:
        if child.exclude or child.collection.hide_render:
            layer.collection.children.unlink(child.collection)
        else:
            drop_excluded(child)


def placed():
    """All objects, those of instanced collections too."""
    found, new = set(), set(bpy.context.scene.objects)
    while new:
        found |= new
        new = {o for thing in new if thing.instance_collection for o in thing.instance_collection.all_objects} - found
    return sorted(found, key=lambda o: o.name)


def make_real():
    """Instances by geometry nodes, particles, vertices and faces become objects; the exporter knows those of collections
    alone."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    meshes, made = {}, {}
    for instance in depsgraph.object_instances:
        parent = instance.parent
        if not instance.is_instance or not parent or parent.original.instance_type == "COLLECTION":
            continue
        original = instance.object.original
        if parent.original.hide_render or original == parent.original or instance.particle_system:
            continue  # the exporter has particles itself; text and curves are instances of themselves
        if not instance.show_self:
            continue
        if instance.object.type != "MESH":
            if instance.object.type == "LIGHT":
                say(f"object {parent.original.name}: its instances of lamp {original.name} are lost")
            continue
        key = instance.object.data
        if key not in meshes:
            mesh = bpy.data.meshes.new_from_object(instance.object)
            meshes[key] = mesh
        made.setdefault(parent.original, []).append((meshes[key], instance.matrix_world.copy()))
    for parent, copies in sorted(made.items(), key=lambda pair: pair[0].name):
        for number, (mesh, matrix) in enumerate(copies):
            thing = bpy.data.objects.new(f"{parent.name} {number}", mesh)
            thing.matrix_world = matrix
            bpy.context.scene.collection.objects.link(thing)
        say(f"object {parent.name}: {len(copies)} instances became objects")
        if parent.instance_type in ("VERTS", "FACES"):
            parent.instance_type = "NONE"
            for child in parent.children:
                child.hide_render = True


def tell_of_lost(things):
    for thing in things:
        if thing.type in LOST and not thing.hide_render:
            say(f"object {thing.name}: is {LOST[thing.type]}, which is lost")
        for particles in thing.particle_systems if thing.type == "MESH" else ():
            if particles.settings.type == "HAIR" and particles.settings.render_type == "PATH":
                say(f"object {thing.name}: its hair is lost")
