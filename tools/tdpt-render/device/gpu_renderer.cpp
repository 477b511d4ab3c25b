#include "tools/tdpt-render/device/gpu_renderer.h"

#include "tools/tdpt-render/device/gpu_machine.h"

namespace tdpt {

GpuUpload::GpuUpload(const gpu::Device& device, const Vista& vista, const FilmPlanes& planes)
    : device_(device),
      tables_(vista),
      film_words_(
          FilmPlaces(vista.view.film.pixels(), planes, vista.openings.portals.portals()).words),
      room_(capacity_on(device, tables_, film_words_)) {}

std::shared_ptr<SampleRenderer> GpuUpload::renderer(const Vista& vista) {
  tables_.follow(vista);
  return std::make_shared<WavefrontRenderer>(
      vista, make_gpu_machine(device_, tables_, room_, film_words_), device_.info().name);
}

}  // namespace tdpt
