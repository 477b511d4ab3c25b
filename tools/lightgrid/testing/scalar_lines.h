// The compute shader's twin: the same text compiled as C++, over the same BVH. What it counts, the
// shader counts, to the last voxel; slow, and there to say so.
#pragma once
#include <memory>

#include "tools/lightgrid/line_tracer.h"

namespace tdpt {

/// Keeps a reference to the tables.
std::unique_ptr<LineTracer> make_scalar_lines(const Scene& scene, const LineTables& tables,
                                              const LightGrid& grid, uint64_t seed);

}  // namespace tdpt
