// What is decided before the first sample of a picture: who renders, how often, and how portals and
// lights are used. Decisions hang on counted work and on samples that are thrown away, never on the
// clock: the same command decides the same on every machine and in every part of a picture.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "tools/tdpt-render/plan/error_estimate.h"
#include "tools/tdpt-render/plan/exploration.h"
#include "tools/tdpt-render/plan/pilot.h"
#include "tools/tdpt-render/plan/session.h"

namespace tdpt {

/// Largest number of samples per pixel, as for --spp.
inline constexpr uint64_t kMostSamples = uint64_t{1} << 32;

struct Plan {
  Integrator integrator = bdpt;  ///< renders, with its expected connections
  std::string label;             ///< of the candidate; several share an integrator's name
  uint64_t spp = 0;              ///< samples per pixel; 0: as many as the time allows
  Explored explored;

  // What was measured besides, reported with the picture.
  Forecast forecast;           ///< of the candidates; without estimates if no pilot ran
  uint64_t pilot_samples = 0;  ///< behind the forecast
  double pilot_cpu_seconds = 0;
  /// Rounds of the error pilot; none without a target error.
  std::vector<ErrorEstimate> error_rounds;
  double error_pilot_cpu_seconds = 0;
  uint64_t needed = 0;  ///< samples per pixel for the target error; 0: unknown
  /// Per pixel, thrown away.
  uint64_t error_pilot_samples() const {
    return error_rounds.empty() ? 0 : kErrorPilotParts * error_rounds.back().samples;
  }

  bool cut_short = false;  ///< by a signal: another run would decide otherwise
};

/// The one integrator that is named, or the candidates of `auto` [candidates.h].
std::vector<Candidate> candidates_of(const Job& job, const Vista& vista);

/// What of the exploration matters for this job: nothing for portals that nothing goes
/// through, for kinds of light that do not compete with a sky, and for paths of any length.
Explored explore(const Job& job, const Vista& vista, const Camera& camera,
                 const std::vector<Portal>& portals);

/// The best candidate, found by a pilot if the budget allows one [pilot.h], else the first; and for
/// a target error the number of samples [error_estimate.h]. The renderer's portals and lights must
/// be as `explored` says.
Plan make_plan(Session& session, const std::vector<Candidate>& candidates, Explored explored);

}  // namespace tdpt
