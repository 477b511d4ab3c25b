// The scalar build of the compute shaders: the same source compiled as C++ over the same BVH. The
// shaders must count exactly what it counts, in every voxel. It is slow and serves as the
// reference.
#pragma once
#include <memory>

#include "tools/lightgrid/line_tracer.h"

namespace tdpt {

/// Keeps a reference to the tables.
std::unique_ptr<LineTracer> make_scalar_lines(const Scene& scene, const LineTables& tables,
                                              const LightGrid& grid, uint64_t seed);

}  // namespace tdpt
