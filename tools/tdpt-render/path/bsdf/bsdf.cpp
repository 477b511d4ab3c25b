// Letters: h half vector or microfacet normal, mu cosine to z, F Fresnel reflectance, E directional
// albedo of the interface (interface_albedo.h), n index of refraction.
#include "tools/tdpt-render/path/bsdf/bsdf.h"

#include <array>
#include <numbers>

#include "libcommon/math/warp.h"
#include "tools/tdpt-render/path/bsdf/ggx.h"
#include "tools/tdpt-render/path/bsdf/interface_albedo.h"
#include "tools/tdpt-render/path/bsdf/sheen.h"

namespace tdpt::bsdf {
namespace {

constexpr double kSmooth = 1e-4;    // alpha below it counts as 0
constexpr double kMatched = 1e-4;   // so does alpha where indices differ by less: no refraction
constexpr double kGrazing = 1e-12;  // a rough interface is not seen at smaller cosines
constexpr double kUpright = 1e-9;   // facets steeper than that: rounding would lose their density

bool positive(const Rgb& c) {
  return c.x > 0 || c.y > 0 || c.z > 0;
}
double sum(const Vec3d& c) {
  return c.x + c.y + c.z;
}
Vec3d colour(const Rgb& c) {
  return Vec3d(c);
}
Rgb narrow(const Vec3d& c) {
  return Rgb(c);
}
Vec3d mirrored(const Vec3d& w) {
  return {w.x, w.y, -w.z};
}
Vec3d uniform_hemisphere(double u, double v) {
  const double z = 1 - u, r = std::sqrt(u * (2 - u)), phi = 2 * std::numbers::pi * v;
  return {r * std::cos(phi), r * std::sin(phi), z};
}

// Gauss-Legendre of 12 nodes: of products of curves of degree 5, exactly.
constexpr std::array kNodes{0.5 * 0.1252334085114689, 0.5 * 0.3678314989981802,
                            0.5 * 0.5873179542866175, 0.5 * 0.7699026741943047,
                            0.5 * 0.9041172563704749, 0.5 * 0.9815606342467193};
constexpr std::array kWeights{0.5 * 0.2491470458134028, 0.5 * 0.2334925365383548,
                              0.5 * 0.2031674267230659, 0.5 * 0.1600783285433462,
                              0.5 * 0.1069393259953184, 0.5 * 0.0471753363865118};

// What the layers above let through: a coat along both directions, a sheen along them together.
struct Covers {
  double from = 1, to = 1, sheen = 1;
  double coat() const { return std::min(from, to); }
};

struct Shares {
  double diffuse, sheen;
  double both() const { return diffuse + sheen; }
};

// The surface as `from` sees it: mirrored, if need be, so that from.z > 0.
struct View {
  const Bsdf& b;
  bool back;
  Vec3d from;
  bool transmits, solid, has_interface, has_diffuse, has_sheen;
  double alpha;                     // 0: smooth
  double ratio;                     // index behind the interface / before it, for Fresnel
  double n_from = 1, n_behind = 1;  // index where directions live

  [[gnu::always_inline]] View(const Bsdf& bsdf, const Vec3d& w)
      : b(bsdf),
        back(w.z < 0),
        from(turn(w)),
        transmits(b.transmits()),
        solid(transmits && !b.thin),
        has_interface(transmits || positive(b.f90)),
        has_diffuse(positive(b.diffuse) && !(solid && back)),
        has_sheen(b.has_sheen() && !(solid && back)),
        alpha(b.alpha < kSmooth || (solid && std::abs(b.eta - 1) < kMatched) ? 0.0 : b.alpha),
        ratio(solid && back ? 1 / double(b.eta) : double(b.eta)) {
    if (solid) (back ? n_from : n_behind) = b.eta;
  }

  Vec3d turn(const Vec3d& w) const { return back ? mirrored(w) : w; }
  bool rough() const { return has_interface && alpha > 0; }
  bool smooth() const { return has_interface && !(alpha > 0); }

  // Cosine behind the interface by Snell's law; -1: total reflection.
  double refracted_cos(double c) const {
    const double sin2 = (1 - c) * (1 + c) / (ratio * ratio);
    return sin2 < 1 ? std::sqrt(1 - sin2) : -1;
  }

  // Reflectance at cosine c to the (microfacet's) normal.
  Vec3d fresnel(double c) const {
    double s = 0;
    if (!transmits) {
      s = schlick(c);
    } else {
      const double ct = refracted_cos(c);
      if (ct < 0) return Vec3d(1.0);
      if (positive(b.diffuse)) {
        s = schlick(ratio >= 1 ? c : ct);
      } else {
        const double rs = (c - ratio * ct) / (c + ratio * ct);
        const double rp = (ratio * c - ct) / (ratio * c + ct);
        const double r0 = (ratio - 1) * (ratio - 1) / ((ratio + 1) * (ratio + 1));
        s = std::max(0.0, (0.5 * (rs * rs + rp * rp) - r0) / (1 - r0));
      }
    }
    const Vec3d f0 = colour(b.f0), f90 = colour(b.f90);
    return f0 + (f90 - f0) * s;
  }
  Vec3d transmittance(const Vec3d& fresnel) const {
    return (Vec3d(1.0) - fresnel) * colour(b.through);
  }

  // 1 - E, what the interface leaves to the diffuse lobe.
  Vec3d left_over(const InterfaceAlbedo& e) const {
    const Vec3d r = Vec3d(1.0) - (colour(b.f0) * e.a + colour(b.f90) * e.b);
    return max(r, Vec3d(0.0));
  }
  bool prepared() const { return alpha > 0 && b.row.node >= 0; }
  Vec3d left_over(double mu) const {
    return left_over(prepared() ? interface_albedo(mu, b.row) : interface_albedo(mu, alpha));
  }
  Vec3d left_over_average() const {
    return left_over(prepared() ? b.row.average : interface_albedo_average(alpha));
  }

  // Diffuse lobe [1/sr] for two directions on this side.
  Vec3d diffuse(double mu_from, double mu_to, const Covers& covers) const {
    const Vec3d d = colour(b.diffuse) * std::numbers::inv_pi;
    if (!has_interface && !b.coat) return d;
    Vec3d p(1.0), q(1.0), mean(1.0);
    if (has_interface) p = left_over(mu_from), q = left_over(mu_to);
    if (b.coat)
      p *= covers.from, q *= covers.to, mean = average_under_coat();
    else
      mean = left_over_average();
    const auto term = [](double x, double y, double m) { return m > 0 ? x * y / m : 0.0; };
    return d * Vec3d(term(p.x, q.x, mean.x), term(p.y, q.y, mean.y), term(p.z, q.z, mean.z));
  }
  // 2 int (1 - E) c mu dmu, as if both had one normal.
  Vec3d average_under_coat() const {
    if (b.under_coat.x >= 0) return colour(b.under_coat);
    Vec3d mean;
    for (size_t i = 0; i < kNodes.size(); ++i)
      for (const double mu : {0.5 - kNodes[i], 0.5 + kNodes[i]})
        mean += (has_interface ? left_over(mu) : Vec3d(1.0)) *
                (2 * mu * kWeights[i] * coat::left_over(b.coat, mu));
    return colour(narrow(mean));
  }

  // What a coat leaves along a direction that is turned as `from` is, and what the sheen does.
  double under_coat(const Vec3d& w) const {
    if (!b.coat || (solid && (w.z < 0) != back)) return 1;
    return coat::left_over(b.coat, dot(turn(w), Vec3d(b.coat.normal)));
  }
  double under_sheen(const Vec3d& w) const {
    if (!b.has_sheen() || (solid && (w.z < 0) != back)) return 1;
    return 1 - max_component(colour(b.sheen)) * sheen::albedo(std::abs(w.z), b.sheen_alpha);
  }
  Covers covers(const Vec3d& to) const {
    if (!b.layers_above()) [[likely]]
      return {};
    return covers_above(to);
  }
  [[gnu::noinline]] Covers covers_above(const Vec3d& to) const {
    return {under_coat(from), under_coat(to), std::min(under_sheen(from), under_sheen(to))};
  }

  // Probabilities that sample() takes a lobe: in proportion to what each reflects or transmits.
  // The interface has the rest. Less than 0: nothing does.
  Shares shares() const {
    const double d = diffuse_probability();
    if (has_sheen) [[unlikely]]
      return shares_below_sheen(d);
    return {d, 0};
  }
  // d: diffuse_probability().
  [[gnu::noinline]] Shares shares_below_sheen(double d) const {
    const double e = sheen::albedo(from.z, b.sheen_alpha);
    const double s = sum(colour(b.sheen)) * std::max(e, 0.05);
    double under = 0;
    if (has_diffuse) under += sum(colour(b.diffuse));
    if (has_interface) under += sum(colour(b.f90));  // at most
    under = std::min(under, 3.0) * (1 - max_component(colour(b.sheen)) * e);
    const double share = d < 0 ? 1 : s / (s + under);
    return {d < 0 ? 0 : (1 - share) * d, share};
  }

  // That the diffuse lobe is taken and not the interface, below a sheen; -1: there is neither.
  double diffuse_probability() const {
    if (!has_diffuse) return has_interface ? 0 : -1;
    if (!has_interface) return 1;
    const Vec3d left = left_over(from.z);
    const double d = sum(colour(b.diffuse) * left);
    double i = 0;
    if (smooth()) {
      const Vec3d f = fresnel(from.z);
      i = sum(f) + sum(transmittance(f));
    } else {
      // Microfacets reflect more than their mean at some angles: never starve them.
      i = sum(Vec3d(1.0) - left + left * colour(b.through)) + 1e-3 * sum(colour(b.f90));
    }
    return d + i > 0 ? d / (d + i) : -1;
  }

  // Probability that the interface, once taken, reflects and does not transmit; -1: neither.
  double reflect_probability(const Vec3d& fresnel) const {
    if (!transmits) return 1;
    const double r = sum(fresnel), t = sum(transmittance(fresnel));
    return r + t > 0 ? r / (r + t) : -1;
  }
};

// Microfacet that joins view.from and `to` (mirrored like it) and how densely it does.
struct Facet {
  Vec3d h;
  double cos = 0;         // from.h > 0
  double dh_dto = 0;      // solid angle of h per solid angle of `to`
  double f_jacobian = 0;  // f = Fresnel part * D * G2/(cos cos) * this
  bool reflects = false;
};

bool facet(const View& view, const Vec3d& to, Facet& out) {
  if (!(view.from.z > kGrazing) || !(std::abs(to.z) > kGrazing)) return false;
  out.reflects = to.z > 0;
  if (!out.reflects && !view.transmits) return false;
  if (out.reflects || !view.solid) {
    out.h = view.from + (out.reflects ? to : mirrored(to));
    const double l = length(out.h);
    if (!(l > 0)) return false;
    out.h = out.h / l;
    out.cos = dot(view.from, out.h);
    if (!(out.cos > 0)) return false;
    out.dh_dto = 0.25 / out.cos;
    out.f_jacobian = 0.25 / (view.n_from * view.n_from);  // of basic radiance
    return true;
  }
  out.h = view.from * view.n_from + to * view.n_behind;
  const double l = length(out.h);
  if (!(l > 0)) return false;
  out.h = out.h / (out.h.z < 0 ? -l : l);
  out.cos = dot(view.from, out.h);
  const double cos_to = -dot(to, out.h);
  if (!(out.cos > 0 && cos_to > 0)) return false;
  const double scale = cos_to / (l * l);  // (n_from from.h + n_to to.h)^2 = l^2
  out.dh_dto = view.n_behind * view.n_behind * scale;
  out.f_jacobian = out.cos * scale;
  return true;
}

}  // namespace
}  // namespace tdpt::bsdf

namespace tdpt {

void Bsdf::prepare() {
  if (alpha > 0) row = interface_row(double{alpha});
  if (coat && bsdf::positive(diffuse))
    under_coat = Rgb(bsdf::View(*this, {0, 0, 1}).average_under_coat());
}

}  // namespace tdpt

namespace tdpt::bsdf {

bool connectible(const Bsdf& b) {
  return positive(b.diffuse) || b.has_sheen() || View(b, {0, 0, 1}).rough();
}

Rgb f(const Bsdf& b, const Vec3d& from, const Vec3d& to) {
  if (from.z == 0 || to.z == 0) return {};
  const View view(b, from);
  const Vec3d w = view.turn(to);
  const Covers covers = view.covers(w);
  Vec3d result;
  if (view.has_diffuse && w.z > 0) result += view.diffuse(view.from.z, w.z, covers);
  Facet m;
  if (view.rough() && facet(view, w, m)) {
    const Vec3d fresnel = view.fresnel(m.cos);
    result += (m.reflects ? fresnel : view.transmittance(fresnel)) *
              (ggx::d(m.h, view.alpha) * ggx::g2_over_cos(view.from.z, std::abs(w.z), view.alpha) *
               m.f_jacobian * covers.coat());
  }
  if (b.has_sheen()) result *= covers.sheen;
  if (view.has_sheen && w.z > 0)
    result += colour(b.sheen) * (sheen::f(view.from, w, b.sheen_alpha) * covers.coat());
  return narrow(result);
}

double pdf_w(const Bsdf& b, const Vec3d& from, const Vec3d& to) {
  if (from.z == 0 || to.z == 0) return 0;
  const View view(b, from);
  const Vec3d w = view.turn(to);
  const Shares shares = view.shares();
  if (shares.diffuse < 0) return 0;
  double pdf = 0;
  if (w.z > 0) {
    pdf += shares.diffuse * w.z * std::numbers::inv_pi;
    if (view.has_sheen) pdf += shares.sheen * (0.5 * std::numbers::inv_pi);
  }
  const double p = shares.both();
  Facet m;
  if (view.rough() && facet(view, w, m)) {
    const double reflect = view.reflect_probability(view.fresnel(m.cos));
    if (reflect >= 0)
      pdf += (1 - p) * (m.reflects ? reflect : 1 - reflect) * ggx::d(m.h, view.alpha) *
             ggx::g1_over_cos(view.from.z, view.alpha) * m.cos * m.dh_dto;
  }
  return pdf;
}

Rgb albedo(const Bsdf& b, const Vec3d& from) {
  const View view(b, from);
  if (view.solid && view.back && view.rough()) return Rgb(1.0f);  // all of it, beyond some angle
  Vec3d left(1.0);
  if (view.smooth()) left = Vec3d(1.0) - view.fresnel(view.from.z);
  if (view.rough()) left = view.left_over(view.from.z);
  Vec3d behind = colour(b.through);
  if (view.has_diffuse) behind += colour(b.diffuse);
  Vec3d all = Vec3d(1.0) - left + left * behind;
  if (b.layers_above()) [[unlikely]] {
    all *= view.under_sheen(view.from);
    if (view.has_sheen) all += colour(b.sheen) * sheen::albedo(view.from.z, b.sheen_alpha);
    all *= view.under_coat(view.from);
  }
  return narrow(all);
}

bool sample(const Bsdf& b, const Vec3d& from, double choice, double u, double v, Scattered& out) {
  if (from.z == 0) return false;
  const View view(b, from);
  const Shares shares = view.shares();
  if (shares.diffuse < 0) return false;
  const double p = shares.both();
  out.dirac = false;
  if (choice < p) {
    const Vec3d w = choice < shares.diffuse ? cosine_hemisphere(u, v) : uniform_hemisphere(u, v);
    out.to = view.turn(w);
    return w.z > 0;
  }
  if (!view.has_interface) return false;
  Vec3d h(0, 0, 1);
  if (view.rough()) {
    if (!(view.from.z > kGrazing)) return false;
    h = ggx::visible_normal(view.from, view.alpha, u, v);
    if (!(h.z > kUpright)) return false;
  }
  const double c = dot(view.from, h);
  if (!(c > 0)) return false;
  const double reflect = view.reflect_probability(view.fresnel(c));
  if (reflect < 0) return false;
  const bool reflects = reflect >= 1 || choice - p < reflect * (1 - p);
  Vec3d w;
  if (reflects || !view.solid) {
    w = h * (2 * c) - view.from;
  } else {
    const double ct = view.refracted_cos(c);
    if (ct < 0) return false;
    w = h * (c / view.ratio - ct) - view.from / view.ratio;
  }
  if (!reflects && !view.solid) {
    if (!(w.z > 0)) return false;
    w = view.smooth() ? -view.from : mirrored(w);
  }
  out.dirac = view.smooth();
  const double least = out.dirac ? 0 : kGrazing;
  if (!(reflects ? w.z > least : w.z < -least)) return false;
  out.to = view.turn(normalize(w));
  return true;
}

double dirac_probability(const Bsdf& b, const Vec3d& from, const Vec3d& to) {
  if (from.z == 0) return 0;
  const View view(b, from);
  if (!view.smooth()) return 0;
  const Shares shares = view.shares();
  const double reflect = view.reflect_probability(view.fresnel(view.from.z));
  if (shares.diffuse < 0 || reflect < 0) return 0;
  return (1 - shares.both()) * (view.turn(to).z > 0 ? reflect : 1 - reflect);
}

double diffuse_probability(const Bsdf& b, const Vec3d& from) {
  if (from.z == 0) return 0;
  return std::max(0.0, View(b, from).shares().both());
}

double any_dirac_probability(const Bsdf& b, const Vec3d& from) {
  return dirac_probability(b, from, from) +
         (b.transmits() ? dirac_probability(b, from, -from) : 0.0);
}

Rgb dirac_reflectance(const Bsdf& b, const Vec3d& from, const Vec3d& to) {
  if (from.z == 0) return {};
  const View view(b, from);
  if (!view.smooth()) return {};
  const Vec3d fresnel = view.fresnel(view.from.z);
  const Vec3d w = view.turn(to);
  const Covers covers = view.covers(w);
  return narrow((w.z > 0 ? fresnel : view.transmittance(fresnel)) * (covers.coat() * covers.sheen));
}

}  // namespace tdpt::bsdf
