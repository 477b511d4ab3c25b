// Triangles of a polygon mesh joined to planar facets.
//
// A modelling program writes vertices in single precision, so the triangles of one polygon lie in
// planes that differ by what was rounded: by r / h for a polygon of height h, which for a slit is
// much. Those belong together whose corners all lie within a tolerance of a common plane; its
// normal n is the mean of theirs weighted by area. The corners are then laid into it.
#pragma once
#include <array>
#include <vector>

#include "libcommon/math/vec.h"

namespace tdpt {

using Corners = std::array<Vec3d, 3>;

struct PlanarFacet {
  Vec3d normal;                    ///< unit; every triangle is counter-clockwise seen from it
  std::vector<Corners> triangles;  ///< in the plane; equal corners stay equal
};

/// Facets of `triangles`, each with an area, in the order of their first triangle and with their
/// triangles in the order given; which of them are joined depends on that order only where
/// triangles are equally large or equally near. Triangles that look opposite ways never are.
/// `tolerance`: of a corner from the plane, in the unit of the corners.
std::vector<PlanarFacet> planar_facets(const std::vector<Corners>& triangles, double tolerance);

}  // namespace tdpt
