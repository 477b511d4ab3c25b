// A first look at a scene, before anything is chosen: a few samples that are then thrown away, so
// that no decision made from them can bias the picture.
//
// Method: tdpt-guided renders a small picture, one sample per pixel, through all portals, each
// working both ways. From every path that carries light, whichever technique made it, three things
// are estimated by its weighted luminance:
//   which way light passes each portal, E(portal, way) = sum over paths of w * value * crossings
//     (the camera's own edge never counts). So the picture's own light decides, from lamps with and
//     without surface alike.
//   how much light arrives from each kind of light, for the selection of lights when there is a sky
//     beside other lights: by power alone a sky would outrank every lamp indoors.
//   how much light a limit of depth leaves out: a ratio estimator over groups of samples, its error
//     by the delta method.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "tools/tdpt-render/plan/portal_ways.h"

namespace tdpt {

/// Light of paths of more than `depth` edges.
struct Truncation {
  int depth = 0;
  double share = 0;  ///< of all light, [0,1]
  double error = 0;  ///< standard error of the share
};
/// "--max-depth 6 leaves out about 25 % of the light".
std::string sentence(const Truncation& beyond);

struct Explored {
  /// By portal; empty: all as drawn. Portals beyond the first 16 stay as drawn. If 100 samples
  /// carried light, a portal is left out that less than a ten-thousandth of the light passed, or
  /// that fewer than 10 samples passed in a picture without the others.
  std::vector<PortalWay> ways;
  /// Selection probability of each kind: nine tenths by what arrived, one tenth by power; all by
  /// power if nothing arrived. A single path counts for at most a tenth of the total.
  Lights::KindProbabilities lights;
  std::optional<Truncation> beyond;  ///< light lost by the limit of depth, if there is one
  uint64_t samples = 0;              ///< drawn for it
  double cpu_seconds = 0;
};

/// Share of a picture's samples that it may take, with a pilot and without, and the bounds of their
/// number.
inline constexpr double kShareBesidePilot = 0.005, kShareAlone = 0.02, kExplorationEnough = 3072,
                        kExplorationFewest = 128;

/// A function of scene, camera, aspect of the picture, portals, rules and `samples`. The small
/// picture has about `samples` pixels; a second one, for portals that got next to no segments
/// beside larger ones, has as many. Next events towards the sky are those of `vista`.
Explored explore(const Vista& vista, const Camera& camera, const std::vector<Portal>& portals,
                 int max_depth, uint64_t seed, double samples = kExplorationEnough);

}  // namespace tdpt
