// A first look at a scene, before anything is chosen: a few samples, which several observers see
// and which are then thrown away, so that no decision made from them can bias the picture.
//
// Method: tdpt-guided renders a small picture, one sample per pixel, through all portals, each
// working both ways. Every path that carries light, whichever technique made it, is passed with its
// weighted luminance to the observers: which way light passes portals [portal_ways.h], which kind
// of light arrives [arrival.h], and how much a limit of depth leaves out [truncation.h].
#pragma once
#include <optional>

#include "tools/tdpt-render/path/sample/world.h"
#include "tools/tdpt-render/plan/arrival.h"
#include "tools/tdpt-render/plan/portal_ways.h"
#include "tools/tdpt-render/plan/truncation.h"

namespace tdpt {

struct Explored {
  std::vector<PortalWay> ways;       ///< which way portals work; empty: as drawn
  Lights::KindProbabilities lights;  ///< selection probability of each kind
  std::optional<Truncation> beyond;  ///< light lost by the limit of depth, if there is one
  uint64_t samples = 0;              ///< drawn for it
  double cpu_seconds = 0;
};

/// Share of a picture's samples that it may take, with a pilot and without, and the bounds of their
/// number.
inline constexpr double kShareBesidePilot = 0.005, kShareAlone = 0.02, kExplorationEnough = 3072,
                        kExplorationFewest = 128;

/// A function of scene, camera, aspect of the picture, portals, rules and `samples`. The small
/// picture has about `samples` pixels; a second one, for portals that few samples of the first
/// passed, has as many. Next events towards the sky are those of `vista`.
Explored explore(const Vista& vista, const Camera& camera, const std::vector<Portal>& portals,
                 int max_depth, uint64_t seed, double samples = kExplorationEnough);

}  // namespace tdpt
