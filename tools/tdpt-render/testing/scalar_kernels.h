// The scalar build of the renderer's kernels: their text as C++ in floats.
#pragma once
#include "shaders/shared/path/tables.h"
#include "tools/tdpt-render/device/tables.h"
#include "tools/tdpt-render/device/wavefront.h"

namespace tdpt::shader {

// Refers to memory under the names of a kernel's buffers.
struct ScalarKernels {
  using Real = float;
#define OF_PATH(binding, type, name, array, count) \
  type* array;                                     \
  LOADS(type, name, array)
  SCENE_TABLES(REFERS_TO)
  PATH_TABLES(OF_PATH)
#undef OF_PATH
  uint* film_words;
  const LightSettings* settings_of_lights;
  GuideParameters guiding;
  // Features of the scene.
  bool scene_has_layers, scene_has_normals, scene_has_textures, scene_has_colours, scene_has_coats,
      scene_has_sheen, scene_has_transmission, scene_has_absorption, scene_has_panes,
      scene_has_coverage, coverage_has_textures;
  bool scene_has_sky, scene_has_sky_map, scene_has_lamps, scene_has_rect_lights, scene_has_windows,
      scene_prefers;
  bool scene_has_portals, portals_have_pairs, guide_active, camera_culls, power_heuristic,
      film_has_layers, film_has_halves, film_is_transparent;
  uint mixture_techniques;
  // The submission.
  RenderParameters render;
  StepParameters work;
  uint bucket;

  uint tally_bucket() const {
    return bucket;
  }

#define light_settings (*settings_of_lights)

#include "shaders/shared/path/kernels.h"

#undef light_settings

  void run(Step what, uint i) {
    const uint slot = work.first + i;
    switch (what) {
#define STEP(name, call) \
  case Step::name:       \
    call;                \
    return;
#include "shaders/shared/path/steps.def"
      case Step::kSteps:
        return;
    }
  }
};

/// Of a scene alone, without the memory of a submission. Refers to the tables.
inline ScalarKernels kernels_of(const RenderTables& t) {
  ScalarKernels k{};
  const SceneSpans scene(t);
#define REFER(type, name, array) k.array = scene.array.data();
  SCENE_TABLES(REFER)
#undef REFER
  k.settings_of_lights = &t.lights.settings;
  k.guiding = t.portals.guiding;
  const SurfaceFeatures& f = t.surfaces.features;
  k.scene_has_layers = f.layers;
  k.scene_has_normals = f.normals;
  k.scene_has_textures = f.textures;
  k.scene_has_colours = f.colours;
  k.scene_has_coats = f.coats;
  k.scene_has_sheen = f.sheen;
  k.scene_has_transmission = f.transmission;
  k.scene_has_absorption = f.absorption;
  k.scene_has_panes = f.panes;
  k.scene_has_coverage = f.coverage;
  k.coverage_has_textures = f.coverage_textures;
  k.scene_has_sky = t.lights.has_sky;
  k.scene_has_sky_map = t.lights.has_sky_map;
  k.scene_has_lamps = t.lights.has_lamps;
  k.scene_has_rect_lights = t.lights.has_rect_lights;
  k.scene_has_windows = t.lights.has_windows;
  k.scene_prefers = t.lights.prefers;
  k.scene_has_portals = !t.portals.facets.empty();
  k.portals_have_pairs = !t.portals.pairs.empty();
  return k;
}

}  // namespace tdpt::shader
