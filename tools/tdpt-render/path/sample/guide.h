// Path guiding by the portals [shaders/shared/path/guide.h], in doubles: how a mixture's walks are
// directed.
#pragma once
#include "tools/tdpt-render/path/bsdf/scatter.h"
#include "tools/tdpt-render/path/light/vertex.h"
#include "tools/tdpt-render/path/sample/mixture.h"
#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt::shader {
struct GuideText;
}

namespace tdpt {

class Guide {
 public:
  /// Walks of `mixture`. Where it has no use for the portals there are none, at no cost.
  Guide(const World& world, const Mixture& mixture)
      : Guide(world, mixture.guiding, mixture.guiding != Guiding{},
              mixture.has(Technique::portal) || mixture.guiding != Guiding{},
              mixture.looks_out() ||
                  (mixture.has(Technique::direct) && world.next_events.by_rect_lights())) {}
  /// The same, and all is known that the densities of any other directed walks depend on.
  static Guide knowing_all(const World& world, const Mixture& mixture) {
    return Guide(world, mixture.guiding, true, true, true);
  }

  /// Whether any walk may be directed; otherwise `crossing` knows D alone and no vertex has
  /// guide totals.
  bool active() const { return active_; }
  /// Whether edges have crossings at all.
  bool sees_portals() const { return sees_portals_; }
  /// Whether vertices are told what next events know of them.
  bool looks_out() const { return looks_out_; }

  /// Of an edge `a` -> `b` of a path, a nearer to the light: here alone it is decided which edges
  /// have one. `tests` counts those that are held against the portals; `drawn`: as in portals.h.
  PortalSet::CrossingDensity crossing(const Point& a, const Point& b, uint64_t& tests,
                                      const PortalSet::Drawn& drawn = {}) const;

  /// Tells a surface that is seen along unit `away` from it, or was left along it, how walks are
  /// directed there.
  void guide_totals_at_surface(const Vec3d& away, Vertex& v) const;
  /// Tells y_0, a place on a light.
  void guide_totals_at_light(Vertex& v) const;

  /// Whether there is anything to aim at from a surface.
  bool may_guide(const Vertex& v, From from) const { return v.guide_totals.of(from) > 0; }
  /// Whether a walk at `v` (`in` null: that begins there) is directed, and then the direction and
  /// the triangle aimed at. `u`: as in PortalSet::aim, and whether.
  bool draw(const Vertex& v, const Incidence* in, From from, const std::array<double, 4>& u,
            Vec3d& w, int& triangle) const;

  /// Whether the walk that leaves y_0 is directed, and then its ray and the triangle aimed at.
  bool leave(const Vertex& y0, const std::array<double, 4>& u, Lights::Ray& ray,
             int& triangle) const;

  /// Of a walk at `at` (`in` null: that begins there) which reaches `to` along `e`: the guided
  /// density [1/canonical area], from the plain one and the edge's crossing.
  double pdf_A(From from, const Vertex& at, const Incidence* in, const Edge& e, const Point& to,
               double plain_A, const PortalSet::CrossingDensity& crossing) const {
    const bool may = plain_A > 0 && guiding_.chance[static_cast<size_t>(from)] > 0;
    const double W = in ? at.guide_totals.of(from) : at.guide_totals.emitted;
    return may && W > 0 ? mixed_pdf_A(from, at, in, e, to, plain_A, crossing, W) : plain_A;
  }

 private:
  Guide(const World& world, const Guiding& guiding, bool active, bool sees_portals, bool looks_out)
      : portals_(world.portals),
        guiding_(guiding),
        active_(active && !world.portals.empty()),
        sees_portals_(sees_portals && !world.portals.empty()),
        looks_out_(looks_out && (!world.windows.empty() || world.next_events.by_rect_lights())) {}
  double mixed_pdf_A(From from, const Vertex& at, const Incidence* in, const Edge& e,
                     const Point& to, double plain_A, const PortalSet::CrossingDensity& crossing,
                     double W) const;
  shader::GuideText text() const;

  const PortalSet& portals_;
  Guiding guiding_;
  bool active_, sees_portals_, looks_out_;
};

}  // namespace tdpt
