// Letters: h half vector or microfacet normal, mu cosine to z, F Fresnel reflectance, E directional
// albedo of the interface, n index of refraction, a GGX's alpha.
#include "tools/tdpt-render/testing/oracle_bsdf.h"

#include <cmath>
#include <numbers>

#include "tools/tdpt-render/path/bsdf/scatter.h"

namespace tdpt::oracle {
namespace {

using std::numbers::inv_pi;
using std::numbers::pi;

constexpr double kLeastAlpha = 1e-4;  // less counts as 0

double square(double x) {
  return x * x;
}
double schlick(double c) {
  return std::pow(1 - c, 5);
}
bool positive(const Vec3d& c) {
  return max_component(c) > 0;
}
double sum(const Vec3d& c) {
  return c.x + c.y + c.z;
}
Vec3d mirrored(const Vec3d& w) {
  return {w.x, w.y, -w.z};
}

// GGX with height-correlated Smith masking, written with tangents.
double tan2(const Vec3d& w) {
  return (w.x * w.x + w.y * w.y) / (w.z * w.z);
}
double ggx_d(const Vec3d& h, double a) {
  return a * a / (pi * square(square(h.z)) * square(a * a + tan2(h)));
}
double lambda(const Vec3d& w, double a) {
  return 0.5 * (std::sqrt(1 + a * a * tan2(w)) - 1);
}
double g1(const Vec3d& w, double a) {
  return 1 / (1 + lambda(w, a));
}
double g2(const Vec3d& v, const Vec3d& w, double a) {
  return 1 / (1 + lambda(v, a) + lambda(w, a));
}

// The surface as seen from `from`, mirrored if necessary so that from.z > 0.
struct OrientedBsdf {
  OrientedBsdf(const Bsdf& bsdf, const Vec3d& w)
      : b(bsdf),
        back(w.z < 0),
        from(turn(w)),
        through(b.through),
        solid(positive(through) && !b.thin),
        interface(positive(through) || b.f90 > 0),
        diffuse(b.diffuse),
        sheen(b.sheen_alpha > 0 && !(solid && back) ? Vec3d(b.sheen) : Vec3d()),
        alpha(b.alpha < kLeastAlpha || (solid && std::abs(b.eta - 1) < 1e-4) ? 0.0 : b.alpha),
        ratio(solid && back ? 1 / double{b.eta} : double{b.eta}) {
    if (solid) (back ? n_from : n_behind) = b.eta;
    if (painted()) glass = sum(through) / sum(through + diffuse);
  }
  // Inside a solid diffuse paint covers the rest of the glass.
  bool painted() const { return solid && back && positive(diffuse); }

  Vec3d turn(const Vec3d& w) const { return back ? mirrored(w) : w; }
  bool rough() const { return interface && alpha > 0; }
  bool smooth() const { return interface && !(alpha > 0); }
  bool inside(const Vec3d& w) const { return solid && (w.z < 0) != back; }

  // Reflectance at cosine c to the (microfacet's) normal.
  Vec3d fresnel(double c) const {
    double s = schlick(c);
    if (positive(through)) {
      const double sin2 = (1 - c * c) / (ratio * ratio);  // behind
      if (sin2 >= 1) return Vec3d(glass);
      const double ct = std::sqrt(1 - sin2);
      if (positive(Vec3d(b.diffuse))) {
        s = schlick(ratio >= 1 ? c : ct);
      } else {
        const double rs = (c - ratio * ct) / (c + ratio * ct);
        const double rp = (ratio * c - ct) / (ratio * c + ct);
        const double r0 = square((ratio - 1) / (ratio + 1));
        s = std::max(0.0, (0.5 * (rs * rs + rp * rp) - r0) / (1 - r0));
      }
    }
    const Vec3d f = (Vec3d(b.f0) + (Vec3d(double{b.f90}) - Vec3d(b.f0)) * s) * glass;
    return positive(through) ? f : max(f - Vec3d(b.dip) * (c * std::pow(1 - c, 6)), Vec3d(0.0));
  }
  Vec3d transmittance(const Vec3d& fresnel) const {
    return (Vec3d(1.0) - fresnel / glass) * through;
  }

  // 1 - E, what the interface leaves to the diffuse lobe.
  Vec3d left_over(const shader::Surfaces::InterfaceAlbedo& e) const {
    return max(Vec3d(1.0) - (Vec3d(b.f0) * e.a + Vec3d(double{b.f90}) * e.b), Vec3d(0.0));
  }
  Vec3d left_over(double mu) const {
    return interface ? left_over(surfaces().interface_albedo(mu, alpha)) : Vec3d(1.0);
  }

  // Transmittance of the layers above along a direction turned like `from`.
  double under_coat(const Vec3d& w) const {
    if (!(b.coat.strength > 0) || inside(w)) return 1;
    return coat::left_over(b.coat, dot(turn(w), Vec3d(b.coat.normal)));
  }
  double under_sheen(const Vec3d& w) const {
    if (!(b.sheen_alpha > 0) || inside(w)) return 1;
    const double e = surfaces().sheen_albedo(std::abs(w.z), b.sheen_alpha);
    return 1 - double{max_component(b.sheen)} * e;
  }

  Vec3d diffuse_lobe(const Vec3d& to) const {
    const Vec3d d = diffuse * inv_pi;
    const double c = under_coat(from) * under_coat(to);
    if (painted()) return d / square(n_from);
    if (!interface && !(b.coat.strength > 0)) return d;
    const Vec3d both = left_over(from.z) * left_over(to.z) * c;
    const Vec3d mean = b.coat.strength > 0 ? average_under_coat() : left_over(average_albedo());
    const auto over = [](double x, double m) { return m > 0 ? x / m : 0.0; };
    return d * Vec3d(over(both.x, mean.x), over(both.y, mean.y), over(both.z, mean.z));
  }
  shader::Surfaces::InterfaceAlbedo average_albedo() const {
    if (!(alpha > 0)) return surfaces().smooth_interface_average();
    return surfaces().interface_average_in(surfaces().interface_row(alpha));
  }
  // 2 int (1 - E) c mu dmu by midpoints, as if both had one normal.
  Vec3d average_under_coat() const {
    constexpr int kPoints = 2000;
    Vec3d mean;
    for (int i = 0; i < kPoints; ++i) {
      const double mu = (i + 0.5) / kPoints;
      mean += left_over(mu) * (2 * mu / kPoints * coat::left_over(b.coat, mu));
    }
    return mean;
  }

  // Probability of the diffuse lobe, as against the interface, below a sheen; -1: there is neither.
  double diffuse_or_interface() const {
    if (!positive(diffuse)) return interface ? 0 : -1;
    if (!interface) return 1;
    const Vec3d left = painted() ? Vec3d(1.0) : left_over(from.z), F = fresnel(from.z);
    const double d = sum(diffuse * left);
    if (painted() && rough()) return d / (d + 3 * glass);
    const double i = smooth() ? sum(F) + sum(transmittance(F))
                              : sum(Vec3d(1.0) - left + left * through) + 3e-3 * b.f90;
    return d + i > 0 ? d / (d + i) : -1;
  }
  // Probabilities of the diffuse lobe and of the sheen; the rest is the interface's. Negative:
  // none.
  std::array<double, 2> shares() const {
    const double d = diffuse_or_interface();
    if (!positive(sheen)) return {d, 0};
    const double e = surfaces().sheen_albedo(from.z, b.sheen_alpha);
    const double under = std::min(sum(diffuse) + (interface ? 3.0 * b.f90 : 0), 3.0) *
                         (1 - max_component(sheen) * e);
    const double s =
        d < 0 ? 1 : sum(sheen) * std::max(e, 0.05) / (sum(sheen) * std::max(e, 0.05) + under);
    return {d < 0 ? 0 : (1 - s) * d, s};
  }
  // Probability that the interface, once chosen, reflects instead of transmitting; -1: neither.
  double reflect_probability(const Vec3d& F) const {
    const double r = sum(F), t = sum(transmittance(F));
    return r + t > 0 ? r / (r + t) : -1;
  }

  const Bsdf& b;
  bool back;
  Vec3d from, through;
  bool solid, interface;
  Vec3d diffuse, sheen;
  double alpha;                     // 0: smooth
  double ratio;                     // index behind the interface / in front of it, for Fresnel
  double n_from = 1, n_behind = 1;  // indices of refraction on either side
  double glass = 1;                 // share of the surface that is interface
};

// The microfacet that connects view.from and `to` (mirrored like it), with its Jacobians.
struct MicroFacet {
  MicroFacet(const OrientedBsdf& view, const Vec3d& to) : reflects(to.z > 0) {
    if (!reflects && !positive(view.through)) return;
    const bool bends = !reflects && view.solid;
    const Vec3d way = bends ? view.from * view.n_from + to * view.n_behind
                            : view.from + (reflects ? to : mirrored(to));
    const double l = length(way);
    h = way / (way.z < 0 ? -l : l);
    cos = dot(view.from, h);
    const double cos_to = bends ? -dot(to, h) : cos;
    there = cos > 0 && cos_to > 0;
    const double scale = bends ? cos_to / (l * l) : 0.25 / cos;  // (n_from from.h + n_to to.h)^2
    dh_dto = bends ? square(view.n_behind) * scale : scale;
    f_jacobian = bends ? cos * scale : 0.25 / square(view.n_from);  // for basic radiance
  }

  Vec3d h;
  double cos = 0, dh_dto = 0, f_jacobian = 0;
  bool reflects, there = false;
};

}  // namespace

namespace bsdf {

bool transmits(const Bsdf& b) {
  return positive(Vec3d(b.through));
}
bool only_diffuse(const Bsdf& b) {
  return !(b.f90 > 0) && !transmits(b) && !(b.sheen_alpha > 0) && !(b.coat.strength > 0);
}
double index(const Bsdf& b, const Vec3d& w) {
  return w.z < 0 && !b.thin && transmits(b) ? double{b.eta} : 1.0;
}

Vec3d f(const Bsdf& b, const Vec3d& from, const Vec3d& to) {
  const OrientedBsdf view(b, from);
  const Vec3d w = view.turn(to);
  const double coat = std::min(view.under_coat(view.from), view.under_coat(w));
  Vec3d all;
  if (w.z > 0) all += view.diffuse_lobe(w);
  const MicroFacet m(view, w);
  if (view.rough() && m.there) {
    const Vec3d F = view.fresnel(m.cos);
    all += (m.reflects ? F : view.transmittance(F)) *
           (ggx_d(m.h, view.alpha) * g2(view.from, w, view.alpha) / (view.from.z * std::abs(w.z)) *
            m.f_jacobian * coat);
  }
  all *= std::min(view.under_sheen(view.from), view.under_sheen(w));
  if (w.z > 0 && positive(view.sheen))
    all += view.sheen * (surfaces().sheen_f(view.from, w, b.sheen_alpha) * coat);
  return all;
}

double pdf_w(const Bsdf& b, const Vec3d& from, const Vec3d& to) {
  const OrientedBsdf view(b, from);
  const Vec3d w = view.turn(to);
  const auto [diffuse, sheen] = view.shares();
  if (diffuse < 0) return 0;
  double pdf = w.z > 0 ? (diffuse * w.z + 0.5 * sheen) * inv_pi : 0;
  const MicroFacet m(view, w);
  if (!view.rough() || !m.there) return pdf;
  const double reflect = view.reflect_probability(view.fresnel(m.cos));
  const double of_h = ggx_d(m.h, view.alpha) * g1(view.from, view.alpha) * m.cos / view.from.z;
  return pdf + (1 - diffuse - sheen) * (m.reflects ? reflect : 1 - reflect) * of_h * m.dh_dto;
}

Vec3d albedo(const Bsdf& b, const Vec3d& from) {
  const OrientedBsdf view(b, from);
  if (view.solid && view.back && view.rough()) return Vec3d(1.0);  // all, beyond some angle
  if (const Vec3d F = view.fresnel(view.from.z); view.painted())
    return F + view.transmittance(F) + view.diffuse;
  const Vec3d left =
      view.smooth() ? Vec3d(1.0) - view.fresnel(view.from.z) : view.left_over(view.from.z);
  Vec3d all = Vec3d(1.0) - left + left * (view.through + view.diffuse);
  all *= view.under_sheen(view.from);
  if (positive(view.sheen)) all += view.sheen * surfaces().sheen_albedo(view.from.z, b.sheen_alpha);
  return all * view.under_coat(view.from);
}

double dirac_probability(const Bsdf& b, const Vec3d& from, const Vec3d& to) {
  const OrientedBsdf view(b, from);
  if (!view.smooth()) return 0;
  const auto [diffuse, sheen] = view.shares();
  const double reflect = view.reflect_probability(view.fresnel(view.from.z));
  if (diffuse < 0 || reflect < 0) return 0;
  return (1 - diffuse - sheen) * (view.turn(to).z > 0 ? reflect : 1 - reflect);
}

Vec3d dirac_reflectance(const Bsdf& b, const Vec3d& from, const Vec3d& to) {
  const OrientedBsdf view(b, from);
  if (!view.smooth()) return {};
  const Vec3d F = view.fresnel(view.from.z), w = view.turn(to);
  return (w.z > 0 ? F : view.transmittance(F)) *
         (std::min(view.under_coat(view.from), view.under_coat(w)) *
          std::min(view.under_sheen(view.from), view.under_sheen(w)));
}

double diffuse_probability(const Bsdf& b, const Vec3d& from) {
  const auto [diffuse, sheen] = OrientedBsdf(b, from).shares();
  return std::max(0.0, diffuse + sheen);
}

}  // namespace bsdf

namespace coat {
namespace {

double fresnel(double c) {
  return 0.04 + 0.96 * schlick(c);
}
// The half vector, unit; its cosine to both is more than 0.
bool half_vector(const shader::Coat& c, const Vec3d& from, const Vec3d& to, Vec3d& h) {
  h = normalize(from + to);
  return !smooth(c) && from.z > 0 && to.z > 0;
}

}  // namespace

bool smooth(const shader::Coat& c) {
  return c.alpha < kLeastAlpha;
}

double left_over(const shader::Coat& c, double mu) {
  const auto e = surfaces().interface_albedo(std::abs(mu), smooth(c) ? 0.0 : double{c.alpha});
  return 1 - c.strength * (0.04 * e.a + e.b);
}

double f(const shader::Coat& c, const Vec3d& from, const Vec3d& to) {
  Vec3d h;
  if (!half_vector(c, from, to, h)) return 0;
  return c.strength * fresnel(dot(from, h)) * ggx_d(h, c.alpha) * g2(from, to, c.alpha) /
         (4 * from.z * to.z);
}

double pdf_w(const shader::Coat& c, const Vec3d& from, const Vec3d& to) {
  Vec3d h;
  if (!half_vector(c, from, to, h)) return 0;
  return ggx_d(h, c.alpha) * g1(from, c.alpha) / (4 * from.z);
}

double reflectance(const shader::Coat& c, double mu) {
  return c.strength * fresnel(std::abs(mu));
}

}  // namespace coat

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
