// Joins the triangles of a polygon mesh into planar facets.
//
// A modelling program writes vertices in single precision, so the triangles of one polygon lie in
// planes that differ by rounding: by r / h for a polygon of height h, which is much for a slit.
// Triangles belong together if all their corners lie within a tolerance of a common plane, whose
// normal n is the mean of theirs weighted by area. The corners are then projected onto it.
#pragma once
#include <array>
#include <vector>

#include "libcommon/math/vec.h"

namespace tdpt {

using Corners = std::array<Vec3d, 3>;

struct PlanarFacet {
  Vec3d normal;                    ///< unit; every triangle is counter-clockwise seen from its tip
  std::vector<Corners> triangles;  ///< in the plane; equal corners stay equal
};

/// Facets of `triangles`, all of non-zero area. Facets are in the order of their first triangle,
/// triangles in the order given; that order decides what is joined only between triangles of equal
/// size or equal distance. Triangles that face opposite ways are never joined. `tolerance`:
/// distance of a corner from the plane, in the unit of the corners.
std::vector<PlanarFacet> planar_facets(const std::vector<Corners>& triangles, double tolerance);

}  // namespace tdpt
