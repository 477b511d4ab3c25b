// Traces and counts lines of light on a Vulkan device: visibility tests and ray marching in compute
// shaders, atomic additions on 3D images (section 4.2).
#pragma once
#include <algorithm>
#include <memory>

#include "libcommon/gpu/device.h"
#include "tools/lightgrid/line_tracer.h"

namespace tdpt {

/// Bounds below the device's own limits, for tests.
struct GpuLineBounds {
  uint32_t lines = 1u << 18;       ///< per submission
  uint64_t voxels = ~uint64_t{0};  ///< in memory at a time: a larger grid is processed in slabs
};

/// Number of z layers per slab, chosen so that four images of one slab fit the limits of the device
/// called `device`. Throws Error (no_device) if none does.
uint32_t slab_depth(const std::string& device, const gpu::Limits& limits, const LightGrid& grid,
                    uint64_t most_voxels = ~uint64_t{0});

/// Layers low <= z < high of slab `number`; all slabs but the last have `depth` layers.
struct Slab {
  int32_t low, high;
};
inline Slab slab_of(uint32_t number, uint32_t depth, int32_t layers) {
  const auto low = static_cast<int32_t>(number * depth);
  return {low, std::min(low + static_cast<int32_t>(depth), layers)};
}

/// Keeps a reference to the tables. Throws Error (no_device) if the scene or the grid is too large
/// for the device. The scene's glass must be open.
std::unique_ptr<LineTracer> make_gpu_lines(const gpu::Device& device, const Scene& scene,
                                           const LineTables& tables, const LightGrid& grid,
                                           uint64_t seed, const GpuLineBounds& bounds = {});

}  // namespace tdpt
