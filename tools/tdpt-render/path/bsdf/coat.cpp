#include "tools/tdpt-render/path/bsdf/coat.h"

#include "tools/tdpt-render/path/bsdf/ggx.h"

namespace tdpt::coat {
namespace {

constexpr double kSmooth = 1e-4;    // alpha below it counts as 0
constexpr double kGrazing = 1e-12;  // a rough coat is not seen at smaller cosines
constexpr double kUpright = 1e-9;   // facets steeper than that: rounding would lose their density

double fresnel(double c) {
  return kF0 + (1 - kF0) * schlick(c);
}

// The half vector and its cosine to both; false: there is none.
bool half(const Coat& c, const Vec3d& from, const Vec3d& to, Vec3d& h, double& cos) {
  if (smooth(c) || !(from.z > kGrazing) || !(to.z > kGrazing)) return false;
  h = from + to;
  const double l = length(h);
  if (!(l > 0)) return false;
  h = h / l;
  cos = dot(from, h);
  return cos > 0;
}

}  // namespace

bool smooth(const Coat& c) {
  return c.alpha < kSmooth;
}

double left_over(const Coat& c, double mu) {
  const InterfaceAlbedo e =
      interface_albedo(std::min(std::abs(mu), 1.0), smooth(c) ? 0.0 : double{c.alpha});
  return 1 - c.strength * (kF0 * e.a + e.b);
}

double f(const Coat& c, const Vec3d& from, const Vec3d& to) {
  Vec3d h;
  double cos;
  if (!half(c, from, to, h, cos)) return 0;
  return c.strength * fresnel(cos) * ggx::d(h, c.alpha) * ggx::g2_over_cos(from.z, to.z, c.alpha) *
         0.25;
}

double pdf_w(const Coat& c, const Vec3d& from, const Vec3d& to) {
  Vec3d h;
  double cos;
  if (!half(c, from, to, h, cos)) return 0;
  return ggx::d(h, c.alpha) * ggx::g1_over_cos(from.z, c.alpha) * 0.25;
}

bool sample(const Coat& c, const Vec3d& from, double u, double v, Vec3d& to) {
  Vec3d h(0, 0, 1);
  if (!smooth(c)) {
    if (!(from.z > kGrazing)) return false;
    h = ggx::visible_normal(from, c.alpha, u, v);
    if (!(h.z > kUpright)) return false;
  }
  const double cos = dot(from, h);
  if (!(cos > 0)) return false;
  to = h * (2 * cos) - from;
  if (!(to.z > (smooth(c) ? 0 : kGrazing))) return false;
  to = normalize(to);
  return true;
}

double reflectance(const Coat& c, double mu) {
  return c.strength * fresnel(std::min(std::abs(mu), 1.0));
}

}  // namespace tdpt::coat
