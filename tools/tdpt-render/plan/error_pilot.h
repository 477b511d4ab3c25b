// How many samples a picture needs to meet a given relMSE, estimated before it is rendered.
//
// Method: two-stage sampling, as Stein's for a mean, so that the stopping point does not depend on
// the picture's own samples. Eight parts with random numbers of their own are rendered with
// doubling numbers of samples until their estimate suffices [error_estimate.h]; they are thrown
// away.
#pragma once
#include <functional>
#include <optional>

#include "tools/tdpt-render/integrators/sample_renderer.h"
#include "tools/tdpt-render/plan/error_estimate.h"

namespace tdpt {

struct ErrorPilot {
  static constexpr uint64_t kParts = kErrorPilotRounds.count;
  /// Parts of that many samples per pixel.
  struct Round {
    uint64_t samples = 0;
    ErrorEstimate estimate;
  };
  std::vector<Round> rounds;  ///< each of twice as many samples; none: given up before the first
  uint64_t needed = 0;        ///< samples per pixel; 0: unknown

  uint64_t part_samples() const { return rounds.empty() ? 0 : rounds.back().samples; }
  uint64_t samples() const { return kParts * part_samples(); }  ///< per pixel, thrown away
  /// The round that best predicts a picture of `samples`: the last that is no larger, since relMSE
  /// falls at least as 1/N; if there is none, or its estimate does not suffice, the next that does.
  /// Needs a round.
  const Round& about(uint64_t samples) const;
};

/// Sums over those samples of a part, by pixel; nothing to give up.
using DrawPart =
    std::function<std::optional<std::vector<Vec3d>>(uint64_t part, const SampleRange& samples)>;

/// `most`: upper limit of the picture's samples per pixel.
ErrorPilot run_error_pilot(uint64_t pixels, double target, uint64_t most, const DrawPart& draw);

/// Gives up soon after `give_up` returns true. The film has the picture's size; it is left empty.
ErrorPilot run_error_pilot(SampleRenderer& renderer, const Integrator& integrator,
                           const SampleRules& rules, double target, uint64_t most,
                           const std::function<bool()>& give_up, Film& film, ProgressBar& progress);

}  // namespace tdpt
