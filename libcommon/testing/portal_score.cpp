#include "libcommon/testing/portal_score.h"

#include <set>

#include "libcommon/math/alias_table.h"
#include "libcommon/math/rng.h"
#include "libcommon/math/warp.h"

namespace tdpt::testing {
namespace {

constexpr int kLines = 20000;

struct Line {
  Vec3d point, direction;
};

// Whether `p` in the plane of the outline lies within it.
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

// Meets the portal along its normal.
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

// Triangles to draw lines from.
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

double coverage(const KnownAperture& opening, const std::vector<Portal>& portals) {
  Rng rng(1, 0, 0);
  const LineSource source = lines_of(opening);
  int lines = 0, covered = 0;
  for (int drawn = 0; lines < kLines && drawn < 200 * kLines; ++drawn) {
    const Line line = source.draw(rng);
    if (!passes(opening, line)) continue;
    ++lines;
    for (const Portal& portal : portals)
      if (crosses(portal, line)) {
        ++covered;
        break;
      }
  }
  return lines > 0 ? static_cast<double>(covered) / lines : 0;
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

PortalScore score(const std::vector<Portal>& portals, const std::vector<KnownAperture>& openings) {
  PortalScore s;
  s.portals = portals.size();
  s.openings = openings.size();
  for (const KnownAperture& o : openings) s.coverage = std::min(s.coverage, coverage(o, portals));
  std::set<size_t> matched;
  for (const Portal& portal : portals) {
    if (openings.empty()) break;
    size_t best = 0;
    double most = -1;
    for (size_t i = 0; i < openings.size(); ++i)
      if (const double share = share_passing(lines_of(portal), {openings[i]}); share > most)
        most = share, best = i;
    const double tight = tightness(portal, openings[best], openings);
    s.tightness = std::min(s.tightness, tight);
    if (tight < 0.3) {
      ++s.strays;
      continue;
    }
    matched.insert(best);
    s.angle = std::max(s.angle, angle_to(openings[best], mean_normal(portal)));
  }
  s.matched = matched.size();
  if (portals.empty() && !openings.empty()) s.tightness = 0, s.angle = 90;
  if (openings.empty()) s.strays = portals.size(), s.tightness = portals.empty() ? 1 : 0;
  return s;
}

}  // namespace tdpt::testing
