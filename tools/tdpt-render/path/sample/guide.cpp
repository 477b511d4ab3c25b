#include "tools/tdpt-render/path/sample/guide.h"

#include "tools/tdpt-render/portals/portal_text.h"

namespace tdpt::shader {

// The shared code in doubles.
struct GuideText : PortalText {
  using Point = tdpt::Point;
  using GuideTotals = tdpt::GuideTotals;
  using Arrival = const Incidence*;  // null: the walk begins there
  using Source = const LightSource*;
  static constexpr Source SOURCE_NONE = nullptr;
  struct Render {
    double guide_light, guide_camera;
  };

  Render render;
  bool scene_has_portals, guide_active;

  static bool begins(Arrival in) { return !in; }
  static Arrival no_arrival() { return nullptr; }
  static bool on_surface(const Point& p) { return p.on_surface(); }
  static bool source_met(Source source) { return !source || source->met(); }
  static bool source_at_infinity(Source source) { return source && source->at_infinity(); }
  static Vec3d source_facing(Source source, const Vec3d& normal) { return source->facing(normal); }
  static double albedo_at(const Point& p, Arrival in) { return tdpt::albedo_at(p, *in); }
  static Odds<double> odds_at(const Point& p, Arrival in) { return tdpt::odds_at(p, *in); }

#include "shaders/shared/path/guide.h"
};

}  // namespace tdpt::shader

namespace tdpt {
namespace {

uint32_t index(From from) {
  return from == From::light ? shader::FROM_LIGHT : shader::FROM_CAMERA;
}

}  // namespace

shader::GuideText Guide::text() const {
  return {shader::PortalText(portals_),
          {guiding_.chance[0], guiding_.chance[1]},
          sees_portals_,
          active_};
}

[[gnu::flatten]] PortalSet::CrossingDensity Guide::crossing(const Point& a, const Point& b,
                                                            uint64_t& tests,
                                                            const PortalSet::Drawn& drawn) const {
  const shader::GuideText guide = text();
  if (!guide.has_crossing(a, b)) return {};
  ++tests;
  return guide.edge_crossing(a, b, drawn);
}

[[gnu::flatten]] void Guide::guide_totals_at_surface(const Vec3d& away, Vertex& v) const {
  v.guide_totals = text().guide_totals_at_surface(v, away);
}

void Guide::guide_totals_at_light(Vertex& v) const {
  v.guide_totals = text().guide_totals_at_light(v);
}

bool Guide::draw(const Vertex& v, const Incidence* in, From from, const std::array<double, 4>& u,
                 Vec3d& w, int& triangle) const {
  return text().guide_draw(v, v.guide_totals, in, index(from), u[0], u[1], u[2], u[3], w, triangle);
}

double Guide::guided_survival(From from, double albedo) const {
  return text().guided_survival(index(from), 1, albedo);
}

bool Guide::leave(const Vertex& y0, const std::array<double, 4>& u, Lights::Ray& ray,
                  int& triangle) const {
  return text().guide_leave(y0, y0.guide_totals, u[0], u[1], u[2], u[3], ray.origin, ray.direction,
                            triangle);
}

[[gnu::flatten]] double Guide::mixed_pdf_A(From from, const Vertex& at, const Incidence* in,
                                           const Edge& e, const Point& to, double plain_A,
                                           const PortalSet::CrossingDensity& crossing,
                                           double W) const {
  const shader::GuideText guide = text();
  return guide.guided_pdf_A(index(from), W, guide.guide_chance(index(from), at, in),
                            guide.guide_odds(at, in), plain_A, to.cosine(e.w) / e.d2, crossing);
}

}  // namespace tdpt
