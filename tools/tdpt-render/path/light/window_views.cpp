#include "tools/tdpt-render/path/light/window_views.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include <oneapi/tbb/parallel_for.h>

#include "libcommon/math/sequence.h"
#include "libcommon/math/streams.h"

namespace tdpt {
namespace {

constexpr size_t kLines = 1 << 16, kFewest = 1 << 13;  // in all, and at least per window
constexpr double kAcross = 64;                         // cells along the longest side
constexpr size_t kAround = 2;                          // extra cells on all sides
constexpr double kFar = 8;                             // beyond the extent of any scene

}  // namespace

// From a point in a window along unit w, `length` long.
struct WindowViews::Line {
  Vec3d from, w;
  double length = 0;
  uint32_t window = 0;
  Vec3d end() const { return from + w * length; }
};

namespace {

using Opening = WindowViews::Opening;

// Distance along a ray at which it leaves by another window than `own`; infinite if it does not.
double way_out(const std::vector<Opening>& openings, size_t own, const Vec3d& from,
               const Vec3d& w) {
  double least = HUGE_VAL;
  for (size_t i = 0; i < openings.size(); ++i) {
    const auto& [corner, across, up, out] = openings[i];
    const double t = dot(out, corner - from) / dot(out, w);
    if (i == own || !(dot(out, w) > 0) || !(t > 0 && t < least)) continue;
    const Vec3d p = from + w * t - corner;
    const double x = dot(p, across), y = dot(p, up);
    if (x >= 0 && x <= dot(across, across) && y >= 0 && y <= dot(up, up)) least = t;
  }
  return least;
}

// Length of a line from opening i along unit w; kFar if it leaves by a hole without a window.
double reach(const Tracer& tracer, const std::vector<Opening>& openings, size_t i,
             const Vec3f& from, const Vec3d& w) {
  Hit hit;
  const double wall = tracer.closest_from(from, w, hit) ? hit.distance : kFar;
  return std::min(wall, way_out(openings, i, Vec3d(from), w));
}

// Uniform over the directions into the house: views at a slant through the window count, too.
Vec3d inwards(const Opening& opening, double u, double v) {
  const double z = 1 - u, r = std::sqrt(std::max(0.0, 1 - z * z)), phi = 2 * std::numbers::pi * v;
  return Onb<double>(-opening.out).to_world({r * std::cos(phi), r * std::sin(phi), z});
}

}  // namespace

WindowViews::WindowViews(const Tracer& tracer, const std::vector<Opening>& openings)
    : openings_(openings) {
  const size_t each = openings.empty() ? 0 : std::max(kFewest, kLines / openings.size());
  std::vector<Line> lines(each * openings.size());
  tbb::parallel_for(size_t{0}, lines.size(), [&](size_t k) {
    const size_t i = k / each;
    Sequence numbers(*kWindowViews.seed, kWindowViews.first, i, k % each);
    const auto [x, y, u, v] = numbers.uniforms<4>();
    const Vec3f from(openings[i].corner + openings[i].across * x + openings[i].up * y);
    const Vec3d w = inwards(openings[i], u, v);
    lines[k] = {Vec3d(from), w, reach(tracer, openings, i, from, w), static_cast<uint32_t>(i)};
  });
  std::erase_if(lines, [](const Line& line) { return !(line.length > 0); });
  beyond_ = 0;
  if (lines.empty()) return;
  lay_out(lines);
  mark(lines);
  widen();
}

// Lays a grid around the region where nearly all lines begin and end: the few that leave by holes
// without a portal would make its cells as large as houses.
void WindowViews::lay_out(const std::vector<Line>& lines) {
  constexpr double kLeftOut = 0.002;
  Vec3d high;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> places;
    for (const Line& line : lines) {
      places.push_back(line.from[axis]);
      if (line.length < kFar) places.push_back(line.end()[axis]);
    }
    std::sort(places.begin(), places.end());
    const auto skipped = static_cast<size_t>(kLeftOut * static_cast<double>(places.size()));
    low_[axis] = places[skipped];
    high[axis] = places[places.size() - 1 - skipped];
  }
  const Vec3d extent = high - low_;
  const double width = std::max({extent.x, extent.y, extent.z}) / kAcross;
  per_width_ = 1 / width;
  low_ = low_ - Vec3d(1, 1, 1) * (kAround * width);
  for (int axis = 0; axis < 3; ++axis)
    size_[static_cast<size_t>(axis)] =
        static_cast<size_t>(extent[axis] * per_width_) + 1 + 2 * kAround;
}

void WindowViews::mark(const std::vector<Line>& lines) {
  std::vector<std::atomic<uint32_t>> masks(size_[0] * size_[1] * size_[2]);
  tbb::parallel_for(size_t{0}, lines.size(), [&](size_t k) {
    const Line& line = lines[k];
    const double cells = std::min(line.length * per_width_, 4 * kAcross);
    const auto steps = static_cast<int>(cells) + 1;
    for (int s = 0; s <= steps; ++s) {
      const Vec3d p = (line.from + line.w * (line.length * s / steps) - low_) * per_width_;
      std::array<size_t, 3> i;
      bool inside = true;
      for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<size_t>(axis);
        inside = inside && p[axis] >= 0 && p[axis] < static_cast<double>(size_[a]);
        i[a] = inside ? static_cast<size_t>(p[axis]) : 0;
      }
      if (inside) masks[index(i)].fetch_or(1u << line.window, std::memory_order_relaxed);
    }
  });
  masks_.assign(masks.begin(), masks.end());
}

// Extends masks to the neighbours of each cell, one axis after the other.
void WindowViews::widen() {
  size_t stride = 1;
  for (const size_t n : size_) {
    const std::vector<uint32_t> before = masks_;
    for (size_t i = 0; i < masks_.size(); ++i) {
      const size_t at = i / stride % n;
      if (at > 0) masks_[i] |= before[i - stride];
      if (at + 1 < n) masks_[i] |= before[i + stride];
    }
    stride *= n;
  }
}

}  // namespace tdpt
