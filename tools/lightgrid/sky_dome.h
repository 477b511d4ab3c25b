// The sky as surfaces: a distant dome of triangles around a scene, one per bin of directions
// (sky_bins.h). Lines of light from the sky begin on it, and lines that leave the scene end on it,
// as on any patch.
#pragma once
#include "libcommon/formats/cut.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

/// Radius of the dome [canonical]: the direction to a bin varies by at most 3 degrees over a scene.
inline constexpr float kDomeRadius = 32;

/// Whether a cut has sky directions among its nodes.
bool has_sky(const CutFile& cut);

/// Adds the dome after all triangles, facing inwards, and sets `scene.dome`.
void add_sky_dome(Scene& scene);

/// The face of a sky bin, seen from inside.
inline uint32_t dome_face(const Scene& scene, int32_t bin) {
  return 2 * (scene.dome + static_cast<uint32_t>(bin));
}

}  // namespace tdpt
