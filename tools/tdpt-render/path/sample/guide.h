// Path guiding by the portals in doubles [shaders/shared/path/guide.h]: directs a mixture's walks.
#pragma once
#include "tools/tdpt-render/path/bsdf/scatter.h"
#include "tools/tdpt-render/path/bsdf/point.h"
#include "tools/tdpt-render/path/sample/mixture.h"
#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt::shader {
struct GuideText;
}

namespace tdpt {

class Guide {
 public:
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
  bool active() const { return active_; }
  /// Whether edges have crossings at all.
  bool sees_portals() const { return sees_portals_; }
  /// Whether vertices store what next events need.
  bool looks_out() const { return looks_out_; }

  /// Crossing density of edge `a` -> `b` of a path, a nearer to the light; the only place that
  /// decides which edges have one. `tests` counts the edges tested against the portals; `drawn`: as
  /// in portals.h.
  PortalSet::CrossingDensity crossing(const Point& a, const Point& b, uint64_t& tests,
                                      const PortalSet::Drawn& drawn = {}) const;

  /// Sets the guide totals of a surface that is seen along unit `away` from it, or was left along
  /// it.
  void guide_totals_at_surface(const Vec3d& away, Vertex& v) const;
  /// Sets the guide totals of y_0, a point on a light.
  void guide_totals_at_light(Vertex& v) const;

  /// Whether a walk on a surface has any portal to aim at.
  bool may_guide(const Vertex& v, From from) const { return v.guide_totals.of(from) > 0; }
  /// Whether a walk at `v` is guided, and if so its direction and the triangle aimed at. `in` null:
  /// the walk begins there. `u`: as in PortalSet::aim, and one for the decision.
  bool draw(const Vertex& v, const Incidence* in, From from, const std::array<double, 4>& u,
            Vec3d& w, int& triangle) const;

  /// Survival probability of a walk from that end where it scatters at `v`, from its albedo there.
  double survival(From from, const Vertex& v, double albedo) const {
    return active_ && may_guide(v, from) ? guided_survival(from, albedo) : albedo;
  }

  /// Whether the walk that leaves y_0 is guided, and if so its ray and the triangle aimed at.
  bool leave(const Vertex& y0, const std::array<double, 4>& u, Lights::Ray& ray,
             int& triangle) const;

  /// Density [1/canonical area] of a guided walk at `at` that reaches `to` along `e`, from the
  /// plain density and the edge's crossing. `in` null: the walk begins there.
  double pdf_A(From from, const Vertex& at, const Incidence* in, const Edge& e, const Point& to,
               double plain_A, const PortalSet::CrossingDensity& crossing) const {
    const bool may = plain_A > 0 && guiding_.chance[static_cast<size_t>(from)] > 0;
    const double W = in ? at.guide_totals.of(from) : at.guide_totals.emitted;
    return may && W > 0 ? mixed_pdf_A(from, at, in, e, to, plain_A, crossing, W) : plain_A;
  }

 private:
  Guide(const Vista& vista, const Guiding& guiding, bool active, bool sees_portals, bool looks_out)
      : portals_(vista.openings.portals),
        guiding_(guiding),
        active_(active && !portals_.empty()),
        sees_portals_(sees_portals && !portals_.empty()),
        looks_out_(looks_out &&
                   (!vista.openings.windows.empty() || !vista.world->rect_lights.empty())) {}
  double guided_survival(From from, double albedo) const;
  double mixed_pdf_A(From from, const Vertex& at, const Incidence* in, const Edge& e,
                     const Point& to, double plain_A, const PortalSet::CrossingDensity& crossing,
                     double W) const;
  shader::GuideText text() const;

  const PortalSet& portals_;
  Guiding guiding_;
  bool active_, sees_portals_, looks_out_;
};

}  // namespace tdpt
