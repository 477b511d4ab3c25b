// Test only: the code of shaders/shared/path/surface.h as C++, over tables on the host.
#pragma once
#include "libcommon/scene/surface_tables.h"
#include "shaders/shared/path/tables.h"
#include "shaders/shared/tables.h"
#include "tools/tdpt-render/path/bsdf/scatter.h"

namespace tdpt::shader {

/// The same for all scenes.
struct Curves {
  std::vector<float> surface = of(tdpt::surface_curves()), sheen = of(tdpt::sheen_curves());
  static std::vector<float> of(std::span<const double> curves) {
    return {curves.begin(), curves.end()};
  }
};

struct ScalarSurface {
  using Real = float;
  TABLES_OF_SURFACES(REFERS_TO)
  bool scene_has_layers, scene_has_normals, scene_has_textures, scene_has_colours, scene_has_coats,
      scene_has_sheen, scene_has_transmission, scene_has_absorption, scene_has_panes,
      scene_has_coverage, coverage_has_textures;

  ScalarSurface(const SurfaceTables& t, const Curves& curves)
      : faces(t.faces.data()),
        materials(t.materials.data()),
        material_maps(t.material_maps.data()),
        texture_maps(t.maps.data()),
        face_corners(t.face_corners.data()),
        corner_attributes(t.corner_attributes.data()),
        surface_curves(curves.surface.data()),
        sheen_curves(curves.sheen.data()),
        coverage_of(t.coverage.coverage_of.data()),
        coverages(t.coverage.coverages.data()),
        texel_words(t.texel_words.data()),
        scene_has_layers(t.features.layers),
        scene_has_normals(t.features.normals),
        scene_has_textures(t.features.textures),
        scene_has_colours(t.features.colours),
        scene_has_coats(t.features.coats),
        scene_has_sheen(t.features.sheen),
        scene_has_transmission(t.features.transmission),
        scene_has_absorption(t.features.absorption),
        scene_has_panes(t.features.panes),
        scene_has_coverage(t.features.coverage),
        coverage_has_textures(t.features.coverage_textures) {}

#include "shaders/shared/path/surface.h"
};

}  // namespace tdpt::shader
