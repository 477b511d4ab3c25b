// All that is decided before the first sample of a picture: who renders it, and how many samples.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "tools/tdpt-render/plan/pilot.h"
#include "tools/tdpt-render/plan/plan.h"
#include "tools/tdpt-render/plan/sample_count.h"

namespace tdpt {

/// What was found out before, for the plan.
struct Known {
  std::vector<PortalWay> ways;       ///< which way portals work; empty: as drawn
  std::optional<Truncation> beyond;  ///< what the limit of depth leaves out
};

struct Decision {
  Plan plan;               ///< what was decided by measuring
  bool cut_short = false;  ///< a signal came before it was: another run would decide otherwise
  SampleCount count;
  std::optional<int> longest;  ///< path worth sampling, if shorter than asked [longest_path.h]
  size_t chosen = 0;           ///< which of the candidates renders
  std::string chosen_label;    ///< empty when there is only one
  Forecast forecast;           ///< of the candidates; no estimates where none was looked at
  uint64_t pilot_samples = 0;  ///< samples that they are told from
  double pilot_cpu_seconds = 0;
};

/// The best of the candidates, found by a pilot if the budget allows one [pilot.h], else the first;
/// and its samples. `film`: empty, as large as the picture; it is left so.
Decision decided(Session& session, const std::vector<Candidate>& candidates, const Known& known,
                 Film& film);
/// What a plan says.
Decision obeyed(const Plan& plan, const Session& session, const std::vector<Candidate>& candidates);

}  // namespace tdpt
