// Form factors between triangles, with visibility; symbols as in radiosity.
//
//   F_ij = (1/A_i) int int cos_i cos_j V / (pi r^2) dA_j dA_i                               [eq. 9]
//
// is the share of the diffuse light leaving i that arrives at j: A_i F_ij = A_j F_ji, and in a
// closed box the F_ij sum to 1 over j. (The paper labels it j -> i.)
#pragma once
#include "libcommon/math/rng.h"
#include "libcommon/trace/tracer.h"

namespace tdpt {

/// A triangle seen from one side.
struct FacingTriangle {
  Vec3d p0, e1, e2;
  Vec3d normal;  ///< unit, of the side that it faces
  double area;
};

/// The side of `face` = 2 * triangle + side.
FacingTriangle facing(const Scene& scene, uint32_t face);

/// Estimate of F_ij from n points on i times m points on j: A_j / (n m) sum sum cos_i cos_j V / (pi
/// r^2) [eq. 10], which the paper prints without V. Without a tracer everything is visible.
double form_factor(const FacingTriangle& i, const FacingTriangle& j, int n, int m, Rng& rng,
                   const Tracer* tracer);

}  // namespace tdpt
