// Renders samples on a Vulkan device: what fits into its memory, and the steps as compute kernels.
#pragma once
#include <memory>

#include "libcommon/gpu/kernel.h"
#include "tools/tdpt-render/device/tables.h"
#include "tools/tdpt-render/device/wavefront.h"
#include "tools/tdpt-render/integrators/passes.h"

namespace tdpt {

/// What a rendering needs of a device beside the samples.
struct DeviceNeeds {
  uint64_t scene = 0, film = 0;  ///< bytes; the scene is in one buffer
  bool layered = false;          ///< vertices store their layers [SurfaceFeatures::layers]
  size_t buffers = 0;            ///< storage buffers that a kernel binds
};

/// The slots and samples that suit the device `name`: together with scene and film at most three
/// quarters of its memory; by themselves at most an eighth, since laptops share it with everything
/// else, or whatever the fewest samples take. Throws Error (no_device), with the number needed and
/// the one allowed, if that is too much.
Capacity capacity_on(const std::string& name, const gpu::Limits& limits, const DeviceNeeds& needs);

/// The capacity that suits the device beside the scene and the film. Throws Error (no_device), with
/// both numbers, if they are too large for it.
Capacity capacity_on(const gpu::Device& device, const RenderTables& tables, uint32_t film_words);

/// `film_words`: of the film and its counters. Throws Error (no_device) if other programs have
/// taken the memory.
std::unique_ptr<Machine> make_gpu_machine(const gpu::Device& device, const RenderTables& tables,
                                          const Capacity& room, uint32_t film_words);

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
