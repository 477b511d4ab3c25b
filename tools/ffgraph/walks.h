// Which surfaces matter, and how strongly each end of the transport reaches them: random walks from
// the lights and from the camera over the scene with all surfaces diffuse and nothing absorbed, in
// the place of the paper's sets S_d and S_p, which know direct light alone.
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
  uint32_t face;   ///< 2 * triangle + side, or one of the marks behind a walk's last hit
  Vec3f position;  ///< canonical
};
inline constexpr uint32_t kWalkLeft = UINT32_MAX - 1;     ///< the walk left the scene
inline constexpr uint32_t kWalkStopped = UINT32_MAX - 2;  ///< it had hit `bounces` surfaces
/// The walk left the scene towards a bin of the sky, number h.face - kWalkToSky; only where light
/// comes from there.
inline constexpr uint32_t kWalkToSky = kWalkStopped - kSkyBins;
constexpr bool is_hit(const WalkHit& h) {
  return h.face < kWalkToSky;
}
constexpr bool to_sky(const WalkHit& h) {
  return h.face >= kWalkToSky && h.face < kWalkStopped;
}

/// All hits of all walks, walk by walk, each with its mark. No absorption: a walk ends when it
/// leaves the scene or after `bounces` surfaces.
using Walks = std::vector<WalkHit>;
Walks light_walks(const Scene& scene, const Tracer& tracer, const WalkSettings& settings);
/// The same; those from infinity begin on `lines`.
struct SkyStarts {
  std::vector<double> begun;  ///< of each bin of the sky: how many came to a surface
  std::vector<size_t> hits;   ///< which of all hits are of walks from there
};
Walks light_walks(const Scene& scene, const Tracer& tracer, const WalkSettings& settings,
                  const SkyLines& lines, SkyStarts& starts);
Walks camera_walks(const Scene& scene, const Camera& camera, const Tracer& tracer,
                   const WalkSettings& settings);
/// Where the light's walks begin, those that begin on a surface.
std::vector<WalkHit> light_starts(const Scene& scene, const WalkSettings& settings);
size_t hits_in(const Walks& walks);

}  // namespace tdpt
