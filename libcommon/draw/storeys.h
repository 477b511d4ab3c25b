// The storeys of a building, found from its geometry alone: a floor is a level surface from which a
// person who stands there has a ceiling over the head; a storey is a height at which there is much
// of that. Ground in the open has no ceiling, so that terrain, however large, is none.
#pragma once
#include <optional>
#include <vector>

#include "libcommon/trace/tracer.h"

namespace tdpt::draw {

/// All in metres, in the axes of the scene's file.
struct Storey {
  /// Empty in a scene without floors, which is shown as a whole.
  std::optional<double> floor;
  double cut = 0;              ///< height of its plan: eye height, lower under low ceilings
  double bottom = 0, top = 0;  ///< what its plan shows; top: just below the next floor, or infinity
  Vec3d low{}, high{};         ///< its floor's extent in x and z, with the walls around it
  std::vector<Vec3d> air;      ///< places at the height of the cut that are in the air
};

/// Ascending; empty if there is no floor. `tracer` is of `scene`.
std::vector<Storey> storeys_of(const Scene& scene, const Tracer& tracer);

/// The storeys to draw for a camera and other places to show: those with the camera or a good share
/// of the places, and those between, upwards. One at least.
std::vector<Storey> storeys_to_draw(const Scene& scene, const Tracer& tracer, const Vec3d& camera,
                                    const std::vector<Vec3d>& places);

}  // namespace tdpt::draw
