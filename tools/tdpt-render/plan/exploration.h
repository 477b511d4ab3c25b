// A first look at a scene, before anything is chosen: a few samples of the picture, which several
// observers see and which are then thrown away, so that nothing they decide can bias the picture.
//
// Method: a small picture is rendered by tdpt-guided through all portals, each working both ways,
// one sample of each pixel. Every path that brings light, whichever technique made it, is seen with
// its weighted luminance by those who ask which way light passes portals [portal_ways.h], which
// kind of light arrives [arrival.h], and what a limit of depth leaves out [truncation.h].
#pragma once
#include <optional>

#include "tools/tdpt-render/path/sample/world.h"
#include "tools/tdpt-render/plan/arrival.h"
#include "tools/tdpt-render/plan/portal_ways.h"
#include "tools/tdpt-render/plan/truncation.h"

namespace tdpt {

struct Explored {
  std::vector<PortalWay> ways;     ///< by portal
  std::vector<PortalLight> light;  ///< by portal
  Lights::KindProbabilities arriving;
  std::optional<Truncation> beyond;  ///< where there is a limit of depth
  uint64_t samples = 0;              ///< that were drawn
};

/// Share of a picture's samples that it may take, beside a pilot and where there is none, and how
/// many are enough or tell nothing.
inline constexpr double kShareBesidePilot = 0.005, kShareAlone = 0.02, kExplorationEnough = 3072,
                        kExplorationFewest = 128;

/// A function of scene, camera, aspect of the picture, portals, rules and `samples`: the small
/// picture has about so many pixels, and a second one, for portals that few samples of the first
/// passed, as many again. `world` must hold the portals' scene; it is as before afterwards.
Explored explore(World& world, const Camera& camera, const std::vector<Portal>& portals,
                 int max_depth, uint64_t seed, double samples = kExplorationEnough);

}  // namespace tdpt
