// shaders/shared/traversal.h as C++, one ray at a time: the scalar build of a kernel's ray queries.
#pragma once
#include "libcommon/trace/bvh.h"
#include "shaders/shared/bvh.h"
#include "shaders/shared/records.h"
#include "shaders/shared/tables.h"

namespace tdpt::shader {

/// Refers to a Bvh. Treats every surface as opaque, whatever its coverage.
struct ScalarTracer {
  TABLES_OF_BVH(REFERS_TO)

  explicit ScalarTracer(const Bvh& bvh)
      : bvh_nodes(bvh.nodes.data()), bvh_triangles(bvh.triangles.data()) {}

  bool surface_stops(uint, float, float, uint, const vec3&) const { return true; }

#include "shaders/shared/traversal.h"
};

}  // namespace tdpt::shader
