// The scalar build of a device: the kernels compiled as C++, on the CPU. Slow and plain, it defines
// what a device must render, byte for byte.
#pragma once
#include <memory>

#include "tools/tdpt-render/device/tables.h"
#include "tools/tdpt-render/device/wavefront.h"

namespace tdpt {

/// Keeps a reference to the tables. `film_words`: of the film and of the counts beside it.
std::unique_ptr<Machine> make_scalar_machine(const RenderTables& tables, const Capacity& room,
                                             uint32_t film_words);

}  // namespace tdpt
