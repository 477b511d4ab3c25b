#include "tools/ffgraph/triangle_flow.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>
#include <vector>

#include <oneapi/tbb/parallel_for.h>

#include "libcommon/math/streams.h"
#include "tools/ffgraph/walks.h"

namespace tdpt {
namespace {

std::vector<Vec3d> points_on(const TriangleShape& t, int n, Rng& rng) {
  std::vector<Vec3d> points;
  for (int k = 0; k < n; ++k) {
    const double u = rng.uniform();
    const double v = rng.uniform();
    double b1, b2;
    uniform_triangle(u, v, b1, b2);
    points.push_back(t.p0 + t.e1 * b1 + t.e2 * b2);
  }
  return points;
}

}  // namespace

double form_factor(const TriangleShape& i, const TriangleShape& j, int n, int m, Rng& rng,
                   const Tracer* tracer) {
  const std::vector<Vec3d> on_i = points_on(i, n, rng);
  const std::vector<Vec3d> on_j = points_on(j, m, rng);
  double sum = 0;
  for (const Vec3d& x : on_i)
    for (const Vec3d& y : on_j) {
      const Vec3d d = y - x;
      const double r2 = dot(d, d);
      // cos_i cos_j / r^2 = (n_i . d) (-n_j . d) / r^4; cosines before visibility.
      const double at_i = dot(i.normal, d), at_j = -dot(j.normal, d);
      if (!(at_i > 0 && at_j > 0)) continue;
      if (tracer && !tracer->visible({x, i.normal}, {y, j.normal})) continue;
      sum += at_i * at_j / (r2 * r2);
    }
  // [eq. 10]
  return j.area * sum / (std::numbers::pi * n * m);
}

namespace {

constexpr double kScale = 1 << 30;
constexpr double kSamples = 300000;  // over all patches, in proportion to area

struct Seen {
  uint32_t face;
  double share;  // of all rays
};

// Faces by number of hits, descending; at most `largest` of them.
std::vector<Seen> most_hit(const Walks& walks, const TriangleSettings& s, size_t& found) {
  std::unordered_map<uint32_t, uint32_t> count;
  for (const WalkHit& h : walks)
    if (is_hit(h)) ++count[h.face];
  std::vector<Seen> faces;
  for (const auto& [face, n] : count) faces.push_back({face, static_cast<double>(n) / s.rays});
  std::sort(faces.begin(), faces.end(), [](const Seen& a, const Seen& b) {
    return a.share != b.share ? a.share > b.share : a.face < b.face;
  });
  found = faces.size();
  if (faces.size() > s.largest_set) faces.resize(s.largest_set);
  return faces;
}

// One cell that contains the whole scene.
PatchGrid one_cell(const Scene& scene) {
  PatchGrid grid;
  grid.base_cell = 4 / scene.frame.scale;
  grid.origin = scene.frame.to_metres(Vec3d(-2));
  return grid;
}

Patch patch_of(const Scene& scene, uint32_t node, uint32_t face) {
  const TriangleShape t = facing(scene, face);
  Patch p;
  p.node = node;
  p.samples = t.area;
  p.centre = scene.frame.to_metres(t.p0 + (t.e1 + t.e2) / 3.0);
  p.normal = t.normal;
  p.faces = {face};
  return p;
}

}  // namespace

DimacsFile triangle_flow(const Scene& scene, const Camera& camera, const TriangleSettings& settings,
                         TriangleReport& report, Phases& phases) {
  const Tracer tracer(scene, camera.culls);
  phases.done("bvh");
  const WalkSettings first_hit{settings.seed, settings.rays, 1};
  const std::vector<Seen> lit =
      most_hit(light_walks(scene, tracer, first_hit).hits, settings, report.lit);
  const std::vector<Seen> seen =
      most_hit(camera_walks(scene, camera, tracer, first_hit), settings, report.seen);
  phases.done("walks");

  DimacsFile file;
  file.has_patches = true;
  file.scale = kScale;
  file.scene_hash = scene.identity();
  file.grid = one_cell(scene);
  FlowNetwork& net = file.network;
  net.source = 0;
  net.sink = 1;
  const auto add = [&net](uint32_t from, uint32_t to, double capacity) {
    if (const int64_t c = std::llround(capacity * kScale); c > 0) net.arcs.push_back({from, to, c});
  };
  std::unordered_map<uint32_t, uint32_t> node;
  const auto node_of = [&](uint32_t face) {
    const auto [entry, is_new] = node.try_emplace(face, static_cast<uint32_t>(node.size()) + 2);
    if (is_new) file.patches.push_back(patch_of(scene, entry->second + 1, face));
    return entry->second;
  };
  for (const Seen& i : lit) add(net.source, node_of(i.face), i.share);
  for (const Seen& j : seen) {
    report.shared += node.contains(j.face);
    add(node_of(j.face), net.sink, j.share);
  }
  if (report.shared > 0) add(net.source, net.sink, 1);

  std::vector<double> factors(lit.size() * seen.size(), 0);
  tbb::parallel_for(size_t{0}, lit.size(), [&](size_t i) {
    for (size_t j = 0; j < seen.size(); ++j) {
      if (lit[i].face == seen[j].face) continue;
      Rng rng(settings.seed, kTriangleFlow.first, lit[i].face, seen[j].face);
      factors[i * seen.size() + j] =
          form_factor(facing(scene, lit[i].face), facing(scene, seen[j].face), settings.points,
                      settings.points, rng, &tracer);
    }
  });
  for (size_t i = 0; i < lit.size(); ++i)
    for (size_t j = 0; j < seen.size(); ++j)
      add(node.at(lit[i].face), node.at(seen[j].face), std::min(1.0, factors[i * seen.size() + j]));

  net.nodes = static_cast<uint32_t>(node.size()) + 2;
  double area = 0;
  for (const Patch& p : file.patches) area += p.samples;
  for (Patch& p : file.patches) p.samples *= kSamples / area;
  phases.done("patches");
  return file;
}

}  // namespace tdpt
