// Path guiding by the portals in doubles [shaders/shared/path/guide.h]: directs a mixture's walks.
#pragma once
#include "tools/tdpt-render/path/bsdf/scatter.h"
#include "tools/tdpt-render/path/sample/mixture.h"
#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt::shader {

class Guide : private PortalSet {
 public:
  using Point = tdpt::Point;
  using Edge = tdpt::Edge;
  using GuideTotals = tdpt::GuideTotals;
  using PortalSet::CrossingDensity, PortalSet::Drawn;

  /// Guides walks of `mixture`. If that has no use for portals the guide sees none, at no cost.
  Guide(const Vista& vista, const Mixture& mixture)
      : Guide(vista, mixture.guiding, mixture.guiding != Guiding{},
              mixture.has(Technique::portal) || mixture.guiding != Guiding{},
              mixture.looks_out() ||
                  (mixture.has(Technique::direct) && !vista.world->rect_lights.empty())) {}
  /// The same, but with everything known that the densities of any other guided walks depend on.
  static Guide knowing_all(const Vista& vista, const Mixture& mixture) {
    return Guide(vista, mixture.guiding, true, true, true);
  }

  /// Whether any walk may be guided; otherwise `crossing` sets only D and vertices have no guide
  /// totals.
  bool active() const { return guide_active; }
  /// Whether edges have crossings at all.
  bool sees_portals() const { return scene_has_portals; }
  /// Whether vertices store what next events need.
  bool looks_out() const { return looks_out_; }

  /// Crossing density of edge `a` -> `b` of a path, a nearer to the light. `tests` counts the edges
  /// tested against the portals.
  CrossingDensity crossing(const Point& a, const Point& b, uint64_t& tests,
                           const Drawn& drawn = {}) const;

  /// Sets the guide totals of a surface that is seen along unit `away` from it, or was left along
  /// it.
  void set_totals_at_surface(const Vec3d& away, Vertex& v) const;
  /// Sets the guide totals of y_0, a point on a light.
  void set_totals_at_light(Vertex& v) const { v.guide_totals = guide_totals_at_light(v); }

  /// Whether a walk on a surface has any portal to aim at.
  bool may_guide(const Vertex& v, From from) const { return v.guide_totals.of(from) > 0; }
  /// Whether a walk at `v` is guided, and if so its direction and the triangle aimed at. `in` null:
  /// the walk begins there.
  bool draw(const Vertex& v, const Incidence* in, From from, const std::array<double, 4>& u,
            Vec3d& w, int& triangle) const {
    return guide_draw(v, v.guide_totals, in, static_cast<uint>(from), u[0], u[1], u[2], u[3], w,
                      triangle);
  }

  /// Survival probability of a walk from that end where it scatters at `v`, from its albedo there.
  double survival(From from, const Vertex& v, double albedo) const {
    if (!guide_active) return albedo;
    return guided_survival(static_cast<uint>(from), v.guide_totals.of(from), albedo);
  }

  /// Whether the walk that leaves y_0 is guided, and if so its ray and the triangle aimed at.
  bool leave(const Vertex& y0, const std::array<double, 4>& u, Lights::Ray& ray,
             int& triangle) const {
    return guide_leave(y0, y0.guide_totals, u[0], u[1], u[2], u[3], ray.origin, ray.direction,
                       triangle);
  }

  /// Density [1/canonical area] of a guided walk at `at` that reaches `to` along `e`, from the
  /// plain density and the edge's crossing. `in` null: the walk begins there.
  double pdf_A(From from, const Vertex& at, const Incidence* in, const Edge& e, const Point& to,
               double plain_A, const CrossingDensity& crossing) const {
    const bool may = plain_A > 0 && guide_first_chance(static_cast<uint>(from)) > 0;
    const double W = in ? at.guide_totals.of(from) : at.guide_totals.emitted;
    return may && W > 0 ? mixed_pdf_A(from, at, in, e, to, plain_A, crossing) : plain_A;
  }

 private:
  // What the shared code needs.
  using Arrival = const Incidence*;  // null: the walk begins there
  using Source = const LightSource*;
  static constexpr Source SOURCE_NONE = nullptr;
  struct {
    double guide_light, guide_camera;
  } render;
  bool guide_active, scene_has_portals, looks_out_;

  static bool begins(Arrival in) { return !in; }
  static Arrival no_arrival() { return nullptr; }
  static bool on_surface(const Point& p) { return p.on_surface(); }
  static bool source_met(Source source) { return !source || source->met(); }
  static bool source_at_infinity(Source source) { return source && source->at_infinity(); }
  static Vec3d source_facing(Source source, const Vec3d& normal) { return source->facing(normal); }
  static double albedo_at(const Point& p, Arrival in) { return tdpt::albedo_at(p, *in); }
  static shader::Odds<double> odds_at(const Point& p, Arrival in) { return tdpt::odds_at(p, *in); }

#include "shaders/shared/path/guide.h"

  Guide(const Vista& vista, const Guiding& shares, bool active, bool sees_portals, bool looks_out)
      : PortalSet(vista.openings.portals),
        render{shares.chance[0], shares.chance[1]},
        guide_active(active && !empty()),
        scene_has_portals(sees_portals && !empty()),
        looks_out_(looks_out &&
                   (!vista.openings.windows.empty() || !vista.world->rect_lights.empty())) {}
  double mixed_pdf_A(From from, const Vertex& at, const Incidence* in, const Edge& e,
                     const Point& to, double plain_A, const CrossingDensity& crossing) const;
};

}  // namespace tdpt::shader

namespace tdpt {
using shader::Guide;
}
