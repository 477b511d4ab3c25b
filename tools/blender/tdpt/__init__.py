"""tdpt in Blender: finds the light portals of a scene, and renders through them."""
import bpy

from . import engine, finding, panel

bl_info = {
    "name": "tdpt: light portals",
    "description": "Finds the doors and windows through which light comes, and renders through them",
    "author": "The tdpt authors",
    "version": (0, 2, 0),
    "blender": (3, 4, 0),
    "location": "Render Properties > Light Portals",
    "category": "Render",
}

CLASSES = (*panel.CLASSES, *finding.CLASSES, *engine.CLASSES)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Scene.tdpt = bpy.props.PointerProperty(type=panel.TdptSettings)
    for other in panel.panels():
        other.COMPAT_ENGINES.add(engine.TdptEngine.bl_idname)


def unregister():
    for other in panel.panels():
        other.COMPAT_ENGINES.discard(engine.TdptEngine.bl_idname)
    del bpy.types.Scene.tdpt
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
