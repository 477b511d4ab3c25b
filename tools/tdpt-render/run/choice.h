// Which integrator renders, as far as that is known before the first sample: the one that the
// command line names, or candidates among which a pilot chooses [pilot.h].
#pragma once
#include "libcommon/base/phases.h"
#include "libcommon/cli/cli.h"
#include "tools/tdpt-render/run/arguments.h"
#include "tools/tdpt-render/run/render.h"

namespace tdpt {

/// What the command line asks for.
struct Request {
  bool automatic = false;           ///< `auto`, by name or because there are portals
  Integrator named = bdpt;          ///< that to render with, when it is not automatic
  Integrator guided = tdpt_guided;  ///< for `auto` to try, with the numbers that were given
};
/// Throws UsageError where numbers for directed walks are given to an integrator that has none.
Request request_of(const Arguments& a);

struct Choice : Known {
  std::vector<Candidate> candidates;
  Integrator integrator;    ///< the only candidate, or `auto` with the techniques of all
  bool probed = false;      ///< portals were looked at
  bool planned = false;     ///< a plan said all that
  bool by_arrival = false;  ///< kinds of light are chosen by what arrives
  uint64_t explored = 0;    ///< samples that were drawn to choose by, before
  Phases phases;            ///< exploration
};
/// Warns of light that will be missing, and explores the scene where something hangs on it
/// [exploration.h]. Portals that will be used are turned to the way that light passes them, or left
/// out where none does, in `portals` and in the world, and what was measured is told.
Choice choose(const Request& request, const RenderSettings& settings, const Camera& camera,
              World& world, std::vector<Portal>& portals, const cli::Common& common);

/// The same by a plan from `file`: nothing is measured. Throws InputError where it is of other
/// portals or lights.
Choice choose_as_planned(const Plan& plan, const std::string& file, const Request& request,
                         const RenderSettings& settings, World& world, std::vector<Portal>& portals,
                         const cli::Common& common);

}  // namespace tdpt
