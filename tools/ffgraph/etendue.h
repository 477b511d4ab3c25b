// Etendue between patches, by rays [DESIGN 3.1]: points uniform by area on the patches, cosine
// directions, closest hit. The count n_ij estimates A_i F_ij + A_j F_ji, which is additive, so
// invariant under subdivision, and has no singularity where patches touch.
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

/// `rays` samples. A patch at level l is sampled 4^l times as densely per area (up to 4^2), and its
/// samples count 1/4^l: so the splinters of a split patch are not left without rays.
Etendue measure_etendue(const PatchMap& patches, const Fragments& fragments, const Tracer& tracer,
                        uint64_t seed, uint32_t rays);

}  // namespace tdpt
