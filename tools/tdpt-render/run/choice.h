// Which integrator renders, as far as it is known before the first sample: the one named on the
// command line, or candidates among which a pilot chooses [pilot.h].
#pragma once
#include "libcommon/base/phases.h"
#include "libcommon/cli/cli.h"
#include "tools/tdpt-render/run/arguments.h"
#include "tools/tdpt-render/run/render.h"

namespace tdpt {

/// What the command line asks for.
struct Request {
  bool automatic = false;           ///< `auto`, by name or because there are portals
  Integrator named = bdpt;          ///< renders if not automatic
  Integrator guided = tdpt_guided;  ///< `auto` tries it, with the numbers given
};
/// Throws UsageError if numbers for guided walks are given to an integrator that has none.
Request request_of(const Arguments& a);

struct Choice : Known {
  std::vector<Candidate> candidates;
  Integrator integrator;    ///< the only candidate, or `auto` with the techniques of all
  bool probed = false;      ///< portals were explored
  bool planned = false;     ///< everything was read from a plan
  bool by_arrival = false;  ///< kinds of light are selected by the light that arrives
  uint64_t explored = 0;    ///< samples of the exploration
  Phases phases;            ///< exploration
};
/// Warns of light that will be missing, and explores the scene if a decision depends on it
/// [exploration.h]. Portals that will be used are turned to the way that light passes them, or left
/// out if none does, in `portals` and in the world; the measurements are reported.
Choice choose(const Request& request, const RenderSettings& settings, const Camera& camera,
              World& world, std::vector<Portal>& portals, const cli::Common& common);

/// The same by a plan from `file`, without measuring. Throws InputError if it was made for other
/// portals or lights.
Choice choose_as_planned(const Plan& plan, const std::string& file, const Request& request,
                         const RenderSettings& settings, World& world, std::vector<Portal>& portals,
                         const cli::Common& common);

/// The same for a frame of a shot that has portals of its own: of the plan the integrator and its
/// numbers are obeyed, as far as the frame has portals for it; what is known of portals and lights
/// is measured anew, and taken into `plan`.
Choice choose_for_frame(Plan& plan, const Request& request, const RenderSettings& settings,
                        const Camera& camera, World& world, std::vector<Portal>& portals,
                        const cli::Common& common);

}  // namespace tdpt
