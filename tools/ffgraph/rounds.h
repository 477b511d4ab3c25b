// From a scene to its network: walks, patches, etendue, and adaptive refinement. Refinement splits
// the patches that straddle an opening: they leak more light than a small opening passes.
#pragma once
#include <numeric>
#include <vector>

#include "libcommon/base/process.h"
#include "tools/ffgraph/light_flow.h"

namespace tdpt {

struct GraphSettings {
  WalkSettings walks;
  uint32_t rays = 300000;  ///< etendue samples of one round
  int rounds = 1;          ///< refinements after the first estimate
  double cells = 24;       ///< along the diagonal of the region that the walks reach [grid_for]
  double straddle_share = 0.92;
};

/// One round of splitting.
struct RoundReport {
  size_t openings = 0;     ///< cuts whose patches were examined
  size_t split = 0;        ///< patches that straddle one of them
  double cpu_seconds = 0;  ///< of the examination and of the estimate after it
};

struct GraphReport {
  size_t light_hits = 0;            ///< surfaces hit by the walks
  std::vector<size_t> camera_hits;  ///< the same of each camera
  uint64_t rays = 0;                ///< etendue rays of all rounds
  std::vector<RoundReport> rounds;  ///< including the one that found nothing to split
  size_t reached_by_both = 0;       ///< patches with hits from the light and a camera
  const char* why_stopped = "";     ///< completes "because ..."

  size_t hits_of_cameras() const {
    return std::accumulate(camera_hits.begin(), camera_hits.end(), size_t{0});
  }
  /// Patches split in all rounds together.
  size_t split() const {
    size_t sum = 0;
    for (const RoundReport& round : rounds) sum += round.split;
    return sum;
  }
};

/// Throws InputError for `file` when the patches of `cut` cannot be those of `scene`.
void check_patches(const std::string& file, const Scene& scene, const CutFile& cut);

/// Splits where the patches of `refine` (a cut of this scene) straddle its opening. Without it,
/// makes cuts of its own, for at most `rounds` rounds, and stops when nothing straddles. `refine`
/// must have passed check_patches. The cameras must not differ in `culls`. Times the phases
/// surfaces, bvh, walks and patches.
LightFlow build_graph(const Scene& scene, const std::vector<Camera>& cameras,
                      const GraphSettings& settings, const CutFile* refine, GraphReport& report,
                      Phases& phases);

}  // namespace tdpt
