#include "tools/tdpt-render/path/interface_albedo.h"

#include <array>

#include "tools/tdpt-render/path/ggx.h"

namespace tdpt {
namespace {

constexpr int kMu = 48, kAlpha = 24;        // nodes
constexpr int kAzimuths = 12, kRings = 24;  // quadrature over visible normals
constexpr double kGrazing = 1e-4;           // stands for mu = 0

// Mean of F G2/G1 over the normals visible from mu, by the midpoint rule in the numbers that sample
// them; half of the azimuths do, the other half is their mirror image.
InterfaceAlbedo integrate(double mu, double alpha) {
  const Vec3d w(std::sqrt(1 - mu * mu), 0, mu);
  InterfaceAlbedo sum;
  for (int i = 0; i < kRings; ++i)
    for (int j = 0; j < kAzimuths; ++j) {
      const Vec3d h =
          ggx::visible_normal(w, alpha, 0.5 * (j + 0.5) / kAzimuths, (i + 0.5) / kRings);
      const double c = dot(w, h), to_z = 2 * c * h.z - w.z;
      if (!(to_z > 0)) continue;
      const double g = ggx::g2_over_cos(w.z, to_z, alpha) * to_z / ggx::g1_over_cos(w.z, alpha);
      sum.a += g * (1 - schlick(c));
      sum.b += g * schlick(c);
    }
  return {sum.a / (kRings * kAzimuths), sum.b / (kRings * kAzimuths)};
}

struct Table {
  std::array<std::array<InterfaceAlbedo, kMu>, kAlpha> at;
  std::array<InterfaceAlbedo, kAlpha> average;

  Table() {
    for (size_t k = 0; k < kAlpha; ++k) {
      const double root_alpha = static_cast<double>(k) / (kAlpha - 1);
      for (size_t i = 0; i < kMu; ++i) {
        const double t = static_cast<double>(i) / (kMu - 1);
        at[k][i] = k == 0 ? InterfaceAlbedo{1 - schlick(t * t), schlick(t * t)}
                          : integrate(std::max(t * t, kGrazing), root_alpha * root_alpha);
      }
      // 2 int E mu dmu = 4 int E t^3 dt, E linear in t between nodes.
      for (size_t i = 0; i + 1 < kMu; ++i) {
        const double t0 = static_cast<double>(i) / (kMu - 1);
        const double t1 = static_cast<double>(i + 1) / (kMu - 1);
        const double t3 = std::pow(t1, 4) - std::pow(t0, 4);  // 4 int t^3
        const double t4 = 0.8 * (std::pow(t1, 5) - std::pow(t0, 5));
        const double second = (t4 - t0 * t3) / (t1 - t0), first = t3 - second;
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

// Node below sqrt(x), x in [0,1], and the way from it to the next.
size_t node(double x, size_t nodes, double& rest) {
  const double t = std::sqrt(std::clamp(x, 0.0, 1.0)) * static_cast<double>(nodes - 1);
  const size_t i = std::min(static_cast<size_t>(t), nodes - 2);
  rest = t - static_cast<double>(i);
  return i;
}

}  // namespace

InterfaceAlbedo interface_albedo(double mu, double alpha) {
  if (!(alpha > 0)) return {1 - schlick(mu), schlick(mu)};
  double s, t;
  const size_t k = node(alpha, kAlpha, s), i = node(mu, kMu, t);
  const Table& e = table();
  return mix(mix(e.at[k][i], e.at[k][i + 1], t), mix(e.at[k + 1][i], e.at[k + 1][i + 1], t), s);
}

InterfaceAlbedo interface_albedo_average(double alpha) {
  if (!(alpha > 0)) return {20.0 / 21, 1.0 / 21};
  double s;
  const size_t k = node(alpha, kAlpha, s);
  return mix(table().average[k], table().average[k + 1], s);
}

}  // namespace tdpt
