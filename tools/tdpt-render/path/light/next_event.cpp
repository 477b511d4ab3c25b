#include "tools/tdpt-render/path/light/next_event.h"

#include "shaders/shared/path/point.h"
#include "shaders/shared/warp.h"

namespace tdpt::shader {
namespace {

// The shared code in doubles.
struct NextEvents {
  using Real = double;
  using Point = tdpt::Point;
  using LightContext = tdpt::LightContext;
  using InSky = Lights::InSky;
  using Source = const LightSource*;
  using RectLight = tdpt::RectLight;
  using LightPlace = Lights::Point;

  const LightSelection& selection;
  const WindowSky& windows;
  const std::vector<RectLight>& rect_lights;

  static constexpr bool scene_has_windows = true;
  bool scene_has_rect_lights = !rect_lights.empty();
  struct {
    uint rect_lights;
    double surfaces, sky_pdf_1;
  } light_settings{static_cast<uint>(rect_lights.size()), selection.shares().surfaces,
                   selection.sky_pdf_1()};
  const RectLight& load_rect_light(uint i) const { return rect_lights[i]; }
  static bool is_surface(Source source) { return source->is_surface(); }
  static bool is_sky(Source source) { return source->is_sky(); }
  static bool is_two_sided(Source source) { return source->both_sides(); }
  static LightPlace no_light_place() { return {}; }
  double light_pdf(Source source, uint triangle, const Vec3d& position, const InSky& in_sky) const {
    return selection.pdf(*source, triangle, position, in_sky);
  }
  double windows_pdf_w(const Vec3d& x, const Vec3d& facing, double seen, const Vec3d& to) const {
    return windows.pdf_w(x, facing, seen, to);
  }

#include "shaders/shared/path/rect_lights.h"
  // A separate block of includes: each begins with language.h.
#include "shaders/shared/path/next_event_pdf.h"
};

}  // namespace
}  // namespace tdpt::shader

namespace tdpt {

[[gnu::flatten]] double NextEvents::sent_by_rect_lights(const Vertex& v) const {
  return shader::NextEvents{selection_, windows_, rect_lights_}.sent_by_rect_lights(
      v, v.light_context.facing);
}

// Like place_on_rect_lights() of the shared code, which looks at each light a second time.
[[gnu::flatten]] Lights::Point NextEvents::sample_rect_lights(Vertex& v, double pick, double a,
                                                              double b) const {
  const shader::NextEvents text{selection_, windows_, rect_lights_};
  const Vec3d up = text.rect_light_horizon(v, v.light_context.facing);
  const bool both_ways = shader::is_zero(v.light_context.facing);
  std::array<shader::NextEvents::RectLightView, kMostRectLights> views;
  double& sent = v.light_context.sent;
  sent = 0;
  for (size_t i = 0; i < rect_lights_.size(); ++i) {
    views[i] = text.look_at_rect_light(rect_lights_[i], v.position, up, both_ways);
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
  return text.place_on_rect_light(rect_lights_[chosen], views[chosen], sent, a, b);
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
    const Vec3d towards = windows_.sample(shaded.position, facing, seen, side / q, u, v);
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
  const shader::NextEvents text{selection_, windows_, rect_lights_};
  LightContext light_context = shaded.light_context;
  if (light_context.sent < 0 && light.source->is_surface())
    light_context.sent = sent_by_rect_lights(shaded);
  const auto pdf_by = [&](double q) {
    return text.next_event_pdf(shaded, light_context, q, light.source, light.triangle,
                               light.position, light.in_sky);
  };
  const bool sees_windows = light.source->is_sky() && light_context.seen > 0;
  return {pdf_by(0), sees_windows ? pdf_by(1) : 0, sees_windows};
}

}  // namespace tdpt
