// Separates openings that share lines or an edge: each is fitted again to its own lines.
//
// Method: alternating assignment of lines and fit of openings. The plane of one opening bounds the
// other as a half-plane, at which its convex outline is clipped.
#include "tools/portalfit/parting.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace tdpt {
namespace {

// Midpoint of the half-plane's border within `polygon`, if it crosses it.
std::optional<Vec2d> middle_of_border(const Polygon& polygon, const HalfPlane& half) {
  Vec2d sum{};
  int ends = 0;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Vec2d p = polygon[i], q = polygon[(i + 1) % polygon.size()];
    const double from = dot(p, half.axis) - half.limit, to = dot(q, half.axis) - half.limit;
    if ((from > 0) == (to > 0)) continue;
    sum = sum + p + (q - p) * (from / (from - to));
    ++ends;
  }
  if (ends == 0) return {};
  return sum * (1.0 / ends);
}

// Clips `a`, which is or replaces number `own` of `all`, at the edges that it shares with the
// others. Returns false if it shares none.
bool keep_before(Aperture& a, size_t own, const std::vector<Aperture>& all,
                 const FitLimits& limits) {
  bool shares = false;
  for (size_t b = 0; b < all.size(); ++b) {
    if (b == own) continue;
    const auto edge = shared_edge(a, all[b], limits);
    if (!edge) continue;
    a.polygon = clipped(a.polygon, edge->axis, edge->limit);
    shares = true;
  }
  return shares;
}

// Lines through `plane` near `polygon`, except those in `taken`, which is sorted.
std::vector<LightLine> lines_near(const Bundle& all, const Plane& plane, const Polygon& polygon,
                                  const std::vector<uint32_t>& taken, const FitLimits& limits) {
  const Polygon reach = enlarged(polygon, limits.widening);
  std::vector<LightLine> lines;
  for (const uint32_t l : all.which)
    if (const auto at = clear_crossing(plane, all.line(l), limits);
        at && contains(reach, *at) && !std::binary_search(taken.begin(), taken.end(), l))
      lines.push_back(all.line(l));
  return lines;
}

std::vector<Vec2d> places_in(const Plane& plane, const std::vector<LightLine>& lines,
                             const FitLimits& limits) {
  std::vector<Vec2d> places;
  for (const LightLine& line : lines)
    if (const auto at = clear_crossing(plane, line, limits)) places.push_back(*at);
  return places;
}

// Fits the opening again, to all lines that pass here and not through the others.
std::optional<Aperture> fitted_again(const FitInput& in, const Bundle& all,
                                     const std::vector<uint32_t>& taken, Aperture a) {
  constexpr int kRounds = 6;
  for (int round = 0; round < kRounds; ++round) {
    const auto own = lines_near(all, a.tube.middle, a.polygon, taken, in.limits);
    if (in.limits.few(own.size())) return {};
    a.tube = holding_plane(own, a.tube, in.limits);
    if (const auto square = tube_in_wall(own, a.tube, in.grid.walls, in.limits)) a.tube = *square;
    const auto places = places_in(a.tube.middle, own, in.limits);
    if (in.limits.few(places.size())) return {};
    const bool last = round + 1 == kRounds;
    a.polygon = last ? whole_outline(places, in.limits) : outline_of(places, in.limits);
    if (a.polygon.empty()) return {};
  }
  return a;
}

// Whether `a` is a better opening than `b`: less area, or more lines. A fit to only part of the
// light may be turned by what it lacks.
bool better(const Aperture& a, const Aperture& b, double worth_of_line) {
  const auto lines = [](const Aperture& x) { return static_cast<double>(x.lines.size()); };
  return std::log(area(a.polygon) / area(b.polygon)) <
         worth_of_line * std::log(lines(a) / lines(b));
}

}  // namespace

std::optional<HalfPlane> shared_edge(const Aperture& a, const Aperture& b,
                                     const FitLimits& limits) {
  const Plane &own = a.tube.middle, &other = b.tube.middle;
  const Onb<double> frame(own.n);
  const Vec2d axis{dot(other.n, frame.x), dot(other.n, frame.y)};
  const double slant = std::hypot(axis.x, axis.y);
  if (slant * slant < 1 - limits.parallel * limits.parallel) return {};
  HalfPlane half{axis * (1 / slant), dot(other.o - own.o, other.n) / slant};
  const double whole = area(a.polygon);
  double kept = area(clipped(a.polygon, half.axis, half.limit));
  if (kept < 0.5 * whole) half = {half.axis * -1, -half.limit}, kept = whole - kept;
  const auto middle = middle_of_border(enlarged(a.polygon, limits.widening), half);
  if (!middle) return {};
  const Vec2d there = in_plane(other, to_space(own, *middle));
  if (!contains(enlarged(b.polygon, limits.widening), there)) return {};
  return half;
}

void part_from_each_other(const FitInput& in, const Bundle& all, std::vector<Aperture>& found) {
  if (found.size() < 2) return;
  for (const double growth : {in.limits.widening, std::sqrt(in.limits.widening), 1.0}) {
    for (Aperture& a : found) {
      std::vector<uint32_t> others;
      for (const Aperture& b : found) {
        if (&b == &a) continue;
        Aperture wider = b;
        wider.polygon = enlarged(b.polygon, growth);
        const Bundle across = lines_across(all, wider);
        others.insert(others.end(), across.which.begin(), across.which.end());
      }
      std::sort(others.begin(), others.end());
      const auto without = [&](const Bundle& lines) {
        Bundle left{all.of};
        std::set_difference(lines.which.begin(), lines.which.end(), others.begin(), others.end(),
                            std::back_inserter(left.which));
        return left;
      };
      const auto shared = static_cast<double>(a.lines.size() - without(a.lines).size());
      const auto size = static_cast<double>(a.lines.size());
      if (shared < in.limits.slight * size || shared > 0.5 * size) continue;
      auto again = outlined(in, without(all), a.tube, true);
      if (!again) continue;
      again->lines = lines_across(all, *again);
      if (again->lines.size() >= kMost * size) a = std::move(*again);
    }
  }
}

Bundle lines_beside(const Bundle& all, const std::vector<Aperture>& others,
                    const FitLimits& limits) {
  return all.where([&](const LightLine& line) {
    return std::none_of(others.begin(), others.end(), [&](const Aperture& b) {
      const auto at = clear_crossing(b.tube.middle, line, limits);
      return at && contains(b.polygon, *at);
    });
  });
}

void part_at_shared_edges(const FitInput& in, const Bundle& all, std::vector<Aperture>& found) {
  std::vector<size_t> smallest_first;
  for (size_t k = 0; k < found.size(); ++k)
    if (keep_before(found[k], k, found, in.limits)) {
      found[k].lines = lines_across(all, found[k]);
      smallest_first.push_back(k);
    }
  std::stable_sort(smallest_first.begin(), smallest_first.end(), [&](size_t a, size_t b) {
    return found[a].lines.size() < found[b].lines.size();
  });
  for (const size_t k : smallest_first) {
    std::vector<uint32_t> taken;
    for (size_t b = 0; b < found.size(); ++b)
      if (b != k)
        taken.insert(taken.end(), found[b].lines.which.begin(), found[b].lines.which.end());
    std::sort(taken.begin(), taken.end());
    auto again = fitted_again(in, all, taken, found[k]);
    if (!again) continue;
    keep_before(*again, k, found, in.limits);
    again->lines = lines_across(all, *again);
    if (again->lines.size() >= kMost * static_cast<double>(found[k].lines.size()) &&
        better(*again, found[k], in.limits.missing_of_known))
      found[k] = std::move(*again);
  }
}

}  // namespace tdpt
