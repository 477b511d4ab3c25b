#include "tools/tdpt-render/portals/portals.h"

#include <algorithm>
#include <numbers>

namespace tdpt {

namespace {

constexpr double kLeastTwiceArea = 1e-24;  // canonical; below that a triangle is degenerate

Vec3d twice_area(const Corners& t) {
  return cross(t[1] - t[0], t[2] - t[0]);
}
Vec3d centre(const Corners& t) {
  return t[0] + ((t[1] - t[0]) + (t[2] - t[0])) / 3;
}

// Calls set(i, cumulative share of `weights` up to and including entry i).
template <class Set>
void set_cumulative_shares(const std::vector<double>& weights, const Set& set) {
  double all = 0, sum = 0;
  for (const double w : weights) all += w;
  for (size_t i = 0; i < weights.size(); ++i)
    set(i, i + 1 == weights.size() ? 1 : std::min((sum += weights[i]) / all, 1.0));
}

FlatPortal turned_round(FlatPortal flat) {
  flat.normal = -flat.normal;
  for (Corners& t : flat.triangles) std::swap(t[1], t[2]);
  return flat;
}

// The smallest rectangle around the triangles that has a side along a side of one of them, enlarged
// by kSurroundMargin; its normal is theirs.
struct Surround {
  Vec3d corner, x, y;
};
Surround surround_of(const FlatPortal& flat) {
  const double more = shader::kSurroundMargin;
  Surround best;
  double least = HUGE_VAL;
  for (const Corners& t : flat.triangles)
    for (size_t i = 0; i < 3; ++i) {
      const Vec3d x = normalize(t[(i + 1) % 3] - t[i]), y = cross(flat.normal, x);
      double x0 = HUGE_VAL, x1 = -HUGE_VAL, y0 = HUGE_VAL, y1 = -HUGE_VAL;
      for (const Corners& of : flat.triangles)
        for (const Vec3d& corner : of) {
          x0 = std::min(x0, dot(x, corner - t[i])), x1 = std::max(x1, dot(x, corner - t[i]));
          y0 = std::min(y0, dot(y, corner - t[i])), y1 = std::max(y1, dot(y, corner - t[i]));
        }
      // Of equals the first.
      const double area = (x1 - x0) * (y1 - y0);
      if (!(area < least * (1 - 1e-9))) continue;
      least = area;
      const Vec3d along = x * (x1 - x0), across = y * (y1 - y0);
      best = {t[i] + x * x0 + y * y0 - (along + across) * more, along * (1 + 2 * more),
              across * (1 + 2 * more)};
    }
  return best;
}

}  // namespace

FlatPortal flattened(const Portal& portal, const Frame& frame) {
  FlatPortal flat;
  Vec3d all, largest;
  for (const auto& t : portal.triangles) {
    Corners& corners = flat.triangles.emplace_back();
    for (size_t i = 0; i < 3; ++i) corners[i] = frame.to_canonical(portal.vertices[t[i]]);
    const Vec3d n = twice_area(corners);
    all += n;
    if (dot(n, n) > dot(largest, largest)) largest = n;
  }
  const Vec3d front = dot(all, largest) < 0 ? -largest : largest;
  Vec3d sum, lever;
  double weight = 0;
  for (Corners& t : flat.triangles) {
    if (dot(front, twice_area(t)) < 0) std::swap(t[1], t[2]);
    const Vec3d n = twice_area(t);
    sum += n;
    lever += centre(t) * length(n);
    weight += length(n);
  }
  if (!(weight > kLeastTwiceArea)) return {};
  flat.normal = normalize(sum);
  const Vec3d middle = lever / weight;
  for (Corners& t : flat.triangles)
    for (Vec3d& c : t) {
      const double height = dot(flat.normal, c - middle);
      flat.off = std::max(flat.off, std::abs(height));
      flat.width = std::max(flat.width, 2 * length(c - middle));
      c = c - flat.normal * height;
    }
  std::erase_if(flat.triangles, [&](const Corners& t) {
    return !(dot(flat.normal, twice_area(t)) > kLeastTwiceArea);
  });
  return flat;
}

}  // namespace tdpt

namespace tdpt::shader {

PortalSet::PortalSet(const std::vector<Portal>& portals, const Frame& frame) {
  for (const Portal& portal : portals) {
    const FlatPortal flat = flattened(portal, frame);
    const auto number = static_cast<uint32_t>(portals_++);
    if (flat.triangles.empty()) continue;
    add_facet(flat, number);
    if (portal.both_ways) add_facet(turned_round(flat), number);
  }
  guiding.facets = static_cast<uint32_t>(tables_->facets.size());
  guiding.polygons = static_cast<uint32_t>(tables_->polygons.size());
  if (empty()) return;
  std::vector<double> areas;  // p(q), up to a factor
  double total = 0;
  for (const PortalFacet& f : tables_->facets) {
    for (uint32_t i = f.first; i + 1 < f.end; ++i)
      areas.push_back((1 - Real{kSurroundShare}) * polygon(static_cast<int>(i)).area);
    areas.push_back(Real{kSurroundShare} * f.area);
    total += f.area;
  }
  set_cumulative_shares(areas,
                        [&](size_t i, double end) { tables_->polygons[i].end_of_all = end; });
  // p(F) = A_F / total, so p(F) / (A_F pi) is the same for every facet.
  for (PortalFacet& f : tables_->facets) f.density = 1 / (total * std::numbers::pi);
  make_pairs();
}

void PortalSet::add_facet(const FlatPortal& flat, uint32_t portal) {
  constexpr double kBorder = 1e-4;
  PortalFacet f;
  f.normal = flat.normal;
  f.border = kBorder;
  f.first = static_cast<uint32_t>(tables_->polygons.size());
  f.first_corner = static_cast<uint32_t>(tables_->corners.size());
  std::vector<double> areas;
  for (const Corners& corners : flat.triangles) {
    add_polygon(corners[0], corners[1] - corners[0], corners[2] - corners[0], f.normal, portal);
    const double area = 0.5 * length(twice_area(corners));
    f.centre = (f.centre * f.area + centre(corners) * area) / (f.area + area);
    f.area += area;
    for (const Vec3d& corner : corners)
      if (std::none_of(tables_->corners.begin() + f.first_corner, tables_->corners.end(),
                       [&](const Vec3d& c) { return length(c - corner) < 1e-9; }))
        tables_->corners.push_back(corner);
    areas.push_back((1 - Real{kSurroundShare}) * area);
  }
  const Surround surround = surround_of(flat);
  add_polygon(surround.corner, surround.x, surround.y, f.normal, portal);
  areas.push_back(Real{kSurroundShare} * f.area);
  f.surround = Real{kSurroundShare} * f.area / length(cross(surround.x, surround.y));
  f.end = static_cast<uint32_t>(tables_->polygons.size());
  f.end_corner = static_cast<uint32_t>(tables_->corners.size());
  f.per_area = 1 / f.area;
  set_cumulative_shares(
      areas, [&](size_t i, double end) { tables_->polygons[f.first + i].end_of_facet = end; });
  tables_->facets.push_back(f);
}

void PortalSet::add_polygon(const Vec3d& p0, const Vec3d& e1, const Vec3d& e2, const Vec3d& normal,
                            uint32_t portal) {
  auto& q = tables_->polygons.emplace_back();
  q.portal = portal;
  q.facet = static_cast<uint32_t>(tables_->facets.size());
  q.p0 = p0, q.e1 = e1, q.e2 = e2;
  const double twice = length(cross(e1, e2));
  q.grad1 = cross(e2, normal) / twice;
  q.grad2 = cross(normal, e1) / twice;
}

void PortalSet::make_pairs() {
  constexpr double kShare = 0.25;  // c
  struct Pair {
    uint32_t first, second;
    double etendue;  // A_F A_G cos_F cos_G / d^2, from centre to centre; p(F,G) is its share
  };
  std::vector<Pair> pairs;
  const auto all = [&](const PortalFacet& of, const PortalFacet& f, double side) {
    return std::all_of(tables_->corners.begin() + of.first_corner,
                       tables_->corners.begin() + of.end_corner, [&](const Vec3d& corner) {
                         return side * dot(f.normal, corner - f.centre) > kPortalMargin;
                       });
  };
  // A heap with the weakest kept pair on top.
  const auto stronger = [](const Pair& a, const Pair& b) { return a.etendue > b.etendue; };
  for (uint32_t i = 0; i < tables_->facets.size(); ++i)
    for (uint32_t j = 0; j < tables_->facets.size(); ++j) {
      const PortalFacet &f = tables_->facets[i], &g = tables_->facets[j];
      const Vec3d d = g.centre - f.centre;
      const double cos_f = dot(f.normal, d), cos_g = dot(g.normal, d), d2 = dot(d, d);
      if (!(cos_f > 0 && cos_g > 0)) continue;
      const double etendue = f.area * g.area * cos_f * cos_g / (d2 * d2);
      const bool full = pairs.size() == kMostPairs;
      if ((full && etendue <= pairs[0].etendue) || !all(g, f, 1) || !all(f, g, -1)) continue;
      if (full) {
        std::pop_heap(pairs.begin(), pairs.end(), stronger);
        pairs.pop_back();
      }
      pairs.push_back({i, j, etendue});
      std::push_heap(pairs.begin(), pairs.end(), stronger);
    }
  if (pairs.empty()) return;
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
    return std::pair(a.first, a.second) < std::pair(b.first, b.second);
  });
  std::vector<double> etendues;
  double total = 0;
  for (const Pair& pair : pairs) {
    etendues.push_back(pair.etendue);
    total += pair.etendue;
  }
  set_cumulative_shares(etendues, [&](size_t i, double end) {
    const auto& [first, second, etendue] = pairs[i];
    PortalFacet& f = tables_->facets[first];
    tables_->pairs.push_back(
        {first, second, kShare * (etendue / total) / (f.area * tables_->facets[second].area), end});
    if (f.end_pair == 0) f.first_pair = static_cast<uint32_t>(i);
    f.end_pair = static_cast<uint32_t>(i + 1);
  });
  guiding.pairs = static_cast<uint32_t>(tables_->pairs.size());
  portals_have_pairs = true;
  guiding.pair_share = kShare;
  guiding.per_pair_share = 1 / kShare;
  for (PortalFacet& f : tables_->facets) f.density *= 1 - kShare;
}

PortalSet::SegmentDraw PortalSet::sample(tdpt::Rng& rng) const {
  std::array<double, 7> u;
  for (double& x : u) x = rng.uniform();
  return sample(u);
}

}  // namespace tdpt::shader
