// Renders samples on a Vulkan device.
#pragma once
#include <memory>

#include "libcommon/gpu/device.h"
#include "tools/tdpt-render/device/capacity.h"
#include "tools/tdpt-render/integrators/sample_renderer.h"

namespace tdpt {

/// A world on its way to a device: that there is room for it is known before work begins, its
/// portals and shares of lights are those of the end.
class GpuUpload {
 public:
  /// `layers`: films may have them. The world must outlive it. Throws Error (no_device), with both
  /// numbers, where the scene or the film is too large.
  GpuUpload(const gpu::Device& device, const World& world, bool layers);
  /// Brings the world there, as it is now; it must outlive the renderer, too. Once.
  std::shared_ptr<SampleRenderer> renderer();

 private:
  gpu::Device device_;
  const World& world_;
  const bool layers_;
  RenderTables tables_;
  const Capacity room_;
};

}  // namespace tdpt
