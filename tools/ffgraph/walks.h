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

struct LightWalks {
  Walks hits;
  std::vector<double> power;  ///< per walk: the light that it stands for [any unit]

  /// Where walks begin: on a face, or in a bin of the sky.
  struct Start {
    uint32_t walk;
    WalkHit at;  ///< face kNoFace: not on a surface
  };
  std::vector<Start> starts;  ///< of the walks that begin on a surface
  std::vector<uint32_t> bin;  ///< per walk from infinity its bin, else kSkyBins; empty: none
  bool from_sky(size_t walk) const { return !bin.empty() && bin[walk] < kSkyBins; }
};
/// `lines`: where walks from infinity begin; null: outside the scene, spread over all of it.
LightWalks light_walks(const Scene& scene, const Tracer& tracer, const WalkSettings& settings,
                       const SkyLines* lines = nullptr);
Walks camera_walks(const Scene& scene, const Camera& camera, const Tracer& tracer,
                   const WalkSettings& settings);
size_t hits_in(const Walks& walks);

}  // namespace tdpt
