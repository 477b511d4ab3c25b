#include "tools/tdpt-render/device/gpu_renderer.h"

#include "tools/tdpt-render/device/gpu_machine.h"

namespace tdpt {
namespace {

uint32_t film_words(const World& world, const FilmPlanes& planes) {
  const auto pixels =
      static_cast<uint64_t>(world.film.width()) * static_cast<uint64_t>(world.film.height());
  return FilmPlaces(pixels, planes, world.portals.portals()).words;
}

}  // namespace

GpuUpload::GpuUpload(const gpu::Device& device, const World& world, const FilmPlanes& planes)
    : device_(device),
      world_(world),
      planes_(planes),
      tables_(world),
      room_(capacity_on(device, tables_, film_words(world, planes))) {}

std::shared_ptr<SampleRenderer> GpuUpload::renderer() {
  tables_.follow(world_);
  return std::make_shared<WavefrontRenderer>(
      world_, make_gpu_machine(device_, tables_, room_, film_words(world_, planes_)),
      device_.info().name);
}

}  // namespace tdpt
