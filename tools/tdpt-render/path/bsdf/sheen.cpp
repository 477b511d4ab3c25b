#include "tools/tdpt-render/path/bsdf/sheen.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace tdpt::sheen {
namespace {

constexpr double kGrazing = 1e-6;
constexpr size_t kMu = 40, kRoughness = 24;  // nodes: mu = t^3, roughness evenly
constexpr size_t kHeights = 32, kAzimuths = 24;

// Of Estevez & Kulla's fit: L = a / (1 + b x^c) + d x + e, between the values for a = 0 and 1.
struct Masking {
  double a, b, c, d, e, at_half;

  explicit Masking(double alpha) {
    const double t = (1 - alpha) * (1 - alpha);
    const auto mix = [t](double rough, double smooth) { return rough + t * (smooth - rough); };
    a = mix(21.5473, 25.3245);
    b = mix(3.82987, 3.32435);
    c = mix(0.19823, 0.16801);
    d = mix(-1.97760, -1.27393);
    e = mix(-4.32054, -4.85967);
    at_half = fit(0.5);
  }
  double fit(double x) const { return a / (1 + b * std::pow(x, c)) + d * x + e; }
  double operator()(double cos) const {
    return std::exp(cos < 0.5 ? fit(cos) : 2 * at_half - fit(1 - cos));
  }
};

double distribution(double sin2, double a) {
  return (2 + 1 / a) * std::pow(sin2, 0.5 / a) * (0.5 * std::numbers::inv_pi);
}
double visibility(double cos_v, double cos_w, double masks) {
  return 0.25 / ((1 + masks) * cos_v * cos_w);
}

// Squared sine of the half vector, also where v and w almost oppose each other.
double sin2_of_half(const Vec3d& v, const Vec3d& w) {
  const Vec3d h = v + w;
  const double flat = h.x * h.x + h.y * h.y, whole = flat + h.z * h.z;
  return whole > 0 ? std::min(flat / whole, 1.0) : 1.0;
}

double mu_of(size_t node) {
  const double t = static_cast<double>(node) / (kMu - 1);
  return std::max(t * t * t, 10 * kGrazing);
}
double alpha_of(size_t node) {
  const double r =
      kLeastRoughness + (1 - kLeastRoughness) * static_cast<double>(node) / (kRoughness - 1);
  return r * r;
}

struct Table {
  std::array<std::array<double, kMu>, kRoughness> unscaled, albedo;

  Table() {
    for (size_t k = 0; k < kRoughness; ++k) {
      const double a = alpha_of(k);
      const Masking masking(a);
      for (size_t i = 0; i < kMu; ++i)
        unscaled[k][i] = integrate(mu_of(i), a, masking, [](double) { return 1.0; });
      for (size_t i = 0; i < kMu; ++i) {
        const double own = scale(unscaled[k][i]);
        albedo[k][i] = integrate(mu_of(i), a, masking, [&](double mu) {
          return std::min(own, scale(along(unscaled[k], mu)));
        });
      }
    }
  }

  static double scale(double e0) { return e0 > 1 ? 1 / e0 : 1.0; }

  static double along(const std::array<double, kMu>& row, double mu) {
    const double t = std::cbrt(std::clamp(mu, 0.0, 1.0)) * (kMu - 1);
    const size_t i = std::min(static_cast<size_t>(t), kMu - 2);
    return row[i] + (row[i + 1] - row[i]) * (t - static_cast<double>(i));
  }
  static double at(const std::array<std::array<double, kMu>, kRoughness>& table, double mu,
                   double a) {
    const double r = (std::sqrt(a) - kLeastRoughness) / (1 - kLeastRoughness) * (kRoughness - 1);
    const double t = std::clamp(r, 0.0, kRoughness - 1.0);
    const size_t k = std::min(static_cast<size_t>(t), kRoughness - 2);
    const double p = along(table[k], mu), q = along(table[k + 1], mu);
    return p + (q - p) * (t - static_cast<double>(k));
  }

  // int D V scale cos dw over the hemisphere: heights z = y^3, dense at the horizon, half of the
  // azimuths.
  template <class Scale>
  static double integrate(double mu, double a, const Masking& masking, const Scale& scale) {
    const double sine = std::sqrt(1 - mu * mu), mask = masking(mu);
    double sum = 0;
    for (size_t i = 0; i < kHeights; ++i) {
      const double y = (static_cast<double>(i) + 0.5) / kHeights, z = y * y * y;
      const double flat = std::sqrt(1 - z * z);
      double ring = 0;
      for (size_t j = 0; j < kAzimuths; ++j) {
        const double phi = std::numbers::pi * (static_cast<double>(j) + 0.5) / kAzimuths;
        const Vec3d w(flat * std::cos(phi), flat * std::sin(phi), z);
        ring += distribution(sin2_of_half({sine, 0, mu}, w), a);
      }
      sum += ring * visibility(mu, z, mask + masking(z)) * scale(z) * z * 3 * y * y;
    }
    return sum * 2 * std::numbers::pi / (kHeights * kAzimuths);
  }
};

const Table& table() {
  static const Table t;
  return t;
}

}  // namespace

double f(const Vec3d& v, const Vec3d& w, double a) {
  if (!(v.z >= kGrazing) || !(w.z >= kGrazing)) return 0;
  const Masking masking(a);
  const Table& t = table();
  const double scale =
      Table::scale(std::max(Table::at(t.unscaled, v.z, a), Table::at(t.unscaled, w.z, a)));
  return distribution(sin2_of_half(v, w), a) * visibility(v.z, w.z, masking(v.z) + masking(w.z)) *
         scale;
}

double unscaled_albedo(double mu, double a) {
  return Table::at(table().unscaled, mu, a);
}

double albedo(double mu, double a) {
  return Table::at(table().albedo, mu, a);
}

}  // namespace tdpt::sheen
