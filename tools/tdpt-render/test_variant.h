// For tests: integrators that do something else than their mixture says, to be caught.
#pragma once
#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/path/path_sampler.h"

namespace tdpt {

/// The rows of the table.
inline std::vector<const Integrator*> integrators() {
  std::vector<const Integrator*> rows;
  for (const Integrator& row : kIntegrators) rows.push_back(&row);
  return rows;
}

struct Variant {
  Variant(const Integrator& integrator_) : integrator(integrator_) {}  // as it should be
  Variant(const Integrator& integrator_, void (*run_)(PathSampler&))
      : integrator(integrator_), run(run_) {}
  /// Weighed as `techniques`, samples of its own.
  Variant(TechniqueSet techniques, void (*run_)(PathSampler&))
      : integrator{"faulty", 9, {techniques}}, run(run_) {}

  SampleSettings settings(int max_depth, uint64_t seed) const {
    return {integrator.mixture, max_depth, beta[0], seed, integrator.stream};
  }
  void sample(PathSampler& sampler, int x, int y, uint64_t s) const {
    sampler.begin(x, y, s);
    run(sampler);
    sampler.end();
  }

  Integrator integrator;
  /// Exponent of the MIS weights of each technique's samples, which sum to 1 if it is the same.
  std::array<double, kTechniques> beta{1, 1, 1, 1, 1};
  void (*run)(PathSampler&) = [](PathSampler& sampler) { sampler.run(); };
};

/// Runs `fewer` in place of all that the mixture has.
template <Technique... fewer>
void run_only(PathSampler& sampler) {
  sampler.walk_from_camera();
  sampler.walk_from_light();
  (sampler.run(fewer), ...);
}

/// Runs one of its techniques again.
template <Technique again>
void run_twice(PathSampler& sampler) {
  sampler.run();
  sampler.run(again);
}

}  // namespace tdpt
