#include "libcommon/draw/plan.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "libcommon/base/words.h"
#include "libcommon/draw/sheet.h"

namespace tdpt::draw {
namespace {

constexpr int kCells = 2;              // per pixel, along each axis, where what is solid is found
constexpr double kThickestWall = 1.2;  // [m]
constexpr size_t kMostLamps = 4096, kMostAvoided = 64;  // drawn; kept free of labels
Projection from_above(const Scene& scene, const Storey& storey, const Extent& extent,
                      const Box& panel) {
  const Vec3d middle{0.5 * (extent.low_x + extent.high_x), storey.cut,
                     0.5 * (extent.low_z + extent.high_z)};
  const double width = extent.high_x - extent.low_x, depth = extent.high_z - extent.low_z;
  const double half = 0.5 * std::max(width, depth * panel.width / panel.height);
  return Projection::flat(scene.frame.to_canonical(middle), {1, 0, 0}, {0, 0, -1},
                          std::max(half * scene.frame.scale, 1e-6), panel);
}

bool overlap(const Box& a, const Box& b) {
  return a.x < b.right() && b.x < a.right() && a.y < b.bottom() && b.y < a.bottom();
}

Box around(const Point& a, const Point& b, double more) {
  const double x = std::min(a.x, b.x) - more, y = std::min(a.y, b.y) - more;
  return {x, y, std::max(a.x, b.x) + more - x, std::max(a.y, b.y) + more - y};
}

// Length in pixels of the line from a to b within a box.
double within(const Point& a, const Point& b, const Box& box) {
  double enter = 0, leave = 1;
  const auto clip = [&](double from, double to, double low, double high) {
    const double d = to - from;
    if (d == 0) {
      if (from < low || from >= high) leave = -1;
      return;
    }
    enter = std::max(enter, std::min((low - from) / d, (high - from) / d));
    leave = std::min(leave, std::max((low - from) / d, (high - from) / d));
  };
  clip(a.x, b.x, box.x, box.right());
  clip(a.y, b.y, box.y, box.bottom());
  return leave > enter ? (leave - enter) * std::hypot(b.x - a.x, b.y - a.y) : 0;
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

}  // namespace

Extent extent_of(const std::vector<Storey>& storeys, const std::vector<Vec3d>& places) {
  Extent e{INFINITY, INFINITY, -INFINITY, -INFINITY};
  const auto include = [&e](const Vec3d& low, const Vec3d& high) {
    e.low_x = std::min(e.low_x, low.x);
    e.low_z = std::min(e.low_z, low.z);
    e.high_x = std::max(e.high_x, high.x);
    e.high_z = std::max(e.high_z, high.z);
  };
  for (const Storey& s : storeys) include(s.low, s.high);
  // A camera before the house is shown, one on the next hill would make the house too small.
  const double near = 0.3 * std::max(e.high_x - e.low_x, e.high_z - e.low_z), margin = 0.4;
  const Extent house = e;
  for (const Vec3d& p : places)
    if (p.x > house.low_x - near && p.x < house.high_x + near && p.z > house.low_z - near &&
        p.z < house.high_z + near)
      include(p - Vec3d(margin), p + Vec3d(margin));
  return e;
}

Plan::Plan(Canvas& canvas, const Scene& scene, const Tracer& tracer, Storey storey,
           const Extent& extent, const Box& panel)
    : canvas_(canvas),
      scene_(scene),
      storey_(std::move(storey)),
      tracer_(tracer),
      section_(section(scene, scene.frame.to_canonical({0, storey_.cut, 0}).y)),
      view_(canvas, tracer, from_above(scene, storey_, extent, panel)) {}

Point Plan::project(const Vec3d& place) const {
  return projection().project(scene_.frame.to_canonical(place));
}

void Plan::paint(const Colouring& colour, const Ink& nothing) {
  view_.paint(colour, nothing, [this](Raster& seen) { darken_solid(seen); });
  draw_section();
  draw_lamps();
}

void Plan::darken_solid(Raster& seen) {
  const Projection& p = projection();
  const double half_height = p.half_width * p.panel.height / p.panel.width;
  // What lies beyond the panel tells a wall from the ground.
  const double cell = 2 * p.half_width / (kCells * seen.width()),
               thickest = kThickestWall * scene_.frame.scale;
  const int beyond = std::min(static_cast<int>(std::ceil(thickest / cell)), kCells * seen.width());
  grid_ = {p.eye.x - p.half_width - beyond * cell, p.eye.z - half_height - beyond * cell, cell,
           kCells * seen.width() + 2 * beyond, kCells * seen.height() + 2 * beyond};
  std::vector<Vec3d> air;
  for (const Vec3d& place : storey_.air) air.push_back(scene_.frame.to_canonical(place));
  cells_ = filled(scene_, section_, grid_, air, thickest);
  for (int y = 0; y < seen.height(); ++y)
    for (int x = 0; x < seen.width(); ++x) {
      int walls = 0, earth = 0;
      for (int k = 0; k < kCells * kCells; ++k) {
        const auto at = static_cast<size_t>(beyond + kCells * x + k % kCells) +
                        static_cast<size_t>(grid_.columns) *
                            static_cast<size_t>(beyond + kCells * y + k / kCells);
        walls += cells_[at] == Filled::wall;
        earth += cells_[at] == Filled::earth;
      }
      constexpr double kAll = kCells * kCells;
      seen.at(x, y) = mix(seen.at(x, y), kCutEarth, earth / kAll);
      seen.at(x, y) = mix(seen.at(x, y), kCutWall, walls / kAll);
    }
}

// Seams of the ground are no edges of anything.
bool Plan::within_earth(const Segment& s) const {
  const Vec3d along = normalize(s.b - s.a), middle = (s.a + s.b) * 0.5;
  for (const double side : {-2.0, 2.0}) {
    const double i = (middle.x - along.z * side * grid_.cell - grid_.low_x) / grid_.cell,
                 j = (middle.z + along.x * side * grid_.cell - grid_.low_z) / grid_.cell;
    if (!(i >= 0 && i < grid_.columns && j >= 0 && j < grid_.rows)) continue;
    if (cells_[static_cast<size_t>(i) +
               static_cast<size_t>(grid_.columns) * static_cast<size_t>(j)] != Filled::earth)
      return false;
  }
  return true;
}

void Plan::draw_section() {
  canvas_.clip(projection().panel);
  std::vector<std::array<Point, 2>> walls, panes;
  for (const Segment& s : section_) {
    const Point a = projection().project(s.a), b = projection().project(s.b);
    if (within(a, b, projection().panel) > 0 && !within_earth(s))
      (is_pane(scene_, s.triangle) ? panes : walls).push_back({a, b});
  }
  canvas_.lines(walls, 1.2, kCutWall);
  canvas_.lines(panes, 1.4, kCutGlass);
  canvas_.unclip();
}

// Ceiling lamps are cut away: their outlines are drawn anyway.
void Plan::draw_lamps() {
  canvas_.clip(projection().panel);
  size_t lamps = 0;
  const auto end = std::min<size_t>(scene_.triangles.size(), scene_.dome);
  for (uint32_t t = 0; t < end && lamps < kMostLamps; ++t) {
    if (!(max_component(scene_.material_of(t).emission) > 0)) continue;
    if (!holds(scene_.frame.to_metres(Vec3d(scene_.vertex(t, 0))))) continue;
    ++lamps;
    std::vector<Point> corners;
    for (int k = 0; k < 3; ++k) corners.push_back(projection().project(Vec3d(scene_.vertex(t, k))));
    canvas_.polygon(corners, kLamp);
    if (lamps <= kMostAvoided) taken_.push_back(around(corners[0], corners[1], 2));
    for (size_t k = 0; k < 3; ++k) canvas_.line(corners[k], corners[(k + 1) % 3], 3, kLamp);
  }
  for (const PunctualLight& light : scene_.lights) {
    if (light.kind == PunctualLight::Kind::directional) continue;
    if (!holds(scene_.frame.to_metres(light.position))) continue;
    const Point at = projection().project(light.position);
    canvas_.disc(at, 7, kInk);
    canvas_.disc(at, 5.5, kLamp);
    if (++lamps <= kMostAvoided) taken_.push_back(around(at, at, 8));
  }
  canvas_.unclip();
}

void Plan::line(const Vec3d& from, const Vec3d& to, double width, const Ink& c, double alpha) {
  double enter = 0, leave = 1;
  const double d = to.y - from.y;
  if (d == 0 && !holds(from)) return;
  if (d != 0) {
    const double t0 = (storey_.bottom - from.y) / d, t1 = (storey_.top - from.y) / d;
    enter = std::max(enter, std::min(t0, t1));
    leave = std::min(leave, std::max(t0, t1));
  }
  if (!(enter < leave)) return;
  const Vec3d a = scene_.frame.to_canonical(from), b = scene_.frame.to_canonical(to);
  view_.line(a + (b - a) * enter, a + (b - a) * leave, width, c, alpha);
}

void Plan::dot(const Vec3d& place, double radius, const Ink& c, double alpha) {
  if (holds(place)) view_.dot_at(scene_.frame.to_canonical(place), radius, c, alpha);
}

// An outline that only its sill lies below the floor of belongs to the storey above.
bool Plan::holds(const std::vector<Vec3d>& outline) const {
  constexpr double kLeast = 0.2;  // of its height
  double low = INFINITY, high = -INFINITY;
  for (const Vec3d& v : outline) low = std::min(low, v.y), high = std::max(high, v.y);
  const double within = std::min(high, storey_.top) - std::max(low, storey_.bottom);
  return within > 0 ? within >= kLeast * (high - low) : within == 0 && low == high;
}

void Plan::openings(const std::vector<Opening>& openings) {
  canvas_.clip(projection().panel);
  for (const bool refused : {true, false})
    for (const Opening& o : openings) {
      if (o.refused != refused) continue;
      const Ink colour = refused ? kRefused : kPortal;
      // Upright ones are a line in plan, others an area.
      const bool upright = std::abs(o.way.y) < 0.35;
      Vec3d sum{};
      for (const Vec3d& v : o.outline) sum = sum + v;
      if (!holds(o.outline)) continue;
      const Point middle = project(sum / static_cast<double>(o.outline.size()));
      Point low = middle, high = middle;
      std::vector<Point> points;
      for (const Vec3d& v : o.outline) {
        points.push_back(project(v));
        const Point& p = points.back();
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
      }
      canvas_.polygon(points, colour, 0.3);
      for (size_t k = 0; k < points.size(); ++k)
        canvas_.line(points[k], points[(k + 1) % points.size()],
                     !upright  ? 1.4
                     : refused ? 3
                               : 4.5,
                     colour);
      const double across = std::hypot(o.way.x, o.way.z);
      if (across > 0.3 && !refused) {
        const double x = o.way.x / across, y = o.way.z / across;
        const auto at = [&](double along, double side) {
          return Point{middle.x + along * x - side * y, middle.y + along * y + side * x};
        };
        canvas_.line(middle, at(15, 0), 2, colour);
        canvas_.polygon({at(22, 0), at(13, -4.5), at(13, 4.5)}, colour);
        taken_.push_back(around(at(22, 0), at(22, 0), 4));
      }
      taken_.push_back(around(low, high, 4));
      if (!o.label.empty() && projection().panel.contains(middle))
        labels_.push_back({middle, o.label, refused ? ink(0x5f636b) : ink(0x0a5f4b)});
    }
  canvas_.unclip();
}

void Plan::camera(const Camera& camera) {
  const Vec3d metres = scene_.frame.to_metres(camera.position);
  if (!holds(metres)) return;
  canvas_.clip(projection().panel);
  const Point at = projection().project(camera.position);
  const double aspect = camera.aspect > 0 ? camera.aspect : 16.0 / 9;
  const double half = std::tan(0.5 * camera.yfov) * aspect;
  const double reach = std::clamp(0.15 * projection().panel.width, 60.0, 150.0),
               scale = projection().pixels_per_unit();
  // Only as far as it sees, at its own height.
  std::vector<Point> cone{at};
  constexpr int kRays = 40;
  for (int k = -kRays; k <= kRays; ++k) {
    const Vec3d w = camera.forward + camera.right * (half * k / kRays);
    const double across = std::hypot(w.x, w.z);
    if (across < 1e-9) continue;
    const Vec3d level{w.x / across, 0, w.z / across};
    Hit hit;
    const double far = tracer_.first_seen(camera.position, level, hit)
                           ? std::min(reach, hit.distance * scale)
                           : reach;
    cone.push_back({at.x + far * level.x, at.y + far * level.z});
  }
  if (cone.size() > 2) {
    canvas_.polygon(cone, kCutCamera, 0.22);
    for (const Point& end : {cone[1], cone.back()}) canvas_.line(at, end, 1.6, kCutCamera);
  }
  canvas_.disc(at, 6.5, ink(0xffffff));
  canvas_.disc(at, 4.8, kCutCamera);
  canvas_.unclip();
  taken_.push_back(around(at, at, 8));
  for (size_t k = 1; k < cone.size(); k += 8)
    for (const double t : {0.35, 0.7, 1.0})
      taken_.push_back(around({at.x + t * (cone[k].x - at.x), at.y + t * (cone[k].y - at.y)},
                              {at.x + t * (cone[k].x - at.x), at.y + t * (cone[k].y - at.y)}, 1));
  if (projection().panel.contains(at))
    labels_.push_back({at, camera.name.empty() ? "camera" : camera.name, kCutCamera});
}

// Each beside its mark, where nothing else is.
void Plan::draw_labels() {
  constexpr double kHigh = kSmallSize + 7;
  const Box& panel = projection().panel;
  for (size_t own = 0; own < labels_.size(); ++own) {
    const Label& label = labels_[own];
    const double wide = text_width(label.words, kSmallSize) + 8;
    Box best;
    double least = INFINITY;
    for (const double away : {16.0, 26.0, 38.0, 54.0, 74.0, 98.0})
      for (int k = 0; k < 16; ++k) {
        const double angle = 2 * 3.14159265358979 * (k + 0.5) / 16;
        const double x = label.at.x + std::cos(angle) * (away + 0.5 * wide),
                     y = label.at.y + std::sin(angle) * (away + 0.5 * kHigh);
        const Box box{x - 0.5 * wide, y - 0.5 * kHigh, wide, kHigh};
        if (box.x < panel.x + 2 || box.right() > panel.right() - 2 || box.y < panel.y + 2 ||
            box.bottom() > panel.bottom() - 2)
          continue;
        double cost = away;
        for (const Box& other : taken_)
          if (overlap(box, other)) cost += other.width < 3 ? 30 : 1000;
        // Better over a floor than over a wall.
        for (const Segment& s : section_)
          cost += 0.25 * within(projection().project(s.a), projection().project(s.b), box);
        if (cost < least) least = cost, best = box;
      }
    if (!(least < INFINITY)) continue;
    taken_.push_back(best);
    const Point end{std::clamp(label.at.x, best.x, best.right()),
                    std::clamp(label.at.y, best.y, best.bottom())};
    canvas_.line(label.at, end, 1, label.ink);
    canvas_.fill(best, ink(0xffffff), 0.88);
    canvas_.text({best.x + 4, best.bottom() - 4}, label.words, {kSmallSize, label.ink});
  }
}

// Which way x and z go, in place of north, which no scene tells.
void Plan::draw_axes(Point corner) {
  const auto arrow = [&](double dx, double dy, double length, const char* name) {
    const Point tip{corner.x + dx * length, corner.y + dy * length};
    canvas_.line(corner, tip, 1.4, kMuted);
    canvas_.polygon({{tip.x + dx * 5, tip.y + dy * 5},
                     {tip.x - dx * 2 - dy * 3, tip.y - dy * 2 + dx * 3},
                     {tip.x - dx * 2 + dy * 3, tip.y - dy * 2 - dx * 3}},
                    kMuted);
    canvas_.text({tip.x + dx * 14, tip.y + 4}, name,
                 {kSmallSize, kMuted, dx > 0 ? Align::middle : Align::right});
  };
  arrow(1, 0, 20, "x");
  arrow(0, 1, 12, "z  ");
}

void Plan::finish() {
  draw_labels();
  const Box& panel = projection().panel;
  canvas_.frame(panel, 1, kFaint);
  caption(canvas_, panel, name_of(storey_));
  const double left = scale_bar(canvas_, {panel.right() - 2, panel.bottom() + 26},
                                projection().pixels_per_unit() * scene_.frame.scale);
  draw_axes({left - 64, panel.bottom() + 14});
}

}  // namespace tdpt::draw
