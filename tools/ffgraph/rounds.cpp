#include "tools/ffgraph/rounds.h"

#include <algorithm>

#include <oneapi/tbb/parallel_for.h>

#include "libcommon/base/error.h"
#include "libcommon/flow/series_cut.h"
#include "tools/ffgraph/patch_map.h"
#include "tools/ffgraph/walks.h"

namespace tdpt {
namespace {

// For a network that carries no flow.
constexpr uint32_t kFewRays = 1000, kFewWalks = 1000;

// Added to the seed: the rays that decide where to split are independent of those that measure.
constexpr uint64_t kSplittingSeed = 0x5eed;

// Maximum number of openings in series that ffgraph itself looks for.
constexpr size_t kMostCuts = 8;

// Several cameras share the walks of a single one, since the etendue is estimated from those of all
// together; each has at least one part of so many.
constexpr uint32_t kMostParts = 8;

// This share of a camera's hits is left out: walks that have passed several openings reach few
// places.
constexpr double kSeldomShare = 0.001;

// Patches that straddle an opening make it look wider than it is.
constexpr double kLeaks = 1.5;

// The side of every patch, for each cut.
using Sides = std::vector<std::vector<Side>>;

// The cuts of all cameras, one after the other; the same opening may occur several times.
Sides own_cuts(const LightFlow& f) {
  CutLimits limits;
  limits.largest_conductance *= kLeaks;
  std::vector<SeriesCut> of_camera(f.lit.size());
  tbb::parallel_for(size_t{0}, of_camera.size(), [&](size_t k) {
    PatchNetwork network = network_between(f.file, k);
    // Rounds look for openings by the walks alone.
    network.brightness.clear();
    network.importance.clear();
    network.weight = network.sky.empty() ? std::vector<double>() : network.viewed;
    of_camera[k] = of_camera.size() > 1 ? camera_cut(network, kMostCuts, limits)
                                        : series_cut(network, kMostCuts, limits);
  });
  Sides cuts;
  for (const SeriesCut& series : of_camera)
    for (size_t c = 0; c < series.cuts.size(); ++c) {
      std::vector<Side>& sides = cuts.emplace_back();
      for (uint32_t i = 0; i < f.patches.size(); ++i)
        sides.push_back(series.region[i + 2] <= c ? Side::source : Side::sink);
    }
  return cuts;
}

Sides given_cuts(const CutFile& file) {
  Sides cuts(file.cuts.size());
  for (size_t c = 0; c < cuts.size(); ++c)
    for (size_t i = 0; i < file.patches.size(); ++i) cuts[c].push_back(file.side_of(i, c));
  return cuts;
}

// A map of this scene with the patches of a cut, in the cut's order.
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

// Canonical; of each camera `share` of its hits lie outside each end of each axis.
Extent reach_of_hits(const std::vector<Walks>& cameras, double share) {
  Extent reach;
  for (const Walks& walks : cameras) {
    std::vector<Vec3d> places;
    for (const WalkHit& h : walks)
      if (is_hit(h)) places.push_back(Vec3d(h.position));
    reach.add(reach_of(places, share));
  }
  return reach;
}

BothWalks both_walks(const Scene& scene, const std::vector<Camera>& cameras, const Tracer& tracer,
                     WalkSettings settings) {
  BothWalks walks;
  WalkSettings each = settings;
  const auto parts = std::min(static_cast<uint32_t>(cameras.size()), kMostParts);
  each.walks = (settings.walks + parts - 1) / parts;
  for (const Camera& camera : cameras)
    walks.cameras.push_back(camera_walks(scene, camera, tracer, each));
  if (std::all_of(walks.cameras.begin(), walks.cameras.end(),
                  [](const Walks& of_camera) { return hits_in(of_camera) == 0; }))
    settings.walks = std::min(settings.walks, kFewWalks);
  if (!lit_from_infinity(scene)) {
    walks.light = light_walks(scene, tracer, settings);
    return walks;
  }
  walks.sky_grade = sky_grades(sky_bin_light(scene));
  const SkyLines lines(scene, reach_of_hits(walks.cameras, kFarShare),
                       reach_of_hits(walks.cameras, kSeldomShare));
  walks.light = light_walks(scene, tracer, settings, &lines);
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

LightFlow build_graph(const Scene& scene, const std::vector<Camera>& cameras,
                      const GraphSettings& settings, const CutFile* refine, GraphReport& report,
                      Phases& phases) {
  const std::vector<uint32_t> component = surface_components(scene);
  phases.done("surfaces");
  // Constructed after steps with a high temporary memory use.
  const Tracer tracer(scene, cameras[0].culls);
  phases.done("bvh");
  const BothWalks walks = both_walks(scene, cameras, tracer, settings.walks);
  phases.done("walks");
  report.light_hits = hits_in(walks.light.hits);
  for (const Walks& of_camera : walks.cameras) report.camera_hits.push_back(hits_in(of_camera));
  // A network that carries no flow is for inspection only.
  const bool flows = report.light_hits > 0 && report.hits_of_cameras() > 0;
  const uint32_t rays = flows ? settings.rays : std::min(settings.rays, kFewRays);
  const GridOfWalks grid = grid_for(scene, walks.light.hits, walks.cameras, settings.cells);

  uint64_t estimates = 0;
  const auto estimate = [&](PatchMap map) {
    report.rays += rays;
    return light_flow(std::move(map), walks, tracer, settings.walks.seed + estimates++ * 0x10001,
                      rays);
  };
  // Begins the report of a round; the map without the patches that straddle any of the cuts.
  const auto split = [&](const PatchMap& map, const Etendue& etendue, const Sides& cuts) {
    std::vector<uint8_t> chosen(map.size(), 0);
    for (const std::vector<Side>& side : cuts) {
      const std::vector<uint8_t> of_cut = straddling(etendue, side, settings.straddle_share);
      for (uint32_t i = 0; i < map.size(); ++i)
        chosen[i] |=
            of_cut[i] && !map.is_sky(i) && map.keys()[i].level < map.fine_level() + kDeepestSplit;
    }
    const auto count = std::count(chosen.begin(), chosen.end(), 1);
    report.rounds.push_back({cuts.size(), static_cast<size_t>(count), 0});
    return map.split(chosen);
  };

  LightFlow flow;
  if (refine) {
    const double cpu = cpu_seconds();
    // Walks with other settings may have had another grid; then coarse cells remain where there are
    // no patches.
    const bool same = grid.grid.base_cell == refine->grid.base_cell;
    const PatchMap map = map_of(scene, component, *refine, same ? grid.fine : FineRegion{});
    const Etendue etendue =
        measure_etendue(map, Fragments(map), tracer, kSplittingSeed + settings.walks.seed, rays);
    report.rays += rays;
    flow = estimate(split(map, etendue, given_cuts(*refine)));
    report.rounds.back().cpu_seconds = cpu_seconds() - cpu;
    report.why_stopped = "a cut was given";
  } else {
    flow = estimate(PatchMap(scene, grid.grid, component, grid.fine));
    report.why_stopped = report.hits_of_cameras() == 0 ? "the camera sees no surface"
                         : report.light_hits == 0      ? "no light reaches a surface"
                                                       : "--set rounds allows no more";
    for (int round = 0; flows && round < settings.rounds; ++round) {
      const double cpu = cpu_seconds();
      PatchMap finer = split(flow.patches, flow.etendue, own_cuts(flow));
      const bool done = report.rounds.back().split == 0;
      if (!done) flow = estimate(std::move(finer));
      report.rounds.back().cpu_seconds = cpu_seconds() - cpu;
      if (!done) continue;
      report.why_stopped = "nothing straddles any more";
      break;
    }
  }
  for (const PatchWalks& patch : flow.file.walks) {
    bool viewed = false;
    for (size_t k = 0; k < cameras.size(); ++k) viewed |= flow.lit[k] && patch.camera[k] > 0;
    report.reached_by_both += viewed && patch.light > 0;
  }
  phases.done("patches");
  return flow;
}

}  // namespace tdpt
