// The slow, obvious reference for path.cpp: every density of a path from its positions and normals
// alone, as logarithms, without ratios, caches or the walks that made it. For tests.
#pragma once
#include <vector>

#include "tools/tdpt-render/path/sample/path.h"
#include "tools/tdpt-render/testing/oracle_lights.h"

namespace tdpt::oracle {

struct StrategyDensity {
  Strategy strategy;
  double log_p;  ///< natural logarithm of the density per canonical area^(k+1); -inf: impossible
  double sample_weight;  ///< its factor in the mixture's weights
};

/// A planted fault for a twin.
enum class Fault {
  none,
  portal_density_5_percent,
  no_surround,        ///< points of portals that are uniform on their triangles
  one_way_5_percent,  ///< density of segments to +x
  missing_cosine,
  connection_at_a_mirror,
  guide_5_percent,       ///< density of the directions towards portals
  immortal,              ///< walks that always survive
  sky_5_percent,         ///< density of the sky's directions
  sky_segment_distance,  ///< segments from the sky spread over the squared distance to the portal
  window_5_percent,      ///< density of next events through windows
  rect_light_5_percent,  ///< density of next events at rectangular lights
  sky_segment_cosine,    ///< the same, without cancelling the portal's cosine
  film_of_the_middle,    ///< of lens and exposure, not that of the sample
};

/// All strategies of `mixture` that can make the path. `sky`: of the vista, to be reused.
std::vector<StrategyDensity> densities(const Vista& vista, const Path& path, const Mixture& mixture,
                                       Fault fault = Fault::none, const SkyLight* sky = nullptr);

/// Weight of `used`: (n p)^beta over the sum of those of all strategies, n the sample weight.
/// Balance heuristic [eq. 6] for beta = 1, power heuristic for beta = 2.
double weight(const std::vector<StrategyDensity>& densities, Strategy used, double beta);

/// Measurement contribution function: Le G f G ... f G W, the product of [eq. 1] to [eq. 3] without
/// visibility, without absorption along the edges and without the deltas of Dirac lobes.
Vec3d contribution(const Path& path);

}  // namespace tdpt::oracle
