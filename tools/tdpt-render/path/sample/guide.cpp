#include "tools/tdpt-render/path/sample/guide.h"

#include "tools/tdpt-render/path/sample/roulette.h"
#include "tools/tdpt-render/path/sample/surface.h"

namespace tdpt {
namespace {

size_t index(From from) {
  return static_cast<size_t>(from);
}

PortalSet::Way way(From from) {
  return from == From::light ? PortalSet::Way::with_light : PortalSet::Way::against_light;
}

// b and m of a walk.
struct Scope {
  double broad = 1, matt = 1;
};

Scope scope(const Point& at, const Incidence* in) {
  if (!in || at.simple) return {};
  const Odds odds = odds_at(at, *in);
  return {odds.broad, 1 - odds.dirac};
}

// By the mixture: q, and `towards`, what the infinite ray crosses. [1/canonical area]
double mixed(double q, const Scope& s, double plain_A, double towards, double W, const Edge& e,
             const Point& to) {
  const double by_surface = (1 - q * s.broad) * plain_A;
  if (towards == 0) return by_surface;
  return by_surface + to_area(q / W * s.broad * s.matt * towards, e, to);
}

}  // namespace

PortalSet::Crossing Guide::crossing(const Point& a, const Point& b, uint64_t& tests,
                                    const PortalSet::Drawn& drawn) const {
  PortalSet::Crossing c{};
  // No technique puts a portal on the camera's own edge, and no segment ends on a light without
  // surface: of its edges only directed walks ask.
  if (!sees_portals_ || !b.on_surface() || !(a.met() || active_)) return c;
  ++tests;
  const Vec3d from = a.at_infinity() ? before_the_scene(b.position, a.position) : a.position;
  if (active_)
    c = portals_.crossing(from, b.position, drawn);
  else
    c.density = portals_.density(from, b.position, drawn);
  if (active_ && a.at_infinity())
    c.from_light = portals_.crossed_along(a.position, b.position, drawn);
  if (!a.met()) c.density = 0;
  return c;
}

double Guide::aims(const Point& v, const Vec3d& facing, From from) const {
  return v.at_infinity() ? portals_.aims_along(v.position)
                         : portals_.aims(v.position, facing)[index(from)];
}

void Guide::aim_at_surface(const Vec3d& away, Vertex& v) const {
  v.aims.facing = facing(v, away);
  for (const From from : {From::light, From::camera})
    v.aims.scattered[index(from)] = v.connectible ? aims(v, v.aims.facing, from) : 0;
  v.aims.emitted = v.source ? aims(v, v.source->facing(v.normal), From::light) : 0;
}

void Guide::aim_at_light(Vertex& v) const {
  v.aims = {};
  v.aims.facing = v.source->facing(v.normal);
  v.aims.emitted = aims(v, v.aims.facing, From::light);
}

double Guide::chance(From from, const Vertex& v, const Incidence* in) const {
  constexpr double kMost = 0.4;
  return in ? std::min(chance(from), kMost * (1 - albedo_at(v, *in))) : chance(from);
}

bool Guide::draw(const Vertex& v, const Incidence* in, From from, const std::array<double, 4>& u,
                 Vec3d& w, int& triangle) const {
  const double W = in ? v.aims.scattered[index(from)] : v.aims.emitted;
  if (!(W > 0)) return false;
  const double q = chance(from, v, in);
  if (!(u[3] < q) || !(u[3] < q * scope(v, in).broad)) return false;
  triangle = portals_.aim(v.position, v.aims.facing, way(from), W, {u[0], u[1], u[2]}, w);
  return true;
}

bool Guide::leave(const Vertex& y0, const std::array<double, 4>& u, Lights::Ray& ray,
                  int& triangle) const {
  if (!y0.at_infinity()) {
    if (!draw(y0, nullptr, From::light, u, ray.direction, triangle)) return false;
    ray.origin = y0.position;
    return true;
  }
  const double W = y0.aims.emitted;
  if (!(W > 0 && u[3] < chance(From::light))) return false;
  Vec3d at;
  triangle = portals_.aim_along(ray.direction, W, {u[0], u[1], u[2]}, at);
  ray.origin = before_the_scene(at, ray.direction);
  return true;
}

double Guide::mixed_pdf_A(From from, const Vertex& at, const Incidence* in, const Edge& e,
                          const Point& to, double plain_A, const PortalSet::Crossing& crossing,
                          double W) const {
  const double towards = from == From::light ? crossing.from_light : crossing.from_camera;
  return mixed(chance(from, at, in), scope(at, in), plain_A, towards, W, e, to);
}

}  // namespace tdpt
