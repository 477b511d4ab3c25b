// Renders a range of samples of every pixel: a pure function of vista, integrator, rules and range.
#pragma once
#include "libcommon/base/progress.h"
#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/path/sample/path_sampler.h"

namespace tdpt {

/// Settings shared by all samples of a rendering, whatever the integrator.
struct SampleRules {
  int max_depth = kMaxDepth;
  double beta = 1;  ///< 1: balance heuristic, 2: power heuristic
  uint64_t seed = 1;
};

/// Renders those samples of every pixel into `film` and counts them in `tally`, in parallel.
/// `round` 0 is the picture itself; other rounds have their own random numbers. Film and tally do
/// not depend on how samples are split into calls or among threads.
void render_samples(const Vista& vista, const Integrator& integrator, const SampleRules& rules,
                    uint64_t round, const SampleRange& samples, Film& film, Tally& tally,
                    ProgressBar& progress);

/// Options of a film: a layer for each technique in `layers`, a transparent background if `alpha`,
/// and two halves of the samples if `halves`.
Film::Options film_options(const TechniqueSet& layers, bool alpha, bool halves);
/// A film for pictures of it.
Film film_for(const Vista& vista, const TechniqueSet& layers, bool alpha = false,
              bool halves = false);

/// The counts of a whole rendering.
struct RenderTally {
  RayCounts rays;
  std::array<double, kTechniques> energy{};         ///< sum of luminance per technique
  std::array<double, Tally::kOctaves> by_length{};  ///< by path length, as in Tally
  struct OfPortal {
    uint64_t drawn = 0, lit = 0;
    double energy = 0;
  };
  std::vector<OfPortal> portals;  ///< as in Tally
  uint64_t not_finite = 0;
  std::vector<Tally::SamplePixel> not_finite_at;

  void add(const Tally& tally);
};

}  // namespace tdpt
