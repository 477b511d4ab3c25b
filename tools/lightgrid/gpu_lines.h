// Lines of light traced and counted by a Vulkan device: visibility tests and ray marching in
// compute shaders, atomic additions on 3D images (section 4.2).
#pragma once
#include <algorithm>
#include <memory>

#include "libcommon/gpu/device.h"
#include "tools/lightgrid/line_tracer.h"

namespace tdpt {

/// Bounds on what is asked of the device, below its own limits; for tests.
struct GpuLineBounds {
  uint32_t lines = 1u << 18;       ///< in one submission
  uint64_t voxels = ~uint64_t{0};  ///< in memory at a time: a larger grid is counted in slabs
};

/// Seconds that the submissions of each kernel have taken.
struct GpuLineTimes {
  double trace = 0, votes = 0, march = 0;
};

/// Layers along z of the slabs that the grid is counted in, so that four images of one slab keep to
/// the limits of `device`, its name. Throws Error (no_device) where none does.
uint32_t slab_depth(const std::string& device, const gpu::Limits& limits, const LightGrid& grid,
                    uint64_t most_voxels = ~uint64_t{0});

/// Layers low <= z < high of slab `number`, of those that are `depth` layers each but the last.
struct Slab {
  int32_t low, high;
};
inline Slab slab_of(uint32_t number, uint32_t depth, int32_t layers) {
  const auto low = static_cast<int32_t>(number * depth);
  return {low, std::min(low + static_cast<int32_t>(depth), layers)};
}

/// Keeps a reference to the tables, and to `times`, to which it then adds: kernels are submitted
/// one by one for that, which takes longer. Throws Error (no_device) when the scene or the grid is
/// too large for the device. The scene's glass is open.
std::unique_ptr<LineTracer> make_gpu_lines(const gpu::Device& device, const Scene& scene,
                                           const LineTables& tables, const LightGrid& grid,
                                           uint64_t seed, const GpuLineBounds& bounds = {},
                                           GpuLineTimes* times = nullptr);

}  // namespace tdpt
