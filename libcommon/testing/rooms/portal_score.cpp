#include "libcommon/testing/rooms/portal_score.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "libcommon/math/discrete.h"
#include "libcommon/math/rng.h"

namespace tdpt::testing {
namespace {

constexpr int kLines = 20000;

// Whether `p`, in the plane of the outline, lies within it.
bool within(const std::vector<Vec3d>& outline, const Vec3d& normal, const Vec3d& p) {
  int left = 0, right = 0;
  for (size_t i = 0; i < outline.size(); ++i) {
    const Vec3d a = outline[i], b = outline[(i + 1) % outline.size()];
    (dot(cross(b - a, p - a), normal) >= 0 ? left : right)++;
  }
  return left == 0 || right == 0;
}

bool crosses(const std::vector<Vec3d>& outline, const Line& line) {
  const Vec3d normal = cross(outline[1] - outline[0], outline[2] - outline[0]);
  const double slope = dot(line.direction, normal);
  if (slope == 0) return false;
  const double t = dot(outline[0] - line.point, normal) / slope;
  return within(outline, normal, line.point + line.direction * t);
}

bool passes(const KnownAperture& o, const Line& line) {
  const double slope = dot(line.direction, o.normal);
  if (!(slope > 0)) return false;
  if (!o.mouth.empty() && !crosses(o.mouth, line)) return false;
  for (const double side : {-0.5, 0.5}) {
    const Vec3d shift = o.normal * (side * o.thickness);
    const double t = dot(o.outline[0] + shift - line.point, o.normal) / slope;
    if (!within(o.outline, o.normal, line.point + line.direction * t - shift)) return false;
    if (o.thickness == 0) break;
  }
  return true;
}

bool meets(const Quad& q, const Line& line) {
  return crosses({q[0], q[1], q[2]}, line) || crosses({q[0], q[2], q[3]}, line);
}

bool is_free(const KnownAperture& o, const Line& line) {
  return passes(o, line) && std::none_of(o.obstacles.begin(), o.obstacles.end(),
                                         [&](const Quad& q) { return meets(q, line); });
}

// Whether the line crosses the portal in the direction of its normal.
bool crosses(const Portal& portal, const Line& line) {
  for (const auto& t : portal.triangles) {
    const Vec3d p0 = portal.vertices[t[0]];
    const Vec3d e1 = portal.vertices[t[1]] - p0, e2 = portal.vertices[t[2]] - p0;
    const Vec3d n = cross(e1, e2);
    const double slope = dot(n, line.direction);
    if (!(slope > 0)) continue;
    const Vec3d at = line.point + line.direction * (dot(n, p0 - line.point) / slope) - p0;
    const double b1 = dot(cross(at, e2), n) / dot(n, n), b2 = dot(cross(e1, at), n) / dot(n, n);
    if (b1 >= 0 && b2 >= 0 && b1 + b2 <= 1) return true;
  }
  return false;
}

// Triangles from which lines are sampled.
class LineSource {
 public:
  void add(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& normal) {
    triangles_.push_back({a, b, c, normal});
    areas_.push_back(0.5 * length(cross(b - a, c - a)));
  }
  void prepare() { table_ = AliasTable(areas_); }
  Line draw(Rng& rng) const {
    const double pick = rng.uniform(), u = rng.uniform(), v = rng.uniform();
    const double c = rng.uniform(), d = rng.uniform();
    const Triangle& t = triangles_[table_.sample(pick)];
    double b1, b2;
    uniform_triangle(u, v, b1, b2);
    return {t.a + (t.b - t.a) * b1 + (t.c - t.a) * b2,
            Onb<double>(t.normal).to_world(cosine_hemisphere(c, d))};
  }

 private:
  struct Triangle {
    Vec3d a, b, c, normal;
  };
  std::vector<Triangle> triangles_;
  std::vector<double> areas_;
  AliasTable table_;
};

LineSource lines_of(const KnownAperture& o) {
  LineSource source;
  for (size_t i = 2; i < o.outline.size(); ++i)
    source.add(o.outline[0], o.outline[i - 1], o.outline[i], o.normal);
  source.prepare();
  return source;
}

LineSource lines_of(const Portal& portal) {
  LineSource source;
  for (const auto& t : portal.triangles) {
    const Vec3d &a = portal.vertices[t[0]], &b = portal.vertices[t[1]], &c = portal.vertices[t[2]];
    source.add(a, b, c, normalize(cross(b - a, c - a)));
  }
  source.prepare();
  return source;
}

double share_passing(const LineSource& source, const std::vector<KnownAperture>& openings) {
  Rng rng(2, 0, 0);
  int passing = 0;
  for (int i = 0; i < kLines; ++i) {
    const Line line = source.draw(rng);
    for (const KnownAperture& o : openings)
      if (passes(o, line)) {
        ++passing;
        break;
      }
  }
  return static_cast<double>(passing) / kLines;
}

}  // namespace

bool passes(const KnownAperture& opening, const Vec3d& point, const Vec3d& direction) {
  return passes(opening, Line{point, direction});
}

KnownAperture rectangle(const Vec3d& corner, const Vec3d& u, const Vec3d& v, const Vec3d& normal,
                        double thickness) {
  return {{corner, corner + u, corner + u + v, corner + v}, normal, thickness};
}

std::vector<Line> free_lines(const KnownAperture& opening, size_t count) {
  Rng rng(1, 0, 0);
  const LineSource source = lines_of(opening);
  std::vector<Line> lines;
  for (size_t drawn = 0; lines.size() < count && drawn < 200 * count; ++drawn)
    if (const Line line = source.draw(rng); is_free(opening, line)) lines.push_back(line);
  return lines;
}

double coverage(const KnownAperture& opening, const std::vector<Portal>& portals) {
  const std::vector<Line> lines = free_lines(opening, kLines);
  const auto covered = [&](const Line& line) {
    return std::any_of(portals.begin(), portals.end(),
                       [&](const Portal& portal) { return crosses(portal, line); });
  };
  const auto n = std::count_if(lines.begin(), lines.end(), covered);
  return lines.empty() ? 0 : static_cast<double>(n) / static_cast<double>(lines.size());
}

double tightness(const Portal& portal, const KnownAperture& opening,
                 const std::vector<KnownAperture>& openings) {
  const double perfect = share_passing(lines_of(opening), {opening});
  return perfect > 0 ? share_passing(lines_of(portal), openings) / perfect : 0;
}

Vec3d mean_normal(const Portal& portal) {
  Vec3d sum;
  for (const auto& t : portal.triangles)
    sum += cross(portal.vertices[t[1]] - portal.vertices[t[0]],
                 portal.vertices[t[2]] - portal.vertices[t[0]]);
  return normalize(sum);
}

double degrees_between(const Vec3d& a, const Vec3d& b) {
  return std::acos(std::clamp(dot(a, b), -1.0, 1.0)) * 57.29577951308232;
}

double angle_to(const KnownAperture& opening, const Vec3d& normal) {
  if (opening.mouth.empty()) return degrees_between(normal, opening.normal);
  const std::vector<Vec3d>& m = opening.mouth;
  Vec3d other = normalize(cross(m[1] - m[0], m[2] - m[0]));
  if (dot(other, opening.normal) < 0) other = -other;
  double least = 180;
  for (double t = 0; t <= 1; t += 1.0 / 64)
    least =
        std::min(least, degrees_between(normal, normalize(opening.normal * (1 - t) + other * t)));
  return least;
}

namespace {

constexpr double kStray = 0.3;

struct Fit {
  size_t opening;    ///< the opening that most of the portal's lines pass
  double tightness;  ///< there, over all openings
};

Fit best_fit(const Portal& portal, const std::vector<KnownAperture>& openings) {
  const LineSource lines = lines_of(portal);
  size_t best = 0;
  double most = -1;
  for (size_t i = 0; i < openings.size(); ++i)
    if (const double share = share_passing(lines, {openings[i]}); share > most)
      most = share, best = i;
  return {best, tightness(portal, openings[best], openings)};
}

// What the portals are scored against: an opening, its panes, or nothing if it is optional.
std::vector<KnownAperture> as_found(const std::vector<Portal>& portals,
                                    const std::vector<KnownAperture>& openings) {
  std::vector<size_t> fitting(openings.size());
  if (!openings.empty())
    for (const Portal& portal : portals)
      if (const Fit fit = best_fit(portal, openings); fit.tightness >= kStray)
        ++fitting[fit.opening];
  std::vector<KnownAperture> out;
  for (size_t i = 0; i < openings.size(); ++i) {
    const KnownAperture& o = openings[i];
    if (fitting[i] > 1 && !o.panes.empty())
      out.insert(out.end(), o.panes.begin(), o.panes.end());
    else if (fitting[i] > 0 || !o.optional)
      out.push_back(o);
  }
  return out;
}

}  // namespace

PortalScore score(const std::vector<Portal>& portals, const std::vector<KnownAperture>& known) {
  const std::vector<KnownAperture> openings = as_found(portals, known);
  PortalScore s;
  s.portals = portals.size();
  s.openings = openings.size();
  for (const KnownAperture& o : openings) s.coverage = std::min(s.coverage, coverage(o, portals));
  std::set<size_t> matched;
  for (const Portal& portal : portals) {
    if (openings.empty()) break;
    const Fit fit = best_fit(portal, openings);
    s.tightness = std::min(s.tightness, fit.tightness);
    if (fit.tightness < kStray) {
      ++s.strays;
      continue;
    }
    matched.insert(fit.opening);
    s.angle = std::max(s.angle, angle_to(openings[fit.opening], mean_normal(portal)));
  }
  s.matched = matched.size();
  if (portals.empty() && !openings.empty()) s.tightness = 0, s.angle = 90;
  if (openings.empty()) s.strays = portals.size(), s.tightness = portals.empty() ? 1 : 0;
  return s;
}

namespace {

double to_segment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d d = b - a;
  const double t = std::clamp(dot(p - a, d) / dot(d, d), 0.0, 1.0);
  return length(p - a - d * t);
}

double to_triangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d n = cross(b - a, c - a), at = p - a;
  const double b1 = dot(cross(at, c - a), n) / dot(n, n);
  const double b2 = dot(cross(b - a, at), n) / dot(n, n);
  if (b1 >= 0 && b2 >= 0 && b1 + b2 <= 1) return std::abs(dot(at, n)) / length(n);
  return std::min({to_segment(p, a, b), to_segment(p, b, c), to_segment(p, c, a)});
}

// For a convex portal the maximum is at a corner.
double one_way(const Portal& from, const Portal& to) {
  double farthest = 0;
  for (const Vec3d& v : from.vertices) {
    double nearest = INFINITY;
    for (const auto& t : to.triangles)
      nearest = std::min(nearest,
                         to_triangle(v, to.vertices[t[0]], to.vertices[t[1]], to.vertices[t[2]]));
    farthest = std::max(farthest, nearest);
  }
  return farthest;
}

}  // namespace

double distance(const Portal& a, const Portal& b) {
  return std::max(one_way(a, b), one_way(b, a));
}

double distance_to_nearest(const Portal& portal, const std::vector<Portal>& others) {
  double nearest = INFINITY;
  for (const Portal& other : others) nearest = std::min(nearest, distance(portal, other));
  return nearest;
}

}  // namespace tdpt::testing
