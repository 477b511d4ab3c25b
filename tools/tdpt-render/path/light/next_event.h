// Where a next event looks: which light, and where on it, for a given shaded point
// [shaders/shared/path/next_event_pdf.h], q [Mixture::through_windows].
#pragma once
#include "libcommon/scene/lights.h"
#include "tools/tdpt-render/path/light/rect_lights.h"
#include "tools/tdpt-render/path/light/vertex.h"
#include "tools/tdpt-render/path/light/window_sky.h"

namespace tdpt {

/// p_nee of a place on a light, whatever q.
struct NextEventPdf {
  double plain = 0, windows = 0;
  bool sees_windows = false;  ///< the shaded point does, and the place is in the sky
  double of(double q) const { return sees_windows ? (1 - q) * plain + q * windows : plain; }
};

class NextEvents {
 public:
  NextEvents(const Scene& scene, const Lights& lights, const WindowSky& windows)
      : lights_(lights), windows_(windows), rect_lights_(rect_lights_of(scene, lights)) {}

  /// Whether their densities depend on the shaded point by more than what windows show.
  bool by_rect_lights() const { return !rect_lights_.empty(); }
  const std::vector<RectLight>& rect_lights() const { return rect_lights_; }

  /// Tells a surface that is seen along unit `away` from it, or was left along it, what it sees;
  /// of rectangular lights later, when that is asked for.
  void look_out(const Vec3d& away, Vertex& v) const {
    if (windows_.empty() && rect_lights_.empty()) return;
    v.light_context.facing = facing(v, away);
    if (!windows_.empty())
      v.light_context.seen = v.connectible ? windows_.seen(v.position, v.light_context.facing) : 0;
    if (!rect_lights_.empty()) v.light_context.sent = v.connectible ? -1 : 0;
  }
  /// And of the rectangular lights at once: for one that many paths ask.
  void look_at_rect_lights(Vertex& v) const {
    if (v.light_context.sent < 0) v.light_context.sent = sent_by_rect_lights(v);
  }

  /// A place on a light, without one where no rectangular light sends anything; in the sky without
  /// its density, and black where it is below the horizon of `shaded`, which has looked out if q is
  /// more than 0 or there are rectangular lights, and is told what they send. Four numbers in
  /// [0,1), as Lights::sample.
  Lights::Point sample(Vertex& shaded, double q, double pick, double u, double v,
                       double side) const;
  /// Density of `sample` at a place on a light.
  NextEventPdf pdf(const Vertex& shaded, const Point& light) const;

 private:
  double sent_by_rect_lights(const Vertex& v) const;
  Lights::Point sample_rect_lights(Vertex& v, double pick, double a, double b) const;

  const Lights& lights_;
  const WindowSky& windows_;
  std::vector<RectLight> rect_lights_;
};

}  // namespace tdpt
