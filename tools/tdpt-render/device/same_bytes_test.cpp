// A device produces the same bytes as its scalar build on the CPU, whatever is in the scene, and
// Vulkan's validation layers report nothing.
#include <gtest/gtest.h>

#include "tools/tdpt-render/device/gpu_renderer.h"
#include "tools/tdpt-render/plan/candidates.h"
#include "tools/tdpt-render/testing/device.h"
#include "tools/tdpt-render/testing/stages.h"
#include "tools/tdpt-render/testing/surface_scene.h"
#include "tools/tdpt-render/testing/variant.h"

namespace tdpt::same_bytes_test {

constexpr int kWidth = 33, kHeight = 17;

class device_bytes : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* on = getenv("TDPT_VULKAN_VALIDATION");
    ASSERT_TRUE(on && std::string(on) == "1") << "run it with ctest, or set what ctest sets";
    device_ = std::make_unique<gpu::Device>(gpu::Device::open());
  }
  const gpu::Device& device() const { return *device_; }

 private:
  std::unique_ptr<gpu::Device> device_;
};

// Both machines of a stage, for pictures of up to kWidth x kHeight pixels.
class Pair {
 public:
  Pair(const gpu::Device& device, const Stage& stage)
      : stage_(stage), largest_(stage.vista(kWidth, kHeight)), tables_(largest_) {
    const uint32_t words = film_words(largest_);
    gpu_ = make_gpu_machine(device, tables_, kEnough, words);
    twin_ = make_scalar_machine(tables_, kEnough, words);
  }

  struct Outcomes {
    Outcome gpu, scalar;
  };
  Outcomes rendered(int width, int height, const Integrator& integrator, const Samples& samples,
                    const Capacity& room = kEnough) const {
    const Vista vista = stage_.vista(width, height);
    const auto by = [&](Machine& machine) {
      WavefrontRenderer renderer(vista, std::make_unique<Borrowed>(machine, room), "borrowed");
      return rendered_by(renderer, vista, integrator, samples);
    };
    return {by(*gpu_), by(*twin_)};
  }

  void expect_same(int width, int height, const Integrator& integrator, const Samples& samples,
                   const Capacity& room = kEnough) const {
    const Outcomes both = rendered(width, height, integrator, samples, room);
    EXPECT_EQ(both.gpu, both.scalar) << stage_.name << " " << integrator.name << " " << width
                                     << " x " << height << ", depth " << samples.rules.max_depth;
  }

 private:
  const Stage& stage_;
  const Vista largest_;
  const RenderTables tables_;
  std::unique_ptr<Machine> gpu_, twin_;
};

// Compiling kernels takes most of the time: two stages use integrators that together run all
// kernels, the others one. An integrator's kernels are specialised alike for all its samples.
const std::vector<const Integrator*> kFew{&nee, &bdpt, &tdpt_guided};

Samples samples_of(const Integrator& integrator, const SampleRange& range, int depth,
                   const Stage& stage) {
  const double beta = tdpt_guided.name == std::string_view(integrator.name) ? 2 : 1;
  return {
      range, {depth, beta, range.first}, stage.alpha, &integrator != &bdpt, &integrator != &nee};
}

void expect_all_same(const gpu::Device& device, const Stage& stage,
                     const std::vector<const Integrator*>& chosen = {&tdpt_guided}) {
  const Pair pair(device, stage);
  uint64_t seed = 0;
  for (const Integrator* integrator : chosen) {
    const auto expect_same = [&](int width, int height, const SampleRange& range, int depth,
                                 const Capacity& room = kEnough) {
      pair.expect_same(width, height, *integrator, samples_of(*integrator, range, depth, stage),
                       room);
    };
    for (const int depth : {1, 2, 3, 16}) expect_same(kWidth, kHeight, {++seed, 2}, depth);
    expect_same(1, 1, {0, 5}, 5);
    expect_same(7, 5, {0, 3}, 5);
    expect_same(kWidth, kHeight, {0, 2}, 5, {1u << 13, kMostOfCache});
  }
}

Stage heap_stage() {
  return {"heap", under(test::SurfaceHeap().scene(), one_colour_sky(Rgb(1))), {}};
}

// So that no kernel's branch goes without a comparison.
TEST(stages, use_every_feature_between_them) {
  std::vector<bool> used(20);
  for (const Stage& stage : {two_rooms_stage(), door_stage(), materials_stage(), heap_stage(),
                             lamps_stage(), sky_stage(), culling_stage(), everything_stage()}) {
    const RenderTables t(stage.vista());
    const LightTables& l = t.lights;
    const SurfaceFeatures& f = t.surfaces.features;
    const std::array<bool, 20> uses{l.has_sky,
                                    l.has_sky_map,
                                    l.has_lamps,
                                    l.has_rect_lights,
                                    l.has_windows,
                                    l.prefers,
                                    l.settings.plain.block > 1,
                                    l.settings.suns > 0,
                                    f.layers,
                                    f.normals,
                                    f.textures,
                                    f.colours,
                                    f.coats,
                                    f.sheen,
                                    f.transmission,
                                    f.absorption,
                                    f.panes,
                                    f.coverage,
                                    f.coverage_textures,
                                    !t.portals.pairs.empty()};
    for (size_t i = 0; i < used.size(); ++i) used[i] = used[i] || uses[i];
  }
  EXPECT_EQ(used, std::vector<bool>(used.size(), true));
}

// A test each, so that they run side by side.
TEST_F(device_bytes, of_plain_rooms) {
  expect_all_same(device(), two_rooms_stage(), kFew);
}
TEST_F(device_bytes, of_many_lamps_behind_a_door) {
  expect_all_same(device(), door_stage());
}
TEST_F(device_bytes, of_all_materials) {
  expect_all_same(device(), materials_stage());
}
TEST_F(device_bytes, of_a_heap_of_odd_surfaces) {
  expect_all_same(device(), heap_stage(), {&bdpt});
}
TEST_F(device_bytes, of_lamps_without_surface) {
  expect_all_same(device(), lamps_stage());
}
TEST_F(device_bytes, of_sky_sun_and_windows) {
  expect_all_same(device(), sky_stage());
}
TEST_F(device_bytes, of_a_camera_that_culls_and_a_transparent_film) {
  expect_all_same(device(), culling_stage());
}
TEST_F(device_bytes, of_everything) {
  expect_all_same(device(), everything_stage(), kFew);
}

// With everything the program adds: the device's own capacity, passes, errors, auto.
TEST_F(device_bytes, by_the_renderer_that_the_program_has) {
  const Stage stage = sky_stage();
  const Vista vista = stage.vista(kWidth, kHeight);
  Job settings;
  settings.limits.spp = 5;
  settings.max_depth = 6;
  settings.alpha = settings.layers = settings.halves = true;
  const auto by_device = GpuUpload(device(), vista, {true, true}).renderer(vista);
  ScalarRenderer by_scalar(vista);
  const std::vector<Candidate> candidates = auto_candidates(vista);
  const RenderResult a = render(*by_device, candidates, settings),
                     b = render(by_scalar, candidates, settings);
  EXPECT_EQ(a.plan.forecast.best, b.plan.forecast.best);
  EXPECT_EQ(outcome_of(a.progress->film, a.progress->tally),
            outcome_of(b.progress->film, b.progress->tally));
}

// Twin: one wrong bit in a table makes another picture.
TEST_F(device_bytes, twin_one_wrong_bit_in_a_table_is_seen) {
  const Stage stage = two_rooms_stage();
  const auto up = [](float& x) { x = std::nextafter(x, 2 * x); };
  const std::vector<std::function<void(RenderTables&)>> spoils{
      [&](RenderTables& t) { up(t.surfaces.materials[0].base_color.x); },
      [&](RenderTables& t) { up(t.surfaces.faces[7].e1.y); },
      [&](RenderTables& t) { up(t.portals.facets[0].density); },
      [&](RenderTables& t) { up(t.lights.emitters[0].pdf_A); }};
  const Samples samples{{0, 4}, {8}};
  const Pair::Outcomes both = Pair(device(), stage).rendered(kWidth, kHeight, tdpt_org, samples);
  EXPECT_EQ(both.gpu, both.scalar);
  const Vista vista = stage.vista(kWidth, kHeight);
  for (size_t i = 0; i < spoils.size(); ++i) {
    ScalarRenderer spoilt(vista, kEnough, {.tables = spoils[i]});
    EXPECT_NE(both.gpu, rendered_by(spoilt, vista, tdpt_org, samples)) << i;
  }
}

}  // namespace tdpt::same_bytes_test
