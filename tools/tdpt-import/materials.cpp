#include "tools/tdpt-import/materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tdpt::foreign {
namespace {

struct Conductor {
  const char* name;
  Rgb eta, k;
};
// Complex indices of evaporated metals in red, green and blue, as Mitsuba and Tungsten weight the
// measured spectra: by the colour matching functions, so that a constant spectrum is no constant.
constexpr Conductor kConductors[] = {
    {"a-C", {2.944f, 2.227f, 1.968f}, {0.8875f, 0.7993f, 0.8153f}},
    {"Ag", {0.1553f, 0.1167f, 0.1384f}, {4.828f, 3.122f, 2.147f}},
    {"Al", {1.658f, 0.8804f, 0.5212f}, {9.224f, 6.27f, 4.837f}},
    {"Au", {0.143f, 0.3753f, 1.442f}, {3.983f, 2.386f, 1.603f}},
    {"Be", {4.185f, 3.185f, 2.784f}, {3.835f, 3.01f, 2.869f}},
    {"Cr", {4.37f, 2.917f, 1.655f}, {5.207f, 4.231f, 3.755f}},
    {"Cu", {0.201f, 0.9237f, 1.102f}, {3.913f, 2.453f, 2.142f}},
    {"Cu2O", {3.552f, 2.95f, 2.752f}, {0.1142f, 0.1939f, 0.6061f}},
    {"CuO", {3.248f, 2.448f, 2.21f}, {0.5211f, 0.57f, 0.7222f}},
    {"Hg", {2.399f, 1.44f, 0.9096f}, {6.328f, 4.372f, 3.422f}},
    {"Ir", {3.086f, 2.082f, 1.618f}, {5.592f, 4.067f, 3.267f}},
    {"K", {0.06404f, 0.04641f, 0.03818f}, {2.104f, 1.349f, 0.9131f}},
    {"Li", {0.2658f, 0.1956f, 0.2209f}, {3.54f, 2.311f, 1.669f}},
    {"Mo", {4.484f, 3.525f, 2.776f}, {4.111f, 3.421f, 3.151f}},
    {"Nb", {3.42f, 2.79f, 2.396f}, {3.441f, 2.738f, 2.58f}},
    {"Rh", {2.586f, 1.86f, 1.554f}, {6.782f, 4.703f, 3.976f}},
    {"Ta", {2.063f, 2.393f, 2.628f}, {2.408f, 1.741f, 1.947f}},
    {"TiC", {3.701f, 2.837f, 2.582f}, {3.266f, 2.352f, 2.173f}},
    {"TiN", {1.648f, 1.151f, 1.38f}, {3.368f, 1.943f, 1.102f}},
    {"VC", {3.658f, 2.753f, 2.533f}, {3.068f, 2.199f, 1.963f}},
    {"VN", {2.866f, 2.119f, 1.94f}, {3.032f, 2.056f, 1.616f}},
    {"W", {4.371f, 3.3f, 2.998f}, {3.501f, 2.605f, 2.273f}},
};

struct Dielectric {
  const char* name;
  double ior;
};
constexpr Dielectric kDielectrics[] = {
    {"vacuum", 1.0},       {"helium", 1.000036},        {"hydrogen", 1.000132},
    {"air", 1.000277},     {"carbon dioxide", 1.00045}, {"water", 1.3330},
    {"acetone", 1.36},     {"ethanol", 1.361},          {"carbon tetrachloride", 1.461},
    {"glycerol", 1.4729},  {"benzene", 1.501},          {"silicone oil", 1.52045},
    {"bromine", 1.661},    {"water ice", 1.31},         {"fused quartz", 1.458},
    {"pyrex", 1.470},      {"acrylic glass", 1.49},     {"polypropylene", 1.49},
    {"bk7", 1.5046},       {"sodium chloride", 1.544},  {"amber", 1.55},
    {"pet", 1.5750},       {"diamond", 2.419},          {"glass-BK7", 1.5168},
    {"glass-BAF10", 1.67}, {"glass-FK51A", 1.4866},     {"glass-LASF9", 1.8503},
    {"glass-F5", 1.6034},  {"glass-F10", 1.6228},       {"glass-F11", 1.6206}};

constexpr double kLeast = 1e-6;  // an index this near 1 has no interface

float f0_of(float eta, float k) {
  return ((eta - 1) * (eta - 1) + k * k) / ((eta + 1) * (eta + 1) + k * k);
}

// Reflectance of a smooth dielectric at cosine c in front, ratio eta.
double fresnel(double c, double eta) {
  const double s2 = (1 - c * c) / (eta * eta);
  if (s2 >= 1) return 1;
  const double q = std::sqrt(1 - s2);
  const double s = (c - eta * q) / (c + eta * q), p = (eta * c - q) / (eta * c + q);
  return 0.5 * (s * s + p * p);
}

}  // namespace

Colour through(const Colour& c, const std::function<Rgb(const Rgb&)>& f) {
  if (!c.texture) return {f(c.factor), {}, {}};
  return {Rgb(1), c.texture, [f, factor = c.factor, before = c.curve](const Rgb& texel) {
            return f((before ? before(texel) : texel) * factor);
          }};
}

Colour through(const Colour& c, const std::function<float(float)>& f) {
  return through(c, [f](const Rgb& v) { return Rgb(f(v.x), f(v.y), f(v.z)); });
}

Number through(const Number& n, const std::function<float(float)>& f) {
  if (!n.texture) return {f(n.factor), {}, {}};
  return {1, n.texture, [f, factor = n.factor, before = n.curve](float texel) {
            return f(factor * (before ? before(texel) : texel));
          }};
}

double diffuse_fresnel(double eta) {
  constexpr int kCells = 1024;  // midpoints in sin^2, where the cosine weight is uniform
  double sum = 0;
  for (int i = 0; i < kCells; ++i) sum += fresnel(std::sqrt(1 - (i + 0.5) / kCells), eta);
  return sum / kCells;
}

Material diffuse(const Colour& reflectance) {
  Material m;
  m.base = reflectance;
  return m;
}

namespace {

Number root(const Number& alpha) {
  return through(alpha, [](float a) { return std::sqrt(std::clamp(a, 0.0f, 1.0f)); });
}

// A Lambertian base under an interface, of whose light base(reflectance) comes out again.
Material under_interface(const Colour& reflectance, double ior, const Number& alpha,
                         const std::function<float(float)>& base) {
  Material m = diffuse(through(reflectance, base));
  m.specular = 1;
  m.ior = static_cast<float>(ior);
  m.roughness = root(alpha);
  return m;
}

// An index below 1 becomes the one with the same reflectance at normal incidence.
double index_above_1(double ior) {
  return ior < 1 ? 1 / ior : ior;
}
bool has_interface(double ior) {
  return std::abs(ior - 1) >= kLeast;
}

// The visible normal of GGX from `v` (front, z > 0, y = 0) for two numbers in 0..1 [Heitz 2018].
Vec3d visible_normal(const Vec3d& v, double alpha, double u1, double u2) {
  const Vec3d s = normalize(Vec3d(alpha * v.x, 0, v.z)), t1(0, 1, 0), t2 = cross(s, t1);
  const double r = std::sqrt(u1), phi = 2 * std::numbers::pi * u2;
  const double x = r * std::cos(phi), share = 0.5 * (1 + s.z);
  const double y = (1 - share) * std::sqrt(1 - x * x) + share * r * std::sin(phi);
  const Vec3d h = t1 * x + t2 * y + s * std::sqrt(std::max(0.0, 1 - x * x - y * y));
  return normalize(Vec3d(alpha * h.x, alpha * h.y, std::max(1e-9, h.z)));
}

// Smith's shadowing at cosine mu.
double unshadowed(double mu, double alpha) {
  const double tan2 = (1 - mu * mu) / (mu * mu);
  return 2 / (1 + std::sqrt(1 + alpha * alpha * tan2));
}

// Visits visible microfacets of all cosine-distributed directions: each with the cosine c of the
// direction to it and the direction's and its own cosine to the surface. Returns their number.
template <class Visit>
double each_microfacet(double alpha, const Visit& visit) {
  constexpr int kCosines = 32, kNormals = 16;
  for (int i = 0; i < kCosines; ++i) {
    const double mu = std::sqrt((i + 0.5) / kCosines);
    const Vec3d v(std::sqrt(1 - mu * mu), 0, mu);
    for (int j = 0; j < kNormals; ++j)
      for (int k = 0; k < kNormals; ++k) {
        const Vec3d h = visible_normal(v, alpha, (j + 0.5) / kNormals, (k + 0.5) / kNormals);
        visit(std::clamp(dot(v, h), 1e-9, 1.0), mu, h.z);
      }
  }
  return kCosines * kNormals * kNormals;
}

}  // namespace

InterfaceShares rough_interface(double eta, double alpha) {
  InterfaceShares sum{0, 0};
  const double n = each_microfacet(alpha, [&](double c, double mu, double h) {
    const double f = fresnel(c, eta), reflected = 2 * c * h - mu;
    if (reflected > 0) sum.reflected += f * unshadowed(reflected, alpha);
    if (f < 1) {
      const double behind = std::sqrt(std::max(0.0, 1 - (1 - c * c) / (eta * eta)));
      const double z = (c / eta - behind) * h - mu / eta;
      if (z < 0) sum.transmitted += (1 - f) * unshadowed(-z, alpha);
    }
  });
  return {sum.reflected / n, sum.transmitted / n};
}

Material plastic_under_layer(const Colour& reflectance, double ior, const Number& alpha,
                             double depth) {
  constexpr int kCells = 1024;
  const double eta = index_above_1(ior);
  double in = 0, out = 0,
         back = 0;  // shares that get through the layer and the interface, or twice
  for (int i = 0; i < kCells; ++i) {
    const double c = std::sqrt((i + 0.5) / kCells), f = fresnel(c, 1 / eta);
    in += (1 - fresnel(c, eta)) * std::exp(-depth / std::sqrt(1 - (1 - c * c) / (eta * eta)));
    out += (1 - f) * std::exp(-depth / c), back += f * std::exp(-2 * depth / c);
  }
  in /= kCells, out /= kCells, back /= kCells;
  const double passed = in * out / (1 - diffuse_fresnel(eta));
  Material m = under_interface(reflectance, eta, alpha, [=](float r) {
    return static_cast<float>(r * passed / (1 - r * back));
  });
  if (!has_interface(ior)) m.specular = 0;
  return m;
}

Material plastic(const Colour& reflectance, double ior, const Number& alpha, bool nonlinear) {
  if (nonlinear) return plastic_under_layer(reflectance, ior, alpha, 0);
  if (!has_interface(ior)) return diffuse(reflectance);
  return under_interface(reflectance, index_above_1(ior), alpha, [](float r) { return r; });
}

Material rough_plastic(const Colour& reflectance, double ior, const Number& alpha, bool nonlinear) {
  if (!has_interface(ior)) return diffuse(reflectance);
  ior = index_above_1(ior);
  const double a = std::clamp(static_cast<double>(alpha.factor), 1e-3, 1.0);
  const InterfaceShares outside = rough_interface(ior, a), inside = rough_interface(1 / ior, a);
  const auto back = static_cast<float>(inside.reflected);
  // What enters is 1 - reflected in glTF's words, and comes out by the same share as it went in.
  const auto out = static_cast<float>(outside.transmitted * outside.transmitted / (ior * ior) /
                                      (1 - outside.reflected));
  return under_interface(reflectance, ior, alpha, [back, out, nonlinear](float r) {
    return r * out / (1 - (nonlinear ? r : 1) * back);
  });
}

namespace {

// The share of diffuse light that a white base of [Burley 2012] scatters back.
double burley_albedo(double roughness) {
  constexpr int kCells = 24;
  const auto rise = [](double mu) { return std::pow(1 - mu, 5); };
  double sum = 0;
  for (int i = 0; i < kCells; ++i)
    for (int j = 0; j < kCells; ++j)
      for (int k = 0; k < kCells; ++k) {
        const double a = std::sqrt((i + 0.5) / kCells), b = std::sqrt((j + 0.5) / kCells);
        const double between = a * b + std::sqrt((1 - a * a) * (1 - b * b)) *
                                           std::cos(std::numbers::pi * (k + 0.5) / kCells);
        const double fa = rise(a), fb = rise(b), retro = roughness * (1 + between);
        sum += (1 - fa / 2) * (1 - fb / 2) + retro * (fa + fb + fa * fb * (retro - 1));
      }
  return sum / (kCells * kCells * kCells);
}

// The share of diffuse light that an interface reflects is f0 a + f90 b, if its reflectance rises
// from f0 to f90 by Schlick's curve. Microfacets shadow each other by their heights (correlated) or
// independently (separable) [Smith].
struct SchlickShares {
  double a = 0, b = 0;
};
struct Shadowings {
  SchlickShares correlated, separable;
};
Shadowings rough_reflection(double alpha) {
  Shadowings sum;
  const double n = each_microfacet(alpha, [&](double c, double mu, double h) {
    const double reflected = 2 * c * h - mu, rise = std::pow(1 - c, 5);
    if (!(reflected > 0)) return;
    const double out = unshadowed(reflected, alpha), in = unshadowed(mu, alpha);
    const double both = 1 / (1 + in / out - in);  // (1 + L_in) / (1 + L_in + L_out), L = 1 / G - 1
    sum.correlated.a += (1 - rise) * both, sum.correlated.b += rise * both;
    sum.separable.a += (1 - rise) * out, sum.separable.b += rise * out;
  });
  for (SchlickShares* s : {&sum.correlated, &sum.separable}) s->a /= n, s->b /= n;
  return sum;
}

}  // namespace

std::string lost_of_rough_metal(const Number& alpha) {
  const double a = std::clamp(static_cast<double>(alpha.factor), 1e-3, 1.0);
  const auto [ours, theirs] = rough_reflection(a);
  const double gain = (ours.a + ours.b) / (theirs.a + theirs.b);
  if (gain <= 1.015) return "";
  return fmt::format("metals of roughness {:.3g} reflect {}{:.0f} % more in glTF", a,
                     alpha.texture ? "up to " : "", 100 * (gain - 1));
}

// Burley adds up what glTF lets one layer take from the next: the base gets the colour c with which
// as much of a uniform sky's light comes back,
//   (1 - m) c (1 - E) + E = all,  E = f0 a + f90 b,  f0 = (1 - m) F0 + m c,
// where E is the interface by glTF, with shadowing that is correlated in height.
Material burley(const Colour& base, double ior, const Number& roughness, double metallic,
                double specular) {
  const double r = roughness.texture ? 0.5 : std::clamp(roughness.factor, 0.0f, 1.0f);
  const auto [ours, theirs] = rough_reflection(std::max(r * r, 1e-3));
  const double m = metallic, f90 = (1 - m) * specular + m, a = ours.a, b = ours.b * f90;
  const double f0 = (1 - m) * specular * std::pow((ior - 1) / (ior + 1), 2);
  const double of_colour = (1 - m) * burley_albedo(r) + m * theirs.a;
  const double of_interface = f0 * theirs.a + f90 * theirs.b;
  const auto base_of = [=](float colour) {
    const double all = colour * of_colour + of_interface;
    const double p = (1 - m) * (1 - b - a * f0) + a * m, q = (1 - m) * a * m;
    const double more = std::max(0.0, all - a * f0 - b);
    return static_cast<float>(
        std::min(2 * more / (p + std::sqrt(std::max(0.0, p * p - 4 * q * more))), 1e30));
  };
  Material out = diffuse(through(base, base_of));
  out.metallic = static_cast<float>(m);
  out.specular = static_cast<float>(specular);
  out.ior = static_cast<float>(ior);
  out.roughness = roughness;
  return out;
}

Material metal(const Colour& reflectance, const Number& alpha) {
  Material m = diffuse(reflectance);
  m.metallic = 1;
  m.specular = 1;
  m.roughness = root(alpha);
  return m;
}

Material conductor(const Rgb& eta, const Rgb& k, const Colour& tint, const Number& alpha) {
  const Rgb f0{f0_of(eta.x, k.x), f0_of(eta.y, k.y), f0_of(eta.z, k.z)};
  Colour base = tint;
  base.factor = tint.factor * f0;
  Material m = metal(base, alpha);
  const bool tinted = tint.factor.x != 1 || tint.factor.y != 1 || tint.factor.z != 1;
  m.tinted = tinted || tint.texture;
  if (!tinted) m.eta_k = {eta, k};
  return m;
}

Material mirror(const Colour& reflectance) {
  Material m = metal(reflectance, {0.0f, {}, {}});
  const Rgb& r = reflectance.factor;
  m.tinted = reflectance.texture || r.x != 1 || r.y != 1 || r.z != 1;
  return m;
}

Material glass(double ior, const Colour& tint, const Number& alpha, bool solid) {
  Material m = diffuse(tint);
  m.transmission = 1;
  m.solid = solid;
  m.specular = 1;
  m.roughness = root(alpha);
  if (!solid) {
    // Light bounces to and fro between the two sides of a sheet, which reflects 2 f / (1 + f).
    const double f = (ior - 1) * (ior - 1) / ((ior + 1) * (ior + 1)), both = 2 * f / (1 + f);
    ior = (1 + std::sqrt(both)) / (1 - std::sqrt(both));
  }
  m.ior = static_cast<float>(ior);
  return m;
}

std::optional<std::array<Rgb, 2>> conductor_named(const std::string& name) {
  for (const Conductor& c : kConductors)
    if (name == c.name) return std::array<Rgb, 2>{c.eta, c.k};
  return {};
}

std::optional<double> ior_named(const std::string& name) {
  for (const Dielectric& d : kDielectrics)
    if (name == d.name) return d.ior;
  return {};
}

}  // namespace tdpt::foreign
