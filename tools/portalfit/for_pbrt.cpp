// pbrt-v4: an infinite light with `portal`, four corners of a rectangle in world axes,
// counter-clockwise seen from the room: PortalImageInfiniteLight takes z = cross(p3 - p0, p1 - p0)
// as the way out. Such a light shines through its portal only, so each window has its own. Light
// through two portals would count twice: only portals of one cut become lights, without overlaps.
//   https://pbrt.org/fileformat-v4#lights
#include <algorithm>
#include <limits>

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

double cut_of(const Portal& portal) {
  const auto at = portal.figures.find("cut");
  return at == portal.figures.end() ? 0 : at->second;
}

std::string light(const Portal& portal, const std::string& margin) {
  std::vector<double> places;
  for (const Vec3d& corner : rectangle_of(portal).corners())
    for (int i = 0; i < 3; ++i) places.push_back(corner[i]);
  return fmt::format(
      "{0}AttributeBegin\n"
      "{0}    ConcatTransform [ 0 0 1 0  -1 0 0 0  0 1 0 0  0 0 0 1 ]\n"
      "{0}    LightSource \"infinite\" \"string filename\" \"sky.exr\"\n"
      "{0}        \"point3 portal\" [ {1} ]\n"
      "{0}AttributeEnd\n",
      margin, numbers(places));
}

}  // namespace

std::string portals_for_pbrt(const PortalFile& file) {
  std::string text;
  for (const std::string& remark : remarks_on(file)) text += "# " + remark + "\n";
  text += kUse;
  double first = std::numeric_limits<double>::infinity();
  for (const Portal& portal : file.portals) first = std::min(first, cut_of(portal));
  std::vector<Portal> lights, further;
  for (size_t n = 0; n < file.portals.size(); ++n) {
    Portal portal = file.portals[n];
    portal.name = fmt::format("portal.{}", n);
    (cut_of(portal) > first ? further : lights).push_back(std::move(portal));
  }
  for (const Portal& portal : without_overlaps(std::move(lights)))
    text += fmt::format("\n# {}\n{}", portal.name, light(portal, ""));
  for (const Portal& portal : further)
    text += fmt::format(
        "\n# {}: further in, light through it has passed a portal already. It is no light.\n{}",
        portal.name, light(portal, "# "));
  return text;
}

}  // namespace tdpt
