// Steps of the renderer as compute kernels of a Vulkan device.
#pragma once
#include <memory>

#include "libcommon/gpu/device.h"
#include "tools/tdpt-render/device/room.h"

namespace tdpt {

/// Seconds of each step's submissions: of a device that is a CPU, of all its cores.
struct StepTimes {
  std::array<double, static_cast<size_t>(Step::kSteps)> of{};
  double gather = 0;
};

/// As much as suits the device beside the scene and the film. Throws Error (no_device), with both
/// numbers, where they are too large for it.
Room room_on(const gpu::Device& device, const RenderTables& tables, uint32_t film_words);

/// `film_words`: of the film and of what is counted beside it. Adds to `times`, if there is one.
/// Throws Error (no_device) where others have taken the memory.
std::unique_ptr<Machine> make_gpu_machine(const gpu::Device& device, const RenderTables& tables,
                                          const Room& room, uint32_t film_words,
                                          StepTimes* times = nullptr);

}  // namespace tdpt
