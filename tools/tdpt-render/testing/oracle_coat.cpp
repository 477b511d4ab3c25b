#include "tools/tdpt-render/testing/oracle_coat.h"

#include "tools/tdpt-render/path/sample/world.h"
#include "tools/tdpt-render/testing/oracle_bsdf.h"

namespace tdpt::oracle {
namespace {

// In a frame about `normal`; mirrored to its front side if `to_front`.
Vec3d local(const Vec3d& normal, const Vec3d& w, bool to_front) {
  Vec3d v = Onb<double>(normal).to_local(w);
  if (to_front) v.z = std::abs(v.z);
  return v;
}

}  // namespace

CoatedSurface::CoatedSurface(const Point& p)
    : bsdf_(p.bsdf),
      front_(p.normal),
      base_(p.shading),
      coat_(Onb<double>(p.shading).to_world(Vec3d(p.bsdf.coat.normal))) {}

// Whether the coat, or the base, scatters light from a to b.
bool CoatedSurface::seen(const Vec3d& a, const Vec3d& b, bool by_coat) const {
  const Vec3d& n = by_coat ? coat_ : base_;
  for (const Vec3d& w : {a, b})
    if (dot(n, w) * dot(front_, w) <= 0) return false;
  if (!by_coat) return true;
  const bool solid = bsdf::transmits(bsdf_) && !bsdf_.thin;
  return dot(front_, a) * dot(front_, b) > 0 && !(solid && dot(front_, a) < 0);
}

double CoatedSurface::take(const Vec3d& back) const {
  if (!seen(back, back, true)) return 0;
  if (!seen(back, back, false)) return 1;
  const double e = 1 - coat::left_over(bsdf_.coat, dot(coat_, back)) + 0.02 * bsdf_.coat.strength;
  const Vec3d rest = bsdf::albedo(bsdf_, local(base_, back, false));
  return e / (e + (rest.x + rest.y + rest.z) / 3);
}

// Which of two mirrors connects a and b: the one whose normal is nearer to the half vector.
bool CoatedSurface::mirrored_by_coat(const Vec3d& a, const Vec3d& b) const {
  if (!coat::smooth(bsdf_.coat) || !seen(a, b, true)) return false;
  const bool by_base = seen(a, b, false) && bsdf::dirac_probability(bsdf_, local(base_, a, false),
                                                                    local(base_, b, false)) > 0;
  return !by_base || std::abs(dot(coat_, a + b)) > std::abs(dot(base_, a + b));
}

double CoatedSurface::pdf_w(const Vec3d& back, const Vec3d& to, bool dirac) const {
  const double p = take(back);
  const Vec3d i = local(base_, back, false), o = local(base_, to, false);
  double pdf = 0;
  if (!dirac) {
    if (seen(back, to, true))
      pdf += p * coat::pdf_w(bsdf_.coat, local(coat_, back, true), local(coat_, to, true));
    if (seen(back, to, false)) pdf += (1 - p) * bsdf::pdf_w(bsdf_, i, o);
    return pdf;
  }
  if (mirrored_by_coat(back, to)) return p * std::abs(dot(coat_, to));
  if (!seen(back, to, false)) return 0;
  const double n = bsdf::index(bsdf_, o);
  return (1 - p) * bsdf::dirac_probability(bsdf_, i, o) * n * n * std::abs(o.z);
}

Vec3d CoatedSurface::scattering(const Vec3d& to_light, const Vec3d& to_camera, bool dirac) const {
  const double g = std::abs(dot(front_, to_light));
  const double by_coat = std::abs(dot(coat_, to_light)) / g;
  if (dirac && mirrored_by_coat(to_light, to_camera))
    return Vec3d(coat::reflectance(bsdf_.coat, dot(coat_, to_light)) * by_coat);
  Vec3d sum;
  if (seen(to_light, to_camera, false)) {
    const Vec3d l = local(base_, to_light, false), c = local(base_, to_camera, false);
    const double n = bsdf::index(bsdf_, c);
    sum += (dirac ? bsdf::dirac_reflectance(bsdf_, l, c) : bsdf::f(bsdf_, l, c)) *
           (n * n * std::abs(l.z) / g);
  }
  if (!dirac && seen(to_light, to_camera, true))
    sum += Vec3d(coat::f(bsdf_.coat, local(coat_, to_light, true), local(coat_, to_camera, true)) *
                 by_coat);
  return sum;
}

double CoatedSurface::albedo(const Vec3d& back) const {
  double sum = 0;
  if (seen(back, back, false)) sum += max_component(bsdf::albedo(bsdf_, local(base_, back, false)));
  if (seen(back, back, true)) sum += 1 - coat::left_over(bsdf_.coat, dot(coat_, back));
  return sum;
}

double CoatedSurface::emission_share(const Vec3d& w) const {
  return coat::left_over(bsdf_.coat, dot(coat_, w));
}

void CoatedSurface::odds(const Vec3d& back, double& dirac, double& broad) const {
  const double p = take(back);
  const Vec3d i = local(base_, back, false);
  dirac = coat::smooth(bsdf_.coat) ? p : 0, broad = bsdf_.coat.alpha >= 0.3f ? p : 0;
  double under = 0, broad_under = 1;
  if (seen(back, back, false)) {
    under = bsdf::dirac_probability(bsdf_, i, i) + bsdf::dirac_probability(bsdf_, i, -i);
    if (under == 0 && bsdf_.alpha < 0.3f) broad_under = bsdf::diffuse_probability(bsdf_, i);
  }
  dirac += (1 - p) * under, broad += (1 - p) * broad_under;
  if (dirac > 0) broad = 1;
}

}  // namespace tdpt::oracle
