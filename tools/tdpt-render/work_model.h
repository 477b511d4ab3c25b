// What a sample costs, told from what it counts: a linear model of CPU time, fitted to
// measurements. `auto` weighs errors by it and never by the clock, so that it chooses alike in
// every run.
//   cost = sample + rays.closest (closest + closest_deeper L) + rays.shadow x shadow
//          + rays.portal (portal + portal_triangle T + directed D + (facets + facet F) [D and F >
//          1]),
// rays: of one sample, L = log2(triangles of the scene / 64), 0 at least, T: triangles of the
// portals, F: their facets (portals.h), D: 1 where walks are directed, else 0.
#pragma once
#include "tools/tdpt-render/path/path_sampler.h"

namespace tdpt {

/// CPU nanoseconds of one core on average.
struct WorkCosts {
  double sample = 0;          ///< every sample
  double closest = 0;         ///< a first hit
  double closest_deeper = 0;  ///< more for each doubling of the scene's triangles
  double shadow = 0;          ///< a visibility test
  double portal = 0;          ///< an edge tested against the portals, with the weighing of its path
  double portal_triangle = 0;  ///< more for each triangle of the portals
  double directed = 0;         ///< more where the edge's ends are told how to aim
  double facets = 0;           ///< and where they choose among facets,
  double facet = 0;            ///< for each facet
};

// The tables are bench/work_model.py's, a least-squares fit to what work_model_bench measures: five
// scenes, three depths, the six integrators that `auto` tries. Ratios to bdpt's CPU time come out
// within 4 % on average and 10 % at most at depth 6, 13 % at most at depth 12; without portals 7,
// 13 and 18 %. Without the last three terms tdpt-guided came out 9 to 24 % too small at depth 6. In
// two scenes that had no part in the fit it came out 1 and 5 % too small, nee 12 and 17 %. An edge
// that is tested against 1, 4, 16 and 64 facets of two triangles cost 241, 299, 455 and 1097 by
// measurement.
inline constexpr WorkCosts kWorkWithPortals{
    .sample = 180,
    .closest = 39,
    .closest_deeper = 12,
    .shadow = 156,
    .portal = 187,
    .portal_triangle = 2,
    .directed = 56,
    .facets = 40,
    .facet = 11,
};
inline constexpr WorkCosts kWorkWithoutPortals{
    .sample = 5,
    .closest = 193,
    .closest_deeper = 11,
    .shadow = 215,
};

class WorkModel {
 public:
  /// Of samples of `mixture`, with the table for those that have a use for the world's portals or
  /// for those that have none.
  WorkModel(const World& world, const Mixture& mixture);
  WorkModel(const World& world, const Mixture& mixture, const WorkCosts& costs);

  /// Of one sample [ns]; `rays` of `samples` of them.
  double per_sample(const RayCounts& rays, uint64_t samples) const;

 private:
  double sample_, closest_, shadow_, portal_;
};

}  // namespace tdpt
