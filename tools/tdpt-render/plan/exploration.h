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
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "libcommon/formats/portal.h"
#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {

/// Which way a portal works: with the light that reaches the camera, since a portal that faces the
/// wrong way costs time and finds no light, and modelling programs do not show the way it faces.
enum class PortalWay {
  as_drawn,  ///< as its file says
  front,     ///< only from its back to its front
  back,      ///< only from its front to its back: turned round
  both,
  left_out  ///< no light passes it
};

/// The way in which a portal should work. `passed`: light along its normal and against it; `sure`:
/// the same without the brightest sample, 0 if fewer than 10 samples carried any; `total`: of the
/// whole picture; `wide`: whether is_wide(). As drawn if less than a thousandth of the light passed
/// either way for sure. Otherwise in each way that carries at least a fifth of its light: some
/// light always turns back, at the jambs of a thick wall or in the room behind, and segments that
/// way are wasted. Measured with tdpt-guided: keeping a way that carried 7 to 9 % (a hole of
/// 0.10 m, a window of 1.6 m) took 1.6 to 2 times the work for the same error. A wide portal works
/// one way, as drawn or else the way of the most light: across the middle of a room both ways took
/// 3 times the work of one.
PortalWay way_of(bool drawn_both_ways, const std::array<double, 2>& passed,
                 const std::array<double, 2>& sure, double total, bool wide);

/// Conductance of a portal without figures, such as one drawn by hand: the share of the diffuse
/// bounces whose next edge crosses it, on the side where it is larger. In a closed room it is the
/// area of the opening over that of the room's surface, the conductance of cut(5).
/// Method: conductance of the room's random walk (Cheeger), by Monte Carlo. Diffuse walks begin in
/// the portal; takes some ten thousand rays; a function of its arguments alone.
double probed_conductance(const World& world, const Portal& portal);
/// Whether its conductance is above 0.066.
bool is_wide(const World& world, const Portal& portal);

/// Makes each portal work its way; one that is left out keeps the figure of its area but no
/// triangles. Throws std::out_of_range for a portal that does not exist.
void apply_ways(const std::vector<PortalWay>& ways, std::vector<Portal>& portals);

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
  double samples = 0;                ///< that were asked for; 0: nothing was explored
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
