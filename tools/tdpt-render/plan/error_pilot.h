// How many samples a picture needs for a relMSE that is asked for, told before it is rendered: two
// stages, as Stein's for a mean, so that when to stop does not depend on the picture's own samples.
// Eight parts of the picture with random numbers of their own are rendered, twice as many samples
// each time, until they tell enough [error_estimate.h]; they are thrown away.
#pragma once
#include <functional>
#include <optional>

#include "tools/tdpt-render/integrators/sample_renderer.h"
#include "tools/tdpt-render/plan/error_estimate.h"

namespace tdpt {

struct ErrorPilot {
  static constexpr uint64_t kParts = kErrorPilotRounds.count;
  /// Of parts of so many samples of each pixel.
  struct Round {
    uint64_t samples = 0;
    ErrorEstimate estimate;
  };
  std::vector<Round> rounds;  ///< each of twice as many; none: it was given up before that
  uint64_t needed = 0;        ///< samples of each pixel; 0: it is not known

  uint64_t part_samples() const { return rounds.empty() ? 0 : rounds.back().samples; }
  /// That tells most of a picture of `samples`: the last one that is no larger, since relMSE falls
  /// as 1/N at least; where that one tells too little, or there is none, the next that tells
  /// enough. There is a round.
  const Round& about(uint64_t samples) const;
};

/// Sums over those samples of a part, pixel by pixel; nothing to give up.
using DrawPart =
    std::function<std::optional<std::vector<Vec3d>>(uint64_t part, const SampleRange& samples)>;

/// `most`: samples of each pixel that the picture will have at the most.
ErrorPilot run_error_pilot(uint64_t pixels, double target, uint64_t most, const DrawPart& draw);

/// Gives up soon after `give_up` says so. The film is as large as the picture; it is left empty.
ErrorPilot run_error_pilot(SampleRenderer& renderer, const Integrator& integrator,
                           const SampleRules& rules, double target, uint64_t most,
                           const std::function<bool()>& give_up, Film& film, Progress& progress);

}  // namespace tdpt
