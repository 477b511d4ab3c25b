#include "tools/portalfit/plane.h"

namespace tdpt {
namespace {

constexpr double kGrazing = 0.05;  // cosine between line and normal

}  // namespace

std::optional<Vec2d> inside_at(const Tube& tube, const LightLine& line, double offset) {
  const Vec3d a = line.light - tube.middle.o, d = line.camera - line.light;
  const double from = dot(a, tube.middle.n), along = dot(d, tube.middle.n);
  if (!(along > 0) || from > tube.half || from + along < -tube.half) return {};
  const Vec3d p = a + d * std::clamp((offset - from) / along, 0.0, 1.0);
  const Onb<double> frame(tube.middle.n);
  return Vec2d{dot(p, frame.x), dot(p, frame.y)};
}

std::optional<Vec2d> crossing(const Plane& plane, const LightLine& line) {
  const Vec3d d = line.camera - line.light;
  const double along = dot(d, plane.n), gap = dot(plane.o - line.light, plane.n);
  if (!(along > 0) || gap < 0 || gap > along) return {};
  return in_plane(plane, line.light + d * (gap / along));
}

std::optional<Vec2d> clear_crossing(const Plane& plane, const LightLine& line) {
  const Vec3d d = line.camera - line.light;
  if (dot(d, plane.n) < kGrazing * length(d)) return {};
  return crossing(plane, line);
}

Vec3d to_space(const Plane& plane, Vec2d at) {
  const Onb<double> frame(plane.n);
  return plane.o + frame.x * at.x + frame.y * at.y;
}

Vec2d in_plane(const Plane& plane, const Vec3d& place) {
  const Onb<double> frame(plane.n);
  return {dot(place - plane.o, frame.x), dot(place - plane.o, frame.y)};
}

}  // namespace tdpt
