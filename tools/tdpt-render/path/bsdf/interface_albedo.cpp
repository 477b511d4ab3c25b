#include "tools/tdpt-render/path/bsdf/interface_albedo.h"

#include <array>

#include "tools/tdpt-render/path/bsdf/ggx.h"

namespace tdpt {
namespace {

constexpr int kMu = 64, kAlpha = 48;        // nodes
constexpr int kAzimuths = 12, kRings = 24;  // quadrature over visible normals
constexpr double kGrazing = 1e-5;           // stands for mu = 0

// What sampling visible normals (ggx::visible_normal) with a given number of azimuths and rings
// takes: half of the azimuths do, the others are their mirror image. Rings y, with 1 - v = y^2, are
// dense at v = 1, where reflected directions meet the horizon.
struct Quadrature {
  std::array<double, kAzimuths> cos_phi, sin_phi;
  std::array<double, kRings> one_minus_v, weight;

  Quadrature() {
    for (size_t j = 0; j < kAzimuths; ++j) {
      const double phi = std::numbers::pi * (static_cast<double>(j) + 0.5) / kAzimuths;
      cos_phi[j] = std::cos(phi);
      sin_phi[j] = std::sin(phi);
    }
    for (size_t i = 0; i < kRings; ++i) {
      const double y = (static_cast<double>(i) + 0.5) / kRings;
      one_minus_v[i] = y * y;
      weight[i] = 2 * y / (kRings * kAzimuths);
    }
  }

  // Mean of F G2/G1 over the normals visible from mu. Written out, as it takes all the table's
  // time.
  InterfaceAlbedo integrate(double mu, double a) const {
    const double sine = std::sqrt(1 - mu * mu);
    const double scale = 1 / std::sqrt(a * a * sine * sine + mu * mu);
    const double wx = a * sine * scale, wz = mu * scale;  // stretched
    const double s_mu = ggx::stretched(mu, a);
    InterfaceAlbedo sum;
    for (size_t i = 0; i < kRings; ++i) {
      const double hz = one_minus_v[i] * (1 + wz), z = hz - wz;
      const double r = std::sqrt(std::max(0.0, (1 - z) * (1 + z)));
      for (size_t j = 0; j < kAzimuths; ++j) {
        const double hx = a * (r * cos_phi[j] + wx), hy = a * r * sin_phi[j];
        const double l = 1 / std::sqrt(hx * hx + hy * hy + hz * hz);
        const double c = (sine * hx + mu * hz) * l, to_z = 2 * c * hz * l - mu;
        if (!(to_z > 0)) continue;
        const double g =  // G2 / G1
            weight[i] * to_z * (mu + s_mu) / (to_z * s_mu + mu * ggx::stretched(to_z, a));
        const double s = schlick(c);
        sum.a += g * (1 - s);
        sum.b += g * s;
      }
    }
    return sum;
  }
};

struct Table {
  std::array<std::array<InterfaceAlbedo, kMu>, kAlpha> at;
  std::array<InterfaceAlbedo, kAlpha> average;

  Table() {
    const Quadrature quadrature;
    const auto node = [](size_t i, int nodes) { return static_cast<double>(i) / (nodes - 1); };
    for (size_t k = 0; k < kAlpha; ++k) {
      const double alpha = std::pow(node(k, kAlpha), 4);
      for (size_t i = 0; i < kMu; ++i) {
        const double mu = std::pow(node(i, kMu), 4);
        at[k][i] = k == 0 ? InterfaceAlbedo{1 - schlick(mu), schlick(mu)}
                          : quadrature.integrate(std::max(mu, kGrazing), alpha);
      }
      // 2 int E mu dmu = 8 int E t^7 dt with t = mu^(1/4), E linear in t between nodes.
      for (size_t i = 0; i + 1 < kMu; ++i) {
        const double t0 = node(i, kMu), t1 = node(i + 1, kMu);
        const double whole = std::pow(t1, 8) - std::pow(t0, 8);  // 8 int t^7
        const double moment = 8.0 / 9 * (std::pow(t1, 9) - std::pow(t0, 9));
        const double second = (moment - t0 * whole) / (t1 - t0), first = whole - second;
        average[k].a += first * at[k][i].a + second * at[k][i + 1].a;
        average[k].b += first * at[k][i].b + second * at[k][i + 1].b;
      }
    }
  }
};

const Table& table() {
  static const Table t;
  return t;
}

InterfaceAlbedo mix(const InterfaceAlbedo& p, const InterfaceAlbedo& q, double t) {
  return {p.a + (q.a - p.a) * t, p.b + (q.b - p.b) * t};
}

// Node below x^(1/4), x in [0,1], and the way from it to the next.
size_t node(double x, size_t nodes, double& rest) {
  const double t = std::sqrt(std::sqrt(std::clamp(x, 0.0, 1.0))) * static_cast<double>(nodes - 1);
  const size_t i = std::min(static_cast<size_t>(t), nodes - 2);
  rest = t - static_cast<double>(i);
  return i;
}

}  // namespace

InterfaceAlbedo interface_albedo(double mu, double alpha) {
  if (!(alpha > 0)) return {1 - schlick(mu), schlick(mu)};
  InterfaceRow row;
  row.node = static_cast<int>(node(alpha, kAlpha, row.rest));
  return interface_albedo(mu, row);
}

InterfaceAlbedo interface_albedo(double mu, const InterfaceRow& row) {
  double t;
  const size_t k = static_cast<size_t>(row.node), i = node(mu, kMu, t);
  const double s = row.rest;
  const Table& e = table();
  return mix(mix(e.at[k][i], e.at[k][i + 1], t), mix(e.at[k + 1][i], e.at[k + 1][i + 1], t), s);
}

InterfaceRow interface_row(double alpha) {
  InterfaceRow row;
  row.node = static_cast<int>(node(alpha, kAlpha, row.rest));
  row.average = interface_albedo_average(alpha);
  return row;
}

InterfaceAlbedo interface_albedo_average(double alpha) {
  if (!(alpha > 0)) return {20.0 / 21, 1.0 / 21};
  double s;
  const size_t k = node(alpha, kAlpha, s);
  return mix(table().average[k], table().average[k + 1], s);
}

}  // namespace tdpt
