#include "libcommon/testing/houses/house_score.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/math/alias_table.h"
#include "libcommon/math/rng.h"
#include "libcommon/math/warp.h"
#include "libcommon/testing/rooms/portal_score.h"

namespace tdpt::testing {
namespace {

using Json = nlohmann::json;

constexpr uint64_t kStream = 0x686f'7573;
constexpr int kLines = 4000;  // of a portal
// Of a portal's lines: with fewer in openings it lies in none.
constexpr double kInOpening = 0.3;

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
  for (const OpeningPart& part : o.parts)
    if (const int way = crosses(part, s)) return way;
  return 0;
}

// Through gap or doorway: in the wall beside a leaf a line passes one and not the other.
int passes(const HouseOpening& o, const Segment& s) {
  if (const int way = crosses(o, s)) return way;
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

PortalTruth truth_of(const Portal& portal, const Scene& scene, const Tracer& tracer,
                     const std::vector<HouseOpening>& openings) {
  const std::vector<Face> faces = faces_of(portal);
  std::vector<double> areas;
  for (const Face& f : faces) areas.push_back(0.5 * length(cross(f.b - f.a, f.c - f.a)));
  const AliasTable table(areas);
  Rng rng(1, kStream, 0);
  std::vector<int> lines(openings.size(), 0);
  int in_some = 0, drawn = 0;
  while (drawn < kLines) {
    const Face& f = faces[table.sample(rng.uniform())];
    double b1, b2;
    const double u = rng.uniform(), v = rng.uniform();
    uniform_triangle(u, v, b1, b2);
    const Vec3d at = f.a + (f.b - f.a) * b1 + (f.c - f.a) * b2;
    const double c = rng.uniform(), d = rng.uniform();
    const Vec3d w = Onb<double>(f.normal).to_world(cosine_hemisphere(c, d));
    ++drawn;
    // Between the surfaces on either side; under the open sky as far as it goes.
    Segment s{at, at};
    const Vec3d from = scene.frame.to_canonical(at);
    Hit hit;
    s.to = at + w * ((tracer.closest({from}, w, hit) ? hit.distance : 8) / scene.frame.scale);
    s.from = at - w * ((tracer.closest({from}, -w, hit) ? hit.distance : 8) / scene.frame.scale);
    bool any = false;
    for (size_t o = 0; o < openings.size(); ++o)
      if (passes(openings[o], s)) ++lines[o], any = true;
    in_some += any;
  }
  PortalTruth truth;
  const auto most = std::max_element(lines.begin(), lines.end());
  if (!lines.empty() && *most >= kInOpening * kLines)
    truth.opening = static_cast<int>(most - lines.begin());
  truth.in_opening = static_cast<double>(in_some) / kLines;
  return truth;
}

double angle_of(const Vec3d& normal, const HouseOpening& o, bool forward) {
  const double way = forward ? 1 : -1;
  double least = 180;
  for (const OpeningPart& part : o.parts) {
    least = std::min(least, degrees_between(normal, part.normal * way));
    for (const OpeningPart& whole : o.doorway)
      for (double t = 0; t <= 1; t += 1.0 / 64)
        least = std::min(least, degrees_between(normal, normalize(part.normal * (1 - t) +
                                                                  whole.normal * t) * way));
  }
  return least;
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
  std::vector<HouseOpening> openings;
  std::map<std::string, size_t> of_name;
  const Json all = Json::parse(read_file(file), nullptr, false);
  if (!all.is_array()) throw InputError(file, "", "expected a list of openings");
  const auto add = [&](const Json& one) {
    const std::string name = one.at("name");
    const OpeningPart part = part_of(one.at("polygon"), vector_of(one.at("normal")));
    // The wedge above a leaf belongs to its gap; a slit around a closed leaf is an opening itself.
    constexpr std::string_view kAbove = ".above";
    if (name.ends_with(kAbove)) {
      const auto gap = of_name.find(name.substr(0, name.size() - kAbove.size()));
      if (gap != of_name.end()) return openings[gap->second].parts.push_back(part);
    }
    if (one.at("state") == "closed") return;
    of_name[name] = openings.size();
    HouseOpening& o = openings.emplace_back();
    o.name = name, o.kind = one.at("kind"), o.state = one.at("state");
    o.rooms = one.at("rooms").get<std::vector<std::string>>();
    o.parts.push_back(part);
    if (one.contains("leaf") && one["leaf"].contains("doorway"))
      o.doorway.push_back(part_of(one["leaf"]["doorway"], part.normal));
  };
  for (const bool above : {false, true})
    for (const Json& one : all)
      if (one.at("name").get<std::string>().ends_with(".above") == above) add(one);
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
    for (size_t e = 0; e + 1 < path.size(); ++e) {
      const Segment s{path[e], path[e + 1]};
      bool in_portal = false;
      for (size_t p = 0; p < portals.size(); ++p)
        if (crosses(faces[p], s)) {
          by_portal[p] = 1;
          in_portal = in_portal || score.portals[p].opening >= 0;
        }
      for (size_t o = 0; o < openings.size(); ++o)
        if (const int way = crosses(openings[o], s)) {
          by_opening[o] = 1;
          through[o][way > 0] += share;
          if (in_portal) covered[o][way > 0] += share;
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
    if (truth.opening < 0) continue;
    const auto o = static_cast<size_t>(truth.opening);
    OpeningScore& s = score.openings[o];
    s.portals.push_back(p);
    s.tightness = std::min(s.tightness, truth.in_opening);
    s.angle = std::max(s.angle, angle_of(mean_normal(portals[p]), openings[o], s.forward));
  }
  return score;
}

}  // namespace tdpt::testing
