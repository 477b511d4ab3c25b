// x, y  coordinates in the plane of the facet, counter-clockwise seen from its normal
// loop  corners of an outline in order, the covered side on the left: the outer one runs
//       counter-clockwise, those of holes clockwise
#include "tools/tdpt-render/portals/outline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

namespace tdpt {
namespace {

// Ear clipping takes quadratic time, and more if there are many reflex corners.
constexpr size_t kMostCorners = 1024;

struct Point2 {
  double x, y;
  friend bool operator==(const Point2&, const Point2&) = default;
};
using Points = std::vector<Point2>;
using Loop = std::vector<uint32_t>;
using Triple = std::array<uint32_t, 3>;

// Twice the area of abc; positive if they run counter-clockwise.
double turn(const Point2& a, const Point2& b, const Point2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}
double distance(const Point2& a, const Point2& b) {
  return std::hypot(b.x - a.x, b.y - a.y);
}

// Whether two segments share a point.
bool meet(const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
  if (std::max(a.x, b.x) < std::min(c.x, d.x) || std::max(c.x, d.x) < std::min(a.x, b.x) ||
      std::max(a.y, b.y) < std::min(c.y, d.y) || std::max(c.y, d.y) < std::min(a.y, b.y))
    return false;
  return turn(a, b, c) * turn(a, b, d) <= 0 && turn(c, d, a) * turn(c, d, b) <= 0;
}

// The triangles of a facet by indices of their corners, duplicates merged.
struct Numbered {
  explicit Numbered(const PlanarFacet& facet) {
    const Onb<double> axes(facet.normal);
    const Vec3d base = facet.triangles.front()[0];
    std::map<std::array<double, 3>, uint32_t> numbers;
    for (const Corners& triangle : facet.triangles) {
      Triple& t = triangles.emplace_back();
      for (size_t i = 0; i < 3; ++i) {
        const Vec3d& c = triangle[i];
        const auto [at, fresh] =
            numbers.emplace(std::array{c.x, c.y, c.z}, static_cast<uint32_t>(corners.size()));
        t[i] = at->second;
        if (!fresh) continue;
        const Vec3d local = axes.to_local(c - base);
        corners.push_back(c);
        places.push_back({local.x, local.y});
      }
    }
  }
  std::vector<Triple> triangles;
  std::vector<Vec3d> corners;
  Points places;
};

// Groups of triangles connected by edges.
std::vector<std::vector<Triple>> joined(const std::vector<Triple>& triangles) {
  std::vector<size_t> root(triangles.size());
  std::iota(root.begin(), root.end(), size_t{0});
  const auto find = [&](size_t i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  std::map<std::pair<uint32_t, uint32_t>, size_t> met;
  for (size_t t = 0; t < triangles.size(); ++t)
    for (size_t i = 0; i < 3; ++i) {
      const auto [a, b] = std::minmax({triangles[t][i], triangles[t][(i + 1) % 3]});
      const auto [at, fresh] = met.emplace(std::pair(a, b), t);
      if (!fresh) root[std::max(find(t), find(at->second))] = std::min(find(t), find(at->second));
    }
  std::map<size_t, std::vector<Triple>> parts;
  for (size_t t = 0; t < triangles.size(); ++t) parts[find(t)].push_back(triangles[t]);
  std::vector<std::vector<Triple>> out;
  for (auto& [first, part] : parts) out.push_back(std::move(part));
  return out;
}

// Null if an edge belongs to two triangles in the same direction, or the outline passes a corner
// twice.
std::optional<std::vector<Loop>> outline_of(const std::vector<Triple>& triangles) {
  std::map<std::pair<uint32_t, uint32_t>, size_t> edges;
  for (const Triple& t : triangles)
    for (size_t i = 0; i < 3; ++i)
      if (++edges[{t[i], t[(i + 1) % 3]}] > 1) return {};
  std::map<uint32_t, uint32_t> next;
  for (const auto& [edge, n] : edges)
    if (!edges.contains({edge.second, edge.first}) && !next.emplace(edge.first, edge.second).second)
      return {};
  std::vector<Loop> loops;
  while (!next.empty()) {
    Loop& loop = loops.emplace_back();
    for (auto at = next.begin(); at != next.end();) {
      loop.push_back(at->first);
      const uint32_t to = at->second;
      next.erase(at);
      at = next.find(to);
    }
  }
  return loops;
}

double twice_area(const Loop& loop, const Points& at) {
  double sum = 0;
  for (size_t i = 1; i + 1 < loop.size(); ++i)
    sum += turn(at[loop[0]], at[loop[i]], at[loop[i + 1]]);
  return sum;
}

// Drops the corners that lie within `tolerance` of a side between the remaining ones.
Loop straightened(const Loop& loop, const Points& at, double tolerance) {
  const size_t n = loop.size();
  const auto place = [&](size_t i) { return at[loop[i % n]]; };
  // Begin at a definite corner: the one farthest from the first.
  size_t first = 0;
  for (size_t i = 1; i < n; ++i)
    if (distance(place(0), place(i)) > distance(place(0), place(first))) first = i;
  const auto straight = [&](size_t from, size_t to) {
    const Point2 a = place(from), b = place(to);
    const double length = distance(a, b);
    double along = 0;
    for (size_t i = from + 1; i < to; ++i) {
      const Point2 p = place(i);
      const double here = ((p.x - a.x) * (b.x - a.x) + (p.y - a.y) * (b.y - a.y)) / length;
      if (!(std::abs(turn(a, b, p)) <= tolerance * length && here > along && here < length))
        return false;
      along = here;
    }
    return true;
  };
  Loop kept;
  for (size_t from = first; from < first + n;) {
    kept.push_back(loop[from % n]);
    size_t to = from + 1;
    while (to < first + n && straight(from, to + 1)) ++to;
    from = to;
  }
  return kept;
}

// Whether no two sides share a point, except neighbours their corner.
bool simple(const std::vector<Loop>& loops, const Points& at) {
  struct Side {
    uint32_t a, b;
  };
  std::vector<Side> sides;
  for (const Loop& loop : loops)
    for (size_t i = 0; i < loop.size(); ++i)
      sides.push_back({loop[i], loop[(i + 1) % loop.size()]});
  for (size_t i = 0; i < sides.size(); ++i)
    for (size_t j = i + 1; j < sides.size(); ++j) {
      const auto [a, b] = sides[i];
      const auto [c, d] = sides[j];
      if (a != c && a != d && b != c && b != d && meet(at[a], at[b], at[c], at[d])) return false;
    }
  return true;
}

// Whether the line from corner i of the loop to `to` begins on the covered side.
bool begins_inside(const Loop& loop, size_t i, const Point2& to, const Points& at) {
  const size_t n = loop.size();
  const Point2 &here = at[loop[i]], &before = at[loop[(i + n - 1) % n]],
               &after = at[loop[(i + 1) % n]];
  const bool left_of_first = turn(before, here, to) > 0, left_of_second = turn(here, after, to) > 0;
  return turn(before, here, after) > 0 ? left_of_first && left_of_second
                                       : left_of_first || left_of_second;
}

bool in_sight(const Point2& a, const Point2& b, const Loop& loop, const Points& at) {
  for (size_t i = 0; i < loop.size(); ++i) {
    const Point2 &c = at[loop[i]], &d = at[loop[(i + 1) % loop.size()]];
    if (c != a && c != b && d != a && d != b && meet(a, b, c, d)) return false;
  }
  return true;
}

// Joins a hole to the loop around it by a bridge, there and back; false if there is none.
bool bridge(Loop& outer, const std::vector<Loop>& holes, size_t hole, const Points& at) {
  const Loop& inner = holes[hole];
  std::vector<std::pair<double, std::pair<size_t, size_t>>> ways;
  for (size_t i = 0; i < outer.size(); ++i)
    for (size_t k = 0; k < inner.size(); ++k)
      ways.push_back({distance(at[outer[i]], at[inner[k]]), {i, k}});
  std::sort(ways.begin(), ways.end());
  for (const auto& [length, ends] : ways) {
    const auto [i, k] = ends;
    const Point2 &a = at[outer[i]], &b = at[inner[k]];
    bool free = begins_inside(outer, i, b, at) && begins_inside(inner, k, a, at) &&
                in_sight(a, b, outer, at);
    for (size_t h = hole; h < holes.size() && free; ++h) free = in_sight(a, b, holes[h], at);
    if (!free) continue;
    Loop joined(outer.begin(), outer.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    for (size_t j = 0; j <= inner.size(); ++j) joined.push_back(inner[(k + j) % inner.size()]);
    joined.insert(joined.end(), outer.begin() + static_cast<std::ptrdiff_t>(i), outer.end());
    outer = std::move(joined);
    return true;
  }
  return false;
}

// Whether corner i and its neighbours form a triangle that contains no other part of the loop.
bool is_ear(const Loop& loop, size_t i, const Points& at) {
  const size_t n = loop.size();
  const Point2 &a = at[loop[(i + n - 1) % n]], &b = at[loop[i]], &c = at[loop[(i + 1) % n]];
  if (!(turn(a, b, c) > 0)) return false;
  return std::none_of(loop.begin(), loop.end(), [&](uint32_t other) {
    const Point2& p = at[other];
    return p != a && p != b && p != c && turn(a, b, p) >= 0 && turn(b, c, p) >= 0 &&
           turn(c, a, p) >= 0;
  });
}

std::optional<std::vector<Triple>> without_ears(Loop loop, const Points& at) {
  std::vector<Triple> triangles;
  size_t i = 0, tried = 0;
  while (loop.size() >= 3) {
    const size_t n = loop.size();
    i %= n;
    if (!is_ear(loop, i, at)) {
      if (++tried > n) return {};
      ++i;
      continue;
    }
    triangles.push_back({loop[(i + n - 1) % n], loop[i], loop[(i + 1) % n]});
    loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(i));
    tried = 0;
    ++i;  // take every other corner: a fan would have needles
  }
  return triangles;
}

// Fewer triangles with the same area as `triangles`, which share edges; null if that is impossible.
std::optional<std::vector<Triple>> retriangulated(const std::vector<Triple>& triangles,
                                                  const Points& at, double tolerance) {
  auto loops = outline_of(triangles);
  if (!loops) return {};
  size_t corners = 0;
  for (Loop& loop : *loops) {
    if (loop.size() > kMostCorners * 16) return {};
    loop = straightened(loop, at, tolerance);
    if (loop.size() < 3) return {};
    corners += loop.size();
  }
  if (corners > kMostCorners || corners + 2 * loops->size() - 4 >= triangles.size() ||
      !simple(*loops, at))
    return {};
  // The outer one first.
  std::sort(loops->begin(), loops->end(),
            [&](const Loop& a, const Loop& b) { return twice_area(a, at) > twice_area(b, at); });
  if (!(twice_area(loops->front(), at) > 0)) return {};
  if (loops->size() > 1 && twice_area((*loops)[1], at) > 0) return {};
  Loop whole = loops->front();
  for (size_t hole = 1; hole < loops->size(); ++hole)
    if (!bridge(whole, *loops, hole, at)) return {};
  return without_ears(whole, at);
}

}  // namespace

std::vector<Corners> fewest_triangles(const PlanarFacet& facet, double tolerance) {
  const Numbered mesh(facet);
  std::vector<Corners> out;
  for (const std::vector<Triple>& part : joined(mesh.triangles))
    for (const Triple& t : retriangulated(part, mesh.places, tolerance).value_or(part))
      out.push_back({mesh.corners[t[0]], mesh.corners[t[1]], mesh.corners[t[2]]});
  return out;
}

}  // namespace tdpt
