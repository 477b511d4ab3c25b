// Runs the steps of the renderer as compute kernels of a Vulkan device.
#pragma once
#include <memory>

#include "libcommon/gpu/kernel.h"
#include "tools/tdpt-render/device/capacity.h"

namespace tdpt {

/// How often one step ran, and the time it took.
struct StepWork {
  double seconds = 0;  ///< of the device; if it is a CPU, over all its cores
  uint64_t runs = 0, invocations = 0;
};
struct DeviceWork {
  std::array<StepWork, static_cast<size_t>(Step::kSteps)> steps;
  StepWork gather;    ///< flags, ranks and lists: gather(), pick() and place_ends()
  double making = 0;  ///< seconds of compiling kernels
};

/// What a driver's compiler reports about each step's kernel, specialised for a scene with every
/// feature, or for the least: diffuse surfaces behind portals. `device` must be opened for it.
std::array<std::vector<gpu::Statistic>, static_cast<size_t>(Step::kSteps)> step_statistics(
    const gpu::Device& device, bool least);

/// The capacity that suits the device beside the scene and the film. Throws Error (no_device), with
/// both numbers, if they are too large for it.
Capacity capacity_on(const gpu::Device& device, const RenderTables& tables, uint32_t film_words);

/// `film_words`: of the film and its counters. Adds to `work`, if given. Throws Error (no_device)
/// if other programs have taken the memory.
std::unique_ptr<Machine> make_gpu_machine(const gpu::Device& device, const RenderTables& tables,
                                          const Capacity& room, uint32_t film_words,
                                          DeviceWork* work = nullptr);

}  // namespace tdpt
