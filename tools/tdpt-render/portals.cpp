#include "tools/tdpt-render/portals.h"

#include <numbers>

namespace tdpt {

PortalSet::PortalSet(const std::vector<Portal>& portals, const Frame& frame) {
  std::vector<double> areas;
  double total = 0;
  for (const Portal& portal : portals) {
    for (const auto& t : portal.triangles) {
      Polygon q;
      q.portal = static_cast<uint32_t>(portals_);
      q.p0 = frame.to_canonical(portal.vertices[t[0]]);
      q.e1 = frame.to_canonical(portal.vertices[t[1]]) - q.p0;
      q.e2 = frame.to_canonical(portal.vertices[t[2]]) - q.p0;
      const Vec3d n = cross(q.e1, q.e2);
      const double twice_area = length(n);
      if (!(twice_area > 1e-24)) continue;
      q.normal = n / twice_area;
      q.grad1 = cross(q.e2, q.normal) / twice_area;
      q.grad2 = cross(q.normal, q.e1) / twice_area;
      polygons_.push_back(q);
      areas.push_back(0.5 * twice_area);
      total += areas.back();
    }
    ++portals_;
  }
  // p(q) = A_q / total, so p(q) / (A_q pi) is the same for every triangle.
  for (Polygon& q : polygons_) q.density = 1 / (total * std::numbers::pi);
  if (!polygons_.empty()) table_ = AliasTable(areas);
}

double PortalSet::density(const Vec3d& from, const Vec3d& to, int sampled) const {
  double sum = 0;
  const Vec3d d = to - from;
  for (size_t i = 0; i < polygons_.size(); ++i) {
    const Polygon& q = polygons_[i];
    const Vec3d o = from - q.p0;
    const double before = dot(q.normal, o);  // < 0 on the light's side
    const double slope = dot(q.normal, d);
    if (!(before < -kMargin && before + slope > kMargin)) continue;
    if (static_cast<int>(i) == sampled) {
      sum += q.density;
      continue;
    }
    const Vec3d at = o - d * (before / slope);
    const double b1 = dot(q.grad1, at), b2 = dot(q.grad2, at);
    if (b1 >= 0 && b2 >= 0 && b1 + b2 <= 1) sum += q.density;
  }
  return sum;
}

PortalSet::Sample PortalSet::sample(Rng& rng) const {
  const double pick = rng.uniform();
  const double u = rng.uniform();
  const double v = rng.uniform();
  const double s = rng.uniform();
  const double t = rng.uniform();
  const int i = static_cast<int>(table_.sample(pick));
  const Polygon& q = polygons_[static_cast<size_t>(i)];
  double b1, b2;
  uniform_triangle(u, v, b1, b2);
  return {i, q.p0 + q.e1 * b1 + q.e2 * b2,
          normalize(Onb<double>(q.normal).to_world(cosine_hemisphere(s, t)))};
}

}  // namespace tdpt
