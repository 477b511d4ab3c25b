// For tests: the ideal cut of a scene that a plane divides into two sides, as a perfect ffgraph and
// mincut would find it.
#pragma once
#include <functional>
#include <map>

#include "libcommon/formats/cut.h"
#include "libcommon/math/discrete.h"
#include "libcommon/math/rng.h"
#include "libcommon/scene/scene.h"
#include "libcommon/trace/tracer.h"

namespace tdpt::testing {

/// Patches are grid cells (longest side / 24) and facing sides by the main axis of their triangles;
/// arcs count the rays from one side to the other, of `n` area-uniform points with
/// cosine-distributed directions. A patch is on the source side if its centre [metres] satisfies
/// `is_source`.
inline CutFile perfect_cut(const Scene& scene, size_t n,
                           const std::function<bool(const Vec3d&)>& is_source) {
  CutFile cut;
  cut.scene_hash = scene.hash;
  cut.bottleneck = true;
  cut.cuts.resize(1);
  const Tracer tracer(scene);
  Vec3d low(1e9), high(-1e9);
  std::vector<double> areas;
  for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
    areas.push_back(shape_of(scene, t).area);
    for (int v = 0; v < 3; ++v) {
      const Vec3d p = scene.frame.to_metres(Vec3d(scene.vertex(t, v)));
      low = min(low, p), high = max(high, p);
    }
  }
  cut.grid.base_cell = max_component(high - low) / 24;
  cut.grid.origin = low - Vec3d(0.37 * cut.grid.base_cell);
  std::map<std::array<int32_t, 4>, uint32_t> known;  // cell and facing
  std::map<std::array<uint32_t, 2>, double> rays;
  const auto patch_of = [&](uint32_t triangle, const Vec3d& position, const Vec3d& normal) {
    const Vec3d p = scene.frame.to_metres(position);
    const Vec3d q = (p - cut.grid.origin) / cut.grid.base_cell;
    int axis = 0;
    for (int c = 1; c < 3; ++c)
      if (std::abs(normal[c]) > std::abs(normal[axis])) axis = c;
    const std::array<int32_t, 4> key{
        static_cast<int32_t>(std::floor(q.x)), static_cast<int32_t>(std::floor(q.y)),
        static_cast<int32_t>(std::floor(q.z)), 2 * axis + (normal[axis] > 0)};
    const auto [it, fresh] = known.try_emplace(key, static_cast<uint32_t>(cut.patches.size()));
    if (fresh) {
      Patch patch;
      patch.node = it->second + 3;  // 1 and 2 are the terminals
      patch.cell = {key[0], key[1], key[2]};
      cut.patches.push_back(patch);
    }
    Patch& patch = cut.patches[it->second];
    const uint32_t face =
        2 * triangle + (dot(shape_of(scene, triangle).normal, normal) > 0 ? 0 : 1);
    if (std::find(patch.faces.begin(), patch.faces.end(), face) == patch.faces.end())
      patch.faces.push_back(face);
    patch.centre = (patch.centre * patch.samples + p) / (patch.samples + 1);
    patch.normal = normal;
    patch.samples += 1;
    return it->second;
  };
  const AliasTable pick(areas);
  for (size_t i = 0; i < n; ++i) {
    Rng rng(7, 7, i);
    const uint32_t t = pick.sample(rng.uniform());
    const TriangleShape s = shape_of(scene, t);
    double b1, b2;
    const double u = rng.uniform(), v = rng.uniform(), c = rng.uniform(), d = rng.uniform();
    uniform_triangle(u, v, b1, b2);
    const Vec3d p = s.p0 + s.e1 * b1 + s.e2 * b2,
                normal = rng.uniform() < 0.5 ? s.normal : -s.normal;
    const Vec3d w = Onb<double>(normal).to_world(cosine_hemisphere(c, d));
    Hit hit;
    if (!tracer.closest({p, normal}, w, hit)) continue;
    const uint32_t a = patch_of(t, p, normal);
    const uint32_t b =
        patch_of(hit.triangle, hit.position, dot(hit.normal, w) < 0 ? hit.normal : -hit.normal);
    ++rays[{a, b}];
  }
  for (const Patch& patch : cut.patches) cut.sides.push_back(is_source(patch.centre) ? 0 : 1);
  for (const auto& [pair, count] : rays) {
    const auto [a, b] = pair;
    if (cut.sides[a] == cut.sides[b]) continue;
    cut.arcs.push_back(cut.sides[a] == 0 ? CutArc{a, b, count} : CutArc{b, a, count});
    cut.cuts[0].flow += count;
  }
  return cut;
}

}  // namespace tdpt::testing
