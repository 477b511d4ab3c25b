// Etendue between patches: how much diffuse light each pair can exchange.
//
// Method: Monte Carlo, by rays from points uniform by area on the patches along cosine directions
// to the closest hit. The count n_ij estimates A_i F_ij + A_j F_ji [eq. 9], which is additive, so
// invariant under subdivision, and has no singularity where patches touch.
//
// A_i area of patch i, F_ij form factor: the share of the light that leaves i and arrives at j.
//
// Steps of walks over diffuse surfaces are such rays, too, but that they start where the walk is:
// of the rays that leave patch i the same share arrives at j. With q_i rays that start on patch i
// for each of its samples and C_ij rays from i to j,
//   n_ij = 2 (C_ij + C_ji) / (q_i + q_j)
// is the estimate of maximum likelihood. So a hole that few rays find is found by the walks, too.
#pragma once
#include <cstdint>
#include <vector>

#include "libcommon/trace/tracer.h"
#include "tools/ffgraph/fragments.h"

namespace tdpt {

struct Etendue {
  struct Pair {
    uint32_t i, j;  ///< patches, i < j
    double count;   ///< n_ij, rays from either end to the other [samples]
  };
  std::vector<Pair> pairs;  ///< sorted
  std::vector<double>
      samples;  ///< n_i: expected number of samples on patch i, in proportion to its area
};

/// Patches that walks came by: the patch of each hit, kNoPatch where there is none, one of the two
/// marks behind each walk.
using PatchTrace = std::vector<uint32_t>;
inline constexpr uint32_t kTraceLeft = UINT32_MAX - 1, kTraceStopped = UINT32_MAX - 2;

/// `rays` samples, and the steps of `walks`. A patch at level l is sampled 4^(l - L) times as
/// densely per area (up to 4^2), L: level of the fine region. Rays that leave the scene go to the
/// patches of the sky, whose samples are half the sum of their n_ij, as all light that they send
/// arrives. So the splinters of a split patch are
/// not left without rays, and the ground around a house does not take those of its rooms.
Etendue measure_etendue(const PatchMap& patches, const Fragments& fragments, const Tracer& tracer,
                        uint64_t seed, uint32_t rays, const std::vector<PatchTrace>& walks = {});

}  // namespace tdpt
