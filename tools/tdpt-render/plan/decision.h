// Everything decided before the first sample of a picture: the integrator and the number of
// samples.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "tools/tdpt-render/plan/pilot.h"
#include "tools/tdpt-render/plan/plan.h"
#include "tools/tdpt-render/plan/sample_count.h"

namespace tdpt {

/// What the exploration found, for the plan.
struct Known {
  std::vector<PortalWay> ways;       ///< which way portals work; empty: as drawn
  std::optional<Truncation> beyond;  ///< light lost by the limit of depth
};

/// What was measured before the first sample and is told with the picture, whoever ends it.
struct Measured {
  Forecast forecast;           ///< of the candidates; without estimates if no pilot ran
  uint64_t pilot_samples = 0;  ///< samples behind the forecast
  double pilot_cpu_seconds = 0;
};

struct Decision : Measured {
  Plan plan;               ///< everything decided by measuring
  bool cut_short = false;  ///< by a signal: another run would decide otherwise
  SampleCount count;
  std::optional<int> longest;  ///< path worth sampling, if shorter than asked [longest_path.h]
  size_t chosen = 0;           ///< index of the candidate that renders
  std::string chosen_label;    ///< empty when there is only one
};

/// The best candidate, found by a pilot if the budget allows one [pilot.h], else the first; and its
/// number of samples. `film`: empty, of the picture's size; it is left empty.
Decision decided(Session& session, const std::vector<Candidate>& candidates, const Known& known,
                 Film& film);
/// The decision that a plan records.
Decision obeyed(const Plan& plan, const Session& session, const std::vector<Candidate>& candidates);

}  // namespace tdpt
