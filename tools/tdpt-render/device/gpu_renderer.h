// Renders samples on a Vulkan device.
#pragma once
#include <memory>

#include "libcommon/gpu/device.h"
#include "tools/tdpt-render/device/capacity.h"
#include "tools/tdpt-render/device/wavefront.h"
#include "tools/tdpt-render/integrators/sample_renderer.h"

namespace tdpt {

/// The upload of a vista to a device, in two stages: the constructor checks that it fits before
/// any work begins, renderer() uploads its final openings.
class GpuUpload {
 public:
  /// `planes`: what films may have. Throws Error (no_device), with both numbers, if the scene or
  /// the film is too large.
  GpuUpload(const gpu::Device& device, const Vista& vista, const FilmPlanes& planes);
  /// `vista`, which must outlive the renderer: as before, but for its openings. Call once.
  std::shared_ptr<SampleRenderer> renderer(const Vista& vista);

 private:
  gpu::Device device_;
  RenderTables tables_;
  const uint32_t film_words_;
  const Capacity room_;
};

}  // namespace tdpt
