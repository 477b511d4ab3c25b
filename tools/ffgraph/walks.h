// Random walks from the lights and from the camera over the scene with all surfaces diffuse: they
// say which surfaces matter, and how strongly each end of the transport reaches them.
#pragma once
#include <cstdint>
#include <vector>

#include "libcommon/scene/scene.h"
#include "libcommon/trace/tracer.h"

namespace tdpt {

struct WalkSettings {
  uint64_t seed = 1;
  uint32_t walks = 100000;  ///< from each end
  uint32_t bounces = 12;    ///< surfaces hit by one walk at most
};

struct WalkHit {
  uint32_t face;   ///< 2 * triangle + side
  Vec3f position;  ///< canonical
};

/// All hits of all walks, walk by walk. No absorption: a walk ends when it leaves the scene or
/// after `bounces` surfaces.
std::vector<WalkHit> light_walks(const Scene& scene, const Tracer& tracer,
                                 const WalkSettings& settings);
std::vector<WalkHit> camera_walks(const Scene& scene, const Camera& camera, const Tracer& tracer,
                                  const WalkSettings& settings);

}  // namespace tdpt
