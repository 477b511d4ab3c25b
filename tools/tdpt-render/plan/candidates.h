// The candidates among which `auto` chooses.
#pragma once
#include <string>
#include <vector>

#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {

struct Candidate {
  Integrator integrator;
  std::string label;  ///< for notes and statistics; several may share an integrator's name
  /// Whether it uses portals.
  bool with_portals() const {
    const Mixture& m = integrator.mixture;
    return m.has(Technique::portal) || m.guiding != Guiding{} || m.looks_out();
  }
};

/// The candidates for this scene, with the techniques that its portals allow, without those that
/// miss some of its light [light_missed]; if all do, the first. The first is the default if nothing
/// can be measured: the one with portals, since it has the techniques of bdpt too. `guided`: that
/// one.
std::vector<Candidate> auto_candidates(const Vista& vista, const Integrator& guided = tdpt_guided);

/// Sets each candidate's expected number of connections [light_vertex_cache.h].
std::vector<Candidate> expecting_connections(const Vista& vista, std::vector<Candidate> candidates,
                                             int max_depth);

/// An integrator named `auto` with the techniques of all candidates; it cannot be run.
Integrator either_of(const std::vector<Candidate>& candidates);

}  // namespace tdpt
