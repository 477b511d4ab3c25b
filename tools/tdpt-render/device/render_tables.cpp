#include "tools/tdpt-render/device/render_tables.h"

#include "libcommon/film/film.h"
#include "tools/tdpt-render/path/bsdf/surface_curves.h"

namespace tdpt {

RenderTables::RenderTables(const World& world)
    : radiance_unit(Film::power_of_two(world.lights.power())),
      surfaces(make_surfaces(world.scene, radiance_unit)),
      curves(make_surface_curves()),
      lights(make_light_tables(world, radiance_unit)),
      portals(world.portals),
      bvh(build_bvh(world.scene)) {}

void RenderTables::follow(const World& world) {
  lights = make_light_tables(world, radiance_unit);
  portals = PortalTables(world.portals);
}

}  // namespace tdpt
