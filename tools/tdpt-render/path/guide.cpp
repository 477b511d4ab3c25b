#include "tools/tdpt-render/path/guide.h"

namespace tdpt {
namespace {

size_t index(From from) {
  return static_cast<size_t>(from);
}

PortalSet::Way way(From from) {
  return from == From::light ? PortalSet::Way::with_light : PortalSet::Way::against_light;
}

}  // namespace

PortalSet::Crossing Guide::crossing(const Vertex& a, const Vertex& b,
                                    const PortalSet::Drawn& drawn) const {
  PortalSet::Crossing c{};
  if (portals_.empty() || a.at_infinity()) return c;
  if (active_)
    c = portals_.crossing(a.position, b.position, drawn);
  else if (a.on_surface())
    c.density = portals_.density(a.position, b.position, drawn);
  if (!a.on_surface()) c.density = 0;  // no segment ends on a lamp without surface
  return c;
}

void Guide::aim(const Vec3d& facing, Vertex& v) const {
  v.facing = facing;
  v.aim = {};
  if (!v.connectible || v.at_infinity()) return;
  for (const From from : {From::light, From::camera}) {
    const double q = guiding_.chance[index(from)];
    if (!(q > 0)) continue;
    const double W = portals_.aims(v.position, facing, way(from));
    if (W > 0) v.aim[index(from)] = {q, q / W};
  }
}

void Guide::aim_at_surface(const Vec3d& away, Vertex& v) const {
  const bool through = !v.simple && v.bsdf.transmits();
  aim(through ? Vec3d() : dot(v.normal, away) > 0 ? v.normal : -v.normal, v);
}

void Guide::aim_at_light(Vertex& v) const {
  aim(v.lamp || v.material->double_sided ? Vec3d() : v.normal, v);
}

bool Guide::draw(const Vertex& v, From from, Rng& rng, Vec3d& w, int& triangle) const {
  const double coin = rng.uniform();
  const Aim& a = v.aim[index(from)];
  if (!(coin < a.chance)) {
    for (int i = 0; i < 3; ++i) rng.bits();
    return false;
  }
  triangle = portals_.aim(v.position, v.facing, way(from), a.chance / a.per_weight, rng, w);
  return true;
}

double Guide::pdf_A(From from, const Vertex& at, const Vec3d& back, const Vertex& to,
                    double plain_A, const PortalSet::Crossing& crossing) const {
  const Aim& a = at.aim[index(from)];
  if (!(a.chance > 0) || !(plain_A > 0)) return plain_A;
  const double towards = from == From::light ? crossing.from_light : crossing.from_camera;
  const double matt = back == Vec3d() ? 1 : 1 - dirac_probability(at, back);
  return (1 - a.chance) * plain_A + to_area(a.per_weight * matt * towards, between(at, to), to);
}

}  // namespace tdpt
