#include "tools/tdpt-render/device/gpu_renderer.h"

#include "tools/tdpt-render/device/gpu_machine.h"
#include "tools/tdpt-render/device/wavefront.h"

namespace tdpt {

std::shared_ptr<SampleRenderer> make_gpu_renderer(const gpu::Device& device, const World& world,
                                                  bool layers) {
  const RenderTables tables(world);
  const auto pixels =
      static_cast<uint64_t>(world.film.width()) * static_cast<uint64_t>(world.film.height());
  const FilmPlaces places(pixels, layers, world.portals.portals());
  return std::make_shared<WavefrontRenderer>(
      world, make_gpu_machine(device, tables, room_on(device), places.words));
}

}  // namespace tdpt
