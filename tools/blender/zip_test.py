"""zip_test.py ZIP: the extension as people install it, in a Blender with a new home: its engine, panel and preferences are
there, it finds its programs, and it can be switched off again. One with a wheel needs no preference and no PATH for that."""
import os
import sys
import zipfile

import bpy

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:] = [os.path.join(HERE, "testing"), *(folder for folder in sys.path if folder != HERE)]  # it has a tdpt, too
import rooms  # noqa: E402

zip_file = sys.argv[sys.argv.index("--") + 1 if "--" in sys.argv else 1]


def expect(what, words):
    if not what:
        print(f"zip_test.py: {words}", flush=True)
        os._exit(1)


rooms.three_rooms()
if hasattr(bpy.ops, "extensions") and bpy.app.version >= (4, 2):
    module = "bl_ext.user_default.tdpt"
    bpy.ops.extensions.package_install_files(filepath=zip_file, repo="user_default", enable_on_install=True)
else:
    module = "tdpt"
    bpy.ops.preferences.addon_install(filepath=zip_file)
    bpy.ops.preferences.addon_enable(module=module)
expect(module in bpy.context.preferences.addons, f"{module} is not enabled")
preferences = bpy.context.preferences.addons[module].preferences
expect(preferences.folder == "", "preferences are not registered")
scene = bpy.context.scene
scene.render.engine = "TDPT"
expect(scene.tdpt.samples == 64, "settings are not registered")
expect(hasattr(bpy.types, "TDPT_PT_portals"), "the panel is not registered")
expect("TDPT" in bpy.types.RENDER_PT_output.COMPAT_ENGINES if hasattr(bpy.types, "RENDER_PT_output") else True, "no output panel")
programs = sys.modules[f"{module}.programs"]
if any(name.endswith(".whl") for name in zipfile.ZipFile(zip_file).namelist()):
    expected = os.path.join(os.environ["HOME"], "extensions/.local/lib/python{}.{}/site-packages/tdpt/bin/tdpt".format(*sys.version_info))
    os.environ["PATH"], scene.tdpt.quality = "/nowhere", "draft"
    bpy.ops.tdpt.find_portals(measure=False)
    expect("2 portals" in scene.tdpt.found, f"found {scene.tdpt.found}")
else:
    expected = os.path.join(os.environ["TDPT_BIN"], "tdpt")
    preferences.folder = os.environ["TDPT_BIN"]
expect(programs.program() == expected, f"finds {programs.program()}")
bpy.ops.preferences.addon_disable(module=module)
expect(not hasattr(bpy.types.Scene, "tdpt"), "settings stay after it is switched off")
print("zip_test.py: all is well", flush=True)
os._exit(0)
