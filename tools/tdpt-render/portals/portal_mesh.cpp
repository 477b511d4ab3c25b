#include "tools/tdpt-render/portals/portal_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <queue>

#include "tools/tdpt-render/portals/outline.h"

namespace tdpt {
namespace {

constexpr size_t kManyPlanes = 8;

using Triple = std::array<uint32_t, 3>;
using Edge = std::pair<uint32_t, uint32_t>;

// The same as in PortalSet: a file's rounding error is that of its last digit.
double rounding_of(const Portal& portal) {
  constexpr double kRoundings = 4;
  double largest = 0;
  for (const Vec3d& v : portal.vertices) largest = std::max(largest, length(v));
  return kRoundings * portal.rounding + std::ldexp(largest, -46);
}

// Indices of the vertices, equal for those closer than `tolerance`: modelling programs write a
// vertex once for each face with its own normal there.
std::vector<uint32_t> welded(const std::vector<Vec3d>& vertices, double tolerance) {
  std::vector<uint32_t> order(vertices.size()), number(vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  std::iota(number.begin(), number.end(), 0u);
  // Sort along a direction in which few vertices coincide.
  const Vec3d along = normalize(Vec3d(0.61, 0.52, 0.59));
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    return dot(along, vertices[a]) < dot(along, vertices[b]);
  });
  for (size_t i = 1; i < order.size(); ++i)
    for (size_t j = i; j-- > 0;) {
      const Vec3d &a = vertices[order[i]], &b = vertices[order[j]];
      if (dot(along, a - b) > tolerance) break;
      if (length(a - b) > tolerance) continue;
      number[order[i]] = number[order[j]];
      break;
    }
  return number;
}

class Mesh {
 public:
  explicit Mesh(Portal& portal) : portal_(portal), tolerance_(rounding_of(portal)) {
    const std::vector<uint32_t> number = welded(portal.vertices, tolerance_);
    std::map<Triple, Triple> known;
    for (Triple t : portal.triangles) {
      for (uint32_t& v : t) v = number[v];
      if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
      std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
      Triple sorted = t;
      std::sort(sorted.begin(), sorted.end());
      const auto [at, fresh] = known.emplace(sorted, t);
      if (fresh) triangles_.push_back(t);
      if (at->second != t) portal_.both_ways = true;
    }
    for (size_t t = 0; t < triangles_.size(); ++t)
      for (size_t i = 0; i < 3; ++i) at_edge_[edge(t, i)].push_back(t);
  }

  PortalMesh tidy() {
    PortalMesh found;
    found.triangles = triangles_.size();
    if (triangles_.empty()) return found;
    bool changed = triangles_.size() != portal_.triangles.size();
    hang_together(found.turned);
    changed |= found.turned;
    if (is_body())
      found.shape = PortalMesh::body;
    else if (flatness() < kLeastFlatness)
      found.shape = PortalMesh::folded;
    if (found.shape != PortalMesh::planar) return found;
    std::vector<Corners> out;
    for (const std::vector<size_t>& part : parts_) {
      const std::vector<PlanarFacet> facets = planes_of(part, found);
      found.planes += facets.size();
      for (const PlanarFacet& facet : facets)
        for (const Corners& t : fewest_triangles(facet, tolerance_)) out.push_back(t);
    }
    changed |= found.shape != PortalMesh::planar || out.size() < triangles_.size();
    if (changed && found.shape != PortalMesh::folded) replace(out);
    return found;
  }

 private:
  Edge edge(size_t t, size_t i) const {
    const auto [a, b] = std::minmax(triangles_[t][i], triangles_[t][(i + 1) % 3]);
    return {a, b};
  }
  bool runs_up(size_t t, const Edge& e) const {
    for (size_t i = 0; i < 3; ++i)
      if (triangles_[t][i] == e.first && triangles_[t][(i + 1) % 3] == e.second) return true;
    return false;
  }
  Corners corners_of(size_t t) const {
    Corners c;
    for (size_t i = 0; i < 3; ++i) c[i] = portal_.vertices[triangles_[t][i]];
    return c;
  }
  std::vector<Corners> corners_of(const std::vector<size_t>& part) const {
    std::vector<Corners> all;
    for (const size_t t : part) all.push_back(corners_of(t));
    return all;
  }
  Vec3d twice_area(size_t t) const {
    const Corners c = corners_of(t);
    return cross(c[1] - c[0], c[2] - c[0]);
  }
  static double extent_of(const std::vector<Corners>& corners) {
    Vec3d low = corners[0][0], high = low;
    for (const Corners& t : corners)
      for (const Vec3d& c : t) {
        low = min(low, c);
        high = max(high, c);
      }
    return length(high - low);
  }

  // Finds the parts connected by edges of two triangles, and turns the smaller share of each where
  // two neighbours run along their common edge in the same direction.
  void hang_together(bool& turned) {
    std::vector<bool> met(triangles_.size());
    for (size_t first = 0; first < triangles_.size(); ++first) {
      if (met[first]) continue;
      met[first] = true;
      std::vector<size_t>& part = parts_.emplace_back();
      std::vector<size_t> flipped;
      std::queue<std::pair<size_t, bool>> left;
      double area[2] = {0, 0};
      for (left.push({first, false}); !left.empty(); left.pop()) {
        const auto [t, flip] = left.front();
        part.push_back(t);
        if (flip) flipped.push_back(t);
        area[flip] += length(twice_area(t));
        for (size_t i = 0; i < 3; ++i) {
          const std::vector<size_t>& both = at_edge_.at(edge(t, i));
          if (both.size() != 2) continue;
          const size_t other = both[0] == t ? both[1] : both[0];
          if (met[other]) continue;
          met[other] = true;
          left.push({other, flip != (runs_up(t, edge(t, i)) == runs_up(other, edge(t, i)))});
        }
      }
      std::sort(part.begin(), part.end());
      if (flipped.empty()) continue;
      turned = true;
      std::sort(flipped.begin(), flipped.end());
      std::vector<size_t> rest;
      std::set_difference(part.begin(), part.end(), flipped.begin(), flipped.end(),
                          std::back_inserter(rest));
      for (const size_t t : area[1] > area[0] ? rest : flipped)
        std::swap(triangles_[t][1], triangles_[t][2]);
    }
  }

  bool is_body() const {
    return std::all_of(at_edge_.begin(), at_edge_.end(),
                       [](const auto& e) { return e.second.size() > 1; });
  }
  double flatness() const {
    double flat = 0, all = 0;
    for (const std::vector<size_t>& part : parts_) {
      Vec3d sum;
      for (const size_t t : part) {
        sum += twice_area(t);
        all += length(twice_area(t));
      }
      flat += length(sum);
    }
    return flat / all;
  }

  // The planes of a part; `found` records what was done to it.
  std::vector<PlanarFacet> planes_of(const std::vector<size_t>& part, PortalMesh& found) const {
    const std::vector<Corners> corners = corners_of(part);
    std::vector<PlanarFacet> exact = planar_facets(corners, tolerance_);
    if (exact.size() == 1) return exact;
    const double bent = std::max(tolerance_, kBent * extent_of(corners));
    std::vector<PlanarFacet> planes = planar_facets(corners, bent);
    PortalMesh::Shape shape = PortalMesh::bent;
    if (planes.size() == 1) {
      shape = PortalMesh::flattened;
    } else if (exact.size() <= kManyPlanes) {
      planes = std::move(exact);
    } else if (const auto shadow = shadow_of(part)) {
      if (shadow->rim_off <= bent)
        shape = PortalMesh::lid;
      else if (planes.size() > kManyPlanes)
        shape = PortalMesh::flattened;
      if (shape != PortalMesh::bent) planes = {shadow->facet};
    } else if (planes.size() > kManyPlanes) {
      shape = PortalMesh::folded;
    }
    found.shape = std::max(found.shape, shape);
    if (shape == PortalMesh::flattened || shape == PortalMesh::bent)
      found.off = std::max(found.off, off(corners, planes));
    return planes;
  }

  // The triangles of a part projected onto the mean plane of its rim; null if some would face the
  // other way. If the rim lies in that plane, a line that crosses the part an odd number of times
  // crosses the projection. Their area vectors have the same sum.
  struct Shadow {
    PlanarFacet facet;
    double rim_off;  // distance of the rim from the plane
  };
  std::optional<Shadow> shadow_of(const std::vector<size_t>& part) const {
    Vec3d sum;
    for (const size_t t : part) sum += twice_area(t);
    const Vec3d n = normalize(sum);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const size_t t : part) {
      if (!(dot(n, twice_area(t)) > 0)) return {};
      for (size_t i = 0; i < 3; ++i) {
        const Edge e = edge(t, i);
        if (at_edge_.at(e).size() > 1) continue;
        for (const uint32_t v : {e.first, e.second}) {
          low = std::min(low, dot(n, portal_.vertices[v]));
          high = std::max(high, dot(n, portal_.vertices[v]));
        }
      }
    }
    Shadow shadow{{n, corners_of(part)}, 0.5 * (high - low)};
    for (Corners& t : shadow.facet.triangles)
      for (Vec3d& c : t) c = c - n * (dot(n, c) - 0.5 * (low + high));
    return shadow;
  }

  // Facets hold the corners that they were made from, but not in the same order.
  static double off(const std::vector<Corners>& corners, const std::vector<PlanarFacet>& facets) {
    double farthest = 0;
    for (const Corners& t : corners)
      for (const Vec3d& c : t) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const PlanarFacet& f : facets)
          nearest = std::min(nearest, std::abs(dot(f.normal, c - f.triangles[0][0])));
        farthest = std::max(farthest, nearest);
      }
    return farthest;
  }

  void replace(const std::vector<Corners>& triangles) {
    portal_.vertices.clear();
    portal_.triangles.clear();
    std::map<std::array<double, 3>, uint32_t> numbers;
    for (const Corners& corners : triangles) {
      Triple& t = portal_.triangles.emplace_back();
      for (size_t i = 0; i < 3; ++i) {
        const Vec3d& c = corners[i];
        const auto [at, fresh] = numbers.emplace(std::array{c.x, c.y, c.z},
                                                 static_cast<uint32_t>(portal_.vertices.size()));
        t[i] = at->second;
        if (fresh) portal_.vertices.push_back(c);
      }
    }
  }

  Portal& portal_;
  double tolerance_;  // of rounding [m]
  std::vector<Triple> triangles_;
  std::map<Edge, std::vector<size_t>> at_edge_;
  std::vector<std::vector<size_t>> parts_;
};

}  // namespace

PortalMesh tidy(Portal& portal) {
  return Mesh(portal).tidy();
}

}  // namespace tdpt
