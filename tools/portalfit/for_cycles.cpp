// Cycles: an area lamp with Portal set guides the sampling of the world's light. It helps points on
// the side of its -Z, to which it would shine. bench/cycles_blender.py has Blender run the text.
//   https://docs.blender.org/manual/en/latest/render/cycles/light_settings.html
#include <fmt/format.h>

#include "tools/portalfit/renderer_text.h"
#include "tools/portalfit/renderers.h"

namespace tdpt {
namespace {

constexpr const char* kUse =
    R"(# Cycles: an area lamp for each window, set to be a portal of the world's light. For the scene as Blender imports it
# from glTF:
#   blender -b scene.blend --python portals.py -f 1
# or Run Script in the text editor. Run again, it replaces its lamps.
import bpy
from mathutils import Matrix

# Name, width and height [m], and the rows of the lamp's matrix: it shines along its -Z, into the room. Z is up.
PORTALS = [
)";

constexpr const char* kProgram = R"(]

for name, width, height, matrix in PORTALS:
    old = bpy.data.objects.get(name)
    if old and old.type == "LIGHT" and old.data.cycles.is_portal:
        bpy.data.objects.remove(old)
    lamp = bpy.data.lights.new(name, "AREA")
    lamp.shape, lamp.size, lamp.size_y = "RECTANGLE", width, height
    lamp.cycles.is_portal = True
    portal = bpy.data.objects.new(name, lamp)
    portal.matrix_world = Matrix(matrix)
    bpy.context.scene.collection.objects.link(portal)
)";

// The axes that Blender's glTF importer gives.
Vec3d z_up(const Vec3d& v) {
  return {v.x, -v.z, v.y};
}

std::string row_of(const Portal& portal) {
  const Rectangle r = rectangle_of(portal);
  const Placement p = shining_along_minus_z(r);
  std::string text =
      fmt::format("    (\"{}\", {},\n     (", portal.name, numbers({r.width, r.height}, ", "));
  const char* between = "";
  for (const auto& row : Placement{z_up(p.x), z_up(p.y), z_up(p.z), z_up(p.origin)}.rows()) {
    text += fmt::format("{}({})", between, numbers(row, ", "));
    between = ",\n      ";
  }
  return text + ")),\n";
}

}  // namespace

std::string portals_for_cycles(const PortalFile& file) {
  std::string text;
  for (const std::string& remark : remarks_on(file)) text += "# " + remark + "\n";
  text += kUse;
  const SkyPortals portals = sky_portals(file);
  for (const Portal& portal : portals.outer) text += row_of(portal);
  for (const Portal& portal : portals.inner) text += commented(portal, row_of(portal), "# ");
  return text + kProgram;
}

}  // namespace tdpt
