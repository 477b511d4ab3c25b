#include "libcommon/testing/houses/house_score.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/math/discrete.h"
#include "libcommon/math/rng.h"
#include "libcommon/testing/rooms/portal_score.h"

namespace tdpt::testing {
namespace {

using Json = nlohmann::json;

constexpr uint64_t kStream = 0x686f'7573;
constexpr int kLines = 4000;  // of a portal
// Of a portal's lines: with fewer in openings it lies in none.
constexpr double kInOpening = 0.3;
// It lies in another one, too, of the same plane or element, with this share of the first one's.
constexpr double kAlso = 0.1;
constexpr double kNear = 0.05;  // [m]

struct Segment {
  Vec3d from, to;
};

// Odd number of edges to the right of p, in the two axes across the normal's largest.
bool within(const OpeningPart& part, const Vec3d& p) {
  const Vec3d n = max(part.normal, -part.normal);
  const int drop = n.x >= n.y && n.x >= n.z ? 0 : n.y >= n.z ? 1 : 2;
  const int a = (drop + 1) % 3, b = (drop + 2) % 3;
  bool inside = false;
  const auto& c = part.polygon;
  for (size_t i = 0, j = c.size() - 1; i < c.size(); j = i++)
    if ((c[i][b] > p[b]) != (c[j][b] > p[b]) &&
        p[a] < (c[j][a] - c[i][a]) * (p[b] - c[i][b]) / (c[j][b] - c[i][b]) + c[i][a])
      inside = !inside;
  return inside;
}

// +1 along the normal, -1 against it, 0: not at all.
int crosses(const OpeningPart& part, const Segment& s) {
  const double from = dot(s.from - part.polygon[0], part.normal);
  const double to = dot(s.to - part.polygon[0], part.normal);
  if (from * to >= 0) return 0;
  if (!within(part, s.from + (s.to - s.from) * (from / (from - to)))) return 0;
  return to > from ? 1 : -1;
}

int crosses(const HouseOpening& o, const Segment& s) {
  return crosses(o.part, s);
}

// The same for a segment that begins and ends outside the wall: others end on a jamb, and where in
// the wall a portal lies decides whether it has them.
bool beyond_wall(const HouseOpening& o, const Segment& s) {
  const double from = dot(s.from - o.part.polygon[0], o.part.normal);
  const double to = dot(s.to - o.part.polygon[0], o.part.normal);
  return std::min(from, to) < -o.front && std::max(from, to) > o.rear;
}

// Through gap or doorway: in the wall beside a leaf a line passes one and not the other.
int passes(const HouseOpening& o, const Segment& s) {
  if (const int way = crosses(o.part, s)) return way;
  for (const OpeningPart& part : o.doorway)
    if (const int way = crosses(part, s)) return way;
  return 0;
}

struct Face {
  Vec3d a, b, c, normal;
};

std::vector<Face> faces_of(const Portal& portal) {
  std::vector<Face> faces;
  for (const auto& t : portal.triangles) {
    Face f{portal.vertices[t[0]], portal.vertices[t[1]], portal.vertices[t[2]], {}};
    f.normal = normalize(cross(f.b - f.a, f.c - f.a));
    faces.push_back(f);
  }
  return faces;
}

bool crosses(const std::vector<Face>& portal, const Segment& s) {
  return std::any_of(portal.begin(), portal.end(), [&](const Face& f) {
    return crosses(OpeningPart{{f.a, f.b, f.c}, f.normal}, s) > 0;
  });
}

// Between the surfaces on either side; under the open sky as far as it goes.
Segment free_segment(const Scene& scene, const Tracer& tracer, const Vec3d& at, const Vec3d& w) {
  constexpr double kFar = 8;  // scene sizes
  const Vec3d from = scene.frame.to_canonical(at);
  Hit hit;
  const double ahead = tracer.closest({from}, w, hit) ? hit.distance : kFar;
  const double behind = tracer.closest({from}, -w, hit) ? hit.distance : kFar;
  return {at - w * (behind / scene.frame.scale), at + w * (ahead / scene.frame.scale)};
}

// Of lines uniform by etendue on these faces the number that pass each opening, and at last any.
std::vector<int> lines_through(const std::vector<Face>& faces, const Scene& scene,
                               const Tracer& tracer, const std::vector<HouseOpening>& openings) {
  std::vector<double> areas;
  for (const Face& f : faces) areas.push_back(0.5 * length(cross(f.b - f.a, f.c - f.a)));
  const AliasTable table(areas);
  Rng rng(1, kStream, 0);
  std::vector<int> lines(openings.size() + 1, 0);
  for (int i = 0; i < kLines; ++i) {
    const Face& f = faces[table.sample(rng.uniform())];
    double b1, b2;
    const double u = rng.uniform(), v = rng.uniform();
    uniform_triangle(u, v, b1, b2);
    const double c = rng.uniform(), d = rng.uniform();
    const Vec3d w = Onb<double>(f.normal).to_world(cosine_hemisphere(c, d));
    const Segment s = free_segment(scene, tracer, f.a + (f.b - f.a) * b1 + (f.c - f.a) * b2, w);
    bool any = false;
    for (size_t o = 0; o < openings.size(); ++o)
      if (passes(openings[o], s)) ++lines[o], any = true;
    lines.back() += any;
  }
  return lines;
}

// The convex hull of several openings, in the plane of the first moved by `offset` along its
// normal.
std::vector<Face> hull_of(const std::vector<HouseOpening>& openings,
                          const std::vector<size_t>& panes, double offset) {
  const OpeningPart& first = openings[panes.front()].part;
  const Onb<double> frame(first.normal);
  std::vector<Vec3d> corners;
  for (const size_t o : panes)
    for (const Vec3d& p : openings[o].part.polygon)
      corners.push_back(p - first.normal * (dot(p - first.polygon[0], first.normal) - offset));
  // Gift wrapping.
  const auto flat = [&](const Vec3d& p) { return Vec3d{dot(p, frame.x), dot(p, frame.y), 0}; };
  size_t start = 0;
  for (size_t i = 1; i < corners.size(); ++i)
    if (flat(corners[i]).x < flat(corners[start]).x) start = i;
  std::vector<Vec3d> hull;
  size_t at = start;
  do {
    hull.push_back(corners[at]);
    size_t next = at == 0 ? 1 : 0;
    for (size_t i = 0; i < corners.size(); ++i) {
      const Vec3d a = flat(corners[next]) - flat(corners[at]),
                  b = flat(corners[i]) - flat(corners[at]);
      const double turn = a.x * b.y - a.y * b.x;
      if (turn < 0 || (turn == 0 && dot(b, b) > dot(a, a))) next = i;
    }
    at = next;
  } while (at != start && hull.size() <= corners.size());
  std::vector<Face> faces;
  for (size_t i = 2; i < hull.size(); ++i)
    faces.push_back({hull[0], hull[i - 1], hull[i], first.normal});
  return faces;
}

double angle_of(const Vec3d& normal, const HouseOpening& o) {
  double least = 180;
  for (const double way : {1.0, -1.0}) {
    least = std::min(least, degrees_between(normal, o.part.normal * way));
    for (const OpeningPart& whole : o.doorway)
      for (double t = 0; t <= 1; t += 1.0 / 64)
        least = std::min(
            least,
            degrees_between(normal, normalize(o.part.normal * (1 - t) + whole.normal * t) * way));
  }
  return least;
}

bool in_one_plane(const HouseOpening& a, const HouseOpening& b) {
  constexpr double kSame = 0.99;
  const double off = dot(b.part.polygon[0] - a.part.polygon[0], a.part.normal);
  return std::abs(dot(a.part.normal, b.part.normal)) > kSame && off >= -a.front - kNear &&
         off <= a.rear + kNear;
}

PortalTruth truth_of(const Portal& portal, const Scene& scene, const Tracer& tracer,
                     const std::vector<HouseOpening>& openings) {
  const std::vector<Face> faces = faces_of(portal);
  const std::vector<int> lines = lines_through(faces, scene, tracer, openings);
  PortalTruth truth;
  truth.tightness = static_cast<double>(lines.back()) / kLines;
  if (openings.empty() || truth.tightness < kInOpening) return truth;
  const auto most =
      static_cast<size_t>(std::max_element(lines.begin(), lines.end() - 1) - lines.begin());
  const HouseOpening& main = openings[most];
  truth.openings.push_back(most);
  for (size_t o = 0; o < openings.size(); ++o)
    if (o != most && lines[o] >= kAlso * lines[most] &&
        (openings[o].element == main.element || in_one_plane(main, openings[o])))
      truth.openings.push_back(o);
  for (const size_t o : truth.openings)
    truth.angle = std::min(truth.angle, angle_of(mean_normal(portal), openings[o]));
  // Beside a leaf the two narrow places differ, and the portal may lie in either.
  if (!main.doorway.empty()) return truth;
  Vec3d middle{};
  for (const Face& f : faces)
    middle += (f.a + f.b + f.c) / (3.0 * static_cast<double>(faces.size()));
  const double offset =
      std::clamp(dot(middle - main.part.polygon[0], main.part.normal), -main.front, main.rear);
  const std::vector<int> perfect =
      lines_through(hull_of(openings, truth.openings, offset), scene, tracer, openings);
  truth.tightness = std::min(1.0, truth.tightness * kLines / std::max(1, perfect.back()));
  return truth;
}

Vec3d vector_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

OpeningPart part_of(const Json& corners, const Vec3d& normal) {
  OpeningPart part;
  for (const Json& corner : corners) part.polygon.push_back(vector_of(corner));
  part.normal = normal;
  if (part.polygon.size() > 2) {
    Vec3d n{};  // Newell's
    for (size_t i = 0; i < part.polygon.size(); ++i)
      n += cross(part.polygon[i] - part.polygon[0],
                 part.polygon[(i + 1) % part.polygon.size()] - part.polygon[0]);
    if (length(n) > 0) part.normal = normalize(dot(n, normal) < 0 ? -n : n);
  }
  return part;
}

}  // namespace

std::vector<HouseOpening> read_openings(const std::string& file) {
  const Json all = Json::parse(read_file(file), nullptr, false);
  if (!all.is_array()) throw InputError(file, "", "expected a list of openings");
  std::vector<HouseOpening> openings;
  for (const Json& one : all) {
    if (one.at("state") == "closed") continue;
    HouseOpening& o = openings.emplace_back();
    o.name = one.at("name"), o.kind = one.at("kind"), o.state = one.at("state");
    o.element = o.name.substr(0, o.name.find('.'));
    o.rooms = one.at("rooms").get<std::vector<std::string>>();
    o.part = part_of(one.at("polygon"), vector_of(one.at("normal")));
    if (one.contains("wall")) {
      const double half = 0.5 * one["wall"].value("thickness", 0.0);
      const double offset = one["wall"].value("offset", 0.0);
      o.front = std::max(0.0, half + offset), o.rear = std::max(0.0, half - offset);
    }
  }
  // Gap and wedge share the doorway.
  for (const Json& one : all)
    if (one.contains("leaf") && one["leaf"].contains("doorway"))
      for (HouseOpening& o : openings)
        if (o.element == one.at("name").get<std::string>())
          o.doorway.push_back(part_of(one["leaf"]["doorway"], vector_of(one.at("normal"))));
  return openings;
}

HouseScore score_house(const Scene& scene, const Tracer& tracer,
                       const std::vector<HouseOpening>& openings, const LightPaths& paths,
                       const std::vector<Portal>& portals) {
  HouseScore score;
  score.openings.resize(openings.size());
  std::vector<std::vector<Face>> faces;
  for (const Portal& portal : portals) {
    faces.push_back(faces_of(portal));
    score.portals.push_back(truth_of(portal, scene, tracer, openings));
  }
  const double share = 1 / static_cast<double>(std::max<size_t>(paths.paths.size(), 1));
  // Edges through each opening, by way, and those of them that cross a portal that lies in one.
  std::vector<std::array<double, 2>> through(openings.size()), covered(openings.size());
  for (const LightPath& path : paths.paths) {
    std::vector<uint8_t> by_portal(portals.size(), 0), by_opening(openings.size(), 0);
    std::vector<Segment> edges;
    for (size_t e = 0; e + 1 < path.size(); ++e) edges.push_back({path[e], path[e + 1]});
    const auto in_portal = [&](size_t e, const auto& counts) {
      for (size_t p = 0; p < portals.size(); ++p)
        if (counts(score.portals[p]) && crosses(faces[p], edges[e])) return true;
      return false;
    };
    // Between the edge of a leaf and the jamb light passes one or the other way, or is scattered by
    // the leaf on its way: then the portal is crossed by the edge before or after.
    const auto by_leaf = [&](size_t e, const HouseOpening& o) {
      if (o.doorway.empty()) return false;
      const auto of_leaf = [&](const PortalTruth& p) {
        return std::any_of(p.openings.begin(), p.openings.end(),
                           [&](size_t i) { return openings[i].element == o.element; });
      };
      return (e > 0 && in_portal(e - 1, of_leaf)) ||
             (e + 1 < edges.size() && in_portal(e + 1, of_leaf));
    };
    for (size_t e = 0; e < edges.size(); ++e) {
      for (size_t p = 0; p < portals.size(); ++p)
        if (crosses(faces[p], edges[e])) by_portal[p] = 1;
      const bool straight = in_portal(e, [](const PortalTruth& p) { return !p.openings.empty(); });
      for (size_t o = 0; o < openings.size(); ++o)
        if (const int way = crosses(openings[o], edges[e])) {
          by_opening[o] = 1;
          if (!beyond_wall(openings[o], edges[e])) continue;
          through[o][way > 0] += share;
          if (straight || by_leaf(e, openings[o])) covered[o][way > 0] += share;
        }
    }
    for (size_t p = 0; p < portals.size(); ++p) score.portals[p].light += by_portal[p] * share;
    for (size_t o = 0; o < openings.size(); ++o) score.openings[o].light += by_opening[o] * share;
  }
  for (size_t o = 0; o < openings.size(); ++o) {
    OpeningScore& s = score.openings[o];
    s.forward = through[o][1] >= through[o][0];
    if (through[o][s.forward] > 0) s.coverage = covered[o][s.forward] / through[o][s.forward];
  }
  for (size_t p = 0; p < portals.size(); ++p) {
    const PortalTruth& truth = score.portals[p];
    for (const size_t o : truth.openings) {
      OpeningScore& s = score.openings[o];
      s.portals.push_back(p);
      s.tightness = std::min(s.tightness, truth.tightness);
      s.angle = std::max(s.angle, truth.angle);
    }
  }
  return score;
}

}  // namespace tdpt::testing
