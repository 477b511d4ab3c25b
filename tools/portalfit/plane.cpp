#include "tools/portalfit/plane.h"

namespace tdpt {
std::optional<Vec2d> inside_at(const Tube& tube, const LightLine& line, double offset) {
  const auto passage = Slab(tube).passage(line);
  if (!passage) return {};
  return passage->at(offset);
}

std::optional<Vec2d> crossing(const Plane& plane, const LightLine& line) {
  return inside_at({plane, 0}, line, 0);
}

std::optional<Vec2d> clear_crossing(const Plane& plane, const LightLine& line,
                                    const FitLimits& limits) {
  const Vec3d d = line.camera - line.light;
  if (dot(d, plane.n) < limits.grazing * length(d)) return {};
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
