#include "tools/ffgraph/rounds.h"

#include <algorithm>

#include "libcommon/base/error.h"
#include "libcommon/math/series_cut.h"
#include "tools/ffgraph/connectivity.h"
#include "tools/ffgraph/patch_grid.h"

namespace tdpt {
namespace {

// Rays that look where to split are not those that measure.
constexpr uint64_t kLookSeed = 0x5eed;

// Most openings in series that rounds of ffgraph's own look at.
constexpr size_t kMostCuts = 8;

// Of the camera's hits: walks that have passed several openings come to few places.
constexpr double kSeldomShare = 0.001;

// Patches that straddle an opening make it wider than it is.
constexpr double kLeaks = 1.5;

struct OwnCuts {
  std::vector<uint32_t> region;  // of each patch
  size_t cuts;
};

OwnCuts own_cuts(const LightFlow& f) {
  const auto of_nodes = [](const std::vector<double>& of_patches) {
    std::vector<double> all(2, 0);
    all.insert(all.end(), of_patches.begin(), of_patches.end());
    return all;
  };
  PatchNetwork patches{f.network,         of_nodes(f.etendue.samples), kCapacityScale,
                       of_nodes(f.begun), of_nodes(f.hits_light),      of_nodes(f.hits_camera)};
  if (f.patches.has_sky()) {
    patches.sky.assign(f.network.nodes, 0);
    for (uint32_t i = 0; i < f.patches.size(); ++i) patches.sky[i + 2] = f.patches.is_sky(i);
  }
  CutLimits limits;
  limits.largest_conductance *= kLeaks;
  const SeriesCut series = series_cut(patches, kMostCuts, limits);
  return {{series.region.begin() + 2, series.region.end()}, series.cuts.size()};
}

// Patches that straddle one of the cuts.
std::vector<uint8_t> straddling_any(const Etendue& etendue, const OwnCuts& own, double share) {
  std::vector<uint8_t> chosen(own.region.size(), 0);
  for (size_t c = 0; c < own.cuts; ++c) {
    std::vector<Side> side;
    for (const uint32_t region : own.region) side.push_back(CutFile::side(region, c));
    const std::vector<uint8_t> of_cut = straddling(etendue, side, share);
    for (size_t i = 0; i < chosen.size(); ++i) chosen[i] |= of_cut[i];
  }
  return chosen;
}

// The patches of a cut in a map of this scene, in the order of the cut.
PatchMap map_of(const Scene& scene, const std::vector<uint32_t>& component, const CutFile& cut,
                const FineRegion& fine = {}) {
  PatchMap map(scene, cut.grid, component, fine);
  for (const Patch& p : cut.patches)
    if (p.is_sky())
      map.add_sky(static_cast<uint32_t>(p.sky));
    else
      map.add({p.cell, p.level, map.piece(p.faces.front())});
  return map;
}

// Canonical; `share` of the hits lie beyond either end of each axis.
Extent reach_of_hits(const Walks& walks, double share) {
  std::vector<WeightedPlace> places;
  for (const WalkHit& h : walks)
    if (is_hit(h)) places.push_back({Vec3d(h.position), 1});
  return reach_of(places, share);
}

BothWalks both_walks(const Scene& scene, const Camera& camera, const Tracer& tracer,
                     const WalkSettings& settings) {
  BothWalks walks;
  walks.camera = camera_walks(scene, camera, tracer, settings);
  walks.starts = light_starts(scene, settings);
  if (!lit_from_infinity(scene)) {
    walks.light = light_walks(scene, tracer, settings);
    return walks;
  }
  walks.sky_grade = sky_grades(sky_bin_light(scene));
  const SkyLines lines(scene, reach_of_hits(walks.camera, kFarShare),
                       reach_of_hits(walks.camera, kSeldomShare));
  walks.light = light_walks(scene, tracer, settings, lines, walks.from_sky);
  return walks;
}

}  // namespace

void check_patches(const std::string& file, const Scene& scene, const CutFile& cut) {
  for (const Patch& p : cut.patches)
    for (uint32_t face : p.faces)
      if (face >= 2 * scene.triangles.size())
        throw InputError(file, "",
                         "node " + std::to_string(p.node) + " has face " + std::to_string(face) +
                             ", expected one below " + std::to_string(2 * scene.triangles.size()));
  const PatchMap map = map_of(scene, surface_components(scene), cut);
  if (map.size() != cut.patches.size())
    throw InputError(file, "", "two patches in one place, expected patches made by ffgraph");
}

LightFlow build_graph(const Scene& scene, const Camera& camera, const GraphSettings& settings,
                      const CutFile* refine, GraphReport& report) {
  const std::vector<uint32_t> component = surface_components(scene);
  report.phases.done("surfaces");
  const Tracer tracer(scene);
  report.phases.done("bvh");
  const BothWalks walks = both_walks(scene, camera, tracer, settings.walks);
  report.phases.done("walks");
  report.light_hits = hits_in(walks.light);
  report.camera_hits = hits_in(walks.camera);

  uint64_t round = 0;
  const auto estimate = [&](PatchMap map) {
    report.rays += settings.rays;
    return light_flow(std::move(map), walks, tracer, settings.walks.seed + round++ * 0x10001,
                      settings.rays);
  };
  const auto finer = [&](const PatchMap& map, std::vector<uint8_t> chosen) {
    for (size_t i = 0; i < chosen.size(); ++i) {
      if (map.is_sky(static_cast<uint32_t>(i)) ||
          map.keys()[i].level >= map.fine_level() + kDeepestSplit)
        chosen[i] = 0;
      report.split += chosen[i];
    }
    return map.split(chosen);
  };

  LightFlow flow;
  const GridOfWalks own = grid_for(scene, walks.light, walks.camera, settings.cells);
  if (refine) {
    // Walks of other settings may have had another grid; then coarse cells stay where no patch is.
    const bool same = own.grid.base_cell == refine->grid.base_cell;
    const PatchMap map = map_of(scene, component, *refine, same ? own.fine : FineRegion{});
    const Etendue etendue = measure_etendue(map, Fragments(map), tracer,
                                            kLookSeed + settings.walks.seed, settings.rays);
    report.rays += settings.rays;
    report.rounds = 1;
    report.why_stopped = "those of the given cut";
    const OwnCuts given{refine->region, refine->cuts.size()};
    flow = estimate(finer(map, straddling_any(etendue, given, settings.straddle_share)));
  } else {
    flow = estimate(PatchMap(scene, own.grid, component, own.fine));
    report.why_stopped = "as many as allowed";
    while (report.rounds < static_cast<size_t>(settings.rounds)) {
      const size_t before = report.split;
      PatchMap map = finer(flow.patches,
                           straddling_any(flow.etendue, own_cuts(flow), settings.straddle_share));
      if (report.split == before) {
        report.why_stopped = "nothing straddles any more";
        break;
      }
      ++report.rounds;
      flow = estimate(std::move(map));
    }
  }
  for (size_t i = 0; i < flow.hits_light.size(); ++i)
    report.reached_by_both += flow.hits_light[i] > 0 && flow.hits_camera[i] > 0;
  report.phases.done("patches");
  return flow;
}

}  // namespace tdpt
