// The whole way from a scene to its network: walks, patches, etendue, and adaptive refinement,
// which splits the patches that straddle an opening: they leak more light than a small opening
// passes.
#pragma once
#include "libcommon/base/phases.h"
#include "tools/ffgraph/light_flow.h"

namespace tdpt {

struct GraphSettings {
  WalkSettings walks;
  uint32_t rays = 300000;  ///< etendue samples of one round
  int rounds = 1;          ///< refinements after the first estimate
  double cells = 24;       ///< along the diagonal of what the walks reach [patch_grid.h]
  double straddle_share = 0.92;
};

/// What a round of splitting did.
struct RoundReport {
  size_t openings = 0;     ///< cuts whose patches were looked at
  double conductance = 1;  ///< of the narrowest of them, as they were before
  size_t split = 0;        ///< patches that straddle one of them
  double cpu_seconds = 0;  ///< of looking, and of the estimate that followed
};

struct GraphReport {
  size_t light_walks = 0;                  ///< few where the camera sees nothing
  size_t light_hits = 0, camera_hits = 0;  ///< surfaces hit by the walks
  size_t rounds = 0;                       ///< refinements done
  size_t split = 0;                        ///< patches split in all of them
  uint64_t rays = 0;                       ///< etendue rays of all rounds
  std::vector<RoundReport> by_round;       ///< also that which found nothing to split
  size_t reached_by_both = 0;              ///< patches with hits from the light and the camera
  const char* why_stopped = "";            ///< completes "because ..."
  Phases phases;                           ///< surfaces, bvh, walks, patches
};

/// Throws InputError for `file` when the patches of `cut` cannot be those of `scene`.
void check_patches(const std::string& file, const Scene& scene, const CutFile& cut);

/// Conductance of the narrowest opening of a network, as rounds look for it; 1 where there is none.
double narrowest_opening(const LightFlow& flow);

/// Splits where the patches of `refine` (a cut of this scene) straddle its opening; without it
/// splits by cuts of its own, at most `rounds` times, and stops when nothing straddles. `refine`
/// has passed check_patches.
LightFlow build_graph(const Scene& scene, const Camera& camera, const GraphSettings& settings,
                      const CutFile* refine, GraphReport& report);

}  // namespace tdpt
