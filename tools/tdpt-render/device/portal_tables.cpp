#include "tools/tdpt-render/device/portal_tables.h"

#include <algorithm>

namespace tdpt {
namespace {

// Portals are no smaller than rounding; what is keeps to what a float holds.
float held(double x) {
  constexpr double kMost = 1e30;
  return static_cast<float>(std::clamp(x, -kMost, kMost));
}
Vec3f held(const Vec3d& v) {
  return {held(v.x), held(v.y), held(v.z)};
}

// Distance that a place found in the plane of a portal may be off by, and of that and of 1e-4 of
// the triangle, as in PortalSet, the larger: barycentric.
float border_of(const PortalSet::Polygon& q) {
  constexpr double kOff = 2e-6, kBorder = 1e-4, kMost = 0.3;
  const double steepest = std::max({length(q.grad1), length(q.grad2), length(q.grad1 + q.grad2)});
  return static_cast<float>(std::clamp(kOff * steepest, kBorder, kMost));
}

float reach2_of(double reach2) {
  constexpr double kOff = 1e-5, kBorder = 1e-4;
  const double reach = std::sqrt(reach2) + kOff;
  return static_cast<float>(reach * reach * (1 + kBorder));
}

// Shares of the entries of a table up to and with each; the last is 1.
class Ends {
 public:
  explicit Ends(const CumulativeTable& table) : table_(table) {}
  float next() {
    sum_ += table_.pdf_1(entry_++);
    return entry_ == table_.size() ? 1.0f : static_cast<float>(std::min(sum_, 1.0));
  }

 private:
  const CumulativeTable& table_;
  uint32_t entry_ = 0;
  double sum_ = 0;
};

}  // namespace

PortalTables::PortalTables(const PortalSet& set) {
  if (set.empty()) return;
  add_facets(set);
  add_polygons(set);
  add_pairs(set);
  guiding.facets = static_cast<uint32_t>(facets.size());
  guiding.polygons = static_cast<uint32_t>(polygons.size());
  guiding.pairs = static_cast<uint32_t>(pairs.size());
  if (pairs.empty()) return;
  guiding.pair_share = static_cast<float>(set.pair_share_);
  guiding.per_pair_share = static_cast<float>(1 / set.pair_share_);
}

void PortalTables::add_facets(const PortalSet& set) {
  for (const PortalSet::Facet& f : set.facets_) {
    shader::PortalFacet& out = facets.emplace_back();
    out.normal = Vec3f(f.normal);
    out.area = held(f.area);
    out.centre = Vec3f(f.centre);
    out.reach2 = reach2_of(f.reach2);
    out.density = held(set.polygons_[f.first].density);
    out.per_area = held(1 / f.area);
    out.first = f.first;
    out.end = f.end;
    out.first_corner = static_cast<uint32_t>(corners.size());
    for (const Vec3d& corner : f.corners) corners.push_back({Vec3f(corner), 0});
    out.end_corner = static_cast<uint32_t>(corners.size());
    out.first_pair = f.first_pair;
    out.end_pair = f.end_pair;
  }
}

void PortalTables::add_polygons(const PortalSet& set) {
  Ends of_all(set.table_);
  for (const PortalSet::Facet& f : set.facets_) {
    Ends of_facet(f.table);
    for (uint32_t i = f.first; i < f.end; ++i) {
      const PortalSet::Polygon& q = set.polygons_[i];
      shader::PortalPolygon& out = polygons.emplace_back();
      out.p0 = Vec3f(q.p0);
      out.end_of_all = of_all.next();
      out.e1 = Vec3f(q.e1);
      out.end_of_facet = of_facet.next();
      out.e2 = Vec3f(q.e2);
      facets[q.facet].border = std::max(facets[q.facet].border, border_of(q));
      out.grad1 = held(q.grad1);
      out.portal = q.portal;
      out.grad2 = held(q.grad2);
      out.facet = q.facet;
    }
  }
}

void PortalTables::add_pairs(const PortalSet& set) {
  if (set.pairs_.empty()) return;
  Ends ends(set.pair_table_);
  for (const PortalSet::Pair& pair : set.pairs_)
    pairs.push_back({pair.first, pair.second, held(pair.pdf), ends.next()});
}

}  // namespace tdpt
