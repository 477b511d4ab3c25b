// Which way the light that reaches the camera passes each portal, found before rendering: a portal
// that faces the wrong way costs time and brings nothing, and modelling programs do not tell.
//
// A small picture is rendered by tdpt-guided through all portals, each working both ways. Every
// path that brings light, whichever technique made it, adds its weighted luminance to each portal
// and way that one of its edges crosses (the camera's own edge never counts):
//   E(portal, way) = sum over paths of w * value * crossings,
// so what is compared is the light of the picture itself, of lamps with and without surface alike.
#pragma once
#include <vector>

#include "libcommon/formats/portal.h"
#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {

/// Which way a portal works in a rendering.
struct PortalWay {
  size_t portal = 0;
  enum Way {
    as_drawn,  ///< as its file says
    front,     ///< from its back to its front alone
    back,      ///< from its front to its back alone: turned round
    both,
    left_out  ///< no light passes it
  } way = as_drawn;
  friend bool operator==(const PortalWay&, const PortalWay&) = default;
};

/// The light that passed a portal one way.
struct PassedLight {
  uint64_t samples = 0;  ///< that brought any
  double energy = 0;     ///< sum of luminance
  double brightest = 0;  ///< the most that one sample brought
};

/// What the light says of one portal. `with`: along its normal. `total`: of the whole picture.
/// As drawn where fewer than 10 samples, or less than a thousandth of the light, passed either way.
/// Else it works the ways that a fifth of its light and more goes: some always turns back, at the
/// jambs of a thick wall or in the room behind, and segments that way are lost on it. Measured with
/// tdpt-guided: to keep a way that 7 to 9 % went (a hole of 0.10 m, a window of 1.6 m) took 1.6 to
/// 2 times the work for the same error. What has to be much is counted without its brightest
/// sample. `wide`: its conductance is above 0.066. Then it works one way, that drawn or else that
/// of the most light: across the middle of a room both ways took 3 times the work of one.
PortalWay::Way way_of(bool drawn_both_ways, const PassedLight& with, const PassedLight& against,
                      double total, bool wide);

/// What a small picture showed of the light that passes a portal.
struct PortalLight {
  uint64_t samples = 0, of = 0;  ///< samples whose light passed it, of all; 0 of 0: not measured
  double share = 0;              ///< of the picture's light
};
struct PortalProbe {
  std::vector<PortalWay> ways;
  std::vector<PortalLight> light;
};

/// For each portal which way it should work; those beyond the first 16 as drawn. Where 100 samples
/// brought light, one is left out that less than a ten thousandth of it passed, or that fewer than
/// 10 samples passed in a picture without the others. A function of
/// scene, camera, aspect of the picture, portals, depth, seed and `samples`, of which two small
/// pictures at most have about so many each; kProbeSamples are enough. `world` must hold the
/// portals' scene; it is as before afterwards.
inline constexpr double kProbeSamples = 3072;
PortalProbe probe_ways(World& world, const Camera& camera, const std::vector<Portal>& portals,
                       int max_depth, uint64_t seed, double samples = kProbeSamples);

/// Makes the portals work that way; one that is left out keeps its area as a figure and no
/// triangle. Throws std::out_of_range for one that there is not.
void apply_ways(const std::vector<PortalWay>& ways, std::vector<Portal>& portals);

}  // namespace tdpt
