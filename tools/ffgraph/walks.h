// Random walks from the lights and from the camera: which surfaces matter, and how strongly each
// end reaches them. All surfaces are diffuse and nothing is absorbed. The walks replace the paper's
// sets S_d and S_p, which contain direct light only.
#pragma once
#include <cstdint>
#include <vector>

#include "libcommon/scene/scene.h"
#include "libcommon/scene/sky_bins.h"
#include "libcommon/trace/tracer.h"
#include "tools/ffgraph/sky_lines.h"

namespace tdpt {

struct WalkSettings {
  uint64_t seed = 1;
  uint32_t walks = 100000;  ///< from each end
  uint32_t bounces = 12;    ///< surfaces hit by one walk at most
};

struct WalkHit {
  uint32_t face;   ///< 2 * triangle + side, or one of the end marks after a walk's last hit
  Vec3f position;  ///< canonical
};
inline constexpr uint32_t kWalkLeft = UINT32_MAX - 1;     ///< the walk left the scene
inline constexpr uint32_t kWalkStopped = UINT32_MAX - 2;  ///< it had hit `bounces` surfaces
/// The walk left the scene towards bin h.face - kWalkToSky of the sky; only if light comes from
/// there.
inline constexpr uint32_t kWalkToSky = kWalkStopped - kSkyBins;
constexpr bool is_hit(const WalkHit& h) {
  return h.face < kWalkToSky;
}
constexpr bool to_sky(const WalkHit& h) {
  return h.face >= kWalkToSky && h.face < kWalkStopped;
}

/// The hits of all walks, walk by walk, each followed by its end mark. No absorption: a walk ends
/// when it leaves the scene or after `bounces` surfaces.
using Walks = std::vector<WalkHit>;
Walks light_walks(const Scene& scene, const Tracer& tracer, const WalkSettings& settings);
/// The same; walks from infinity begin on `lines`.
struct SkyStarts {
  std::vector<double> begun;  ///< per bin of the sky: walks from it that hit a surface
  std::vector<size_t> hits;   ///< indices of the hits of walks from the sky
};
Walks light_walks(const Scene& scene, const Tracer& tracer, const WalkSettings& settings,
                  const SkyLines& lines, SkyStarts& starts);
Walks camera_walks(const Scene& scene, const Camera& camera, const Tracer& tracer,
                   const WalkSettings& settings);
/// Starts of the light walks that begin on a surface.
std::vector<WalkHit> light_starts(const Scene& scene, const WalkSettings& settings);
size_t hits_in(const Walks& walks);

}  // namespace tdpt
