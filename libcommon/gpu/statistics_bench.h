// What a driver's compiler reports about a kernel. For benchmarks.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "libcommon/gpu/device.h"

namespace tdpt::gpu {

/// A statistic, "VGPRs", "Scratch size", as the driver calls it.
struct Statistic {
  std::string name;
  double value;
};

/// Throws Error (no_device) if the driver lacks VK_KHR_pipeline_executable_properties. It may lack
/// memory. `program`, `push_bytes` and `constants` as for Kernel; bindings may be storage buffers,
/// texels and uniforms.
std::vector<Statistic> statistics_of(const Device& device, std::span<const uint32_t> program,
                                     uint32_t push_bytes, const std::vector<uint32_t>& constants);

}  // namespace tdpt::gpu
