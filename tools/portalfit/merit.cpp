// Tightness without a scene: the grid's lines are a uniform sample, by etendue, of all lines that
// join the two sides. In the middle of an opening and close to its normal every line passes, so
// there the sample's density d [lines / (m2 sr)] is that of all lines, and
//   t = lines that cross the portal / (d pi A).
// How close to the normal depends on the wall's thickness: the densest of several cones counts.
#include "tools/portalfit/merit.h"

#include <algorithm>
#include <numbers>

#include "libcommon/formats/portal_worth.h"

namespace tdpt {
namespace {

constexpr double kFewestInCone = 60;

// A flat set of triangles, as lines see it.
class Opening {
 public:
  explicit Opening(const Portal& portal) {
    for (const auto& t : portal.triangles) {
      const Vec3d p0 = portal.vertices[t[0]];
      const Vec3d e1 = portal.vertices[t[1]] - p0, e2 = portal.vertices[t[2]] - p0;
      const Vec3d n = cross(e1, e2);
      const double twice_area = length(n);
      if (!(twice_area > 0)) continue;
      triangles_.push_back({p0, e1, e2, n});
      area_ += 0.5 * twice_area;
      middle_ += (p0 * 3 + e1 + e2) * (twice_area / 6);
      normal_ += n;
    }
    if (!(area_ > 0)) return;
    middle_ = middle_ / area_;
    normal_ = normalize(normal_);
  }

  double area() const { return area_; }

  // Whether the line crosses it along its normal; where.
  bool crossed(const LightLine& line, Vec3d& at) const {
    const Vec3d d = line.camera - line.light;
    for (const Triangle& t : triangles_) {
      const double slope = dot(t.n, d);
      if (!(slope > 0)) continue;
      const double k = dot(t.n, t.p0 - line.light) / slope;
      if (!(k >= 0 && k <= 1)) continue;
      at = line.light + d * k;
      if (holds(t, at)) return true;
    }
    return false;
  }
  // Whether `p` on it lies in its middle, half as wide and half as high.
  bool in_the_middle(const Vec3d& p) const {
    const Vec3d twice = middle_ + (p - middle_) * 2;
    return std::any_of(triangles_.begin(), triangles_.end(),
                       [&](const Triangle& t) { return holds(t, twice); });
  }
  // Squared sine between the line and the normal.
  double lean(const LightLine& line) const {
    const double cosine = dot(normalize(line.camera - line.light), normal_);
    return 1 - cosine * cosine;
  }

 private:
  struct Triangle {
    Vec3d p0, e1, e2, n;
  };
  static bool holds(const Triangle& t, const Vec3d& p) {
    const Vec3d at = p - t.p0;
    const double n2 = dot(t.n, t.n);
    const double b1 = dot(cross(at, t.e2), t.n) / n2, b2 = dot(cross(t.e1, at), t.n) / n2;
    return b1 >= 0 && b2 >= 0 && b1 + b2 <= 1;
  }

  std::vector<Triangle> triangles_;
  double area_ = 0;
  Vec3d middle_{}, normal_{};
};

struct OfCut {
  size_t lines = 0;    // of the cut
  size_t crossed = 0;  // by them
};

}  // namespace

void appraise(const LightGrid& grid, std::vector<Portal>& portals) {
  size_t cuts = 1;
  for (const LightLine& l : grid.lines) cuts = std::max<size_t>(cuts, l.cut + 1);
  std::vector<size_t> lines(cuts, 0), cut_of(portals.size(), 0);
  std::vector<std::vector<uint32_t>> crossing(portals.size());
  for (const LightLine& l : grid.lines) ++lines[l.cut];
  for (size_t i = 0; i < portals.size(); ++i) {
    const Opening opening(portals[i]);
    std::vector<OfCut> of(cuts);
    std::vector<Vec3d> place(grid.lines.size());
    for (uint32_t l = 0; l < grid.lines.size(); ++l)
      if (opening.crossed(grid.lines[l], place[l])) {
        ++of[grid.lines[l].cut].crossed;
        crossing[i].push_back(l);
      }
    for (size_t c = 0; c < cuts; ++c) {
      // Shares, as cuts may have different numbers of lines.
      const auto share = [&](size_t k) {
        return lines[k] ? static_cast<double>(of[k].crossed) / static_cast<double>(lines[k]) : 0.0;
      };
      if (share(c) > share(cut_of[i])) cut_of[i] = c;
    }
    portals[i].figures["cut"] = static_cast<double>(cut_of[i]);

    const auto n = static_cast<double>(of[cut_of[i]].crossed);
    double densest = n / std::numbers::pi / opening.area();
    for (double sine2 = 1; sine2 > 1e-4; sine2 *= 0.25) {
      double inside = 0;
      for (const uint32_t l : crossing[i])
        inside += grid.lines[l].cut == cut_of[i] && opening.in_the_middle(place[l]) &&
                  opening.lean(grid.lines[l]) <= sine2;
      if (inside < kFewestInCone) break;
      densest = std::max(densest, inside / (std::numbers::pi * sine2 * 0.25 * opening.area()));
    }
    if (n > 0)
      portals[i].figures["tightness"] =
          std::min(1.0, n / (densest * std::numbers::pi * opening.area()));
  }

  // Lines may end on a jamb before they cross: flux_share counts them, conductance does not. Then
  // tightness to conductance is the room's surface to the opening, wherever the cut ran.
  for (size_t c = 0; c < cuts && c < grid.cuts.size(); ++c) {
    std::vector<uint8_t> met(grid.lines.size(), 0);
    double share = 0, passing = 0, crossed = 0, all = 0;
    for (size_t i = 0; i < portals.size(); ++i) {
      const auto tightness = portals[i].figures.find("tightness");
      if (cut_of[i] != c || tightness == portals[i].figures.end()) continue;
      if (const auto flux = portals[i].figures.find("flux_share"); flux != portals[i].figures.end())
        share += flux->second;
      double own = 0;
      for (const uint32_t l : crossing[i])
        if (grid.lines[l].cut == c) {
          ++own;
          if (!met[l]) met[l] = 1, ++passing;
        }
      crossed += own;
      all += own / tightness->second;
    }
    if (!(passing > 0)) continue;
    const double conductance =
        grid.cuts[c].conductance * grid.cuts[c].kept * passing / static_cast<double>(lines[c]);
    for (size_t i = 0; i < portals.size(); ++i) {
      if (cut_of[i] != c || !portals[i].figures.contains("tightness")) continue;
      portals[i].figures["conductance"] = conductance;
      portals[i].figures["expected_gain"] = expected_gain(share, crossed / all, conductance);
    }
  }
}

}  // namespace tdpt
