#include "tools/tdpt-render/testing/rendering.h"

#include <thread>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "libcommon/testing/tracer_faults.h"
#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/variant.h"

namespace tdpt::render_test {

// Rims of an opening count alike in density and in visibility, whatever the offset of ray origins.
TEST(render, the_step_off_the_surface_does_not_change_the_mean) {
  const Scene scene = read_gltf(two_rooms_path());
  const auto world = std::make_shared<World>(scene, false);
  const Vista vista(world, scene.camera(""), 64, 48, {portal_in_the_hole()});
  const auto run = [&](double scale) {
    TracerFaults::scale_step(world->tracer, scale);
    Job settings;
    settings.limits.spp = 32;
    return luminance(Vec3f(render(vista, tdpt_ref, settings).mean()));
  };
  const double once = run(1);
  EXPECT_NEAR(run(4) / once, 1, 2e-3);
  EXPECT_GT(std::abs(run(20000) / once - 1), 2e-3);  // twin: a step of 1 cm does
}

TEST(render, same_bytes_for_any_number_of_threads_and_others_for_another_seed) {
  const Scene scene = read_gltf(two_rooms_path());
  const Vista vista(scene, scene.camera(""), 40, 30, {portal_in_the_hole()});
  const auto rendered = [&](size_t threads, uint64_t seed) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    Job settings;
    settings.limits.spp = 8;
    settings.seed = seed;
    return render(vista, tdpt_org, settings).picture.pixels;
  };
  EXPECT_EQ(rendered(1, 1), rendered(3, 1));
  EXPECT_NE(rendered(3, 1), rendered(3, 2));
}

TEST(render, no_light_is_a_black_picture) {
  Scene scene = read_gltf(two_rooms_path());
  for (Material& m : scene.materials) m.emission = {};
  const Vista vista(scene, scene.camera(""), 8, 6, {portal_in_the_hole()});
  Job settings;
  settings.limits.spp = 2;
  for (const Integrator* integrator : integrators()) {
    const RenderResult r = render(vista, *integrator, settings);
    EXPECT_EQ(r.nonzero(), 0);
    EXPECT_EQ(r.tally.not_finite, 0u);
  }
}

// Rounding decides whether a ray hits one of two coincident surfaces; all rays must decide alike.
TEST(render, a_lamp_in_the_plane_of_the_ceiling_shines_for_every_integrator) {
  Scene scene = read_gltf(furnace_path());
  for (Material& m : scene.materials) m.emission = {};
  PunctualLight lamp;
  lamp.position = scene.frame.to_canonical({0.1, 2, 0.2});
  lamp.intensity = Rgb(1);
  scene.lights.push_back(lamp);
  const Vista vista(scene, scene.camera(""), 32, 24, {portal_in_the_furnace()});
  Job settings;
  settings.limits.spp = 64;
  const double expected = render(vista, nee, settings).mean().x;
  EXPECT_GT(expected, 0.01);
  for (const Integrator* integrator : {&bdpt, &tdpt_org, &tdpt_ref})
    EXPECT_NEAR(render(vista, *integrator, settings).mean().x / expected, 1, 0.03)
        << integrator->name;
}

// Like a device: slow to prepare, and efficient only with many samples at a time.
class Eager : public CpuRenderer {
 public:
  using CpuRenderer::CpuRenderer;
  void prepare(const Integrator&, const SampleRules&, const Film&, bool) override {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    ++prepared;
  }
  void render(const Integrator& integrator, const SampleRules& rules, uint64_t round,
              const SampleRange& samples, Film& film, Tally& tally,
              ProgressBar& progress) override {
    EXPECT_EQ(prepared, 1);
    calls.push_back(samples.count);
    CpuRenderer::render(integrator, rules, round, samples, film, tally, progress);
  }
  bool on_device() const override { return true; }
  uint64_t samples_of_pass() const override { return uint64_t{1} << 40; }

  int prepared = 0;
  std::vector<uint64_t> calls;
};

TEST(render, gives_a_device_as_many_samples_at_a_time_as_nothing_wants_one_by_one) {
  const Scene scene = read_gltf(two_rooms_path());
  const Vista vista(scene, scene.camera(""), 16, 12, {});
  Job settings;
  settings.limits.spp = 40;
  const RenderResult by_cpu = render(vista, bdpt, settings);
  Eager device(vista);
  const RenderResult r = render(device, bdpt, settings);
  EXPECT_EQ(device.calls, std::vector<uint64_t>(5, 8));
  ASSERT_TRUE(r.noise && by_cpu.noise);
  EXPECT_NEAR(r.noise->relmse / by_cpu.noise->relmse, 1, 1e-4);
  EXPECT_EQ(r.picture.pixels, by_cpu.picture.pixels);
  EXPECT_EQ(r.tally.rays.closest, by_cpu.tally.rays.closest);
  // If all samples exist already, the device is not prepared.
  device.calls.clear(), device.prepared = 0;
  Session session(device, settings);
  EXPECT_EQ(render(session, r.plan, r.progress).picture.pixels, by_cpu.picture.pixels);
  EXPECT_EQ(device.prepared, 0);
  settings.frames = true;
  EXPECT_EQ(render(device, bdpt, settings).picture.pixels, by_cpu.picture.pixels);
  EXPECT_EQ(device.calls, std::vector<uint64_t>(40, 1));
}

TEST(render, counts_no_time_that_a_device_takes_to_be_ready_and_overruns_little) {
  const Scene scene = read_gltf(two_rooms_path());
  const Vista vista(scene, scene.camera(""), 16, 12, {});
  Job settings;
  settings.limits.seconds = 0.2;
  Eager device(vista);
  const RenderResult r = render(device, bdpt, settings);
  EXPECT_GT(r.spp(), 10u);
  EXPECT_GT(r.progress->seconds, 0.1);
  EXPECT_LT(r.progress->seconds, 0.29);
}

}  // namespace tdpt::render_test
