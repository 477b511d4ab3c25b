// What a sample costs, predicted from its counts of rays: a linear model of CPU time, fitted to
// measurements. `auto` weights errors by it and never by the clock, so that it chooses the same
// in every run.
//   cost = sample + rays.closest (closest + closest_deeper L) + rays.shadow x shadow
//          + rays.connect x connect
//          + rays.portal (portal + portal_triangle T + directed D
//                         + (facets + facet F) [D and F > 1])
//          + rays.closest (looking_out + window F) if there is a sky to look for,
// rays: of one sample; L = log2(triangles of the scene / 64), at least 0; T: triangles of the
// portals; F: their facets (portals.h); D: 1 if walks are guided, else 0.
#pragma once
#include <algorithm>
#include <cmath>

#include "tools/tdpt-render/path/sample/path_sampler.h"

namespace tdpt {

/// CPU nanoseconds of one core, on average.
struct WorkCosts {
  double sample = 0;          ///< every sample
  double closest = 0;         ///< a closest-hit ray
  double closest_deeper = 0;  ///< extra for each doubling of the scene's triangles
  double shadow = 0;          ///< a visibility test
  double connect = 0;         ///< a pair of vertices considered for a connection
  double portal = 0;  ///< an edge tested against the portals, and its part of the MIS weight
  double portal_triangle = 0;  ///< extra for each triangle of the portals
  double directed = 0;         ///< extra if the edge's ends have a guiding distribution
  double facets = 0;           ///< extra if it chooses among facets,
  double facet = 0;            ///< and for each facet
  double looking_out = 0;      ///< a closest hit if next events look for the sky through portals,
  double window = 0;           ///< and for each facet
};

// bench/work_model.py fits the tables by least squares to the measurements of work_model_bench: six
// scenes with portals, eight without, depth 3, 6 and no limit, the integrators that `auto` tries
// except `pt`. Some costs were measured apart and held fixed: portal facets and triangles (an edge
// tested against 1, 4, 16 and 64 facets of two triangles: 241, 299, 455 and 1097), looking out (a
// room with one window and one with four) and, with portals, the closest hit, since there are about
// as many as edges. Ratios to bdpt's CPU time are within 10 % on average; `nee` 0.7 to 1.25 times,
// tdpt-guided 0.6 to 1.1 times.
inline constexpr WorkCosts kWorkWithPortals{.closest = 60,
                                            .closest_deeper = 25,
                                            .shadow = 218,
                                            .connect = 19,
                                            .portal = 132,
                                            .portal_triangle = 2,
                                            .directed = 86,
                                            .facets = 59,
                                            .facet = 11,
                                            .looking_out = 70,
                                            .window = 20};
inline constexpr WorkCosts kWorkWithoutPortals{.closest = 193,
                                               .closest_deeper = 25,
                                               .shadow = 297,
                                               .connect = 6,
                                               .looking_out = 70,
                                               .window = 20};

// The same for samples on a device: CPU nanoseconds of Mesa's software device on one core, three
// scenes with portals, five without. Ratios to bdpt's are within 8 % on average, 46 % at most.
// Costs of facets, of portal triangles and of looking out were not measured: they are in proportion
// to a closest hit as on the CPU. Other kinds of devices have not been measured: use
// `work_model_bench --device gpu`.
inline constexpr WorkCosts kDeviceWorkWithPortals{.closest = 474,
                                                  .closest_deeper = 129,
                                                  .shadow = 750,
                                                  .connect = 48,
                                                  .portal_triangle = 5,
                                                  .directed = 317,
                                                  .facets = 145,
                                                  .facet = 27,
                                                  .looking_out = 172,
                                                  .window = 49};
inline constexpr WorkCosts kDeviceWorkWithoutPortals{.closest = 474,
                                                     .closest_deeper = 117,
                                                     .shadow = 845,
                                                     .connect = 19,
                                                     .looking_out = 172,
                                                     .window = 49};

/// The table of a sample's costs, for a device of any kind or the CPU: a sample's cost is the same
/// in every run.
inline const WorkCosts& work_costs(const Vista& vista, const Mixture& mixture, bool on_device) {
  const bool with_portals = Guide(vista, mixture).sees_portals();
  if (on_device) return with_portals ? kDeviceWorkWithPortals : kDeviceWorkWithoutPortals;
  return with_portals ? kWorkWithPortals : kWorkWithoutPortals;
}

/// Cost of one sample [ns]; `rays`: counts over `samples` samples.
inline double sample_work(const Vista& vista, const Mixture& mixture, const WorkCosts& costs,
                          const RayCounts& rays, uint64_t samples) {
  const Openings& openings = vista.openings;
  const double depth =
      std::max(0.0, std::log2(static_cast<double>(vista.world->scene.triangles.size() + 1) / 64));
  double closest = costs.closest + costs.closest_deeper * depth;
  if (!openings.windows.empty() && mixture.looks_out())
    closest +=
        costs.looking_out + costs.window * static_cast<double>(openings.windows.windows().size());
  const auto facets = static_cast<double>(openings.portals.facets());
  const double triangles = static_cast<double>(openings.portals.size()) - facets;
  double portal = costs.portal + costs.portal_triangle * triangles;
  if (facets > 0 && mixture.guiding != Guiding{})
    portal += costs.directed + (facets > 1 ? costs.facets + costs.facet * facets : 0);
  const double n = static_cast<double>(std::max<uint64_t>(samples, 1));
  return costs.sample + closest * static_cast<double>(rays.closest) / n +
         costs.shadow * static_cast<double>(rays.shadow) / n +
         costs.connect * static_cast<double>(rays.connect) / n +
         portal * static_cast<double>(rays.portal) / n;
}

}  // namespace tdpt
