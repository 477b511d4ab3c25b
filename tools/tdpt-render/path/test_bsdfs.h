// BSDFs of every kind, and directions, for tests.
#pragma once
#include <numbers>
#include <string>
#include <vector>

#include "tools/tdpt-render/path/bsdf.h"

namespace tdpt::test {

struct NamedBsdf {
  std::string name;
  Bsdf b;
};

inline Bsdf make(const Rgb& diffuse, const Rgb& f0, float f90, const Rgb& through, float alpha,
                 float eta = 1.5f, bool thin = false) {
  return {diffuse, f0, Rgb(f90), through, alpha, eta, thin};
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
inline Bsdf glass(float alpha, float eta = 1.5f, bool thin = false, const Rgb& through = Rgb(1)) {
  return make({}, normal_reflectance(eta), 1, through, alpha, eta, thin);
}

/// White: nothing absorbs, so that what is not reflected or transmitted is lost by the model.
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
          {"thin milky", make(Rgb(0.5f), Rgb(0.04f), 1, Rgb(0.5f), alpha, 1.5f, true)}};
}
/// Coloured, half and odd mixtures.
inline std::vector<NamedBsdf> coloured(float alpha) {
  return {{"plain", make({0.8f, 0.5f, 0.2f}, {}, 0, {}, alpha)},
          {"plastic", plastic(alpha)},
          {"gold", metal(alpha)},
          {"half metal", make({0.4f, 0.2f, 0.1f}, {0.5f, 0.3f, 0.1f}, 1, {}, alpha)},
          {"faint", make({0.4f, 0.2f, 0.1f}, {0.02f, 0.01f, 0}, 0.5f, {}, alpha)},
          {"green glass", glass(alpha, 1.5f, false, {0.1f, 0.9f, 0.2f})},
          {"green pane", glass(alpha, 1.5f, true, {0.1f, 0.9f, 0.2f})},
          {"jade", make({0.1f, 0.4f, 0.2f}, Rgb(0.04f), 1, {0.2f, 0.5f, 0.3f}, alpha)},
          {"paper", make({0.5f, 0.4f, 0.3f}, Rgb(0.04f), 1, Rgb(0.3f), alpha, 1.5f, true)},
          {"half metal glass", make({}, {0.5f, 0.3f, 0.1f}, 1, Rgb(0.5f), alpha)}};
}

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
