"""Settings and panels in the render properties, and the preferences."""
import bpy

from . import finding, portals, programs
from .engine import Rendered


class TdptSettings(bpy.types.PropertyGroup):
    samples: bpy.props.IntProperty(name="Samples", description="Samples per pixel", default=64, min=1, soft_max=4096)
    time: bpy.props.FloatProperty(
        name="Time Limit", description="Seconds for a frame; 0 for no limit", default=0, min=0, subtype="TIME", unit="TIME_ABSOLUTE"
    )
    noise: bpy.props.FloatProperty(
        name="Noise Target",
        description="Render until the mean squared relative error is this, within the samples and the time; 0 for no target",
        default=0, min=0, soft_max=1, precision=4,
    )
    max_depth: bpy.props.IntProperty(
        name="Longest Path", description="Edges of the longest path, 2 for direct light alone; 0 for no limit", default=0, min=0, max=1024
    )
    seed: bpy.props.IntProperty(name="Seed", default=1, min=0)
    animate_seed: bpy.props.BoolProperty(name="Seed by Frame", description="Another noise in each frame", default=True)
    denoise: bpy.props.BoolProperty(name="Denoise", description="Filter the noise that is left", default=True)
    denoiser: bpy.props.EnumProperty(
        name="Denoiser",
        items=(
            ("auto", "Automatic", "Both, pixel by pixel, where Open Image Denoise is installed, else the own filter"),
            ("regression", "Own Filter", "The filter of tdpt"),
            ("oidn", "Open Image Denoise", "Intel's, which has to be installed"),
        ),
    )
    device: bpy.props.EnumProperty(
        name="Device", items=(("CPU", "CPU", "All cores"), ("GPU", "GPU", "The best Vulkan device")), default="CPU"
    )
    quality: bpy.props.EnumProperty(
        name="Search",
        description="How carefully portals are looked for",
        items=(("draft", "Draft", "A few seconds"), ("normal", "Normal", ""), ("high", "High", "Four times as long")),
        default="normal",
    )
    found: bpy.props.StringProperty(options={"HIDDEN"})  # lines
    lost: bpy.props.StringProperty(options={"HIDDEN"})


class TdptPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    folder: bpy.props.StringProperty(
        name="Programs", description="The folder with tdpt, if it is not on the PATH", subtype="DIR_PATH"
    )

    def draw(self, context):
        self.layout.prop(self, "folder")
        path = programs.program()
        self.layout.label(text=f"Uses {path}" if path else programs.MISSING, icon="CHECKMARK" if path else "ERROR")


class InRender:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"


class TDPT_PT_portals(InRender, bpy.types.Panel):
    bl_label = "Light Portals"
    bl_idname = "TDPT_PT_portals"

    def draw(self, context):
        layout, scene = self.layout, context.scene
        if not programs.program():
            wrapped(layout, programs.MISSING, context, "ERROR")
            return
        if finding.Search.running:
            progress(layout, finding.Search.share, finding.Search.words + " (Esc cancels)")
        else:
            layout.operator("tdpt.find_portals", icon="LIGHT_AREA")
            layout.row().prop(scene.tdpt, "quality", expand=True)
        if not scene.camera:
            wrapped(layout, "The scene has no camera", context, "ERROR")
        for line in scene.tdpt.found.splitlines():
            wrapped(layout, line, context)
        self.draw_list(layout, scene)

    @staticmethod
    def draw_list(layout, scene):
        meshes = portals.collection_of(scene)
        column = layout.column(align=True)
        for thing in meshes.objects if meshes else ():
            if thing.type != "MESH":
                continue
            row = column.row(align=True)
            row.label(text=thing.name, icon="LIGHT_SUN" if thing.get("sky", 0) >= portals.OF_THE_SKY else "MESH_PLANE")
            row.prop(thing, "hide_viewport", text="", emboss=False)
        lamps = portals.lamps_of(scene)
        if lamps:
            on = sum(not lamp.hide_render for lamp in lamps)
            column.label(text=f"Portals of Cycles: {on} of {len(lamps)} on")


class TDPT_PT_lost(InRender, bpy.types.Panel):
    bl_label = "What tdpt Says"
    bl_parent_id = "TDPT_PT_portals"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return bool(Rendered.sentences or context.scene.tdpt.lost)

    def draw(self, context):
        for line in Rendered.sentences or context.scene.tdpt.lost.splitlines():
            wrapped(self.layout, line, context)


class TDPT_PT_sampling(InRender, bpy.types.Panel):
    bl_label = "Sampling"
    COMPAT_ENGINES = {"TDPT"}

    @classmethod
    def poll(cls, context):
        return context.engine == "TDPT"

    def draw(self, context):
        layout, settings = self.layout, context.scene.tdpt
        layout.use_property_split, layout.use_property_decorate = True, False
        for name in ("samples", "time", "noise", "denoise", "denoiser", "max_depth", "seed", "animate_seed", "device"):
            if name != "denoiser" or settings.denoise:
                layout.prop(settings, name)


def progress(layout, share, words):
    if hasattr(layout, "progress"):
        layout.progress(factor=share, text=words)
    else:
        layout.label(text=f"{100 * share:.0f} %: {words}", icon="TIME")


def wrapped(layout, text, context, icon="NONE"):
    """Panels do not break lines."""
    most = max(20, int(context.region.width / (7 * context.preferences.system.ui_scale))) if context.region else 60
    column, line = layout.column(align=True), ""
    for word in text.split():
        if line and len(line) + 1 + len(word) > most:
            column.label(text=line, icon=icon)
            line, icon = "", "BLANK1" if icon != "NONE" else "NONE"
        line = f"{line} {word}".strip()
    column.label(text=line, icon=icon)


# Panels of Blender that serve any renderer, and those of EEVEE for materials, lamps and the world's nodes.
OTHERS = {"VIEWLAYER_PT_filter", "VIEWLAYER_PT_layer_passes"}
OF_EEVEE = {
    "EEVEE_MATERIAL_PT_context_material", "EEVEE_MATERIAL_PT_surface", "EEVEE_WORLD_PT_surface", "DATA_PT_EEVEE_light",
    "DATA_PT_light",
}


def panels():
    for panel in bpy.types.Panel.__subclasses__():
        engines = getattr(panel, "COMPAT_ENGINES", None)
        if engines is None or panel.__name__ in OTHERS:
            continue
        if "BLENDER_RENDER" in engines or panel.__name__ in OF_EEVEE:
            yield panel


CLASSES = (TdptSettings, TdptPreferences, TDPT_PT_sampling, TDPT_PT_portals, TDPT_PT_lost)
