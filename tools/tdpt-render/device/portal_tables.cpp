#include "tools/tdpt-render/device/portal_tables.h"

#include <algorithm>

namespace tdpt {
namespace {

// Clamps to what floats can hold: gradients of portals as small as rounding are large.
float held(double x) {
  constexpr double kMost = 1e30;
  return static_cast<float>(std::clamp(x, -kMost, kMost));
}
Vec3f held(const Vec3d& v) {
  return {held(v.x), held(v.y), held(v.z)};
}

// Error of a point computed in the plane of a portal, in barycentric coordinates.
float border_of(const shader::PortalPolygonOf<double>& q) {
  constexpr double kOff = 2e-6, kMost = 0.3;
  const double steepest = std::max({length(q.grad1), length(q.grad2), length(q.grad1 + q.grad2)});
  return static_cast<float>(std::min(kOff * steepest, kMost));
}

float reach2_of(double reach2) {
  constexpr double kOff = 1e-5;
  const double reach = std::sqrt(reach2) + kOff;
  return static_cast<float>(reach * reach);
}

}  // namespace

PortalTables::PortalTables(const PortalSet& set) {
  if (set.empty()) return;
  for (const auto& f : set.facets_) {
    shader::PortalFacet& out = facets.emplace_back(shader::PortalFacet(f));
    out.area = held(f.area);
    out.reach2 = reach2_of(f.reach2);
    out.density = held(f.density);
    out.per_area = held(f.per_area);
  }
  for (const auto& q : set.polygons_) {
    shader::PortalPolygon& out = polygons.emplace_back(shader::PortalPolygon(q));
    out.grad1 = held(q.grad1);
    out.grad2 = held(q.grad2);
    float& border = facets[q.facet].border;
    border = std::max(border, border_of(q));
  }
  for (const Vec3d& corner : set.corners_) corners.push_back({Vec3f(corner), 0});
  for (const auto& pair : set.pairs_) {
    pairs.push_back(shader::PortalPair(pair));
    pairs.back().pdf = held(pair.pdf);
  }
  const PortalSet::Sizes& sizes = set.sizes_;
  guiding = {sizes.facets,
             sizes.polygons,
             sizes.pairs,
             static_cast<float>(sizes.pair_share),
             static_cast<float>(sizes.per_pair_share),
             0,
             0,
             0};
}

}  // namespace tdpt
