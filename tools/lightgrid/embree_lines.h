// Lines of light traced by Embree on all cores.
#pragma once
#include <memory>

#include "tools/lightgrid/line_tracer.h"

namespace tdpt {

/// Keeps references to the scene and the tables.
std::unique_ptr<LineTracer> make_embree_lines(const Scene& scene, const LineTables& tables,
                                              const LightGrid& grid, uint64_t seed);

}  // namespace tdpt
