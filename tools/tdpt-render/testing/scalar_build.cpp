#include "tools/tdpt-render/testing/scalar_build.h"

#include <oneapi/tbb/parallel_for.h>

#include "libcommon/math/sequence.h"
#include "shaders/shared/path/tables.h"

namespace tdpt {
namespace shader {
namespace {

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

struct Memory {
  const Capacity room;
  const uint words_of_film;
  static constexpr bool layered = true;
#define VECTOR(binding, type, name, array, count) \
  std::vector<type> array = std::vector<type>(count);
  PATH_TABLES(VECTOR)
  std::vector<uint> film_words = std::vector<uint>(words_of_film);
#undef VECTOR
};

ScalarKernels kernels_of(const RenderTables& t) {
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

}  // namespace
}  // namespace shader

namespace {

class ScalarMachine : public Machine {
 public:
  ScalarMachine(const RenderTables& tables, const Capacity& room, uint32_t film_words)
      : room_(room), kernels_(shader::kernels_of(tables)), memory_{room, film_words} {
#define REFER(binding, type, name, array, count) kernels_.array = memory_.array.data();
    PATH_TABLES(REFER)
    kernels_.film_words = memory_.film_words.data();
#undef REFER
  }

  Capacity room() const override {
    return room_;
  }

  void set(const shader::RenderParameters& p, const std::vector<uint32_t>& cache_offsets) override {
    std::copy(cache_offsets.begin(), cache_offsets.end(), kernels_.cache_offsets);
    kernels_.render = p;
    kernels_.camera_culls = p.culls != 0;
    kernels_.mixture_techniques = p.techniques;
    kernels_.power_heuristic = p.beta == 2;
    kernels_.film_has_layers = p.layers != 0;
    kernels_.film_has_halves = p.halves != 0;
    kernels_.film_is_transparent = p.transparent != 0;
    kernels_.guide_active = p.guide_light > 0 || p.guide_camera > 0;
  }

  void run(Step step, const shader::StepParameters& parameters) override {
    constexpr uint32_t kGroup = 64;
    kernels_.work = parameters;
    oneapi::tbb::parallel_for(
        uint32_t{0}, (parameters.count + kGroup - 1) / kGroup, [&](uint32_t group) {
          shader::ScalarKernels kernels = kernels_;
          kernels.bucket = group % shader::kTallyBuckets;
          const uint32_t end = std::min(parameters.count, (group + 1) * kGroup);
          for (uint32_t i = group * kGroup; i < end; ++i) kernels.run(step, i);
        });
  }

  uint32_t pick(uint32_t count, uint32_t first) override {
    uint32_t n = 0;
    for (uint32_t i = 0; i < count; ++i) {
      kernels_.ranks[i] = n;
      if (kernels_.flags[i] != 0) kernels_.alive[n++] = first + i;
    }
    return n;
  }

  void place_ends(uint32_t walks) override {
    uint32_t sum = 0;
    for (uint32_t i = 0; i < walks; ++i) {
      kernels_.end_first[i] = sum;
      sum += kernels_.walk_counts[i];
    }
    kernels_.end_first[walks] = sum;
  }

  std::vector<uint32_t> take_film() override {
    std::vector<uint32_t> words = memory_.film_words;
    std::fill(memory_.film_words.begin(), memory_.film_words.end(), 0u);
    return words;
  }

 private:
  const Capacity room_;
  shader::ScalarKernels kernels_;
  shader::Memory memory_;
};

}  // namespace

std::unique_ptr<Machine> make_scalar_machine(const RenderTables& tables, const Capacity& room,
                                             uint32_t film_words) {
  return std::make_unique<ScalarMachine>(tables, room, film_words);
}

}  // namespace tdpt
