// The sky as surfaces: a dome of triangles far around a scene, one for each bin of directions
// (sky_bins.h). Lines of light that come from the sky begin on it, and those that leave the scene
// end on it, as on any patch.
#pragma once
#include "libcommon/formats/cut.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

/// Of the dome [canonical]: directions to a bin differ by 3 degrees at most over a scene.
inline constexpr float kDomeRadius = 32;

/// Whether a cut has directions of the sky among its nodes.
bool has_sky(const CutFile& cut);

/// Adds the dome behind all triangles, facing inwards, and sets `scene.dome`.
void add_sky_dome(Scene& scene);

/// Face of a bin of the sky, seen from within.
inline uint32_t dome_face(const Scene& scene, int32_t bin) {
  return 2 * (scene.dome + static_cast<uint32_t>(bin));
}

}  // namespace tdpt
