// Flies the pilot of `auto`: renders its rounds, weighs and keeps them, and names the candidate
// that is to render the rest [pilot.h].
#pragma once
#include <functional>
#include <map>
#include <string>

#include "tools/tdpt-render/passes.h"
#include "tools/tdpt-render/pilot.h"

namespace tdpt {

/// What a pilot brought back.
struct PilotRun {
  size_t chosen = 0;                 ///< among the candidates
  std::vector<PilotRecord> records;  ///< empty when the first round was not finished
  uint64_t samples = 0;              ///< of every pixel, all candidates together
  bool cut_short = false;

  // Its part of the picture: sums of pictures by weight, row by row, and the weights together.
  double weight = 0;
  std::vector<Vec3d> sums;
  std::map<size_t, std::vector<Vec3d>> layers;  ///< by layer of the film
  RenderTally tally;                            ///< energies by weight
};

/// Ends early, with what there is, once `stop()` says so.
PilotRun fly_pilot(const World& world, const std::vector<Candidate>& candidates,
                   const PilotPlan& plan, const SampleRules& rules, const TechniqueSet& layers,
                   Progress& progress, const std::function<bool()>& stop);

}  // namespace tdpt
