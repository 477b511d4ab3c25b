// Random walks from the lights and from the camera: which surfaces matter, and how strongly each
// end reaches them. All surfaces are diffuse and nothing is absorbed. The walks replace the paper's
// sets S_d and S_p, which contain direct light only.
#pragma once
#include <cstdint>
#include <vector>

#include "libcommon/math/discrete.h"
#include "libcommon/math/reach.h"
#include "libcommon/math/rng.h"
#include "libcommon/scene/scene.h"
#include "libcommon/scene/sky_bins.h"
#include "libcommon/trace/tracer.h"
#include "tools/ffgraph/patch_map.h"

namespace tdpt {

// Light from infinity for the light walks: which part of the sky a line comes from, and where it is
// aimed.
//
// A small window in a wide landscape would be hit by few of the lines spread over all of it. So
// half of the lines are aimed at a ball around what the camera walks reach, a quarter at a wider
// one, the rest at the whole scene. Windows that face away from the sun count, too: half of the
// lines come from the sky in proportion to light, half from all bins that shine, by solid angle and
// grade.

/// Unary terms of the bins of a sky: min(1, L_k / (0.5 L_med)), L_k = light_k / solid angle, L_med
/// the median of L over the bins that shine, weighted by solid angle.
std::vector<double> sky_grades(const std::vector<double>& light);

class SkyLines {
 public:
  struct Ball {
    Vec3d centre;  ///< canonical
    double radius;
  };

  /// `aim`, `wider`: targets of the first half and the next quarter of the lines. `scene` must be
  /// lit from infinity.
  SkyLines(const Scene& scene, const Extent& aim, const Extent& wider);

  struct Line {
    Vec3d origin, direction;  ///< canonical; outside the scene, unit
    uint32_t bin;             ///< where it comes from
    double power;             ///< luminance / density of the line: the light it stands for
  };
  Line draw(Rng& rng) const;

 private:
  struct Towards {
    Vec3d w;
    double per_pdf;  ///< luminance / density of the direction [1/sr]; of a lamp its irradiance over
                     ///< its probability
  };
  Towards towards(Rng& rng) const;
  double density_across(const Vec3d& through, const Vec3d& w) const;

  std::vector<Ball> balls_;         // aim, wider, all
  SkyDirections directions_;        // of the sky
  std::vector<Vec3d> parallel_;     // directions towards the lamps
  std::vector<double> irradiance_;  // across them, luminance
  const Sky* sky_ = nullptr;
  AliasTable lights_;  // the lamps, then the sky
  AliasTable bins_;    // by grade and solid angle
};

struct WalkSettings {
  uint64_t seed = 1;
  uint32_t walks = 100000;  ///< from each end
  uint32_t bounces = 12;    ///< surfaces hit by one walk at most
};

// End marks of walks [WalkHit].
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
  std::vector<double> power;   ///< per walk: the light that it stands for [any unit]
  std::vector<WalkHit> start;  ///< per walk: where it begins; face kNoFace: not on a surface
  std::vector<uint32_t> bin;   ///< per walk from infinity its bin, else kSkyBins; empty: none
  bool from_sky(size_t walk) const { return !bin.empty() && bin[walk] < kSkyBins; }
};
/// `lines`: where walks from infinity begin; null: outside the scene, spread over all of it.
LightWalks light_walks(const Scene& scene, const Tracer& tracer, const WalkSettings& settings,
                       const SkyLines* lines = nullptr);
Walks camera_walks(const Scene& scene, const Camera& camera, const Tracer& tracer,
                   const WalkSettings& settings);
size_t hits_in(const Walks& walks);

/// The size of patches: chosen by the region that walks reach, not by the scene's bounding box,
/// which a ground or a sky may make a hundred times as large as the rooms.
struct GridOfWalks {
  PatchGrid grid;
  FineRegion fine;
};

/// Cells of (diagonal of the region) / `cells` in and around the region, of several cameras the
/// median of theirs, at least half as large as for all; outside 4 times as large, or 16 times and
/// so on, if the scene is that much larger than the region. The region contains most hits of light
/// walks and most of each camera's walks (reach.h); only those of camera walks if light comes from
/// infinity.
GridOfWalks grid_for(const Scene& scene, const Walks& light, const std::vector<Walks>& cameras,
                     double cells);

}  // namespace tdpt
