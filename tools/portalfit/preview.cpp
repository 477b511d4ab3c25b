#include "tools/portalfit/preview.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "libcommon/base/words.h"
#include "libcommon/draw/scene_panels.h"
#include "libcommon/math/reach.h"
#include "tools/portalfit/plane.h"

namespace tdpt {
namespace {

using namespace draw;

constexpr size_t kMostRows = 6, kMostLines = 60, kMostGlbLines = 400, kMostReasons = 8;
constexpr double kAround = 1.45;  // of the portal's half sides: what its row shows

struct Row {
  PortalFrame frame;
  double half_right, half_up;  ///< what is to be seen around the middle [metres]
  const Portal* portal;        ///< or none
};

float count_at(const LightGrid& grid, const Vec3d& p) {
  const Vec3d q = (p - grid.origin) / grid.voxel;
  for (int c = 0; c < 3; ++c)
    if (!(q[c] >= 0 && q[c] < grid.dim[static_cast<size_t>(c)])) return 0;
  return grid
      .count[grid.index(static_cast<int>(q.x), static_cast<int>(q.y), static_cast<int>(q.z))];
}

// Each texel shows the fullest voxel within `reach` before and behind the view's plane.
void draw_voxels(Panel& panel, const LightGrid& grid, double reach) {
  const float most =
      grid.count.empty() ? 0 : *std::max_element(grid.count.begin(), grid.count.end());
  const int steps = std::clamp(static_cast<int>(std::ceil(2 * reach / grid.voxel)), 1, 64);
  // Voxels are larger than pixels: texels of two are enough.
  fill_backdrop(panel, 2, [&](const Vec3d& place) {
    float count = 0;
    for (int k = 0; k < steps; ++k)
      count = std::max(count, count_at(grid, place + panel.view.forward *
                                                         (reach * ((2.0 * k + 1) / steps - 1))));
    if (count == 0) return ink(0xffffff);
    const double shade =
        std::log1p(static_cast<double>(count)) / std::log1p(static_cast<double>(most));
    return mix(ink(0xffffff), heat(shade), 0.4 * shade);
  });
}

const Ink& ink_of(Way way, const Ink& here) {
  return way == Way::here ? here : way == Way::elsewhere ? kMuted : kAlarm;
}

// Each portal's area, its outline, and its normal, the way of the light.
std::vector<Shape> portal_shapes(const std::vector<Portal>& portals) {
  std::vector<Shape> shapes;
  for (size_t i = 0; i < portals.size(); ++i) {
    const Portal& portal = portals[i];
    const std::string name = fmt::format("portal.{}", i);
    Shape area{.name = name, .through = true},
        outline{
            .name = name + " outline", .kind = Shape::Kind::lines, .size = 3.5, .through = true},
        normal{.name = name + " normal", .kind = Shape::Kind::lines, .size = 2, .through = true};
    for (const auto& t : portal.triangles)
      area.triangle(portal.vertices[t[0]], portal.vertices[t[1]], portal.vertices[t[2]],
                    {kPortal, 0.3f});
    for (const auto& e : outline_of(portal))
      outline.line(portal.vertices[e[0]], portal.vertices[e[1]], kPortal);
    const PortalFrame f = frame_of(portal);
    normal.arrow(f.o, f.n * (0.5 * std::sqrt(shape_of(portal).area)), f.right, f.up, kPortal);
    for (Shape* shape : {&area, &outline, &normal}) shapes.push_back(std::move(*shape));
  }
  return shapes;
}

// A label in the plan of each storey that shows a fifth of an outline's height, as its shape.
void label_outline(Drawing& drawing, const std::vector<Vec3d>& outline, const std::string& words,
                   const Ink& c) {
  Vec3d sum{}, low(INFINITY), high(-INFINITY);
  for (const Vec3d& v : outline) sum = sum + v, low = min(low, v), high = max(high, v);
  const Vec3d middle = sum / static_cast<double>(outline.size());
  for (const double share : {0.2, 0.8})
    drawing.labels.push_back({{middle.x, low.y + share * (high.y - low.y), middle.z}, words, c});
}

// The crossings of the lines with the portal's plane.
Panel front_of(const LightGrid& grid, const Row& row, const std::vector<SeenLine>& lines,
               const draw::Rectangle& panel) {
  Panel front{.view = Projection::flat(row.frame.o, row.frame.right, row.frame.up, row.half_right,
                                       row.half_up, panel),
              .caption = "from the front, along -z"};
  draw_voxels(front, grid, row.portal ? 0.75 * grid.voxel : row.half_right);
  Shape dots{.name = "crossings", .kind = Shape::Kind::points};
  for (const Way way : {Way::elsewhere, Way::here, Way::nowhere})
    for (const SeenLine& c : lines)
      if (c.way == way) dots.point(c.at, {ink_of(way, kInk), way == Way::nowhere ? 0.9f : 0.5f});
  if (row.portal) front.shapes = portal_shapes({*row.portal});
  if (row.portal) front.shapes.pop_back();  // the normal points at the viewer
  front.shapes.insert(front.shapes.begin() + (row.portal ? 1 : 0), std::move(dots));
  return front;
}

// The lines on their way, and the portal edge-on. In plan x runs to the right and z down, as in
// every stage's; openings in floors and ceilings are seen from the front, y up.
Panel above_of(const LightGrid& grid, const Row& row, const std::vector<SeenLine>& lines,
               const draw::Rectangle& panel) {
  const bool level = std::abs(row.frame.n.y) >= 0.9;
  const double half_right = row.portal ? 6 * grid.voxel : row.half_right,
               half_up = row.portal ? 1.3 * row.half_right : 0.53 * grid.dim[2] * grid.voxel;
  Panel above{
      .view = Projection::flat(row.frame.o, {1, 0, 0}, level ? Vec3d{0, 1, 0} : Vec3d{0, 0, -1},
                               half_right, half_up, panel),
      .caption = fmt::format("{}{}", level ? "from the front, along -z" : "from above",
                             row.portal ? "; the light goes along the arrow" : "")};
  draw_voxels(above, grid, row.half_up / kAround);
  Shape ways{.name = "lines of light", .kind = Shape::Kind::lines};
  for (const SeenLine& line : thinned(lines, kMostLines)) {
    const LightLine& l = grid.lines[line.line];
    const float alpha = line.way == Way::elsewhere ? 0.12f : 0.5f;
    ways.line(l.light, line.at, {ink_of(line.way, ink(0xc07a10)), alpha});
    ways.line(line.at, l.camera, {ink_of(line.way, ink(0x2a6bab)), alpha});
  }
  above.shapes = {ways};
  if (!row.portal) return above;
  for (Shape& shape : portal_shapes({*row.portal})) above.shapes.push_back(std::move(shape));
  return above;
}

Row row_of(const Portal& portal, double voxel) {
  Row row{frame_of(portal), voxel, voxel, &portal};
  for (const Vec3d& v : portal.vertices) {
    const Vec3d d = v - row.frame.o;
    row.half_right = std::max(row.half_right, std::abs(dot(d, row.frame.right)));
    row.half_up = std::max(row.half_up, std::abs(dot(d, row.frame.up)));
  }
  row.half_right *= kAround, row.half_up *= kAround;
  return row;
}

Row whole_grid(const LightGrid& grid) {
  const Vec3d size = Vec3d(grid.dim[0], grid.dim[1], grid.dim[2]) * grid.voxel;
  return {{grid.origin + size * 0.5, {0, 0, 1}, {0, 1, 0}, {1, 0, 0}},
          0.53 * size.x,
          0.53 * size.y,
          nullptr};
}

std::string count_words(size_t portals, const std::string& why_none) {
  return portals == 0 ? "no portal: " + why_none
                      : fmt::format("{} portal{}", portals, portals == 1 ? "" : "s");
}

std::string words_for(const Portal& portal, size_t i) {
  const auto& f = portal.figures;
  std::string words = fmt::format("portal.{}", i);
  if (f.contains("area")) words += fmt::format(": {} m2", number_words(f.at("area")));
  if (f.contains("support")) words += fmt::format(", support {:.2f}", f.at("support"));
  return words;
}

bool has_lamps(const Scene& scene) {
  return std::any_of(
             scene.lights.begin(), scene.lights.end(),
             [](const PunctualLight& l) { return l.kind != PunctualLight::Kind::directional; }) ||
         std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& m) { return max_component(m.emission) > 0; });
}

}  // namespace

PortalFrame frame_of(const Portal& portal) {
  const Plane plane = shape_of(portal).plane;
  PortalFrame f;
  f.o = plane.o;
  f.n = plane.n;
  // Openings in floors and ceilings: -z is up, as in a plan.
  const Vec3d upright = std::abs(f.n.y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{0, 0, -1};
  f.up = normalize(upright - f.n * dot(upright, f.n));
  f.right = cross(f.up, f.n);
  return f;
}

std::vector<std::array<uint32_t, 2>> outline_of(const Portal& portal) {
  std::map<std::array<uint32_t, 2>, int> uses;
  const auto sorted = [](uint32_t a, uint32_t b) {
    return std::array<uint32_t, 2>{std::min(a, b), std::max(a, b)};
  };
  for (const auto& t : portal.triangles)
    for (size_t k = 0; k < 3; ++k) ++uses[sorted(t[k], t[(k + 1) % 3])];
  std::vector<std::array<uint32_t, 2>> edges;
  for (const auto& t : portal.triangles)
    for (size_t k = 0; k < 3; ++k)
      if (uses[sorted(t[k], t[(k + 1) % 3])] == 1) edges.push_back({t[k], t[(k + 1) % 3]});
  return edges;
}

std::vector<SeenLine> lines_to_show(const LightGrid& grid,
                                    const std::vector<std::vector<uint32_t>>& lines, size_t own,
                                    const PortalFrame& frame) {
  std::vector<Way> way(grid.lines.size(), lines.empty() ? Way::elsewhere : Way::nowhere);
  for (const auto& of_portal : lines)
    for (const uint32_t l : of_portal) way[l] = Way::elsewhere;
  if (own < lines.size())
    for (const uint32_t l : lines[own]) way[l] = Way::here;
  const Plane plane{frame.o, frame.n};
  std::vector<SeenLine> seen;
  for (uint32_t l = 0; l < grid.lines.size(); ++l) {
    const LightLine& line = grid.lines[l];
    if (way[l] != Way::here && !crossing(plane, line)) continue;
    const Vec3d d = line.camera - line.light;
    const double t = dot(frame.o - line.light, frame.n) / dot(d, frame.n);
    seen.push_back({l, line.light + d * std::clamp(t, 0.0, 1.0), way[l]});
  }
  return seen;
}

draw::Drawing portal_preview(const LightGrid& grid, const std::vector<Portal>& portals,
                             const std::vector<std::vector<uint32_t>>& lines,
                             const std::string& name, const std::string& why_none) {
  std::vector<Row> rows;
  for (size_t i = 0; i < std::min(portals.size(), kMostRows); ++i)
    rows.push_back(row_of(portals[i], grid.voxel));
  if (rows.empty() && !grid.count.empty()) rows.push_back(whole_grid(grid));
  Drawing drawing{.title = "portalfit   " + base_name(name),
                  .sentence = count_words(portals.size(), why_none)};
  if (portals.size() > kMostRows)
    drawing.sentence += fmt::format(", the first {} shown", kMostRows);
  drawing.sentence += fmt::format("; {} lines of light in the grid",
                                  number(static_cast<double>(grid.lines.size())));
  const double height = rows.size() == 1 ? 480 : rows.size() == 2 ? 380 : 340;
  const double width = std::round((kSheetWidth - 3 * kMargin) / 2);
  draw::Rectangle panel{kMargin, kHeading, width, height};
  for (size_t i = 0; i < rows.size(); ++i, panel.y += height + kCaptionRoom) {
    const auto seen = lines_to_show(grid, lines, i, rows[i].frame);
    drawing.panels.push_back(front_of(grid, rows[i], seen, panel));
    if (rows[i].portal) drawing.panels.back().caption = words_for(*rows[i].portal, i);
    drawing.panels.push_back(
        above_of(grid, rows[i], seen, {2 * kMargin + width, panel.y, width, height}));
  }
  if (!rows.empty())
    drawing.key = {{{kPortal}, "portal and its normal"},
                   {{kInk}, "its lines"},
                   {{kMuted}, "through another"},
                   {{kAlarm}, "through none"},
                   {{mix(kPaper, heat(0.7), 0.4)}, "fuller voxels darker"}};
  return drawing;
}

draw::Drawing plan_preview(const Scene& scene, const Camera& camera, const FitResult& found,
                           const std::string& why_none) {
  Drawing drawing{.title = "portalfit   " + base_name(scene.path),
                  .sentence = count_words(found.portals.size(), why_none)};
  size_t not_drawn = 0;
  for (const FitResult::Refusal& r : found.refused) {
    if (r.polygons.empty()) continue;
    if (drawing.notes.size() == kMostReasons) {
      ++not_drawn;
      continue;
    }
    const std::string letter(1, static_cast<char>('A' + drawing.notes.size()));
    drawing.notes.push_back(fmt::format("{}: {}", letter, r.why));
    for (const std::vector<Vec3d>& p : r.polygons) {
      if (p.size() < 3) continue;
      Shape area{.name = "refused", .through = true},
          outline{.name = "refused", .kind = Shape::Kind::lines, .size = 3, .through = true};
      for (size_t k = 0; k < p.size(); ++k) {
        outline.line(p[k], p[(k + 1) % p.size()], kRefused);
        if (k > 1) area.triangle(p[0], p[k - 1], p[k], {kRefused, 0.3f});
      }
      drawing.shapes.push_back(std::move(area));
      drawing.shapes.push_back(std::move(outline));
      label_outline(drawing, p, letter, ink(0x5f636b));
    }
  }
  if (!drawing.notes.empty()) drawing.sentence += "; grey: what was refused, by the letters below";
  if (not_drawn > 0) drawing.notes.push_back(fmt::format("{} more are not drawn", not_drawn));
  std::vector<Vec3d> places;
  for (const Portal& portal : found.portals) {
    const PortalFrame f = frame_of(portal);
    std::string words = fmt::format("portal.{}", places.size());
    if (std::abs(f.n.y) > 0.7) words += f.n.y > 0 ? ", up" : ", down";
    label_outline(drawing, portal.vertices, words, ink(0x0a5f4b));
    places.push_back(f.o);
  }
  for (Shape& shape : portal_shapes(found.portals)) drawing.shapes.push_back(std::move(shape));
  drawing.panels = scene_panels(
      scene, camera, places, [](uint32_t, const Vec3d&) { return kPaper; }, false);
  drawing.key = {{{kPortal}, "portal; the arrow is the way of the light"},
                 {{kCutCamera}, "camera and its view"},
                 {{kCutWall}, "cut at eye height"},
                 {{kCutGlass}, "pane"}};
  if (has_lamps(scene)) drawing.key.push_back({{kLamp}, "lamps"});
  if (!drawing.notes.empty()) drawing.key.push_back({{kRefused}, "refused"});
  return drawing;
}

std::string portal_debug_glb(const LightGrid& grid, const PortalFile& file) {
  std::vector<Shape> shapes = portal_shapes(file.portals);
  Shape lines{.name = "lines of light", .kind = Shape::Kind::lines};
  for (const LightLine& l : thinned(grid.lines, kMostGlbLines))
    lines.line(l.light, l.camera, kLight, kCamera);
  shapes.push_back(std::move(lines));
  return debug_glb_bytes(shapes, file.provenance);
}

}  // namespace tdpt
