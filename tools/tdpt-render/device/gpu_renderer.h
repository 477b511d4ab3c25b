// Renders samples on a Vulkan device.
#pragma once
#include <memory>

#include "libcommon/gpu/device.h"
#include "tools/tdpt-render/sample_renderer.h"

namespace tdpt {

/// Brings the world to the device as it is now; it must outlive the renderer. `layers`: films may
/// have them. Throws Error (no_device), with both numbers, where the scene or the film is too
/// large.
std::shared_ptr<SampleRenderer> make_gpu_renderer(const gpu::Device& device, const World& world,
                                                  bool layers);

}  // namespace tdpt
