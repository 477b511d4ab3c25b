#include "tools/tdpt-render/path/light/next_event.h"

#include <algorithm>
#include <array>
#include <optional>

#include "shaders/shared/path/point.h"
#include "shaders/shared/vector.h"

namespace tdpt {
namespace {

// Least height H, as a share of half a rectangular light's diagonal: otherwise c would fold a light
// whose plane is seen at a grazing angle into its axes.
constexpr double kLeastHeight = 0.05;
constexpr double kBig =
    0.05;  // a single rectangular light is worth its time from this size on [canonical area]
constexpr double kFlat = 1e-6;  // canonical; corners are floats
constexpr double kSquare =
    1e-3;  // of an edge: the density treats a rectangular light as length_x by length_y

using Corners = std::array<Vec3d, 3>;
Corners corners_of(const TriangleShape& s) {
  return {s.p0, s.p0 + s.e1, s.p0 + s.e2};
}

// The edge that two triangles share if they form a rectangle.
struct CommonEdge {
  size_t i, j;  // a_i, the rectangle's first corner, is b_{j+1}
};
std::optional<CommonEdge> common_edge(const Corners& a, const Corners& b) {
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 3; ++j)
      if (a[i] == b[(j + 1) % 3] && a[(i + 1) % 3] == b[j]) return CommonEdge{i, j};
  return std::nullopt;
}

std::optional<RectLight> connected(const Scene& scene, const LightSelection& selection,
                                   uint32_t first, uint32_t second) {
  const TriangleShape sa = shape_of(scene, first), sb = shape_of(scene, second);
  const Corners a = corners_of(sa), b = corners_of(sb);
  const auto edge = common_edge(a, b);
  if (!edge) return std::nullopt;
  // Corners around the rectangle: a_i, the corner of b beyond the edge, a_{i+1}, the corner of a
  // beyond it.
  const auto [i, j] = *edge;
  const std::array<Vec3d, 4> around{a[i], b[(j + 2) % 3], a[(i + 1) % 3], a[(i + 2) % 3]};
  RectLight rect_light;
  rect_light.corner = around[0];
  const Vec3d x = around[1] - around[0], y = around[3] - around[0];
  rect_light.length_x = length(x);
  rect_light.length_y = length(y);
  rect_light.x = x / rect_light.length_x;
  rect_light.y = y / rect_light.length_y;
  rect_light.normal = sa.normal;
  const double skew = std::abs(dot(rect_light.x, rect_light.y)) *
                      std::min(rect_light.length_x, rect_light.length_y);
  const double most = std::min(kFlat, kSquare * std::min(rect_light.length_x, rect_light.length_y));
  if (!(skew < most) || !(length(around[0] + x + y - around[2]) < most)) return std::nullopt;
  const bool both = scene.material_of(first).double_sided;
  if (both != scene.material_of(second).double_sided) return std::nullopt;
  rect_light.source = &selection.lights().surface(both);
  rect_light.least_height = kLeastHeight * 0.5 * length(around[2] - around[0]);
  rect_light.weight = 0.5 * (selection.pdf_A(first) + selection.pdf_A(second)) / (both ? 2 : 1);
  rect_light.triangle0 = second, rect_light.triangle1 = first;
  // `corners`: of a triangle, from its vertex k on.
  const auto packed = [](size_t k, const std::array<uint32_t, 3>& corners) {
    return corners[(4 - k % 3) % 3] | corners[(5 - k % 3) % 3] << 2;
  };
  rect_light.corners = packed(j + 1, {0, 1, 2}) | packed(i, {0, 2, 3}) << 4;
  return rect_light;
}

}  // namespace

std::vector<RectLight> rect_lights_of(const Scene& scene, const LightSelection& selection) {
  std::vector<uint32_t> rest;
  for (uint32_t t = 0; t < scene.triangles.size(); ++t)
    if (selection.pdf_A(t) > 0) {
      if (rest.size() == 2 * kMostRectLights) return {};
      rest.push_back(t);
    }
  std::vector<RectLight> found;
  while (!rest.empty()) {
    std::optional<RectLight> rect_light;
    size_t other = 1;
    while (other < rest.size() && !(rect_light = connected(scene, selection, rest[0], rest[other])))
      ++other;
    if (!rect_light) return {};
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(other));
    rest.erase(rest.begin());
    found.push_back(*rect_light);
  }
  if (found.size() == 1 && found[0].length_x * found[0].length_y < kBig) return {};
  return found;
}

}  // namespace tdpt

namespace tdpt::shader {

// Like place_on_rect_lights() of the shared code, which looks at each light a second time.
[[gnu::flatten]] Lights::Point NextEvents::sample_rect_lights(Vertex& v, double pick, double a,
                                                              double b) const {
  const Vec3d up = rect_light_horizon(v, v.light_context.facing);
  const bool both_ways = is_zero(v.light_context.facing);
  std::array<RectLightView, kMostRectLights> views;
  double& sent = v.light_context.sent;
  sent = 0;
  for (size_t i = 0; i < rect_lights_.size(); ++i) {
    views[i] = look_at_rect_light(rect_lights_[i], v.position, up, both_ways);
    sent += rect_lights_[i].weight * views[i].total;
  }
  double left = pick * sent;
  size_t chosen = rect_lights_.size();
  for (size_t i = 0; i < rect_lights_.size() && left >= 0; ++i) {
    const double share = rect_lights_[i].weight * views[i].total;
    if (!(share > 0)) continue;
    chosen = i;
    left = left < share ? -1 : left - share;
  }
  if (chosen == rect_lights_.size()) return {};
  return place_on_rect_light(rect_lights_[chosen], views[chosen], sent, a, b);
}

Lights::Point NextEvents::sample(Vertex& shaded, double through_windows, double pick, double u,
                                 double v, double side) const {
  if (const double share = selection_.shares().surfaces; !rect_lights_.empty() && pick < share) {
    Lights::Point point = sample_rect_lights(shaded, pick / share, u, v);
    point.pdf *= share;
    return point;
  }
  if (!selection_.picks_sky(pick)) return selection_.sample(pick, u, v, side);
  const auto& [facing, seen, sent] = shaded.light_context;
  const double q = seen > 0 ? through_windows : 0;
  // Directions below the horizon contribute nothing: do not evaluate the sky there.
  const auto above = [&facing = facing](const Vec3d& towards) {
    return facing == Vec3d() || dot(facing, towards) > 0;
  };
  Lights::Point point;
  point.source = selection_.lights().sky();
  if (side < q) {
    const Vec3d towards = windows_.towards_window(shaded.position, facing, seen, side / q, u, v);
    point.position = -towards;
    if (above(towards)) point.in_sky = selection_.look(towards);
  } else {
    const Sky::Place place = selection_.lights().directions().draw((side - q) / (1 - q), u, v);
    point.position = -place.towards;
    if (above(place.towards)) point.in_sky = selection_.look(place);
  }
  return point;
}

[[gnu::flatten]] NextEventPdf NextEvents::pdf(const Vertex& shaded, const Point& light) const {
  LightContext light_context = shaded.light_context;
  if (light_context.sent < 0 && light.source->is_surface())
    light_context.sent = sent_by_rect_lights(shaded, light_context.facing);
  const auto pdf_by = [&](double q) {
    return next_event_pdf(shaded, light_context, q, light.source, light.triangle, light.position,
                          light.in_sky);
  };
  const bool sees_windows = light.source->is_sky() && light_context.seen > 0;
  return {pdf_by(0), sees_windows ? pdf_by(1) : 0, sees_windows};
}

}  // namespace tdpt::shader
