#include "tools/portalfit/preview.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "libcommon/base/words.h"
#include "libcommon/draw/sheet.h"
#include "libcommon/formats/debug_glb.h"
#include "libcommon/math/reach.h"
#include "tools/portalfit/plane.h"

namespace tdpt {
namespace {

using namespace draw;

constexpr size_t kMostRows = 6, kMostLines = 60, kMostGlbLines = 400;
constexpr double kAround = 1.45;  // of the portal's half sides: what its row shows

// A flat view of a part of space in metres.
struct Flat {
  Box panel;
  Vec3d o, right, up;
  double half_width;
  double scale() const { return 0.5 * panel.width / half_width; }
  Point at(const Vec3d& p) const {
    const Vec3d d = p - o;
    return {panel.x + 0.5 * panel.width + scale() * dot(d, right),
            panel.y + 0.5 * panel.height - scale() * dot(d, up)};
  }
  Vec3d place(double x, double y) const {
    return o + right * ((x - panel.x - 0.5 * panel.width) / scale()) +
           up * ((panel.y + 0.5 * panel.height - y) / scale());
  }
};

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

// The fullest voxel within `reach` before and behind the view's plane.
void draw_voxels(Canvas& canvas, const LightGrid& grid, const Flat& view, double reach) {
  const float most =
      grid.count.empty() ? 0 : *std::max_element(grid.count.begin(), grid.count.end());
  const Vec3d deep = cross(view.right, view.up);
  const int steps = std::clamp(static_cast<int>(std::ceil(2 * reach / grid.voxel)), 1, 64);
  // Voxels are larger than pixels: texels of two are enough.
  constexpr double kTexel = 2;
  Raster shades(static_cast<int>(std::ceil(view.panel.width / kTexel)),
                static_cast<int>(std::ceil(view.panel.height / kTexel)), ink(0xffffff));
  for (int y = 0; y < shades.height(); ++y)
    for (int x = 0; x < shades.width(); ++x) {
      const Vec3d place =
          view.place(view.panel.x + (x + 0.5) * kTexel, view.panel.y + (y + 0.5) * kTexel);
      float count = 0;
      for (int k = 0; k < steps; ++k)
        count =
            std::max(count, count_at(grid, place + deep * (reach * ((2.0 * k + 1) / steps - 1))));
      if (count == 0) continue;
      const double shade =
          std::log1p(static_cast<double>(count)) / std::log1p(static_cast<double>(most));
      shades.at(x, y) = mix(ink(0xffffff), heat(shade), 0.4 * shade);
    }
  canvas.clip(view.panel);
  canvas.raster({view.panel.x, view.panel.y}, kTexel, shades);
  canvas.unclip();
}

const Ink& ink_of(Way way, const Ink& here) {
  return way == Way::here ? here : way == Way::elsewhere ? kMuted : kAlarm;
}

// Thousands of dots in the same place of their pixel take far fewer bytes.
Point on_pixel(const Point& p) {
  return {std::floor(p.x) + 0.5, std::floor(p.y) + 0.5};
}

void draw_front(Canvas& canvas, const LightGrid& grid, const Row& row, const Flat& view,
                const std::vector<SeenLine>& lines) {
  draw_voxels(canvas, grid, view, row.portal ? 0.75 * grid.voxel : row.half_right);
  canvas.clip(view.panel);
  if (row.portal)
    for (const auto& t : row.portal->triangles)
      canvas.polygon({view.at(row.portal->vertices[t[0]]), view.at(row.portal->vertices[t[1]]),
                      view.at(row.portal->vertices[t[2]])},
                     kPortal, 0.12);
  for (const Way way : {Way::elsewhere, Way::here, Way::nowhere})
    for (const SeenLine& c : lines)
      if (c.way == way)
        canvas.disc(on_pixel(view.at(c.at)), 1.0, ink_of(way, kInk),
                    way == Way::nowhere ? 0.9 : 0.5);
  if (row.portal) {
    for (const auto& e : outline_of(*row.portal))
      canvas.line(view.at(row.portal->vertices[e[0]]), view.at(row.portal->vertices[e[1]]), 2.5,
                  kPortal);
    for (const auto& e : outline_of(*row.portal))
      canvas.disc(view.at(row.portal->vertices[e[0]]), 3.2, kPortal);
  }
  canvas.unclip();
}

// Between which places across all but one in a hundred of the lines pass, along the way.
void draw_envelope(Canvas& canvas, const LightGrid& grid, const Row& row, const Flat& view,
                   const std::vector<SeenLine>& lines) {
  constexpr int kStations = 120;
  const double far = view.half_width;
  std::array<Point, 2> before{};
  bool has_before = false;
  for (int s = 0; s <= kStations; ++s) {
    const double along = far * (2.0 * s / kStations - 1);
    std::vector<double> across;
    for (const SeenLine& c : lines) {
      if (c.way != Way::here) continue;
      const LightLine& l = grid.lines[c.line];
      const Vec3d w = l.camera - l.light;
      const double t = (along + dot(row.frame.o - l.light, row.frame.n)) / dot(w, row.frame.n);
      if (t >= 0 && t <= 1) across.push_back(dot(l.light + w * t - row.frame.o, row.frame.right));
    }
    if (across.size() < 100) {
      has_before = false;
      continue;
    }
    std::array<Point, 2> now;
    for (size_t side = 0; side < 2; ++side) {
      const auto rank = static_cast<std::ptrdiff_t>((side == 0 ? 0.01 : 0.99) *
                                                    static_cast<double>(across.size() - 1));
      std::nth_element(across.begin(), across.begin() + rank, across.end());
      now[side] = view.at(row.frame.o + row.frame.n * along +
                          row.frame.right * across[static_cast<size_t>(rank)]);
      if (has_before && s % 2 == 0) canvas.line(before[side], now[side], 1.6, kInk, 0.8);
    }
    before = now;
    has_before = true;
  }
}

// From a place towards another.
void draw_arrow(Canvas& canvas, const Point& from, const Point& towards) {
  const double length = std::hypot(towards.x - from.x, towards.y - from.y);
  if (!(length > 0)) return;
  const double x = (towards.x - from.x) / length, y = (towards.y - from.y) / length;
  const auto at = [&](double along, double across) {
    return Point{from.x + along * x - across * y, from.y + along * y + across * x};
  };
  canvas.line(from, at(52, 0), 2.5, kPortal);
  canvas.polygon({at(64, 0), at(50, -6), at(50, 6)}, kPortal);
}

void draw_above(Canvas& canvas, const LightGrid& grid, const Row& row, const Flat& view,
                const std::vector<SeenLine>& lines) {
  draw_voxels(canvas, grid, view, row.half_up / kAround);
  canvas.clip(view.panel);
  for (const SeenLine& line : thinned(lines, kMostLines)) {
    const LightLine& l = grid.lines[line.line];
    const Point from = view.at(l.light), middle = view.at(line.at), to = view.at(l.camera);
    const Way way = line.way;
    const double alpha = way == Way::here ? 0.5 : way == Way::elsewhere ? 0.12 : 0.5;
    canvas.line(from, middle, 1, ink_of(way, ink(0xc07a10)), alpha);
    canvas.line(middle, to, 1, ink_of(way, ink(0x2a6bab)), alpha);
  }
  if (row.portal) {
    draw_envelope(canvas, grid, row, view, lines);
    double low = INFINITY, high = -INFINITY;
    for (const Vec3d& v : row.portal->vertices) {
      low = std::min(low, dot(v - row.frame.o, row.frame.right));
      high = std::max(high, dot(v - row.frame.o, row.frame.right));
    }
    canvas.line(view.at(row.frame.o + row.frame.right * low),
                view.at(row.frame.o + row.frame.right * high), 4.5, kPortal);
    draw_arrow(canvas, view.at(row.frame.o), view.at(row.frame.o + row.frame.n));
  }
  canvas.unclip();
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

std::string words_for(const Portal& portal, size_t i) {
  const auto& f = portal.figures;
  std::string words = fmt::format("portal.{}", i);
  if (f.contains("area")) words += fmt::format(": {} m2", number_words(f.at("area")));
  if (f.contains("support")) words += fmt::format(", support {:.2f}", f.at("support"));
  return words;
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

draw::Canvas portal_preview(const LightGrid& grid, const std::vector<Portal>& portals,
                            const std::vector<std::vector<uint32_t>>& lines,
                            const std::string& name, const std::string& why_none) {
  std::vector<Row> rows;
  for (size_t i = 0; i < std::min(portals.size(), kMostRows); ++i)
    rows.push_back(row_of(portals[i], grid.voxel));
  if (rows.empty() && !grid.count.empty()) rows.push_back(whole_grid(grid));
  const double height = rows.size() == 1 ? 480 : rows.size() == 2 ? 380 : 340, pitch = height + 48;
  const double width = std::round((kSheetWidth - 3 * kMargin) / 2);
  Canvas canvas(kSheetWidth,
                static_cast<int>(kHeading + pitch * static_cast<double>(rows.size()) + 50), kPaper);
  std::string sentence =
      portals.empty() ? "no portal: " + why_none
                      : fmt::format("{} portal{}", portals.size(), portals.size() == 1 ? "" : "s");
  if (portals.size() > kMostRows) sentence += fmt::format(", the first {} shown", kMostRows);
  sentence += fmt::format("; {} lines of light in the grid",
                          number(static_cast<double>(grid.lines.size())));
  heading(canvas, "portalfit   " + base_name(name), sentence);

  if (rows.empty()) return canvas;
  for (size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    const double top = kHeading + pitch * static_cast<double>(i);
    Flat front{{kMargin, top, width, height}, row.frame.o, row.frame.right, row.frame.up, 0};
    front.half_width = std::max(row.half_right, row.half_up * width / height);
    const bool level = std::abs(row.frame.n.y) >= 0.9;
    // In plan x runs to the right and z down, as in every stage's; openings in floors and ceilings
    // are seen edge-on from the front, y up.
    Flat above{{2 * kMargin + width, top, width, height},
               row.frame.o,
               {1, 0, 0},
               level ? Vec3d{0, 1, 0} : Vec3d{0, 0, -1},
               0};
    above.half_width = std::max(1.3 * row.half_right * width / height, 6 * grid.voxel);
    if (!row.portal)
      above.half_width = std::max(row.half_right, 0.53 * grid.dim[2] * grid.voxel * width / height);
    const auto seen = lines_to_show(grid, lines, i, row.frame);
    draw_front(canvas, grid, row, front, seen);
    draw_above(canvas, grid, row, above, seen);
    for (const Flat* view : {&front, &above}) {
      canvas.frame(view->panel, 1, kFaint);
      scale_bar(canvas, {view->panel.right() - 2, view->panel.bottom() + 26}, view->scale());
    }
    caption(canvas, front.panel,
            row.portal ? words_for(*row.portal, i) : "from the front, along -z");
    caption(canvas, above.panel,
            fmt::format("{}{}", level ? "from the front, along -z" : "from above",
                        row.portal ? "; the light goes along the arrow" : ""));
  }
  key(canvas, {kMargin, canvas.height() - 30.0},
      {{kPortal, "portal and its normal"},
       {kInk, "its lines; 1 % lie beyond each dashed line"},
       {kMuted, "through another"},
       {kAlarm, "through none"},
       {mix(kPaper, heat(0.7), 0.4), "fuller voxels darker"}});
  return canvas;
}

std::string portal_debug_glb(const LightGrid& grid, const PortalFile& file, DebugLines as) {
  std::vector<DebugMesh> meshes;
  DebugMesh outlines{.name = "outlines", .kind = DebugMesh::Kind::lines},
      normals{.name = "normals", .kind = DebugMesh::Kind::lines},
      lines{.name = "lines of light", .kind = DebugMesh::Kind::lines};
  const auto green = bytes_of(kPortal), dark = bytes_of(kInk);
  for (size_t i = 0; i < file.portals.size(); ++i) {
    const Portal& portal = file.portals[i];
    DebugMesh mesh{.name = fmt::format("portal.{}", i)};
    for (const auto& t : portal.triangles)
      mesh.triangle(portal.vertices[t[0]], portal.vertices[t[1]], portal.vertices[t[2]],
                    bytes_of(kPortal, 110));
    meshes.push_back(std::move(mesh));
    for (const auto& e : outline_of(portal))
      outlines.line(portal.vertices[e[0]], portal.vertices[e[1]], green, green);
    const PortalFrame f = frame_of(portal);
    const double arrow = std::sqrt(shape_of(portal).area);
    const Vec3d tip = f.o + f.n * arrow;
    normals.line(f.o, tip, dark, dark);
    for (const Vec3d& side : {f.up, -f.up, f.right, -f.right})
      normals.line(tip, tip - f.n * (0.2 * arrow) + side * (0.1 * arrow), dark, dark);
  }
  for (const LightLine& l : thinned(grid.lines, kMostGlbLines))
    lines.line(l.light, l.camera, bytes_of(kLight), bytes_of(kCamera));
  meshes.insert(meshes.end(), {outlines, normals, lines});
  return debug_glb_bytes(meshes, file.provenance, as);
}

}  // namespace tdpt
