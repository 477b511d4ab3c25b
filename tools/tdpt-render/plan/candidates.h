// Those that `auto` chooses among.
#pragma once
#include <string>
#include <vector>

#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {

struct Candidate {
  Integrator integrator;
  std::string label;  ///< names it in notes and statistics; several may share an integrator's name
  /// Whether the world's portals are any use to it.
  bool with_portals() const {
    const Mixture& m = integrator.mixture;
    return m.has(Technique::portal) || m.guiding != Guiding{} || m.looks_out();
  }
};

/// For this scene, with the techniques that its portals allow: the first is taken where nothing can
/// be told. `guided`: what is to be tried with portals.
std::vector<Candidate> possible_candidates(const World& world,
                                           const Integrator& guided = tdpt_guided);
/// Those that miss no light of the scene [light_missed]; the first of all where each does.
std::vector<Candidate> auto_candidates(const World& world, const Integrator& guided = tdpt_guided);

/// With the numbers of connections that are to be expected of each [light_vertex_cache.h].
std::vector<Candidate> expecting_connections(const World& world, std::vector<Candidate> candidates,
                                             int max_depth);

/// `auto` by name, with all techniques of the candidates; it cannot be run.
Integrator either_of(const std::vector<Candidate>& candidates);

}  // namespace tdpt
