// pbrt-v4: an infinite light with `portal`, four corners of a rectangle in world axes,
// counter-clockwise seen from the room: PortalImageInfiniteLight takes z = cross(p3 - p0, p1 - p0)
// as the way out. Such a light shines through its portal only, so each window has its own. Light
// through two portals would count twice: only portals that the sky's light meets first become
// lights, without overlaps. The sides of an opening outside the portal get no light. Rendered by
// hand with pbrt-v4 of June 2026 (doc/cycles.md).
//   https://pbrt.org/fileformat-v4#lights
#include <fmt/format.h>

#include "tools/portalfit/renderer_text.h"
#include "tools/portalfit/renderers.h"

namespace tdpt {
namespace {

constexpr const char* kUse =
    R"(# pbrt-v4: Include this in the scene's world, in place of its infinite light. A light with a portal shines through it
# and nowhere else: so there is one for each window, windows whose rectangles overlap share one, and what the map sends
# past them, as onto a house from outside, is missing.
# sky.exr is a map in pbrt's equal-area parameterization, as "imgtool makeequiarea" makes it. The transform puts up a
# map that was latitude-longitude as tdpt-render's: its centre looks to -Z, three quarters of its width to +X, y is up.
)";

std::string light(const Portal& portal) {
  std::vector<double> places;
  for (const Vec3d& corner : rectangle_of(portal).corners())
    for (int i = 0; i < 3; ++i) places.push_back(corner[i]);
  return fmt::format(
      "AttributeBegin\n"
      "    ConcatTransform [ 0 0 1 0  -1 0 0 0  0 1 0 0  0 0 0 1 ]\n"
      "    LightSource \"infinite\" \"string filename\" \"sky.exr\"\n"
      "        \"point3 portal\" [ {} ]\n"
      "AttributeEnd\n",
      numbers(places));
}

}  // namespace

std::string portals_for_pbrt(const PortalFile& file) {
  std::string text;
  for (const std::string& remark : remarks_on(file)) text += "# " + remark + "\n";
  text += kUse;
  SkyPortals portals = sky_portals(file);
  for (const Portal& portal : without_overlaps(std::move(portals.outer)))
    text += fmt::format("\n# {}\n{}", portal.name, light(portal));
  for (const Portal& portal : portals.inner) text += "\n" + commented(portal, light(portal), "# ");
  return text;
}

}  // namespace tdpt
