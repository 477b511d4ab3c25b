// Light paths of a diffuse scene, drawn in proportion to what they bring to the picture: the truth
// about which openings the camera's light passes.
//
// Method: plain path tracing with next-event estimation, thousands of times as many paths as are
// kept, resampled by luminance. It shares only rays and lights with the renderers.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libcommon/scene/scene.h"

namespace tdpt::testing {

/// From the light to the first surface that the camera sees [metres]. Light from the sky begins
/// outside the scene.
using LightPath = std::vector<Vec3d>;

struct LightPaths {
  std::vector<LightPath> paths;  ///< each brings the same share of the light
  double effective = 0;          ///< (sum of luminance)^2 / sum of its square, before resampling
};

/// `walks` from the camera, of at most `depth` edges with that to the camera; keeps at most `count`
/// paths. What the camera sees of the lights themselves does not count. Every surface is taken as
/// diffuse; glass lets pass what it transmits.
LightPaths light_paths(const Scene& scene, const Camera& camera, uint64_t walks, int depth,
                       size_t count);

/// A path per line, x y z of its corners; read_light_paths throws InputError.
std::string text_of(const LightPaths& paths);
LightPaths read_light_paths(const std::string& file);

}  // namespace tdpt::testing
