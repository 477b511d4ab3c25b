// Which integrator renders, as far as that is known before the first sample: the one that the
// command line names, or candidates among which a pilot chooses [pilot.h].
#pragma once
#include "libcommon/cli/cli.h"
#include "tools/tdpt-render/arguments.h"
#include "tools/tdpt-render/pilot.h"

namespace tdpt {

/// What the command line asks for.
struct Request {
  bool automatic = false;   ///< `auto`, by name or because there are portals
  Integrator named = bdpt;  ///< that to render with, when it is not automatic
  /// tdpt-guided with the numbers that were given, the only one for `auto` to try; empty: none was
  /// given.
  std::vector<Integrator> guided;
};
/// Throws UsageError where numbers for directed walks are given to an integrator that has none.
Request request_of(const Arguments& a, const std::vector<Portal>& portals);

struct Choice {
  std::vector<Candidate> candidates;
  Integrator integrator;  ///< the only candidate, or `auto` with the techniques of all
};
/// Warns of light that will be missing. `portals` are probed if they will be used [portal_probe.h],
/// and what they promise is told.
Choice choose(const Request& request, const World& world, std::vector<Portal>& portals,
              const cli::Common& common);

}  // namespace tdpt
