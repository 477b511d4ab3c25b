// The network of the paper's section 4.1: triangles as nodes, form factors [eq. 9, 10] as
// capacities.
//
//   light -> S_d (lit directly) -> S_p (seen by the camera) -> camera
//
// Symbols as in the paper: S_d, S_p sets of triangles, each a side of one; F_ij form factor from i
// to j; N = M points on each of the two.
//
// Kept for comparison: the sum of fractions grows with the number of nodes, so its cut tends to
// fall on the terminals.
#pragma once
#include "libcommon/base/phases.h"
#include "libcommon/formats/dimacs.h"
#include "libcommon/trace/tracer.h"

namespace tdpt {

struct TriangleSettings {
  uint64_t seed = 1;
  uint32_t rays = 100000;    ///< from the light and from the camera each
  size_t largest_set = 512;  ///< faces of S_d and of S_p kept, those with most hits
  int points = 4;            ///< N = M of eq. 10
};

struct TriangleReport {
  size_t lit = 0, seen = 0;            ///< faces in S_d and S_p
  size_t kept_lit = 0, kept_seen = 0;  ///< of these, in the network
  size_t shared = 0;                   ///< in both: light and camera are connected directly
  Phases phases;                       ///< bvh, walks, patches
};

/// A face is one side of a triangle. Capacities: light -> i is the share of the light's rays that
/// hit i, j -> camera the share of the camera's rays, i -> j is F_ij, light -> camera 1.
DimacsFile triangle_flow(const Scene& scene, const Camera& camera, const TriangleSettings& settings,
                         TriangleReport& report);

}  // namespace tdpt
