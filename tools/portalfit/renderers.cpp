#include "tools/portalfit/renderers.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tdpt_version.h"
#include "tools/portalfit/plane.h"

namespace tdpt {
namespace {

// ---- Rectangles ----

constexpr double kSameWay = 0.9;   // cosine between normals
constexpr double kOverlap = 1e-6;  // of the smaller area
constexpr double kLevel = 1e-9;    // cosine with the vertical

// The rectangle of least area has a side along an edge of the points' convex hull (Freeman and
// Shapira 1975), so each edge is tried; outlines have a dozen corners.
Rectangle rectangle_around(const Plane& plane, const std::vector<Vec3d>& points) {
  std::vector<Vec2d> places;
  for (const Vec3d& p : points) places.push_back(in_plane(plane, p));
  const Polygon hull = convex_hull(places);
  Rectangle r;
  r.normal = plane.n;
  double least = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < hull.size(); ++i) {
    const Vec2d edge = hull[(i + 1) % hull.size()] - hull[i];
    const double length = std::sqrt(dot(edge, edge));
    if (!(length > 0)) continue;
    const Vec2d u = edge * (1 / length), v{-u.y, u.x};
    Vec2d low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};
    for (const Vec2d& p : hull) {
      const Vec2d at{dot(p, u), dot(p, v)};
      low = {std::min(low.x, at.x), std::min(low.y, at.y)};
      high = {std::max(high.x, at.x), std::max(high.y, at.y)};
    }
    const Vec2d size = high - low, middle = (low + high) * 0.5;
    // Edges of the same rectangle differ only by rounding: the first is kept.
    if (!(size.x * size.y < least * (1 - 1e-12))) continue;
    least = size.x * size.y;
    r.width = size.x, r.height = size.y;
    r.centre = to_space(plane, u * middle.x + v * middle.y);
    r.x = to_space({{}, plane.n}, u);
    r.y = cross(r.normal, r.x);
  }
  const bool level = std::abs(r.x.y) < kLevel && std::abs(r.y.y) < kLevel;
  if (level ? r.height > r.width : std::abs(r.x.y) > std::abs(r.y.y)) {
    std::swap(r.width, r.height);
    r.y = r.x;
  }
  if (!level && r.y.y < 0) r.y = -r.y;
  r.x = cross(r.y, r.normal);
  return r;
}

// In the plane of the larger one.
Rectangle joined(const Rectangle& a, const Rectangle& b) {
  const Rectangle& larger = a.area() < b.area() ? b : a;
  std::vector<Vec3d> corners = a.corners();
  for (const Vec3d& corner : b.corners()) corners.push_back(corner);
  Rectangle both = rectangle_around({larger.centre, larger.normal}, corners);
  both.name = a.name + ", " + b.name;
  return both;
}

// Whether `a` and `b` overlap when seen along the normal of `a`, and are close along it.
bool overlap(const Rectangle& a, const Rectangle& b) {
  if (dot(a.normal, b.normal) < kSameWay) return false;
  const double close = 0.5 * std::min({a.width, a.height, b.width, b.height});
  if (std::abs(dot(b.centre - a.centre, a.normal)) > close) return false;
  Polygon seen;
  for (const Vec3d& corner : b.corners())
    seen.push_back({dot(corner - a.centre, a.x), dot(corner - a.centre, a.y)});
  const double smaller = std::min(a.area(), area(seen));
  for (const Vec2d& side : {Vec2d{1, 0}, Vec2d{-1, 0}, Vec2d{0, 1}, Vec2d{0, -1}})
    if (!seen.empty()) seen = clipped(seen, side, 0.5 * (side.x != 0 ? a.width : a.height));
  return seen.size() > 2 && area(seen) > kOverlap * smaller;
}

}  // namespace

std::vector<Vec3d> Rectangle::corners() const {
  const Vec3d a = x * (0.5 * width), b = y * (0.5 * height);
  return {centre - a - b, centre + a - b, centre + a + b, centre - a + b};
}

Rectangle rectangle_of(const Portal& portal) {
  std::vector<Vec3d> corners;
  for (const auto& t : portal.triangles)
    for (const uint32_t v : t) corners.push_back(portal.vertices[v]);
  Rectangle r = rectangle_around(shape_of(portal).plane, corners);
  r.name = portal.name;
  return r;
}

std::vector<Rectangle> without_overlaps(std::vector<Rectangle> rectangles) {
  for (size_t i = 0; i < rectangles.size(); ++i)
    for (size_t j = i + 1; j < rectangles.size(); ++j) {
      if (!overlap(rectangles[i], rectangles[j])) continue;
      rectangles[i] = joined(rectangles[i], rectangles[j]);
      rectangles.erase(rectangles.begin() + static_cast<std::ptrdiff_t>(j));
      return without_overlaps(std::move(rectangles));  // it may overlap with one examined before
    }
  return rectangles;
}

namespace {

// ---- Texts ----

// Least share of a portal's lines that comes from the sky past no other portal: windows have 0.2 to
// 1, doors within a building less than 0.04.
constexpr double kOfTheSky = 0.1;

// Templates of fmt.
struct Renderer {
  const char* name;
  const char* remark;  // a comment
  const char* text;    // {remarks}, {portals} and {paths}
  const char* portal;  // see text_of()
};

constexpr Renderer kRenderers[] = {
    // An area lamp with Portal set guides the sampling of the world's light. It helps points on the
    // side of its -Z, to which it would shine. bench/readers.py has Blender run the text.
    //   https://docs.blender.org/manual/en/latest/render/cycles/light_settings.html
    {"cycles", "# {}\n",
     R"({remarks}# Cycles: an area lamp for each window, set to be a portal of the world's light. For the scene as Blender imports it
# from glTF:
#   blender -b scene.blend --python portals.py -f 1
# or Run Script in the text editor. Run again, it replaces its lamps.
import bpy
from mathutils import Matrix

# Name, width and height [m], and the rows of the lamp's matrix: it shines along its -Z, into the room. Z is up.
PORTALS = [
{portals}]

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
)",
     R"(    ("{name}", {width}, {height},
     (({blender_x}),
      ({blender_y}),
      ({blender_z}),
      (0, 0, 0, 1))),
)"},
    // pbrt-v4: an infinite light with `portal`, four corners of a rectangle in world axes,
    // counter-clockwise seen from the room: PortalImageInfiniteLight takes z = cross(p3 - p0,
    // p1 - p0) as the way out. Such a light shines through its portal only, so each window has its
    // own. Light through two portals would count twice: only portals that the sky's light meets
    // first become lights, without overlaps. The sides of an opening outside the portal get no
    // light. Rendered by hand with pbrt-v4 of June 2026 (doc/peers.md).
    //   https://pbrt.org/fileformat-v4#lights
    {"pbrt", "# {}\n",
     R"({remarks}# pbrt-v4: Include this in the scene's world, in place of its infinite light. A light with a portal shines through it
# and nowhere else: so there is one for each window, windows whose rectangles overlap share one, and what the map sends
# past them, as onto a house from outside, is missing.
# sky.exr is a map in pbrt's equal-area parameterization, as "imgtool makeequiarea" makes it. The transform puts up a
# map that was latitude-longitude as tdpt-render's: its centre looks to -Z, three quarters of its width to +X, y is up.
{portals})",
     R"(
# {name}
AttributeBegin
    ConcatTransform [ 0 0 1 0  -1 0 0 0  0 1 0 0  0 0 0 1 ]
    LightSource "infinite" "string filename" "sky.exr"
        "point3 portal" [ {corners} ]
AttributeEnd
)"},
    // Mitsuba 3: the emitter `portal` is the square [-1, 1] x [-1, 1] of its frame; its +Z points
    // away from the environment. Documented at the head of its src/emitters/portal.cpp, which came
    // after version 3.9.1; `include` in docs/src/key_topics/scene_format.rst. bench/readers.py has
    // its parser read the text.
    {"mitsuba", "<!-- {} -->\n",
     R"(<?xml version="1.0" encoding="utf-8"?>
{remarks}<!-- Mitsuba 3 with the emitter "portal", which its sources have since September 2026 and
     version 3.9.1 lacks:
     <include filename="portals.xml"/> in the scene, beside its envmap or constant. -->
<scene version="3.0.0">
{portals}</scene>
)",
     R"(    <emitter type="portal" id="{id}">
        <transform name="to_world">
            <matrix value="{square} 0 0 0 1"/>
        </transform>
    </emitter>
)"},
    // OpenUSD: a PortalLight is a rectangle in its local XY plane, width along X and height along
    // Y, which transmits light along -Z; a DomeLight names its portals. Points are rows.
    // bench/readers.py has usd-core validate and read the text.
    //   https://openusd.org/release/user_guides/schemas/usdLux/PortalLight.html
    //   https://openusd.org/release/user_guides/schemas/usdLux/DomeLight.html
    {"usd", "# {}\n",
     R"(#usda 1.0
(
    defaultPrim = "Portals"
    metersPerUnit = 1
    upAxis = "Y"
)
{remarks}
def Xform "Portals"
{{
{portals}}}

# As a sublayer of a stage whose dome light is at /Sky; for another, move this opinion there.
over "Sky"
{{
    rel portals = [{paths}]
}}
)",
     R"(    def PortalLight "{id}"
    {{
        float inputs:height = {height}
        float inputs:width = {width}
        matrix4d xformOp:transform = ( ({x}, 0), ({y}, 0), ({z}, 0), ({centre}, 1) )
        uniform token[] xformOpOrder = ["xformOp:transform"]
    }}
)"}};

// Comments for the file: what made it, and of which scene. Plain ASCII without control characters,
// since file names are not trusted, and for XML without two dashes in a row.
std::string remarks_on(const PortalFile& file, size_t outer, const Renderer& to) {
  const size_t n = file.portals.size();
  std::vector<std::string> remarks{fmt::format("{} light {} by portalfit (tdpt {}), in metres",
                                               n == 0 ? "No" : std::to_string(n),
                                               n == 1 ? "portal" : "portals", TDPT_VERSION)};
  if (outer < n)
    remarks.push_back(fmt::format("{} of them {} in the sky; the others are left out", outer,
                                  outer == 1 ? "lets" : "let"));
  if (!file.scene_hash.empty()) remarks.push_back("scene " + file.scene_hash);
  const std::vector<std::string>& lines = file.provenance.lines;
  remarks.insert(remarks.end(), lines.begin(), lines.end());
  std::string text;
  for (const std::string& remark : remarks) {
    std::string plain;
    for (const char c : remark) {
      if (c == '-' && plain.ends_with('-') && to.remark[0] == '<') plain += ' ';
      plain += c < ' ' || c > '~' ? '?' : c;
    }
    text += fmt::format(fmt::runtime(to.remark), plain);
  }
  return text;
}

// Shortest decimals that read back as the same number, separated by `between`; no negative zero.
std::string numbers(const std::vector<double>& values, const char* between = ", ") {
  std::string text;
  for (const double v : values) text += fmt::format("{}{}", text.empty() ? "" : between, v + 0.0);
  return text;
}

std::string list(const Vec3d& v) {
  return numbers({v.x, v.y, v.z});
}

// "portal_0" of portal.0.
std::string identifier(std::string name) {
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}

// {blender_x}, {blender_y}, {blender_z}: rows of the matrix of a lamp at the centre, in the axes
// that Blender's glTF importer gives: x, -z, y. {x}, {y}, {z}: its columns in those of the scene.
// It shines along its -Z. {square}: the first rows of the matrix that maps the square [-1, 1] x
// [-1, 1] to the rectangle.
std::string text_of(const Rectangle& r, const Renderer& to) {
  const Vec3d x = r.x, y = -r.y, z = -r.normal, o = r.centre;
  std::vector<double> corners, square;
  for (const Vec3d& corner : r.corners())
    for (int i = 0; i < 3; ++i) corners.push_back(corner[i]);
  const Vec3d half_x = r.x * (0.5 * r.width), half_y = r.y * (0.5 * r.height);
  for (int i = 0; i < 3; ++i)
    square.insert(square.end(), {half_x[i], half_y[i], r.normal[i], o[i]});
  return fmt::format(
      fmt::runtime(to.portal), fmt::arg("name", r.name), fmt::arg("id", identifier(r.name)),
      fmt::arg("width", numbers({r.width})), fmt::arg("height", numbers({r.height})),
      fmt::arg("blender_x", numbers({x.x, y.x, z.x, o.x})),
      fmt::arg("blender_y", numbers({-x.z, -y.z, -z.z, -o.z})),
      fmt::arg("blender_z", numbers({x.y, y.y, z.y, o.y})), fmt::arg("x", list(x)),
      fmt::arg("y", list(y)), fmt::arg("z", list(z)), fmt::arg("centre", list(o)),
      fmt::arg("corners", numbers(corners, " ")), fmt::arg("square", numbers(square, " ")));
}

}  // namespace

bool lets_in_sky(const Portal& portal) {
  const auto sky = portal.figures.find("sky");
  return sky == portal.figures.end() || sky->second >= kOfTheSky;
}

std::vector<std::string> renderer_names() {
  std::vector<std::string> names;
  for (const Renderer& r : kRenderers) names.push_back(r.name);
  return names;
}

std::string portals_for(const std::string& renderer, const PortalFile& file) {
  const auto to = std::find_if(std::begin(kRenderers), std::end(kRenderers),
                               [&](const Renderer& r) { return renderer == r.name; });
  if (to == std::end(kRenderers)) return {};
  std::vector<Rectangle> outer;
  std::vector<std::string> paths;
  for (size_t n = 0; n < file.portals.size(); ++n) {
    if (!lets_in_sky(file.portals[n])) continue;
    outer.push_back(rectangle_of(file.portals[n]));
    outer.back().name = fmt::format("portal.{}", n);
    paths.push_back(fmt::format("</Portals/{}>", identifier(outer.back().name)));
  }
  const std::string remarks = remarks_on(file, outer.size(), *to);
  if (renderer == "pbrt") outer = without_overlaps(std::move(outer));
  std::string portals;
  for (const Rectangle& r : outer) portals += text_of(r, *to);
  return fmt::format(fmt::runtime(to->text), fmt::arg("remarks", remarks),
                     fmt::arg("portals", portals), fmt::arg("paths", fmt::join(paths, ", ")));
}

}  // namespace tdpt
