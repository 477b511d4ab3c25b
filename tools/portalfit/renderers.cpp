#include "tools/portalfit/renderers.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tdpt_version.h"

namespace tdpt {
namespace {

// Of a portal's lines, the share that comes from the sky past no other portal: 0.2 to 1 of windows,
// less than 0.04 of doors within a building (doc/cycles.md).
constexpr double kOfTheSky = 0.1;

std::string plain(std::string text) {
  for (char& c : text)
    if (c < ' ' || c > '~') c = '?';
  return text;
}

}  // namespace

bool lets_in_sky(const Portal& portal) {
  const auto sky = portal.figures.find("sky");
  return sky == portal.figures.end() || sky->second >= kOfTheSky;
}

namespace {

// Portals named portal.0, portal.1, ...: those that let in the sky, and those further in, where
// the light of the sky has passed another portal. Guiding the sampling of an environment, the
// latter are of no use: they stand in the texts as comments.
struct SkyPortals {
  std::vector<Portal> outer, inner;
  std::vector<std::string> remarks;
};

// "portal_0" of portal.0.
std::string identifier(const Portal& portal) {
  std::string name = portal.name;
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}

// `text` with `mark` before each of its lines, after a line that says why the portal is no light.
std::string commented(const Portal& portal, const std::string& text, const std::string& mark) {
  std::string all = fmt::format("{}{}: no light from the sky meets it first\n", mark, portal.name);
  for (size_t at = 0; at < text.size();) {
    const size_t end = std::min(text.find('\n', at), text.size() - 1) + 1;
    all += mark + text.substr(at, end - at);
    at = end;
  }
  return all;
}

// Comments for the file: what made it, and of which scene. Plain ASCII without control characters,
// since file names are not trusted.
std::vector<std::string> remarks_on(const PortalFile& file) {
  const auto outer =
      static_cast<size_t>(std::count_if(file.portals.begin(), file.portals.end(), lets_in_sky));
  std::vector<std::string> remarks{
      fmt::format("{} light {} by portalfit (tdpt {}), in metres",
                  file.portals.empty() ? std::string("No") : std::to_string(file.portals.size()),
                  file.portals.size() == 1 ? "portal" : "portals", TDPT_VERSION)};
  if (outer < file.portals.size())
    remarks.push_back(fmt::format("{} of them {} in the sky", outer, outer == 1 ? "lets" : "let"));
  if (!file.scene_hash.empty()) remarks.push_back(plain("scene " + file.scene_hash));
  for (const std::string& line : file.provenance.lines) remarks.push_back(plain(line));
  return remarks;
}

SkyPortals sky_portals(const PortalFile& file) {
  SkyPortals sorted{{}, {}, remarks_on(file)};
  for (size_t n = 0; n < file.portals.size(); ++n) {
    Portal portal = file.portals[n];
    portal.name = fmt::format("portal.{}", n);
    (lets_in_sky(portal) ? sorted.outer : sorted.inner).push_back(std::move(portal));
  }
  return sorted;
}

// The remarks as lines of comments that begin with #.
std::string hashed(const std::vector<std::string>& remarks) {
  std::string text;
  for (const std::string& remark : remarks) text += "# " + remark + "\n";
  return text;
}

// Shortest decimals that read back as the same number, separated by `between`; no negative zero.
std::string numbers(const std::vector<double>& values, const char* between = " ") {
  std::string text;
  for (const double v : values) text += fmt::format("{}{}", text.empty() ? "" : between, v + 0.0);
  return text;
}

// Columns of the matrix from a portal's own frame to the world's: points are columns, the last
// column is the origin.
struct Placement {
  Vec3d x, y, z, origin;

  // Rows of the 4 x 4 matrix for points as columns.
  std::vector<std::vector<double>> rows() const {
    std::vector<std::vector<double>> rows;
    for (int i = 0; i < 3; ++i) rows.push_back({x[i], y[i], z[i], origin[i]});
    rows.push_back({0, 0, 0, 1});
    return rows;
  }
};

// Placement of a lamp at the centre of the rectangle which shines along its -Z, the way the light
// goes; width along x, height along y.
Placement shining_along_minus_z(const Rectangle& r) {
  return {r.x, -r.y, -r.normal, r.centre};
}

// ---- Cycles ----

// Cycles: an area lamp with Portal set guides the sampling of the world's light. It helps points on
// the side of its -Z, to which it would shine. bench/cycles_blender.py has Blender run the text.
//   https://docs.blender.org/manual/en/latest/render/cycles/light_settings.html

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

std::string text_for_cycles(const SkyPortals& portals) {
  std::string text = hashed(portals.remarks) + kUse;
  for (const Portal& portal : portals.outer) text += row_of(portal);
  for (const Portal& portal : portals.inner) text += commented(portal, row_of(portal), "# ");
  return text + kProgram;
}

// ---- pbrt ----

// pbrt-v4: an infinite light with `portal`, four corners of a rectangle in world axes,
// counter-clockwise seen from the room: PortalImageInfiniteLight takes z = cross(p3 - p0, p1 - p0)
// as the way out. Such a light shines through its portal only, so each window has its own. Light
// through two portals would count twice: only portals that the sky's light meets first become
// lights, without overlaps. The sides of an opening outside the portal get no light. Rendered by
// hand with pbrt-v4 of June 2026 (doc/cycles.md).
//   https://pbrt.org/fileformat-v4#lights

constexpr const char* kUseInPbrt =
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

std::string text_for_pbrt(const SkyPortals& portals) {
  std::string text = hashed(portals.remarks) + kUseInPbrt;
  for (const Portal& portal : without_overlaps(portals.outer))
    text += fmt::format("\n# {}\n{}", portal.name, light(portal));
  for (const Portal& portal : portals.inner) text += "\n" + commented(portal, light(portal), "# ");
  return text;
}

// ---- Mitsuba ----

// Mitsuba 3: the emitter `portal` is the square [-1, 1] x [-1, 1] of its frame; its +Z points away
// from the environment. Documented at the head of its src/emitters/portal.cpp, which came after
// version 3.9.1; `include` in docs/src/key_topics/scene_format.rst. bench/readers.py has its parser
// read the text.

// XML comments may not contain two dashes in a row.
std::string in_comment(const std::string& text) {
  std::string spaced;
  for (const char c : text) {
    if (c == '-' && spaced.ends_with('-')) spaced += ' ';
    spaced += c;
  }
  return spaced;
}

std::string emitter(const Portal& portal) {
  const Rectangle r = rectangle_of(portal);
  const Placement p{r.x * (0.5 * r.width), r.y * (0.5 * r.height), r.normal, r.centre};
  std::vector<double> matrix;
  for (const auto& row : p.rows()) matrix.insert(matrix.end(), row.begin(), row.end());
  return fmt::format(
      "    <emitter type=\"portal\" id=\"{}\">\n"
      "        <transform name=\"to_world\">\n"
      "            <matrix value=\"{}\"/>\n"
      "        </transform>\n"
      "    </emitter>\n",
      identifier(portal), numbers(matrix));
}

std::string text_for_mitsuba(const SkyPortals& portals) {
  std::string text = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n";
  for (const std::string& remark : portals.remarks)
    text += fmt::format("<!-- {} -->\n", in_comment(remark));
  text +=
      "<!-- Mitsuba 3 with the emitter \"portal\", which its sources have since September 2026 "
      "and\n"
      "     version 3.9.1 lacks:\n"
      "     <include filename=\"portals.xml\"/> in the scene, beside its envmap or constant. -->\n"
      "<scene version=\"3.0.0\">\n";
  for (const Portal& portal : portals.outer) text += emitter(portal);
  for (const Portal& portal : portals.inner)
    text += "    <!--\n" + commented(portal, emitter(portal), "") + "    -->\n";
  return text + "</scene>\n";
}

// ---- OpenUSD ----

// OpenUSD: a PortalLight is a rectangle in its local XY plane, width along X and height along Y,
// which transmits light along -Z; a DomeLight names its portals. bench/readers.py has usd-core
// validate and read the text.
//   https://openusd.org/release/user_guides/schemas/usdLux/PortalLight.html
//   https://openusd.org/release/user_guides/schemas/usdLux/DomeLight.html

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

std::string text_for_usd(const SkyPortals& portals) {
  std::string text =
      "#usda 1.0\n"
      "(\n"
      "    defaultPrim = \"Portals\"\n"
      "    metersPerUnit = 1\n"
      "    upAxis = \"Y\"\n"
      ")\n" +
      hashed(portals.remarks);
  text += "\ndef Xform \"Portals\"\n{\n";
  std::vector<std::string> paths;
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

struct Renderer {
  const char* name;
  std::string (*text)(const SkyPortals&);
};
constexpr Renderer kRenderers[] = {{"cycles", text_for_cycles},
                                   {"pbrt", text_for_pbrt},
                                   {"mitsuba", text_for_mitsuba},
                                   {"usd", text_for_usd}};

}  // namespace

std::vector<std::string> renderer_names() {
  std::vector<std::string> names;
  for (const Renderer& r : kRenderers) names.push_back(r.name);
  return names;
}

std::string portals_for(const std::string& renderer, const PortalFile& file) {
  for (const Renderer& r : kRenderers)
    if (renderer == r.name) return r.text(sky_portals(file));
  return {};
}

}  // namespace tdpt
