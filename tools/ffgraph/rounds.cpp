#include "tools/ffgraph/rounds.h"

#include <algorithm>

#include "libcommon/base/error.h"
#include "tools/ffgraph/connectivity.h"

namespace tdpt {
namespace {

std::vector<Side> own_cut(const LightFlow& f) {
  const MaxFlow flow = max_flow(f.network);
  std::vector<Side> side(f.patches.size());
  for (size_t i = 0; i < side.size(); ++i)
    side[i] = flow.source_side[i + 2] ? Side::source : Side::sink;
  return side;
}

// The patches of a cut, with their sides, in a map of this scene.
PatchMap map_of(const Scene& scene, const std::vector<uint32_t>& component, const CutFile& cut) {
  PatchMap map(scene, cut.grid, component);
  const size_t faces = 2 * scene.triangles.size();
  for (const Patch& p : cut.patches) {
    for (uint32_t face : p.faces)
      if (face >= faces) throw InputError("(cut)", "", "a face beyond the triangles of the scene");
    map.add({p.cell, p.level, map.piece(p.faces.front())});
  }
  if (map.size() != cut.patches.size())
    throw InputError("(cut)", "", "two patches in one place, expected each once");
  return map;
}

}  // namespace

LightFlow build_graph(const Scene& scene, const Camera& camera, const GraphSettings& settings,
                      const CutFile* refine, GraphReport& report) {
  const Tracer tracer(scene);
  const std::vector<uint32_t> component = surface_components(scene);
  const std::vector<WalkHit> light = light_walks(scene, tracer, settings.walks);
  const std::vector<WalkHit> seen = camera_walks(scene, camera, tracer, settings.walks);
  report.light_hits = light.size();
  report.camera_hits = seen.size();

  uint64_t round = 0;
  const auto estimate = [&](PatchMap map) {
    report.rays += settings.rays;
    return light_flow(std::move(map), light, seen, tracer, settings.walks.seed + round++ * 0x10001,
                      settings.rays);
  };
  const auto finer = [&](const PatchMap& map, std::vector<uint8_t> chosen) {
    for (size_t i = 0; i < chosen.size(); ++i) {
      if (map.keys()[i].level >= kDeepestSplit) chosen[i] = 0;
      report.split += chosen[i];
    }
    return map.split(chosen);
  };

  if (refine) {
    const PatchMap map = map_of(scene, component, *refine);
    const Etendue etendue =
        measure_etendue(map, Fragments(map), tracer, settings.walks.seed - 1, settings.rays);
    report.rays += settings.rays;
    report.rounds = 1;
    return estimate(finer(map, straddling(etendue, refine->side, settings.straddle_share)));
  }

  LightFlow flow = estimate(PatchMap(scene, grid_for(scene), component));
  while (report.rounds < static_cast<size_t>(settings.rounds)) {
    const size_t before = report.split;
    PatchMap map =
        finer(flow.patches, straddling(flow.etendue, own_cut(flow), settings.straddle_share));
    if (report.split == before) break;
    ++report.rounds;
    flow = estimate(std::move(map));
  }
  return flow;
}

}  // namespace tdpt
