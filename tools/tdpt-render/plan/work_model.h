// What a sample costs, told from what it counts: a linear model of CPU time, fitted to
// measurements. `auto` weighs errors by it and never by the clock, so that it chooses alike in
// every run.
//   cost = sample + rays.closest (closest + closest_deeper L) + rays.shadow x shadow
//          + rays.connect x connect
//          + rays.portal (portal + portal_triangle T + directed D + (facets + facet F) [D and F >
//          1])
//          + rays.closest (looking_out + window F) where there is a sky to look for,
// rays: of one sample, L = log2(triangles of the scene / 64), 0 at least, T: triangles of the
// portals, F: their facets (portals.h), D: 1 where walks are directed, else 0.
#pragma once
#include "tools/tdpt-render/path/sample/path_sampler.h"

namespace tdpt {

/// CPU nanoseconds of one core on average.
struct WorkCosts {
  double sample = 0;          ///< every sample
  double closest = 0;         ///< a first hit
  double closest_deeper = 0;  ///< more for each doubling of the scene's triangles
  double shadow = 0;          ///< a visibility test
  double connect = 0;         ///< a pair of ends that comes into question for a connection
  double portal = 0;          ///< an edge tested against the portals, with the weighing of its path
  double portal_triangle = 0;  ///< more for each triangle of the portals
  double directed = 0;         ///< more where the edge's ends are told how to aim
  double facets = 0;           ///< and where they choose among facets,
  double facet = 0;            ///< for each facet
  double looking_out = 0;      ///< a first hit where next events look for the sky through portals,
  double window = 0;           ///< for each facet
};

// The tables are bench/work_model.py's, a least-squares fit to what work_model_bench measures: six
// scenes with portals, eight without, depth 3, 6 and no limit, the integrators that `auto` tries
// but `pt`. What facets and triangles of portals cost was measured apart (an edge that is tested
// against 1, 4, 16 and 64 facets of two triangles: 241, 299, 455 and 1097) and held, and so was
// what looking out costs (a room with one window and one with four); with portals a first hit was
// held, too, since there are about as many as edges. Ratios to bdpt's CPU time come out within 10 %
// on average; `nee` 0.7 to 1.25 times, tdpt-guided 0.6 to 1.1 times.
inline constexpr WorkCosts kWorkWithPortals{
    .closest = 60,
    .closest_deeper = 25,
    .shadow = 218,
    .connect = 19,
    .portal = 132,
    .portal_triangle = 2,
    .directed = 86,
    .facets = 59,
    .facet = 11,
    .looking_out = 70,
    .window = 20,
};
inline constexpr WorkCosts kWorkWithoutPortals{
    .closest = 193,
    .closest_deeper = 25,
    .shadow = 297,
    .connect = 6,
    .looking_out = 70,
    .window = 20,
};

// Likewise of samples on a device: CPU nanoseconds of Mesa's software device on one core, three
// scenes with portals, five without. Ratios to bdpt's come out within 8 % on average, 46 % at most.
// What facets, triangles of portals and looking out cost was not measured: they are to a first hit
// as on the CPU. Devices that are of another kind have not been measured: `work_model_bench
// --device gpu` does.
inline constexpr WorkCosts kDeviceWorkWithPortals{
    .closest = 474,
    .closest_deeper = 129,
    .shadow = 750,
    .connect = 48,
    .portal_triangle = 5,
    .directed = 317,
    .facets = 145,
    .facet = 27,
    .looking_out = 172,
    .window = 49,
};
inline constexpr WorkCosts kDeviceWorkWithoutPortals{
    .closest = 474,
    .closest_deeper = 117,
    .shadow = 845,
    .connect = 19,
    .looking_out = 172,
    .window = 49,
};

/// For samples that have a use for portals, and for those that have none.
struct WorkTables {
  WorkCosts with_portals, without_portals;
};
inline constexpr WorkTables kCpuWork{kWorkWithPortals, kWorkWithoutPortals};
/// Of --device gpu, whichever: what a sample costs is then the same in every run.
inline constexpr WorkTables kDeviceWork{kDeviceWorkWithPortals, kDeviceWorkWithoutPortals};

class WorkModel {
 public:
  /// Of samples of `mixture`.
  WorkModel(const World& world, const Mixture& mixture, const WorkTables& tables = kCpuWork);
  WorkModel(const World& world, const Mixture& mixture, const WorkCosts& costs);

  /// Of one sample [ns]; `rays` of `samples` of them.
  double per_sample(const RayCounts& rays, uint64_t samples) const;

 private:
  double sample_, closest_, shadow_, connect_, portal_;
};

}  // namespace tdpt
