"""Objects as the picture shows them: without what is not rendered, and instances that the exporter does not know."""
import bpy

from losses import LIGHT, LOOK, NOTE, say, say_all

EXPORTED = ("MESH", "CURVE", "SURFACE", "FONT", "LIGHT", "CAMERA")
UNSEEN = ("EMPTY", "ARMATURE", "LATTICE", "SPEAKER", "LIGHT_PROBE")
FLAGS = {  # of an object: (what it is in the picture, the harm of another value, what that means)
    "visible_camera": (True, LIGHT, "is invisible to the camera"),
    "visible_diffuse": (True, LIGHT, "is invisible to diffuse rays"),
    "visible_glossy": (True, LOOK, "is invisible in reflections"),
    "visible_transmission": (True, LOOK, "is invisible through glass"),
    "visible_shadow": (True, LIGHT, "casts no shadow"),
    "is_holdout": (False, LOOK, "is a holdout"),
    "is_shadow_catcher": (False, LOOK, "is a shadow catcher"),
}


def as_rendered():
    """What the viewport shows otherwise than the picture."""
    for render in (scene.render for scene in bpy.data.scenes):
        render.simplify_subdivision = render.simplify_subdivision_render
        render.simplify_child_particles = render.simplify_child_particles_render
    for layer in (layer for scene in bpy.data.scenes for layer in scene.view_layers):  # eyes hide nothing in a picture
        parts = [layer.layer_collection]
        for part in parts:
            part.hide_viewport = False
            parts += part.children
        for thing in layer.objects:
            thing.hide_set(False, view_layer=layer)
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
    alone. Returns [(lamp, matrix)], instances of all kinds too."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    meshes, made, lamps = {}, {}, []
    for instance in depsgraph.object_instances:
        parent = instance.parent
        if instance.object.type == "LIGHT":
            lamp = instance.object.original
            if not lamp.hide_render and not (instance.is_instance and parent and parent.original.hide_render):
                lamps.append((lamp, instance.matrix_world.copy()))
            continue
        if not instance.is_instance or not parent or parent.original.instance_type == "COLLECTION":
            continue
        original = instance.object.original
        if parent.original.hide_render or original == parent.original:
            continue  # text and curves are instances of themselves
        if not instance.show_self or instance.object.type != "MESH":
            continue
        key = instance.object.data
        if key not in meshes:
            meshes[key] = bpy.data.meshes.new_from_object(instance.object)
        made.setdefault(parent.original, []).append((meshes[key], instance.matrix_world.copy()))
    for parent, copies in sorted(made.items(), key=lambda pair: pair[0].name):
        for number, (mesh, matrix) in enumerate(copies):
            thing = bpy.data.objects.new(f"{parent.name} {number}", mesh)
            thing.matrix_world = matrix
            bpy.context.scene.collection.objects.link(thing)
        say(NOTE, f"object {parent.name}: {len(copies)} instances became objects")
        for particles in parent.particle_systems:  # the exporter knows those whose objects are rendered themselves
            particles.settings.render_type = "NONE"
        if not parent.show_instancer_for_render:
            parent.hide_render = True
        if parent.instance_type in ("VERTS", "FACES"):
            parent.instance_type = "NONE"
            for child in parent.children:
                child.hide_render = True
    return lamps


def report_objects(things):
    for thing in [t for t in things if not t.hide_render]:
        surface = thing.type in EXPORTED and thing.type not in ("CAMERA", "LIGHT")
        linking = getattr(thing, "light_linking", None)
        facts = [(thing.type not in EXPORTED and thing.type not in UNSEEN, LIGHT if thing.type in ("VOLUME", "META") else LOOK,
                  f"is of type {thing.type.capitalize()}, which is lost"),
                 (linking and (linking.receiver_collection or linking.blocker_collection), LIGHT,
                  "its light linking is lost: it lights and shades everything")]
        for flag, (usual, harm, words) in FLAGS.items():
            # Lamps are invisible to the camera by default, and area lamps always show here, which is said of each.
            relevant = surface or thing.type == "LIGHT" and usual and flag != "visible_camera"
            facts.append((relevant and getattr(thing, flag, usual) != usual, harm, f"{words} in Cycles; here it is as others"))
        for particles in thing.particle_systems if thing.type == "MESH" else ():
            facts.append((particles.settings.type == "HAIR" and particles.settings.render_type == "PATH", LOOK, "its hair is lost"))
        say_all(f"object {thing.name}", facts)
