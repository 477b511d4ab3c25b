#include "tools/tdpt-render/path/bsdf/scatter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "libcommon/scene/texture.h"

namespace tdpt {
namespace {

using shader::FresnelCurve, shader::Surfaces, shader::ggx_stretched, shader::schlick_curve;
using shader::kGaussNodes, shader::kInterfaceAlphas, shader::kInterfaceCosines,
    shader::kSurfaceCurves;
using shader::kLeastSheenRoughness, shader::kSheenCosines, shader::kSheenRoughnesses;
using std::numbers::pi;

double node(uint i, uint nodes) {
  return static_cast<double>(i) / (nodes - 1);
}

constexpr size_t kAzimuths = 12, kRings = 24;  // quadrature over visible normals
constexpr double kGrazing = 1e-5;              // used instead of mu = 0

// Constants for sampling visible normals (ggx_visible_normal) on a grid of azimuths and rings. Half
// of the azimuths suffice, the others are their mirror image. Rings y, with 1 - v = y^2, are dense
// at v = 1, where reflected directions meet the horizon.
struct VisibleNormals {
  std::array<double, kAzimuths> cos_phi, sin_phi;
  std::array<double, kRings> one_minus_v, weight;

  VisibleNormals() {
    for (size_t j = 0; j < kAzimuths; ++j) {
      const double phi = pi * (static_cast<double>(j) + 0.5) / kAzimuths;
      cos_phi[j] = std::cos(phi);
      sin_phi[j] = std::sin(phi);
    }
    for (size_t i = 0; i < kRings; ++i) {
      const double y = (static_cast<double>(i) + 0.5) / kRings;
      one_minus_v[i] = y * y;
      weight[i] = 2 * y / (kRings * kAzimuths);
    }
  }

  // Mean of F G2/G1 over the normals visible from mu, as f0 a + f90 b. Written out, since nearly
  // all of the table's time is spent here.
  std::array<double, 2> integrate(double mu, double a) const {
    const double sine = std::sqrt(1 - mu * mu);
    const double scale = 1 / std::sqrt(a * a * sine * sine + mu * mu);
    const double wx = a * sine * scale, wz = mu * scale;  // stretched
    const double s_mu = ggx_stretched(mu, a);
    std::array<double, 2> sum{};
    for (size_t i = 0; i < kRings; ++i) {
      const double hz = one_minus_v[i] * (1 + wz), z = hz - wz;
      const double r = std::sqrt(std::max(0.0, (1 - z) * (1 + z)));
      for (size_t j = 0; j < kAzimuths; ++j) {
        const double hx = a * (r * cos_phi[j] + wx), hy = a * r * sin_phi[j];
        const double l = 1 / std::sqrt(hx * hx + hy * hy + hz * hz);
        const double c = (sine * hx + mu * hz) * l, to_z = 2 * c * hz * l - mu;
        if (!(to_z > 0)) continue;
        const double g =  // G2 / G1
            weight[i] * to_z * (mu + s_mu) / (to_z * s_mu + mu * ggx_stretched(to_z, a));
        sum[0] += g;
        sum[1] += g * schlick_curve(c).part;
      }
    }
    sum[0] -= sum[1];
    return sum;
  }
};

// A row of interface albedos, and its average: 2 int E mu dmu = 8 int E t^7 dt with t = mu^(1/4), E
// linear in t between nodes.
void add_average(std::vector<double>& curves, uint row) {
  std::array<double, 2> average{};
  for (uint i = 0; i + 1 < kInterfaceCosines; ++i) {
    const double t0 = node(i, kInterfaceCosines), t1 = node(i + 1, kInterfaceCosines);
    const double whole = std::pow(t1, 8) - std::pow(t0, 8);  // 8 int t^7
    const double moment = 8.0 / 9 * (std::pow(t1, 9) - std::pow(t0, 9));
    const double second = (moment - t0 * whole) / (t1 - t0), first = whole - second;
    for (size_t k = 0; k < 2; ++k) {
      const size_t at = 2 * (row * kInterfaceCosines + i) + k;
      average[k] += first * curves[at] + second * curves[at + 2];
    }
  }
  curves.insert(curves.end(), average.begin(), average.end());
}

void add_interface(std::vector<double>& curves) {
  const VisibleNormals normals;
  for (uint k = 0; k < kInterfaceAlphas; ++k)
    for (uint i = 0; i < kInterfaceCosines; ++i) {
      const double mu = std::pow(node(i, kInterfaceCosines), 4);
      const FresnelCurve<double> smooth = schlick_curve(mu);
      const std::array<double, 2> e =
          k == 0
              ? std::array{smooth.rest, smooth.part}
              : normals.integrate(std::max(mu, kGrazing), std::pow(node(k, kInterfaceAlphas), 4));
      curves.insert(curves.end(), e.begin(), e.end());
    }
  for (uint k = 0; k < kInterfaceAlphas; ++k) add_average(curves, k);
}

// Gauss-Legendre with 12 nodes: exact for products of curves of degree 5.
void add_gauss(std::vector<double>& curves) {
  constexpr double nodes[kGaussNodes]{0.1252334085114689, 0.3678314989981802, 0.5873179542866175,
                                      0.7699026741943047, 0.9041172563704749, 0.9815606342467193};
  constexpr double weights[kGaussNodes]{0.2491470458134028, 0.2334925365383548, 0.2031674267230659,
                                        0.1600783285433462, 0.1069393259953184, 0.0471753363865118};
  for (uint i = 0; i < kGaussNodes; ++i)
    curves.insert(curves.end(), {0.5 * nodes[i], 0.5 * weights[i]});
}

std::vector<double> make_surface_curves() {
  std::vector<double> curves;
  curves.reserve(kSurfaceCurves);
  add_interface(curves);
  for (const float light : linear_of_srgb()) curves.push_back(double{light});
  add_gauss(curves);
  return curves;
}

// For one roughness: D V and its scale, by cosine. int D V scale cos dw over the hemisphere:
// heights z = y^3, dense at the horizon, half of the azimuths.
class SheenRow {
 public:
  explicit SheenRow(uint row)
      : alpha_(std::pow(kLeastSheenRoughness +
                            (1 - double{kLeastSheenRoughness}) * node(row, kSheenRoughnesses),
                        2)),
        masking_(surfaces().sheen_masking(alpha_)) {
    for (uint i = 0; i < kSheenCosines; ++i)
      unscaled_[i] = integrate(mu_of(i), [](double) { return 1.0; });
  }

  const std::array<double, kSheenCosines>& unscaled() const { return unscaled_; }
  double albedo(uint i) const {
    const double own = scale(unscaled_[i]);
    return integrate(mu_of(i), [&](double mu) { return std::min(own, scale(along(mu))); });
  }

 private:
  static constexpr uint kHeights = 32, kAround = 24;

  static double mu_of(uint i) { return std::max(std::pow(node(i, kSheenCosines), 3), 1e-5); }
  static double scale(double e0) { return e0 > 1 ? 1 / e0 : 1.0; }
  double along(double mu) const {
    const double t = std::cbrt(mu) * (kSheenCosines - 1);
    const uint i = std::min(static_cast<uint>(t), kSheenCosines - 2);
    return unscaled_[i] + (unscaled_[i + 1] - unscaled_[i]) * (t - i);
  }
  template <class Scale>
  double integrate(double mu, const Scale& scale) const {
    const Surfaces& s = surfaces();
    const double sine = std::sqrt(1 - mu * mu), mask = s.sheen_masks(masking_, mu);
    double sum = 0;
    for (uint i = 0; i < kHeights; ++i) {
      const double y = (i + 0.5) / kHeights, z = y * y * y, flat = std::sqrt(1 - z * z);
      double ring = 0;
      for (uint j = 0; j < kAround; ++j) {
        const double phi = pi * (j + 0.5) / kAround;
        const Vec3d w(flat * std::cos(phi), flat * std::sin(phi), z);
        ring += s.sheen_distribution({sine, 0, mu}, w, alpha_);
      }
      const double visibility = s.sheen_visibility(mu, z, mask + s.sheen_masks(masking_, z));
      sum += ring * visibility * scale(z) * z * 3 * y * y;
    }
    return sum * 2 * pi / (kHeights * kAround);
  }

  double alpha_;
  Surfaces::SheenMasking masking_;
  std::array<double, kSheenCosines> unscaled_{};
};

std::vector<double> make_sheen_curves() {
  std::vector<double> unscaled, albedos;
  for (uint k = 0; k < kSheenRoughnesses; ++k) {
    const SheenRow row(k);
    unscaled.insert(unscaled.end(), row.unscaled().begin(), row.unscaled().end());
    for (uint i = 0; i < kSheenCosines; ++i) albedos.push_back(row.albedo(i));
  }
  unscaled.insert(unscaled.end(), albedos.begin(), albedos.end());
  return unscaled;
}

}  // namespace

std::span<const double> surface_curves() {
  static const std::vector<double> curves = make_surface_curves();
  return curves;
}

std::span<const double> sheen_curves() {
  static const std::vector<double> curves = make_sheen_curves();
  return curves;
}

}  // namespace tdpt
