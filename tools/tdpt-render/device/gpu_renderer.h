// Renders samples on a Vulkan device.
#pragma once
#include <memory>

#include "libcommon/gpu/device.h"
#include "tools/tdpt-render/device/capacity.h"
#include "tools/tdpt-render/device/wavefront.h"
#include "tools/tdpt-render/integrators/sample_renderer.h"

namespace tdpt {

/// The upload of a world to a device, in two stages: the constructor checks that it fits before any
/// work begins, renderer() uploads its final portals and light probabilities.
class GpuUpload {
 public:
  /// `planes`: what films may have. The world must outlive it. Throws Error (no_device), with both
  /// numbers, if the scene or the film is too large.
  GpuUpload(const gpu::Device& device, const World& world, const FilmPlanes& planes);
  /// Uploads the world as it is now; the world must outlive the renderer, too. Call once.
  std::shared_ptr<SampleRenderer> renderer();

 private:
  gpu::Device device_;
  const World& world_;
  const FilmPlanes planes_;
  RenderTables tables_;
  const Capacity room_;
};

}  // namespace tdpt
