#include "libcommon/draw/scene_panels.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "libcommon/base/words.h"
#include "libcommon/draw/section.h"
#include "libcommon/math/reach.h"
#include "libcommon/math/rng.h"

namespace tdpt::draw {
namespace {

constexpr int kSide = 2;               // rays per pixel, along each axis
constexpr double kThickestWall = 1.2;  // [m]
constexpr size_t kMostLamps = 4096;
const Vec3d kSun = normalize(Vec3d{0.4, 0.8, 0.45});

// The surface that a pixel shows, metres; normal 0: none.
struct Seen {
  Vec3d place, normal;
};

// How much neighbouring pixels show surfaces in different planes, in [0,1].
double edge_between(const Projection& view, const Seen& a, const Seen& b) {
  const bool none_a = a.normal == Vec3d{}, none_b = b.normal == Vec3d{};
  if (none_a || none_b) return none_a != none_b ? 1 : 0;
  const Vec3d step = b.place - a.place;
  const double size = view.pinhole ? length(a.place - view.eye) : view.half_width;
  const double gap = std::max(std::abs(dot(step, a.normal)), std::abs(dot(step, b.normal)));
  return gap > 0.02 * size ? 1 : std::clamp(1.8 - 2 * dot(a.normal, b.normal), 0.0, 0.8);
}

// Surfaces with light shading and dark edges.
void paint_surfaces(Panel& panel, const Scene& scene, const Tracer& tracer, const Colouring& colour,
                    const Ink& nothing) {
  const Projection& view = panel.view;
  const int columns = static_cast<int>(view.panel.width),
            rows = static_cast<int>(view.panel.height);
  panel.backdrop = Raster(columns, rows);
  std::vector<Seen> seen(static_cast<size_t>(columns) * static_cast<size_t>(rows));
  panel.depth.assign(seen.size(), INFINITY);
  // Each pixel belongs to one thread, so the order does not matter.
  tbb::parallel_for(0, rows, [&](int row) {
    for (int column = 0; column < columns; ++column) {
      Ink sum{};
      for (int k = 0; k < kSide * kSide; ++k) {
        Vec3d from, w;
        view.ray({view.panel.x + column + (k % kSide + 0.5) / kSide,
                  view.panel.y + row + (k / kSide + 0.5) / kSide},
                 from, w);
        from = scene.frame.to_canonical(from);
        Hit hit;
        if (view.pinhole ? !tracer.first_seen(from, w, hit) : !tracer.closest({from}, w, hit)) {
          sum += nothing;
          continue;
        }
        const double facing = dot(hit.normal, w);
        // Seen from above, most surfaces are horizontal: slanting light distinguishes them.
        const double shade = view.pinhole ? 0.68 + 0.32 * std::abs(facing)
                                          : 0.70 + 0.30 * std::abs(dot(hit.normal, kSun)) / kSun.y;
        sum += colour(2 * hit.triangle + (facing > 0 ? 1 : 0), hit.position) *
               static_cast<float>(std::min(shade, 1.0));
        if (k > 0) continue;
        const size_t at =
            static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column);
        seen[at] = {scene.frame.to_metres(hit.position), facing > 0 ? -hit.normal : hit.normal};
        panel.depth[at] = static_cast<float>(view.depth(seen[at].place));
      }
      panel.backdrop.at(column, row) = sum * (1.0f / (kSide * kSide));
    }
  });
  for (int row = 0; row + 1 < rows; ++row)
    for (int column = 0; column + 1 < columns; ++column) {
      const Seen* at = &seen[static_cast<size_t>(row) * static_cast<size_t>(columns) +
                             static_cast<size_t>(column)];
      const double edge =
          std::max(edge_between(view, at[0], at[1]), edge_between(view, at[0], at[columns]));
      Ink& c = panel.backdrop.at(column, row);
      c = mix(c, ink(0x2b2f36), 0.45 * edge);
    }
}

// Fills the walls, and outlines all that is cut.
void draw_section(Panel& panel, const Scene& scene, const Storey& storey) {
  const Projection& view = panel.view;
  const int columns = panel.backdrop.width(), rows = panel.backdrop.height();
  const double cell = 1 / view.pixels_per_metre();
  // What lies beyond the panel tells a wall from the ground.
  const int beyond = std::min(static_cast<int>(std::ceil(kThickestWall / cell)), columns);
  Vec3d low, w;
  view.ray({view.panel.x, view.panel.y}, low, w);
  const CellGrid grid{low.x - beyond * cell, low.z - beyond * cell, cell, columns + 2 * beyond,
                      rows + 2 * beyond};
  const std::vector<Segment> segments = section(scene, storey.cut);
  const std::vector<bool> is_wall = walls(scene, segments, grid, storey.air, kThickestWall);
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x)
      if (is_wall[static_cast<size_t>(x + beyond) +
                  static_cast<size_t>(grid.columns) * static_cast<size_t>(y + beyond)])
        panel.backdrop.at(x, y) = kCutWall;
  Shape lines{.name = "section", .kind = Shape::Kind::lines, .size = 1.3, .through = true};
  for (const Segment& s : segments)
    lines.line(s.a, s.b, is_pane(scene, s.triangle) ? kCutGlass : kCutWall);
  panel.shapes.push_back(std::move(lines));
}

// Ceiling lamps are cut away: they are drawn anyway.
void draw_lamps(Panel& panel, const Scene& scene) {
  Shape outlines{.name = "lamps", .kind = Shape::Kind::lines, .size = 3, .through = true},
      triangles{.name = "lamps", .through = true},
      rings{.name = "lamps", .kind = Shape::Kind::points, .size = 7, .through = true},
      discs{.name = "lamps", .kind = Shape::Kind::points, .size = 5.5, .through = true};
  const auto end = std::min<size_t>(scene.triangles.size(), scene.dome);
  size_t lamps = 0;
  for (uint32_t t = 0; t < end && lamps < kMostLamps; ++t) {
    if (!(max_component(scene.material_of(t).emission) > 0)) continue;
    Vec3d p[3];
    for (int k = 0; k < 3; ++k) p[k] = scene.frame.to_metres(Vec3d(scene.vertex(t, k)));
    if (!panel.shows((p[0] + p[1] + p[2]) / 3.0)) continue;
    ++lamps;
    triangles.triangle(p[0], p[1], p[2], kLamp);
    for (int k = 0; k < 3; ++k) outlines.line(p[k], p[(k + 1) % 3], kLamp);
  }
  for (const PunctualLight& light : scene.lights) {
    if (light.kind == PunctualLight::Kind::directional) continue;
    const Vec3d place = scene.frame.to_metres(light.position);
    if (!panel.shows(place)) continue;
    rings.point(place, kInk);
    discs.point(place, kLamp);
  }
  for (Shape* shape : {&triangles, &outlines, &rings, &discs})
    panel.shapes.push_back(std::move(*shape));
}

// The camera and what it sees at its own height, only as far as there is nothing in the way.
void draw_camera(Panel& panel, const Scene& scene, const Tracer& tracer, const Camera& camera) {
  constexpr int kRays = 40;
  const double reach =
      std::clamp(0.15 * panel.view.panel.width, 60.0, 150.0) / panel.view.pixels_per_metre();
  const double half = std::tan(0.5 * camera.yfov) * (camera.aspect > 0 ? camera.aspect : 16.0 / 9);
  const Vec3d at = scene.frame.to_metres(camera.position);
  std::vector<Vec3d> ends;
  for (int k = -kRays; k <= kRays; ++k) {
    Vec3d level = camera.forward + camera.right * (half * k / kRays);
    level.y = 0;
    if (!(length(level) > 1e-9)) continue;
    level = normalize(level);
    Hit hit;
    const bool stopped = tracer.first_seen(camera.position, level, hit);
    ends.push_back(at +
                   level * (stopped ? std::min(reach, hit.distance / scene.frame.scale) : reach));
  }
  Shape cone{.name = "camera", .through = true},
      sides{.name = "camera", .kind = Shape::Kind::lines, .size = 1.6, .through = true},
      ring{.name = "camera", .kind = Shape::Kind::points, .size = 6.5, .through = true},
      disc{.name = "camera", .kind = Shape::Kind::points, .size = 4.8, .through = true};
  for (size_t k = 1; k < ends.size(); ++k)
    cone.triangle(at, ends[k - 1], ends[k], {kCutCamera, 0.22f});
  if (!ends.empty())
    for (const Vec3d& end : {ends.front(), ends.back()}) sides.line(at, end, kCutCamera);
  ring.point(at, ink(0xffffff));
  disc.point(at, kCutCamera);
  for (Shape* shape : {&cone, &sides, &ring, &disc}) panel.shapes.push_back(std::move(*shape));
  panel.labels.push_back({at, camera.name.empty() ? "camera" : camera.name, kCutCamera});
}

std::string signed_metres(double height) {
  const double rounded = std::round(height * 100) / 100;
  return fmt::format("{}{} m",
                     rounded > 0   ? "+"
                     : rounded < 0 ? "\u2212"
                                   : "\u00b1",
                     number_words(std::abs(rounded)));
}

std::string name_of(const Storey& storey) {
  if (!storey.floor) return fmt::format("Plan below y = {} m", number_words(storey.cut));
  return fmt::format("Storey at {}, cut at {}", signed_metres(*storey.floor),
                     signed_metres(storey.cut));
}

// What the plans show, each the same: the storeys, and the camera if it stands near. One on the
// next hill would make the house too small.
Extent extent_of(const std::vector<Storey>& storeys, const Vec3d& camera) {
  Extent house;
  for (const Storey& s : storeys) house.add(s.low), house.add(s.high);
  const double near = 0.3 * std::max(house.size().x, house.size().z);
  const Vec3d beyond = max(house.low - camera, camera - house.high);
  if (beyond.x < near && beyond.z < near) {
    house.add(camera - Vec3d(0.4));
    house.add(camera + Vec3d(0.4));
  }
  return house;
}

}  // namespace

std::vector<Panel> scene_panels(const Scene& scene, const Camera& camera,
                                const std::vector<Vec3d>& places, const Colouring& colour,
                                bool with_camera) {
  const Tracer tracer(scene, camera.culls);
  const Vec3d eye = scene.frame.to_metres(camera.position);
  const std::vector<Storey> storeys = storeys_to_draw(scene, tracer, eye, places);
  const Extent extent = extent_of(storeys, eye);
  const Vec3d size = extent.size();
  std::vector<double> aspects(storeys.size(), std::clamp(size.x / size.z, 0.7, 3.0));
  if (with_camera)
    aspects.insert(aspects.begin(),
                   std::clamp(camera.aspect > 0 ? camera.aspect : 16.0 / 9, 0.6, 3.0));
  const std::vector<Rectangle> rectangles = arranged(aspects);
  std::vector<Panel> panels;
  if (with_camera) {
    panels.push_back({.view = Projection::of_camera(camera, scene.frame, rectangles[0]),
                      .caption = camera.name.empty()
                                     ? "The camera's view"
                                     : fmt::format("The view of '{}'", camera.name)});
    paint_surfaces(panels.back(), scene, tracer, colour, kVoid);
  }
  for (const Storey& storey : storeys) {
    Vec3d middle = (extent.low + extent.high) * 0.5;
    middle.y = storey.cut;
    Panel plan{.view = Projection::flat(middle, {1, 0, 0}, {0, 0, -1}, 0.5 * size.x, 0.5 * size.z,
                                        rectangles[panels.size()]),
               .caption = name_of(storey),
               .bottom = storey.bottom,
               .top = storey.top};
    paint_surfaces(plan, scene, tracer, colour, ink(0xffffff));
    draw_section(plan, scene, storey);
    draw_lamps(plan, scene);
    draw_camera(plan, scene, tracer, camera);
    panels.push_back(std::move(plan));
  }
  return panels;
}

size_t PatchLookup::Hash::operator()(const Key& k) const {
  uint64_t h = mix64(k.face + (static_cast<uint64_t>(k.level) << 40));
  for (const int32_t c : k.cell) h = mix64(h ^ static_cast<uint32_t>(c));
  return h;
}

PatchLookup::PatchLookup(const Frame& frame, const PatchGrid& grid,
                         const std::vector<Patch>& patches)
    : frame_(frame), grid_(grid) {
  for (size_t i = 0; i < patches.size(); ++i) {
    const Patch& p = patches[i];
    if (std::find(levels_.begin(), levels_.end(), p.level) == levels_.end())
      levels_.push_back(p.level);
    for (const uint32_t face : p.faces)
      patch_.emplace(Key{face, p.level, p.cell}, static_cast<uint32_t>(i));
  }
  std::sort(levels_.rbegin(), levels_.rend());
}

std::optional<uint32_t> PatchLookup::at(uint32_t face, const Vec3d& place) const {
  const Vec3d metres = frame_.to_metres(place);
  for (const int level : levels_) {
    // Uses the same operations as ffgraph, so that rounding at borders agrees.
    const Vec3d q = (metres - grid_.origin) / grid_.base_cell;
    const double fine = std::ldexp(1.0, 2 * level);
    Key key{face, level, {}};
    for (int c = 0; c < 3; ++c)
      key.cell[static_cast<size_t>(c)] =
          static_cast<int32_t>(std::clamp(std::floor(q[c] * fine), -2147483648.0, 2147483647.0));
    if (const auto found = patch_.find(key); found != patch_.end()) return found->second;
  }
  return {};
}

void add_patch(Shape& shape, const PatchGrid& grid, const Patch& patch, const Ink& c) {
  const double cell = std::ldexp(grid.base_cell, -2 * patch.level);
  shape.square(patch.centre + patch.normal * (0.01 * cell), patch.normal, 0.94 * cell, c);
}

}  // namespace tdpt::draw
