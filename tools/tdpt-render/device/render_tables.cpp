#include "tools/tdpt-render/device/render_tables.h"

#include "libcommon/film/film.h"
#include "libcommon/math/sequence.h"
#include "tools/tdpt-render/path/bsdf/surface_curves.h"

namespace tdpt {
namespace {

std::vector<float> in_floats(std::span<const double> curves) {
  return {curves.begin(), curves.end()};
}

}  // namespace

RenderTables::RenderTables(const Vista& vista)
    : radiance_unit(Film::power_of_two(vista.world->lights.power())),
      surfaces(make_surfaces(vista.world->scene, radiance_unit)),
      surface_curves(in_floats(tdpt::surface_curves())),
      sheen_curves(surfaces.features.sheen ? in_floats(tdpt::sheen_curves())
                                           : std::vector<float>()),
      lights(make_light_tables(vista, radiance_unit)),
      portals(vista.openings.portals),
      bvh(build_bvh(vista.world->scene)) {}

void RenderTables::follow(const Vista& vista) {
  lights = make_light_tables(vista, radiance_unit);
  portals = PortalTables(vista.openings.portals);
}

shader::SceneSpans::SceneSpans(const RenderTables& t)
    : bvh_nodes(t.bvh.nodes),
      bvh_triangles(t.bvh.triangles),
      sobol_points(shader::sobol_points),
      faces(t.surfaces.faces),
      materials(t.surfaces.materials),
      material_maps(t.surfaces.material_maps),
      texture_maps(t.surfaces.maps),
      face_corners(t.surfaces.face_corners),
      corner_attributes(t.surfaces.corner_attributes),
      surface_curves(t.surface_curves),
      sheen_curves(t.sheen_curves),
      coverage_of(t.surfaces.coverage.coverage_of),
      coverages(t.surfaces.coverage.coverages),
      texel_words(t.surfaces.texel_words),
      light_words(t.lights.words),
      light_emitters(t.lights.emitters),
      light_lamps(t.lights.lamps),
      sky_suns(t.lights.suns),
      sky_texels(t.lights.texels),
      rect_lights(t.lights.rect_lights),
      sky_windows(t.lights.windows),
      window_frames(t.lights.frames),
      portal_facets(t.portals.facets),
      portal_polygons(t.portals.polygons),
      portal_corners(t.portals.corners),
      portal_pairs(t.portals.pairs) {}

}  // namespace tdpt
