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
#include "libcommon/base/process.h"
#include "libcommon/formats/dimacs.h"
#include "libcommon/math/rng.h"
#include "libcommon/trace/tracer.h"

namespace tdpt {

struct TriangleSettings {
  uint64_t seed = 1;
  uint32_t rays = 100000;    ///< from the light and from the camera each
  size_t largest_set = 512;  ///< faces of S_d and of S_p kept, those with most hits
  int points = 4;            ///< N = M of eq. 10
};

struct TriangleReport {
  size_t lit = 0, seen = 0;  ///< faces in S_d and S_p
  size_t shared = 0;         ///< kept in both: light and camera are connected directly
};

/// A face is one side of a triangle. Capacities: light -> i is the share of the light's rays that
/// hit i, j -> camera the share of the camera's rays, i -> j is F_ij, light -> camera 1. Times the
/// phases bvh, walks and patches.
DimacsFile triangle_flow(const Scene& scene, const Camera& camera, const TriangleSettings& settings,
                         TriangleReport& report, Phases& phases);

// Form factors between triangles, with visibility; symbols as in radiosity.
//
//   F_ij = (1/A_i) int int cos_i cos_j V / (pi r^2) dA_j dA_i                               [eq. 9]
//
// is the share of the diffuse light leaving i that arrives at j: A_i F_ij = A_j F_ji, and in a
// closed box the F_ij sum to 1 over j. (The paper labels it j -> i.)

/// Estimate of F_ij from n points on i times m points on j: A_j / (n m) sum sum cos_i cos_j V / (pi
/// r^2) [eq. 10], which the paper prints without V. `i` and `j` face along their normals. Without a
/// tracer everything is visible.
double form_factor(const TriangleShape& i, const TriangleShape& j, int n, int m, Rng& rng,
                   const Tracer* tracer);

}  // namespace tdpt
