#include "tools/tdpt-render/path/guide.h"

namespace tdpt {
namespace {

size_t index(From from) {
  return static_cast<size_t>(from);
}

PortalSet::Way way(From from) {
  return from == From::light ? PortalSet::Way::with_light : PortalSet::Way::against_light;
}

/// Side that a light shines to; 0: both.
Vec3d lamp_facing(const Vertex& v) {
  return v.lamp || v.material->double_sided ? Vec3d() : v.normal;
}

// b and m of a walk that came from `back`.
struct Scope {
  double broad = 1, matt = 1;
};

Scope scope(const Vertex& at, const Vec3d& back) {
  constexpr float kNarrow = 0.3f;
  Scope s;
  if (at.simple) return s;
  const Vec3d local = Onb<double>(at.shading).to_local(back);
  if (!(local.z * dot(at.normal, back) > 0)) return s;
  s.matt -= bsdf::any_dirac_probability(at.bsdf, local);
  if (s.matt == 1 && at.bsdf.alpha < kNarrow) s.broad = bsdf::diffuse_probability(at.bsdf, local);
  return s;
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

Aim Guide::aim(const Vertex& v, const Vec3d& facing, From from) const {
  const double q = guiding_.chance[index(from)];
  if (!(q > 0) || v.at_infinity()) return {};
  const double W = portals_.aims(v.position, facing, way(from));
  return W > 0 ? Aim{q, q / W} : Aim{};
}

void Guide::aim_at_surface(const Vec3d& away, Vertex& v) const {
  const bool through = !v.simple && v.bsdf.transmits();
  v.facing = through ? Vec3d() : dot(v.normal, away) > 0 ? v.normal : -v.normal;
  for (const From from : {From::light, From::camera})
    v.aim[index(from)] = v.connectible ? aim(v, v.facing, from) : Aim{};
  v.lamp_aim = emits(v) ? aim(v, lamp_facing(v), From::light) : Aim{};
}

void Guide::aim_at_light(Vertex& v) const {
  v.facing = lamp_facing(v);
  v.aim = {};
  v.lamp_aim = aim(v, v.facing, From::light);
}

bool Guide::draw(const Vertex& v, const Vec3d& back, From from, const std::array<double, 4>& u,
                 Vec3d& w, int& triangle) const {
  const bool begins = back == Vec3d();
  const Aim& a = begins ? v.lamp_aim : v.aim[index(from)];
  if (!(u[3] < a.chance) || (!begins && !(u[3] < a.chance * scope(v, back).broad))) return false;
  triangle =
      portals_.aim(v.position, v.facing, way(from), a.chance / a.per_weight, {u[0], u[1], u[2]}, w);
  return true;
}

double Guide::pdf_A(From from, const Vertex& at, const Vec3d& back, const Vertex& to,
                    double plain_A, const PortalSet::Crossing& crossing) const {
  const bool begins = back == Vec3d();
  const Aim& a = begins ? at.lamp_aim : at.aim[index(from)];
  if (!(a.chance > 0) || !(plain_A > 0)) return plain_A;
  const double towards = from == From::light ? crossing.from_light : crossing.from_camera;
  const Scope s = begins ? Scope{} : scope(at, back);
  return (1 - a.chance * s.broad) * plain_A +
         to_area(a.per_weight * s.broad * s.matt * towards, between(at, to), to);
}

}  // namespace tdpt
