#include "tools/ffgraph/rounds.h"

#include <algorithm>

#include <oneapi/tbb/parallel_for.h>

#include "libcommon/base/error.h"
#include "libcommon/base/process.h"
#include "libcommon/flow/series_cut.h"
#include "tools/ffgraph/patch_map.h"
#include "tools/ffgraph/walks.h"

namespace tdpt {
namespace {

// For a network that carries no flow.
constexpr uint32_t kFewRays = 1000, kFewWalks = 1000;

// The rays that decide where to split are independent of those that measure.
constexpr uint64_t kLookSeed = 0x5eed;

// Maximum number of openings in series that ffgraph itself looks for.
constexpr size_t kMostCuts = 8;

// Of the walks of one camera that each of several has: they also see what others' walks see.
constexpr double kOfSeveral = 0.5;

// Of the camera's hits: walks that have passed several openings reach few places.
constexpr double kSeldomShare = 0.001;

// Patches that straddle an opening make it look wider than it is.
constexpr double kLeaks = 1.5;

struct OwnCuts {
  std::vector<std::vector<Side>> cuts;  // of each cut, per patch
  double conductance = 1;               // of the narrowest cut
};

double narrowest(const auto& cuts) {
  double least = 1;
  for (const auto& c : cuts) least = std::min(least, c.conductance);
  return least;
}

// The network between the light and one camera.
PatchNetwork network_between(const LightFlow& f, size_t camera) {
  const auto of_nodes = [](const std::vector<double>& of_patches) {
    std::vector<double> all(2, 0);
    all.insert(all.end(), of_patches.begin(), of_patches.end());
    return all;
  };
  PatchNetwork patches{network_of(f.network, f.more_sinks, camera),
                       of_nodes(f.etendue.samples),
                       kCapacityScale,
                       of_nodes(f.begun),
                       of_nodes(f.hits_light),
                       of_nodes(f.hits_cameras[camera])};
  if (f.patches.has_sky()) {
    patches.weight = patches.viewed;
    patches.sky.assign(patches.network.nodes, 0);
    for (uint32_t i = 0; i < f.patches.size(); ++i) patches.sky[i + 2] = f.patches.is_sky(i);
  }
  return patches;
}

// Those of all cameras, one after the other; the same opening may occur several times.
OwnCuts own_cuts(const LightFlow& f) {
  CutLimits limits;
  limits.largest_conductance *= kLeaks;
  std::vector<SeriesCut> of_camera(f.hits_cameras.size());
  tbb::parallel_for(size_t{0}, of_camera.size(), [&](size_t k) {
    const PatchNetwork network = network_between(f, k);
    of_camera[k] = of_camera.size() > 1 ? camera_cut(network, kMostCuts, limits)
                                        : series_cut(network, kMostCuts, limits);
  });
  OwnCuts own;
  std::vector<CutFacts> facts;
  for (const SeriesCut& series : of_camera)
    for (size_t c = 0; c < series.cuts.size(); ++c) {
      std::vector<Side>& sides = own.cuts.emplace_back();
      for (uint32_t i = 0; i < f.patches.size(); ++i)
        sides.push_back(series.region[i + 2] <= c ? Side::source : Side::sink);
      if (series.bottleneck) facts.push_back(series.cuts[c].facts);
    }
  own.conductance = narrowest(facts);
  return own;
}

OwnCuts given_cuts(const CutFile& file) {
  OwnCuts given;
  for (size_t c = 0; c < file.cuts.size(); ++c) {
    std::vector<Side>& sides = given.cuts.emplace_back();
    for (size_t i = 0; i < file.patches.size(); ++i) sides.push_back(file.side_of(i, c));
  }
  given.conductance = narrowest(file.cuts);
  return given;
}

// Patches that straddle any of the cuts.
std::vector<uint8_t> straddling_any(const Etendue& etendue, const OwnCuts& own, double share) {
  std::vector<uint8_t> chosen(etendue.samples.size(), 0);
  for (const std::vector<Side>& side : own.cuts) {
    const std::vector<uint8_t> of_cut = straddling(etendue, side, share);
    for (size_t i = 0; i < chosen.size(); ++i) chosen[i] |= of_cut[i];
  }
  return chosen;
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
    std::vector<WeightedPlace> places;
    for (const WalkHit& h : walks)
      if (is_hit(h)) places.push_back({Vec3d(h.position), 1});
    reach.add(reach_of(places, share));
  }
  return reach;
}

// The etendue is estimated from the walks of all together.
uint32_t walks_of_each(uint32_t walks, size_t cameras) {
  return cameras > 1 ? static_cast<uint32_t>(kOfSeveral * walks) : walks;
}

BothWalks both_walks(const Scene& scene, const std::vector<Camera>& cameras, const Tracer& tracer,
                     WalkSettings settings) {
  BothWalks walks;
  WalkSettings each = settings;
  each.walks = walks_of_each(settings.walks, cameras.size());
  for (const Camera& camera : cameras)
    walks.cameras.push_back(camera_walks(scene, camera, tracer, each));
  if (std::all_of(walks.cameras.begin(), walks.cameras.end(),
                  [](const Walks& of_camera) { return hits_in(of_camera) == 0; }))
    settings.walks = std::min(settings.walks, kFewWalks);
  walks.of_light = settings.walks;
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

double narrowest_opening(const LightFlow& flow) {
  return own_cuts(flow).conductance;
}

namespace {

// Builds networks of one scene, coarse to fine.
class Rounds {
 public:
  // The cameras must not differ in `culls`.
  Rounds(const Scene& scene, const std::vector<Camera>& cameras, const GraphSettings& settings,
         GraphReport& report)
      : scene_(scene),
        settings_(settings),
        report_(report),
        component_(components(scene, report)),
        tracer_(scene, cameras[0].culls) {
    report.phases.done("bvh");
    walks_ = both_walks(scene, cameras, tracer_, settings.walks);
    report.phases.done("walks");
    report.light_walks = walks_.of_light;
    report.camera_walks = walks_of_each(settings.walks.walks, cameras.size());
    report.light_hits = hits_in(walks_.light.hits);
    for (const Walks& walks : walks_.cameras) report.camera_hits.push_back(hits_in(walks));
    // Then no network carries a flow, and patches are needed for inspection only.
    if (report.light_hits == 0 || report.hits_of_cameras() == 0) {
      settings_.rays = std::min(settings_.rays, kFewRays);
      settings_.rounds = 0;
    }
    grid_ = grid_for(scene, walks_.light.hits, walks_.cameras, settings_.cells);
  }

  /// Splits where patches straddle the openings of the given cut.
  LightFlow by_cut(const CutFile& cut) {
    const double cpu = cpu_seconds();
    // Walks with other settings may have had another grid; then coarse cells remain where there are
    // no patches.
    const bool same = grid_.grid.base_cell == cut.grid.base_cell;
    const PatchMap map = map_of(scene_, component_, cut, same ? grid_.fine : FineRegion{});
    const Etendue etendue = measure_etendue(map, Fragments(map), tracer_,
                                            kLookSeed + settings_.walks.seed, settings_.rays);
    report_.rays += settings_.rays;
    report_.rounds = 1;
    report_.why_stopped = "a cut was given";
    const std::vector<uint8_t> chosen = chosen_to_split(map, etendue, given_cuts(cut));
    LightFlow flow = estimate(map.split(chosen));
    report_.by_round.back().cpu_seconds = cpu_seconds() - cpu;
    return flow;
  }

  /// Splits by cuts of its own.
  LightFlow by_itself() {
    LightFlow flow = estimate(PatchMap(scene_, grid_.grid, component_, grid_.fine));
    report_.why_stopped = report_.hits_of_cameras() == 0 ? "the camera sees no surface"
                          : report_.light_hits == 0      ? "no light reaches a surface"
                                                         : "--set rounds allows no more";
    while (report_.rounds < static_cast<size_t>(settings_.rounds)) {
      const double cpu = cpu_seconds();
      const std::vector<uint8_t> chosen =
          chosen_to_split(flow.patches, flow.etendue, own_cuts(flow));
      RoundReport& round = report_.by_round.back();
      if (round.split > 0) {
        ++report_.rounds;
        flow = estimate(flow.patches.split(chosen));
      }
      round.cpu_seconds = cpu_seconds() - cpu;
      if (round.split > 0) continue;
      report_.why_stopped = "nothing straddles any more";
      break;
    }
    return flow;
  }

 private:
  static std::vector<uint32_t> components(const Scene& scene, GraphReport& report) {
    std::vector<uint32_t> found = surface_components(scene);
    report.phases.done("surfaces");
    return found;
  }

  // Begins the report of a round and chooses the patches to split.
  std::vector<uint8_t> chosen_to_split(const PatchMap& map, const Etendue& etendue,
                                       const OwnCuts& cuts) {
    std::vector<uint8_t> chosen = straddling_any(etendue, cuts, settings_.straddle_share);
    size_t split = 0;
    for (size_t i = 0; i < chosen.size(); ++i) {
      if (map.is_sky(static_cast<uint32_t>(i)) ||
          map.keys()[i].level >= map.fine_level() + kDeepestSplit)
        chosen[i] = 0;
      split += chosen[i];
    }
    report_.split += split;
    report_.by_round.push_back({cuts.cuts.size(), cuts.conductance, split, 0});
    return chosen;
  }

  LightFlow estimate(PatchMap map) {
    report_.rays += settings_.rays;
    return light_flow(std::move(map), walks_, tracer_,
                      settings_.walks.seed + estimates_++ * 0x10001, settings_.rays);
  }

  const Scene& scene_;
  GraphSettings settings_;
  GraphReport& report_;
  const std::vector<uint32_t> component_;
  const Tracer tracer_;  // constructed after steps with a high temporary memory use
  BothWalks walks_;
  GridOfWalks grid_;
  uint64_t estimates_ = 0;
};

}  // namespace

LightFlow build_graph(const Scene& scene, const std::vector<Camera>& cameras,
                      const GraphSettings& settings, const CutFile* refine, GraphReport& report) {
  Rounds rounds(scene, cameras, settings, report);
  LightFlow flow = refine ? rounds.by_cut(*refine) : rounds.by_itself();
  for (size_t i = 0; i < flow.hits_light.size(); ++i) {
    bool viewed = false;
    for (size_t k = 0; k < cameras.size(); ++k)
      viewed |= flow.lit[k] && flow.hits_cameras[k][i] > 0;
    report.reached_by_both += viewed && flow.hits_light[i] > 0;
  }
  report.phases.done("patches");
  return flow;
}

}  // namespace tdpt
