// OpenUSD: a PortalLight is a rectangle in its local XY plane, width along X and height along Y,
// which transmits light along -Z; a DomeLight names its portals. bench/readers.py has usd-core
// validate and read the text.
//   https://openusd.org/release/user_guides/schemas/usdLux/PortalLight.html
//   https://openusd.org/release/user_guides/schemas/usdLux/DomeLight.html
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tools/portalfit/renderer_text.h"
#include "tools/portalfit/renderers.h"

namespace tdpt {
namespace {

// USD has points as rows.
std::string transposed(const Placement& p) {
  std::vector<std::string> rows;
  for (const Vec3d& v : {p.x, p.y, p.z})
    rows.push_back(fmt::format("({})", numbers({v.x, v.y, v.z, 0}, ", ")));
  rows.push_back(fmt::format("({})", numbers({p.origin.x, p.origin.y, p.origin.z, 1}, ", ")));
  return fmt::format("( {} )", fmt::join(rows, ", "));
}

std::string prim(const Portal& portal) {
  const Rectangle r = rectangle_of(portal);
  return fmt::format(
      "    def PortalLight \"{}\"\n"
      "    {{\n"
      "        float inputs:height = {}\n"
      "        float inputs:width = {}\n"
      "        matrix4d xformOp:transform = {}\n"
      "        uniform token[] xformOpOrder = [\"xformOp:transform\"]\n"
      "    }}\n",
      identifier(portal), numbers({r.height}), numbers({r.width}),
      transposed(shining_along_minus_z(r)));
}

}  // namespace

std::string portals_for_usd(const PortalFile& file) {
  std::string text =
      "#usda 1.0\n"
      "(\n"
      "    defaultPrim = \"Portals\"\n"
      "    metersPerUnit = 1\n"
      "    upAxis = \"Y\"\n"
      ")\n";
  for (const std::string& remark : remarks_on(file)) text += "# " + remark + "\n";
  text += "\ndef Xform \"Portals\"\n{\n";
  std::vector<std::string> paths;
  const SkyPortals portals = sky_portals(file);
  for (const Portal& portal : portals.outer) {
    text += prim(portal);
    paths.push_back(fmt::format("</Portals/{}>", identifier(portal)));
  }
  for (const Portal& portal : portals.inner) text += commented(portal, prim(portal), "# ");
  text += fmt::format(
      "}}\n"
      "\n"
      "# As a sublayer of a stage whose dome light is at /Sky; for another, move this opinion "
      "there.\n"
      "over \"Sky\"\n"
      "{{\n"
      "    rel portals = [{}]\n"
      "}}\n",
      fmt::join(paths, ", "));
  return text;
}

}  // namespace tdpt
