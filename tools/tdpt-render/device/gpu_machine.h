// Steps of the renderer as compute kernels of a Vulkan device.
#pragma once
#include <memory>

#include "libcommon/gpu/kernel.h"
#include "tools/tdpt-render/device/capacity.h"

namespace tdpt {

/// What was asked of one step, and what it took.
struct StepWork {
  double seconds = 0;  ///< of a device that is a CPU, of all its cores
  uint64_t runs = 0, invocations = 0;
};
struct DeviceWork {
  std::array<StepWork, static_cast<size_t>(Step::kSteps)> steps;
  StepWork gather;    ///< flags, ranks and lists: gather(), pick() and place_ends()
  double making = 0;  ///< seconds of making kernels
};

/// What a driver's compiler tells of each step's kernel: of scenes that have all that kernels are
/// made for, or of the least, diffuse surfaces behind portals. The device: opened for it.
std::array<std::vector<gpu::Statistic>, static_cast<size_t>(Step::kSteps)> step_statistics(
    const gpu::Device& device, bool least);

/// As much as suits the device beside the scene and the film. Throws Error (no_device), with both
/// numbers, where they are too large for it.
Capacity capacity_on(const gpu::Device& device, const RenderTables& tables, uint32_t film_words);

/// `film_words`: of the film and of what is counted beside it. Adds to `work`, if there is one.
/// Throws Error (no_device) where others have taken the memory.
std::unique_ptr<Machine> make_gpu_machine(const gpu::Device& device, const RenderTables& tables,
                                          const Capacity& room, uint32_t film_words,
                                          DeviceWork* work = nullptr);

}  // namespace tdpt
