// Colours of spectra: the CIE 1931 responses by the fits of Wyman, Sloan and Shirley (2013, "Simple
// analytic approximations to the CIE XYZ color matching functions", multi-lobe).
#include <cmath>

#include "tools/tdpt-import/materials.h"

namespace tdpt::foreign {
namespace {

constexpr double kFirst = 380, kLast = 780, kStep = 1;  // nm

double lobe(double x, double mean, double below, double above) {
  const double t = (x - mean) * (x < mean ? below : above);
  return std::exp(-0.5 * t * t);
}

Vec3d responses(double nm) {
  return {1.056 * lobe(nm, 599.8, 0.0264, 0.0323) + 0.362 * lobe(nm, 442.0, 0.0624, 0.0374) -
              0.065 * lobe(nm, 501.1, 0.0490, 0.0382),
          0.821 * lobe(nm, 568.8, 0.0213, 0.0247) + 0.286 * lobe(nm, 530.9, 0.0613, 0.0322),
          1.217 * lobe(nm, 437.0, 0.0845, 0.0278) + 0.681 * lobe(nm, 459.0, 0.0385, 0.0725)};
}

Vec3d rgb_of(const Vec3d& xyz) {
  return {3.240479 * xyz.x - 1.537150 * xyz.y - 0.498535 * xyz.z,
          -0.969256 * xyz.x + 1.875991 * xyz.y + 0.041556 * xyz.z,
          0.055648 * xyz.x - 0.204043 * xyz.y + 1.057311 * xyz.z};
}

Rgb rounded(const Vec3d& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

// XYZ of a spectrum, of which a constant 1 has (1, 1, 1).
template <class Spectrum>
Vec3d xyz_of(const Spectrum& spectrum) {
  Vec3d sum{}, white{};
  for (double nm = kFirst; nm <= kLast; nm += kStep) {
    const Vec3d r = responses(nm);
    sum = sum + r * spectrum(nm);
    white = white + r;
  }
  return {sum.x / white.x, sum.y / white.y, sum.z / white.z};
}

double at(const std::vector<std::array<double, 2>>& samples, double nm) {
  if (nm <= samples.front()[0]) return samples.front()[1];
  for (size_t i = 1; i < samples.size(); ++i)
    if (nm <= samples[i][0]) {
      const double width = samples[i][0] - samples[i - 1][0];
      const double t = width > 0 ? (nm - samples[i - 1][0]) / width : 1;
      return samples[i - 1][1] + t * (samples[i][1] - samples[i - 1][1]);
    }
  return samples.back()[1];
}

}  // namespace

Rgb rgb_of_xyz(const Rgb& xyz) {
  return rounded(rgb_of({xyz.x, xyz.y, xyz.z}));
}

Rgb rgb_of_blackbody(double kelvin) {
  constexpr double kSecond = 1.438776877e7;  // nm K
  const auto planck = [&](double nm) {       // relative to 560 nm, to stay in range
    return std::pow(560 / nm, 5) * std::expm1(kSecond / (560 * kelvin)) /
           std::expm1(kSecond / (nm * kelvin));
  };
  const Vec3d xyz = xyz_of(planck);
  const Vec3d rgb = rgb_of(xyz / xyz.y);
  return rounded(max(rgb, Vec3d(0)));
}

Rgb rgb_of_spectrum(const std::vector<std::array<double, 2>>& samples) {
  if (samples.empty()) return {};
  const Vec3d white = rgb_of(Vec3d(1));
  const Vec3d rgb = rgb_of(xyz_of([&](double nm) { return at(samples, nm); }));
  return rounded(max(Vec3d(rgb.x / white.x, rgb.y / white.y, rgb.z / white.z), Vec3d(0)));
}

}  // namespace tdpt::foreign
