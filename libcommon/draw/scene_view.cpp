#include "libcommon/draw/scene_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <tbb/parallel_for.h>

namespace tdpt::draw {
namespace {
constexpr double kNear = 1e-4;  // near plane of the perspective; canonical
constexpr int kSide = 2;        // rays per pixel, along each axis
const Vec3d kSun = normalize(Vec3d{0.4, 0.8, 0.45});
}  // namespace

Projection Projection::of_camera(const Camera& camera, const Box& panel) {
  const double half_height = std::tan(0.5 * camera.yfov);
  return {panel,     camera.position, camera.right,
          camera.up, camera.forward,  half_height * panel.width / panel.height,
          true};
}

Projection Projection::flat(const Vec3d& middle, const Vec3d& right, const Vec3d& up,
                            double half_width, const Box& panel) {
  return {panel, middle, right, up, cross(up, right), half_width, false};
}

Point Projection::project(const Vec3d& place) const {
  const Vec3d d = place - eye;
  const double scale = pixels_per_unit() / (pinhole ? dot(d, forward) : 1.0);
  return {panel.x + 0.5 * panel.width + scale * dot(d, right),
          panel.y + 0.5 * panel.height - scale * dot(d, up)};
}

void Projection::ray(const Point& at, Vec3d& from, Vec3d& w) const {
  const double u = (at.x - panel.x - 0.5 * panel.width) / pixels_per_unit(),
               v = (panel.y + 0.5 * panel.height - at.y) / pixels_per_unit();
  const Vec3d off = right * u + up * v;
  from = pinhole ? eye : eye + off;
  w = pinhole ? normalize(forward + off) : forward;
}

SceneView::SceneView(Canvas& canvas, const Tracer& tracer, const Projection& projection)
    : canvas_(canvas),
      tracer_(tracer),
      projection_(projection),
      left_(static_cast<int>(std::lround(projection.panel.x))),
      top_(static_cast<int>(std::lround(projection.panel.y))),
      columns_(static_cast<int>(std::lround(projection.panel.right())) - left_),
      rows_(static_cast<int>(std::lround(projection.panel.bottom())) - top_) {}

void SceneView::paint(const Colouring& colour, const Ink& nothing,
                      const std::function<void(Raster&)>& over) {
  samples_.assign(static_cast<size_t>(columns_) * static_cast<size_t>(rows_), {});
  Raster seen(columns_, rows_);
  // Each pixel belongs to one thread, so the order does not matter.
  tbb::parallel_for(0, rows_, [&](int row) {
    for (int column = 0; column < columns_; ++column) {
      Ink sum{};
      for (int k = 0; k < kSide * kSide; ++k) {
        const double dx = (k % kSide + 0.5) / kSide, dy = (k / kSide + 0.5) / kSide;
        Vec3d from, w;
        projection_.ray({left_ + column + dx, top_ + row + dy}, from, w);
        Hit hit;
        if (projection_.pinhole ? !tracer_.first_seen(from, w, hit)
                                : !tracer_.closest({from}, w, hit)) {
          sum += nothing;
          continue;
        }
        const double facing = dot(hit.normal, w);
        const uint32_t face = 2 * hit.triangle + (facing > 0 ? 1 : 0);
        // Seen from above, most surfaces are horizontal: slanting light distinguishes them.
        const double shade = projection_.pinhole
                                 ? 0.68 + 0.32 * std::abs(facing)
                                 : 0.70 + 0.30 * std::abs(dot(hit.normal, kSun)) / kSun.y;
        sum += colour(face, hit.position) * static_cast<float>(std::min(shade, 1.0));
        if (k == 0)
          samples_[static_cast<size_t>(row) * static_cast<size_t>(columns_) +
                   static_cast<size_t>(column)] = {Vec3f(hit.position),
                                                   Vec3f(facing > 0 ? -hit.normal : hit.normal)};
      }
      seen.at(column, row) = sum * (1.0f / (kSide * kSide));
    }
  });
  darken_edges(seen);
  if (over) over(seen);
  canvas_.raster({static_cast<double>(left_), static_cast<double>(top_)}, 1, seen);
}

// Darkens pixels whose neighbour shows a surface in another plane.
void SceneView::darken_edges(Raster& seen) const {
  const auto at = [&](int column, int row) -> const Sample& {
    return samples_[static_cast<size_t>(row) * static_cast<size_t>(columns_) +
                    static_cast<size_t>(column)];
  };
  const Vec3f eye(projection_.eye);
  const auto differ = [&](const Sample& a, const Sample& b) {
    const bool none_a = a.normal == Vec3f{}, none_b = b.normal == Vec3f{};
    if (none_a || none_b) return none_a != none_b ? 1.0 : 0.0;
    const float size = projection_.pinhole ? length(a.place - eye) : 1.0f;
    const Vec3f step = b.place - a.place;
    const float gap = std::max(std::abs(dot(step, a.normal)), std::abs(dot(step, b.normal)));
    const double crease = 1 - static_cast<double>(dot(a.normal, b.normal));
    return std::max(std::clamp(2 * crease - 0.2, 0.0, 0.8), gap > 0.02f * size ? 1.0 : 0.0);
  };
  for (int row = 0; row + 1 < rows_; ++row)
    for (int column = 0; column + 1 < columns_; ++column) {
      const double edge = std::max(differ(at(column, row), at(column + 1, row)),
                                   differ(at(column, row), at(column, row + 1)));
      seen.at(column, row) = mix(seen.at(column, row), ink(0x2b2f36), 0.45 * edge);
    }
}

bool SceneView::hides(const Point& at, double depth) const {
  const int column = static_cast<int>(std::floor(at.x)) - left_,
            row = static_cast<int>(std::floor(at.y)) - top_;
  if (samples_.empty() || column < 0 || column >= columns_ || row < 0 || row >= rows_) return false;
  const Sample& s = samples_[static_cast<size_t>(row) * static_cast<size_t>(columns_) +
                             static_cast<size_t>(column)];
  if (s.normal == Vec3f{}) return false;
  return projection_.depth(Vec3d(s.place)) < depth - 0.01 * std::max(std::abs(depth), 0.2);
}

bool SceneView::in_sight(const Vec3d& place) const {
  const double depth = projection_.depth(place);
  if (projection_.pinhole && depth < kNear) return false;
  const Point at = projection_.project(place);
  return projection_.panel.contains(at) && !hides(at, depth);
}

void SceneView::line(const Vec3d& from, const Vec3d& to, double width, const Ink& c, double alpha,
                     double hidden) {
  Vec3d a = from, b = to;
  if (projection_.pinhole) {
    const double da = projection_.depth(a), db = projection_.depth(b);
    if (da < kNear && db < kNear) return;
    if (da < kNear) a = a + (b - a) * ((kNear - da) / (db - da));
    if (db < kNear) b = b + (a - b) * ((kNear - db) / (da - db));
  }
  const Point pa = projection_.project(a), pb = projection_.project(b);
  const double pixels = std::hypot(pb.x - pa.x, pb.y - pa.y);
  if (!(pixels < 1e6)) return;
  canvas_.clip(projection_.panel);
  const int steps = static_cast<int>(std::clamp(pixels / 2, 1.0, 4096.0));
  // A run of equal visibility is drawn as one line: round caps of single pieces would show as
  // beads.
  Point start = pa;
  bool was_hidden = false;
  for (int k = 0; k <= steps; ++k) {
    const double t = (k + 0.5) / steps;
    const Vec3d place = a + (b - a) * std::min(t, 1.0);
    const Point at = projection_.project(a + (b - a) * (static_cast<double>(k) / steps));
    const bool is_hidden =
        k < steps ? hides(projection_.project(place), projection_.depth(place)) : was_hidden;
    if (k == 0) was_hidden = is_hidden;
    if (k < steps && is_hidden == was_hidden) continue;
    canvas_.line(start, at, width, c, was_hidden ? alpha * hidden : alpha);
    start = at;
    was_hidden = is_hidden;
  }
  canvas_.unclip();
}

void SceneView::dot_at(const Vec3d& place, double radius, const Ink& c, double alpha,
                       double hidden) {
  const double depth = projection_.depth(place);
  if (projection_.pinhole && depth < kNear) return;
  const Point at = projection_.project(place);
  canvas_.clip(projection_.panel);
  canvas_.disc(at, radius, c, hides(at, depth) ? alpha * hidden : alpha);
  canvas_.unclip();
}

}  // namespace tdpt::draw
