// Region growing: the largest remaining triangle begins a facet; others join it from near to far,
// as long as the plane of all members holds every corner.
#include "tools/tdpt-render/portals/facets.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace tdpt {
namespace {

Vec3d twice_area(const Corners& t) {
  return cross(t[1] - t[0], t[2] - t[0]);
}
Vec3d centre(const Corners& t) {
  return t[0] + ((t[1] - t[0]) + (t[2] - t[0])) / 3;
}

class Growing {
 public:
  Growing(const std::vector<Corners>& triangles, uint32_t seed, double tolerance)
      : triangles_(&triangles), tolerance_(tolerance), seed_(triangles[seed]), members_{seed} {
    const Vec3d n = twice_area(seed_);
    sum_ = n;
    lever_ = centre(seed_) * length(n);
    weight_ = length(n);
    grad1_ = cross(seed_[2] - seed_[0], n) / dot(n, n);
    grad2_ = cross(n, seed_[1] - seed_[0]) / dot(n, n);
  }

  /// Whether t may lie in the seed's plane, as far as that is known: a plane through corners with
  /// an error of r has an error of (|b0| + |b1| + |b2|) r at barycentrics b.
  bool may_join(const Corners& t) const {
    const Vec3d n = normalize(twice_area(seed_));
    return dot(n, twice_area(t)) > 0 && std::all_of(t.begin(), t.end(), [&](const Vec3d& c) {
             const Vec3d d = c - seed_[0];
             const double b1 = dot(grad1_, d), b2 = dot(grad2_, d);
             const double reach = 1 + std::abs(1 - b1 - b2) + std::abs(b1) + std::abs(b2);
             return std::abs(dot(n, d)) <= reach * tolerance_;
           });
  }

  /// Joins t if one plane holds it and all members.
  bool join(uint32_t t) {
    const Vec3d n = twice_area((*triangles_)[t]);
    const Vec3d sum = sum_ + n, lever = lever_ + centre((*triangles_)[t]) * length(n);
    const double weight = weight_ + length(n);
    const Vec3d normal = normalize(sum), at = lever / weight;
    const auto holds = [&](uint32_t i) {
      return dot(normal, twice_area((*triangles_)[i])) > 0 &&
             std::all_of((*triangles_)[i].begin(), (*triangles_)[i].end(), [&](const Vec3d& c) {
               return std::abs(dot(normal, c - at)) <= tolerance_;
             });
    };
    if (!holds(t) || !std::all_of(members_.begin(), members_.end(), holds)) return false;
    sum_ = sum;
    lever_ = lever;
    weight_ = weight;
    members_.push_back(t);
    return true;
  }

  PlanarFacet facet() {
    std::sort(members_.begin(), members_.end());
    PlanarFacet f{normalize(sum_), {}};
    const Vec3d base = (*triangles_)[members_[0]][0];
    const double height = dot(f.normal, lever_ / weight_ - base);
    for (const uint32_t i : members_) {
      f.triangles.push_back((*triangles_)[i]);
      for (Vec3d& c : f.triangles.back()) c = c - f.normal * (dot(f.normal, c - base) - height);
    }
    return f;
  }
  uint32_t first() const { return *std::min_element(members_.begin(), members_.end()); }

 private:
  const std::vector<Corners>* triangles_;
  double tolerance_;
  Corners seed_;
  Vec3d grad1_, grad2_;  // gradients of the seed's barycentrics b1, b2
  std::vector<uint32_t> members_;
  Vec3d sum_, lever_;  // sums of 2 A n and of 2 A c over the members
  double weight_;      // sum of 2 A
};

}  // namespace

std::vector<PlanarFacet> planar_facets(const std::vector<Corners>& triangles, double tolerance) {
  std::vector<uint32_t> by_size(triangles.size());
  std::iota(by_size.begin(), by_size.end(), 0u);
  const auto size = [&](uint32_t t) { return length(twice_area(triangles[t])); };
  std::stable_sort(by_size.begin(), by_size.end(),
                   [&](uint32_t a, uint32_t b) { return size(a) > size(b); });
  std::vector<bool> taken(triangles.size());
  std::vector<Growing> grown;
  for (const uint32_t seed : by_size) {
    if (taken[seed]) continue;
    taken[seed] = true;
    Growing& facet = grown.emplace_back(triangles, seed, tolerance);
    std::vector<std::pair<double, uint32_t>> others;
    for (uint32_t t = 0; t < triangles.size(); ++t)
      if (!taken[t] && facet.may_join(triangles[t]))
        others.emplace_back(length(centre(triangles[t]) - centre(triangles[seed])), t);
    std::sort(others.begin(), others.end());
    for (const auto& [distance, t] : others) taken[t] = facet.join(t);
  }
  std::sort(grown.begin(), grown.end(),
            [](const Growing& a, const Growing& b) { return a.first() < b.first(); });
  std::vector<PlanarFacet> facets;
  for (Growing& g : grown) facets.push_back(g.facet());
  return facets;
}

}  // namespace tdpt
