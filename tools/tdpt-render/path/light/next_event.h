// Finds rectangular lights among a scene's emitters (windows, ceiling panels, the face of a lamp).
// Next events choose among them by the light that arrives [shaders/shared/path/next_event.h].
#pragma once
#include <vector>

#include "libcommon/scene/lights.h"
#include "tools/tdpt-render/path/bsdf/point.h"
#include "tools/tdpt-render/path/light/window_sky.h"

namespace tdpt {

struct RectLight {
  Vec3d corner, x, y, normal;  ///< x, y: unit, along the edges; normal: unit, front side
  double length_x, length_y, least_height;
  double weight;  ///< selection weight, per area
  const LightSource* source;
  uint32_t triangle0, triangle1;  ///< above the diagonal (x, then y), below it
  uint32_t corners;  ///< two bits each: the corners, counted around from x to y, that are b1's and
                     ///< b2's of triangle0, then of triangle1
};

inline constexpr size_t kMostRectLights = 8;

/// Empty unless all emitting surfaces are rectangles of two triangles: one big one or a few.
std::vector<RectLight> rect_lights_of(const Scene& scene, const LightSelection& selection);

// Next-event estimation: chooses a light and a point on it for a given shaded point
// [shaders/shared/path/next_event.h]. q is Mixture::through_windows.

/// Density p_nee of a point on a light, for any q.
struct NextEventPdf {
  double plain = 0, windows = 0;
  bool sees_windows = false;  ///< the shaded point sees windows, and the light point is in the sky
  double of(double q) const { return sees_windows ? (1 - q) * plain + q * windows : plain; }
};

}  // namespace tdpt

namespace tdpt::shader {

class NextEvents {
 public:
  using Point = tdpt::Point;
  using LightContext = tdpt::LightContext;

  /// Keeps references to all three.
  NextEvents(const LightSelection& selection, const WindowSky& windows,
             const std::vector<tdpt::RectLight>& rect_lights)
      : selection_(selection), windows_(windows), rect_lights_(rect_lights) {}

  /// Sets what next events know of a surface that is seen along unit `away` from it, or was left
  /// along it. Rectangular lights are evaluated later, on first use.
  void look_out(const Vec3d& away, Vertex& v) const {
    if (windows_.empty() && rect_lights_.empty()) return;
    LightContext& known = v.light_context;
    known.facing = facing(v, away);
    if (!windows_.empty())
      known.seen = v.connectible ? windows_.seen_through_windows(v.position, known.facing) : 0;
    if (!rect_lights_.empty()) known.sent = v.connectible ? -1 : 0;
  }
  /// Evaluates the rectangular lights at once, for a vertex that many paths use.
  void look_at_rect_lights(Vertex& v) const {
    if (v.light_context.sent < 0)
      v.light_context.sent = sent_by_rect_lights(v, v.light_context.facing);
  }

  /// Samples a point on a light. `point.source` is null if no rectangular light sends anything. A
  /// point in the sky has no density yet, and is black if below the horizon of `shaded`. If q > 0
  /// or there are rectangular lights, look_out() must have been called for `shaded`, whose `sent`
  /// is then set. Four numbers in [0,1), as in LightSelection::sample.
  Lights::Point sample(Vertex& shaded, double q, double pick, double u, double v,
                       double side) const;
  /// Density with which sample() chooses a point on a light.
  NextEventPdf pdf(const Vertex& shaded, const Point& light) const;

 private:
  Lights::Point sample_rect_lights(Vertex& v, double pick, double a, double b) const;

  const LightSelection& selection_;
  const WindowSky& windows_;
  const std::vector<tdpt::RectLight>& rect_lights_;

  // What the shared code needs.
  using Real = double;
  using InSky = Lights::InSky;
  using Source = const LightSource*;
  using RectLight = tdpt::RectLight;
  using LightPlace = Lights::Point;
  static constexpr bool scene_has_windows = true;
  bool scene_has_rect_lights = !rect_lights_.empty();
  struct {
    uint rect_lights;
    double surfaces, sky_pdf_1;
  } light_settings{static_cast<uint>(rect_lights_.size()), selection_.shares().surfaces,
                   selection_.sky_pdf_1()};
  const RectLight& load_rect_light(uint i) const { return rect_lights_[i]; }
  static bool is_surface(Source source) { return source->is_surface(); }
  static bool is_sky(Source source) { return source->is_sky(); }
  static bool is_two_sided(Source source) { return source->both_sides(); }
  static LightPlace no_light_place() { return {}; }
  double light_pdf(Source source, uint triangle, const Vec3d& position, const InSky& in_sky) const {
    return selection_.pdf(*source, triangle, position, in_sky);
  }
  double windows_pdf_w(const Vec3d& x, const Vec3d& facing, double seen, const Vec3d& to) const {
    return windows_.windows_pdf_w(x, facing, seen, to);
  }

#include "shaders/shared/path/next_event.h"
};

}  // namespace tdpt::shader

namespace tdpt {
using shader::NextEvents;
}
