// BSDFs of every kind, and directions, for tests.
#pragma once
#include <numbers>
#include <string>
#include <vector>

#include "tools/tdpt-render/path/bsdf/scatter.h"
#include "tools/tdpt-render/testing/oracle_bsdf.h"

namespace tdpt::test {

struct NamedBsdf {
  std::string name;
  Bsdf b;
};

inline Bsdf make(const Rgb& diffuse, const Rgb& f0, float f90, const Rgb& through, float alpha,
                 float eta = 1.5f, bool thin = false) {
  Bsdf b = surfaces().diffuse_bsdf(diffuse);
  b.f0 = f0, b.f90 = f90, b.through = through;
  b.alpha = alpha, b.eta = eta, b.thin = thin;
  return b;
}
inline Rgb normal_reflectance(float eta) {
  const float r = (eta - 1) / (eta + 1);
  return Rgb(r * r);
}
inline Bsdf plastic(float alpha, const Rgb& diffuse = {0.8f, 0.5f, 0.2f}, float f0 = 0.04f) {
  return make(diffuse, Rgb(f0), 1, {}, alpha);
}
inline Bsdf metal(float alpha, const Rgb& f0 = {1.0f, 0.75f, 0.3f}) {
  return make({}, f0, 1, {}, alpha);
}
/// From the index eta + i k for red, green and blue.
inline Bsdf conductor(float alpha, const Vec3d& eta, const Vec3d& k) {
  Bsdf b = metal(alpha);
  for (int c = 0; c < 3; ++c) {
    b.f0[c] = static_cast<float>(shader::conductor_reflectance(1.0, eta[c], k[c]));
    b.dip[c] = static_cast<float>(shader::conductor_dip(eta[c], k[c]));
  }
  return b;
}
inline Bsdf glass(float alpha, float eta = 1.5f, bool thin = false, const Rgb& through = Rgb(1)) {
  return make({}, normal_reflectance(eta), 1, through, alpha, eta, thin);
}

inline Bsdf coated_by(float alpha, Bsdf b, float strength = 1) {
  b.coat.strength = strength, b.coat.alpha = alpha;
  b.coat.under = Rgb(surfaces().average_under_coat(b));
  return b;
}
inline Bsdf cloth(float alpha, Bsdf b, const Rgb& sheen) {
  b.sheen = sheen, b.sheen_alpha = std::max(alpha, 0.05f);
  return b;
}

/// White: nothing absorbs; what is neither reflected nor transmitted is lost by the model.
inline std::vector<NamedBsdf> white(float alpha) {
  return {{"plastic", plastic(alpha, Rgb(1))},
          {"lacquer", plastic(alpha, Rgb(1), 0.5f)},
          {"metal", metal(alpha, Rgb(1))},
          {"glass", glass(alpha)},
          {"diamond", glass(alpha, 2.4f)},
          {"bubble", glass(alpha, 0.75f)},
          {"matched", make({}, Rgb(0), 1, Rgb(1), alpha, 1)},
          {"dull glass", make({}, Rgb(0.02f), 0.5f, Rgb(1), alpha)},
          {"thin", glass(alpha, 1.5f, true)},
          {"milky", make(Rgb(0.5f), Rgb(0.04f), 1, Rgb(0.5f), alpha)},
          {"thin milky", make(Rgb(0.5f), Rgb(0.04f), 1, Rgb(0.5f), alpha, 1.5f, true)},
          {"white velvet", cloth(alpha, make(Rgb(1), {}, 0, {}, 1), Rgb(1))},
          {"coated paint", coated_by(alpha, make(Rgb(1), {}, 0, {}, 1))},
          {"coated plastic", coated_by(alpha, plastic(0.3f, Rgb(1)))},
          {"coated mirror", coated_by(alpha, metal(0, Rgb(1)))},
          {"half coated metal", coated_by(alpha, metal(0.1f, Rgb(1)), 0.5f)},
          {"coated glass", coated_by(alpha, glass(0))},
          {"coated thin", coated_by(alpha, glass(0, 1.5f, true))}};
}
/// Coloured, half and odd mixtures.
inline std::vector<NamedBsdf> coloured(float alpha) {
  return {
      {"plain", make({0.8f, 0.5f, 0.2f}, {}, 0, {}, alpha)},
      {"plastic", plastic(alpha)},
      {"gold", metal(alpha)},
      {"iron", conductor(alpha, {2.87, 2.95, 2.65}, {3.36, 2.93, 2.81})},
      {"half metal", make({0.4f, 0.2f, 0.1f}, {0.5f, 0.3f, 0.1f}, 1, {}, alpha)},
      {"faint", make({0.4f, 0.2f, 0.1f}, {0.02f, 0.01f, 0}, 0.5f, {}, alpha)},
      {"green glass", glass(alpha, 1.5f, false, {0.1f, 0.9f, 0.2f})},
      {"green pane", glass(alpha, 1.5f, true, {0.1f, 0.9f, 0.2f})},
      {"jade", make({0.1f, 0.4f, 0.2f}, Rgb(0.04f), 1, {0.2f, 0.5f, 0.3f}, alpha)},
      {"paper", make({0.5f, 0.4f, 0.3f}, Rgb(0.04f), 1, Rgb(0.3f), alpha, 1.5f, true)},
      {"half metal glass", make({}, {0.5f, 0.3f, 0.1f}, 1, Rgb(0.5f), alpha)},
      {"velvet", cloth(alpha, make({0.3f, 0.1f, 0.1f}, {}, 0, {}, 1), {0.8f, 0.5f, 0.4f})},
      {"satin", cloth(0.25f, plastic(alpha), {0.3f, 0.6f, 0.9f})},
      {"veil", cloth(alpha, glass(alpha, 1.5f, true), {0.9f, 0.5f, 0.4f})},
      {"wet stone", cloth(alpha, glass(alpha), {0.9f, 0.5f, 0.4f})},
      {"dust", cloth(alpha, make({}, {}, 0, {}, 1), {0.3f, 0.2f, 0.1f})},
      {"car paint", coated_by(alpha, make({0.5f, 0.1f, 0.1f}, {0.3f, 0.1f, 0.1f}, 1, {}, 0.3f))},
      {"lacquered gold", coated_by(0.5f, metal(alpha), 0.7f)},
      {"coated green glass", coated_by(alpha, glass(0.2f, 1.5f, false, {0.1f, 0.9f, 0.2f}))},
      {"coated paper",
       coated_by(alpha, make({0.5f, 0.4f, 0.3f}, Rgb(0.04f), 1, Rgb(0.3f), 0.5f, 1.5f, true))},
      {"coated velvet", coated_by(alpha, cloth(0.3f, plastic(0.3f), {0.8f, 0.5f, 0.4f}), 0.6f)},
      {"varnished black", coated_by(alpha, make({}, {}, 0, {}, 1))}};
}

inline bool transmits(const Bsdf& b) {
  return surfaces().transmits(b);
}
inline bool has_sheen(const Bsdf& b) {
  return surfaces().has_sheen(b);
}
inline bool has_coat(const Bsdf& b) {
  return surfaces().has_coat(b);
}
/// Index of refraction on the side of w.
inline double index(const Bsdf& b, const Vec3d& w) {
  return surfaces().index_at(b, w);
}

/// All layers together, each about z.
namespace whole {

inline Point point(const Bsdf& b) {
  Point p;
  p.normal = p.shading = {0, 0, 1};
  p.simple = false;
  p.bsdf = b;
  return p;
}
inline Vec3d f(const Bsdf& b, const Vec3d& from, const Vec3d& to) {
  const double n = index(b, to);
  return surfaces().bsdf_at(point(b), from, to) * (1 / (n * n));
}
inline double pdf_w(const Bsdf& b, const Vec3d& from, const Vec3d& to) {
  return surfaces().scatter_pdf_w(point(b), from, to, false);
}
/// The Dirac lobe that connects `from` and `to`.
inline shader::Surfaces::Layers dirac(const Bsdf& b, const Vec3d& from, const Vec3d& to) {
  const Point p = point(b);
  const shader::Surfaces& s = surfaces();
  return s.layers_between(p, s.scatter_context_at(p, from), s.seen_from(p, to), true);
}
inline double dirac_probability(const Bsdf& b, const Vec3d& from, const Vec3d& to) {
  return dirac(b, from, to).pdf_w;
}
inline Vec3d dirac_reflectance(const Bsdf& b, const Vec3d& from, const Vec3d& to) {
  const auto layers = dirac(b, from, to);
  return layers.base + Vec3d(layers.coat);
}
inline Vec3d albedo(const Bsdf& b, const Vec3d& from) {
  const Point p = point(b);
  return surfaces().coated_albedo(p, surfaces().scatter_context_at(p, from));
}
struct Scattered {
  Vec3d to;
  bool dirac;
};
/// Three uniform numbers in [0,1). False if the walk is absorbed: pdf_w and dirac_probability sum
/// to 1 less the probability of that.
inline bool sample(const Bsdf& b, const Vec3d& from, double choice, double u, double v,
                   Scattered& out) {
  Turn turn;
  if (!surfaces().turn(point(b), shader::FROM_CAMERA, from, u, v, choice, turn)) return false;
  out = {turn.w, turn.dirac};
  return true;
}
inline bool connectible(const Bsdf& b) {
  return surfaces().bsdf_connectible(b) || (has_coat(b) && !surfaces().coat_smooth(b.coat));
}

}  // namespace whole

inline Vec3d direction(double z, double azimuth) {
  const double r = std::sqrt(std::max(0.0, (1 - z) * (1 + z)));
  return {r * std::cos(azimuth), r * std::sin(azimuth), z};
}
template <class Random>
Vec3d uniform_direction(Random& rng) {
  const double z = 2 * rng.uniform() - 1;
  return direction(z, 2 * std::numbers::pi * rng.uniform());
}

}  // namespace tdpt::test
