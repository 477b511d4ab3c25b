// Etendue between patches: how much diffuse light each pair can exchange.
//
// Method: Monte Carlo with rays from uniform points on the patches along cosine-distributed
// directions to the closest hit. The count n_ij estimates A_i F_ij + A_j F_ji [eq. 9]. It is
// additive, so invariant under subdivision, and has no singularity where patches touch.
//
// A_i area of patch i, F_ij form factor: the share of the light leaving i that arrives at j.
//
// Steps of walks over diffuse surfaces are such rays, too, except that they start where the walk
// is: the same share of the rays that leave patch i arrives at j. With q_i rays that start on patch
// i for each of its samples and C_ij rays from i to j,
//   n_ij = 2 (C_ij + C_ji) / (q_i + q_j)
// is the maximum-likelihood estimate. So the walks also help to find a hole that few rays pass.
#pragma once
#include <cstdint>
#include <vector>

#include "libcommon/math/rng.h"
#include "libcommon/trace/tracer.h"
#include "tools/ffgraph/patch_map.h"

namespace tdpt {

/// The surface of patches: each triangle clipped to the cells it crosses.
class Fragments {
 public:
  struct Fragment {
    uint32_t patch, face;
    double area;     ///< canonical
    Vec3d centroid;  ///< canonical
  };

  /// `grow`: null, or `patches`, to which are first added all cells of split patches that contain a
  /// piece of their surface: what a walk touched remains complete when it is split.
  explicit Fragments(const PatchMap& patches, PatchMap* grow = nullptr);

  /// Ordered by patch, then by face.
  const std::vector<Fragment>& all() const { return fragments_; }

  /// `numbers`: of PatchMap::keep, which must have kept all that have fragments.
  void renumber(const std::vector<uint32_t>& numbers);

  struct Point {
    uint32_t patch;
    Vec3d position, normal;  ///< canonical; on the facing side
  };
  /// Uniform by area on fragment `f`: uses 3 dimensions of `rng`.
  Point sample(uint32_t f, Rng& rng) const;

 private:
  struct Part;
  struct Walker;
  const PatchMap& patches_;
  std::vector<Fragment> fragments_;
};

struct Etendue {
  struct Pair {
    uint32_t i, j;  ///< patches, i < j
    double count;   ///< n_ij, rays in both directions [samples]
  };
  std::vector<Pair> pairs;  ///< sorted
  std::vector<double>
      samples;  ///< n_i: expected number of samples on patch i, in proportion to its area
};

/// The patches that walks visited: the patch of each hit, kNoPatch if there is none; after each
/// walk the patch of the sky to which it left, kNoPatch if there is none, or kTraceStopped if it
/// stopped on a surface.
using PatchTrace = std::vector<uint32_t>;
inline constexpr uint32_t kTraceStopped = UINT32_MAX - 1;

/// Uses `rays` samples and the steps of `walks`. A patch at level l is sampled 4^(l - L) times as
/// densely per area (up to 4^2), L: level of the fine region, so that the small pieces of a split
/// patch get rays and the ground around a house does not take those of its rooms. Rays that leave
/// the scene go to the patches of the sky, whose samples are half the sum of their n_ij, since all
/// light that they send arrives.
Etendue measure_etendue(const PatchMap& patches, const Fragments& fragments, const Tracer& tracer,
                        uint64_t seed, uint32_t rays, const std::vector<PatchTrace>& walks = {});

}  // namespace tdpt
