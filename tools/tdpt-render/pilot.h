// How many samples a picture needs for a relMSE that is asked for, told before it is rendered: two
// stages, as Stein's for a mean, so that when to stop does not depend on the picture's own samples.
// Eight parts of the picture with random numbers of their own are rendered, twice as many samples
// each time, until they tell enough [error_estimate.h]; they are thrown away.
#pragma once
#include <functional>
#include <optional>

#include "tools/tdpt-render/error_estimate.h"
#include "tools/tdpt-render/passes.h"

namespace tdpt {

struct Pilot {
  static constexpr uint64_t kParts = 8;
  ErrorEstimate estimate;     ///< of a part
  uint64_t part_samples = 0;  ///< of each pixel in each part; 0: it was given up before that
  uint64_t needed = 0;        ///< samples of each pixel; 0: it is not known
};

/// Sums over those samples of a part, pixel by pixel; nothing to give up.
using DrawPart =
    std::function<std::optional<std::vector<Vec3d>>(uint64_t part, const SampleRange& samples)>;

/// `most`: samples of each pixel that the picture will have at the most.
Pilot run_pilot(uint64_t pixels, double target, uint64_t most, const DrawPart& draw);

/// Gives up soon after `give_up` says so. The film is as large as the picture; it is left empty.
Pilot run_pilot(const World& world, const Integrator& integrator, const SampleRules& rules,
                double target, uint64_t most, const std::function<bool()>& give_up, Film& film,
                Progress& progress);

}  // namespace tdpt
