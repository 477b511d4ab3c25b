#include "tools/tdpt-render/testing/oracle_rect_lights.h"

#include "tools/tdpt-render/testing/oracle_bsdf.h"

namespace tdpt::oracle {
namespace {

Vec3d towards(const Vertex& from, const Vertex& to) {
  return to.at_infinity() ? -to.position : normalize(to.position - from.position);
}

// cos cos / d^2 of a point on a rectangular light.
double arrives(const Vertex& x1, const Vec3d& up, bool both_ways, const RectLight& rect_light,
               const Vec3d& place) {
  const Vec3d d = place - x1.position;
  const double cos = dot(up, normalize(d));
  return (both_ways ? std::abs(cos) : std::max(0.0, cos)) *
         std::abs(dot(rect_light.normal, normalize(d))) / dot(d, d);
}

// The plane of a rectangular light as seen from a point: s and t of a place on it, and a, b.
struct Layout {
  Layout(const RectLight& rect_light, const Vec3d& point)
      : x(rect_light.x),
        y(rect_light.y),
        foot(point - rect_light.normal * dot(rect_light.normal, point - rect_light.corner)) {
    const double diagonal = std::hypot(rect_light.length_x, rect_light.length_y);
    H = std::max(length(point - foot), 0.025 * diagonal);
  }
  double s(const Vec3d& place) const { return dot(x, place - foot) / H; }
  double t(const Vec3d& place) const { return dot(y, place - foot) / H; }
  static double c(double v) { return v / (1 + std::abs(v)); }
  double da_db_per_area(const Vec3d& place) const {
    return 1 / std::pow(H * (1 + std::abs(s(place))) * (1 + std::abs(t(place))), 2);
  }
  Vec3d x, y, foot;
  double H;
};

}  // namespace

double rect_light_pdf_A(const Vista& vista, const Vertex& x0, const Vertex& x1, const Vertex& x2) {
  const bool both_ways = !x1.simple && bsdf::transmits(x1.bsdf);
  const Vec3d way = towards(x1, x2);
  Vec3d up = x1.simple ? x1.normal : x1.shading;
  const Vec3d seen_from = dot(x1.normal, way) > 0 ? x1.normal : -x1.normal;
  if (!both_ways && dot(up, seen_from) < 0) up = -up;
  double sum = 0, mine = 0;
  for (const RectLight& rect_light : vista.world->rect_lights) {
    const double height = dot(rect_light.normal, x1.position - rect_light.corner);
    if (height == 0 || (height < 0 && !rect_light.source->both_sides())) continue;
    const Layout layout(rect_light, x1.position);
    const Vec3d u = rect_light.x * rect_light.length_x, v = rect_light.y * rect_light.length_y;
    // [i][j]: i along x, j along y.
    double R[2][2];
    double mean = 0;
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) {
        const Vec3d corner = rect_light.corner + u * i + v * j;
        R[i][j] = arrives(x1, up, both_ways, rect_light, corner) / layout.da_db_per_area(corner);
        mean += R[i][j] / 4;
      }
    const double a0 = layout.c(layout.s(rect_light.corner)),
                 a1 = layout.c(layout.s(rect_light.corner + u));
    const double b0 = layout.c(layout.t(rect_light.corner)),
                 b1 = layout.c(layout.t(rect_light.corner + v));
    sum += rect_light.weight * mean * (a1 - a0) * (b1 - b0);
    if (rect_light.triangle0 != x0.triangle && rect_light.triangle1 != x0.triangle) continue;
    const double A = (layout.c(layout.s(x0.position)) - a0) / (a1 - a0);
    const double B = (layout.c(layout.t(x0.position)) - b0) / (b1 - b0);
    mine = rect_light.weight * layout.da_db_per_area(x0.position) *
           ((1 - A) * (1 - B) * R[0][0] + A * (1 - B) * R[1][0] + (1 - A) * B * R[0][1] +
            A * B * R[1][1]);
  }
  return sum > 0 ? mine / sum : 0;
}

}  // namespace tdpt::oracle
