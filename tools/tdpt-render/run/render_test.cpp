#include "tools/tdpt-render/run/render.h"

#include <thread>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "libcommon/testing/tracer_faults.h"
#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/variant.h"

namespace tdpt {
namespace {

struct MeanAndError {
  double mean, error;  ///< luminance; standard error from independent seeds
};

// Mean of the picture from `runs` seeds of spp/runs samples each.
MeanAndError estimate(const World& world, const Integrator& integrator, int max_depth, int runs,
                      uint64_t spp) {
  double sum = 0, square = 0;
  for (int r = 0; r < runs; ++r) {
    RenderSettings settings;
    settings.spp = spp / static_cast<uint64_t>(runs);
    settings.max_depth = max_depth;
    settings.seed = static_cast<uint64_t>(r) + 1;
    const double m = luminance(Vec3f(render(world, integrator, settings).mean()));
    sum += m;
    square += m * m;
  }
  const double mean = sum / runs;
  return {mean, std::sqrt(std::max(0.0, square / runs - mean * mean) / (runs - 1))};
}

double z(const MeanAndError& a, const MeanAndError& b) {
  return std::abs(a.mean - b.mean) / std::hypot(a.error, b.error);
}

TEST(render, the_five_integrators_agree_in_the_mean_of_two_rooms) {
  const Scene scene = read_gltf(two_rooms_path());
  const World world(scene, scene.camera(""), 64, 48, {portal_in_the_hole()});
  std::vector<MeanAndError> results;
  for (const Integrator* integrator : integrators()) {
    results.push_back(estimate(world, *integrator, 6, 16, 256));
    const MeanAndError& r = results.back();
    std::printf("%-9s %.6g +- %.2g\n", integrator->name, r.mean, r.error);
    EXPECT_GT(r.mean, 0);
  }
  for (size_t i = 0; i < results.size(); ++i)
    for (size_t j = 0; j < i; ++j)
      EXPECT_LT(z(results[i], results[j]), 3)
          << integrators()[i]->name << " and " << integrators()[j]->name;
}

TEST(render, twin_a_technique_that_is_weighed_but_never_run_is_caught) {
  const Scene scene = read_gltf(two_rooms_path());
  const World world(scene, scene.camera(""), 64, 48, {portal_in_the_hole()});
  const Variant without_splats{tdpt_ref.mixture.techniques,
                               run_only<Technique::camera, Technique::direct, Technique::portal>};
  double sum = 0, square = 0;
  for (uint64_t seed = 1; seed <= 8; ++seed) {
    Film film(64, 48, world.lights.power());
    Tally tally;
    PathSampler sampler(world, without_splats.settings(6, seed), film, tally);
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x)
        for (uint64_t i = 0; i < 8; ++i) without_splats.sample(sampler, x, y, i);
    double mean = 0;
    for (const Vec3d& p : film.sums()) mean += luminance(Vec3f(p)) / (8 * 64 * 48);
    sum += mean;
    square += mean * mean;
  }
  const MeanAndError faulty{sum / 8, std::sqrt((square / 8 - sum / 8 * sum / 8) / 7)};
  EXPECT_GT(z(faulty, estimate(world, tdpt_ref, 6, 8, 64)), 5);
}

// Closed box: every surface emits 1 and reflects rho. L = sum_{i<k} rho^i.
TEST(render, furnace_box_shows_the_geometric_series) {
  const Scene scene = read_gltf(furnace_path());
  const World world(scene, scene.camera(""), 32, 24, {portal_in_the_furnace()});
  const double rho = scene.materials[scene.triangles[0].material].base_color.x;
  ASSERT_GT(rho, 0.1);
  for (int k = 1; k <= 6; ++k) {
    double expected = 0;
    for (int i = 0; i < k; ++i) expected += std::pow(rho, i);
    for (const Integrator* integrator : integrators()) {
      const MeanAndError r = estimate(world, *integrator, k, 8, 64);
      // pt meets a light at every vertex: no variance at all but rounding.
      EXPECT_LT(std::abs(r.mean - expected), 3.5 * r.error + 1e-5 * expected)
          << integrator->name << " depth " << k << ": " << r.mean << " for " << expected;
      EXPECT_LT(r.error, 0.02 * expected);
    }
  }
}

void expect_all_to_agree(const World& world, uint64_t spp) {
  const MeanAndError truth = estimate(world, nee, 5, 8, 2 * spp);
  for (const Integrator* integrator : {&bdpt, &tdpt_org, &tdpt_ref}) {
    const MeanAndError r = estimate(world, *integrator, 5, 8, spp);
    EXPECT_LT(z(r, truth), 3.5) << integrator->name << " " << r.mean << " for " << truth.mean;
    EXPECT_LT(r.error, 0.015 * r.mean);  // fine enough to notice a few per cent
  }
}

TEST(render, lamps_that_shine_on_both_sides_agree_too) {
  Scene scene = read_gltf(TDPT_TESTDATA "/scenes/window.glb");
  for (Material& m : scene.materials) m.double_sided = true;
  const World world(scene, scene.camera(""), 32, 24, {portal_in_the_hole()});
  expect_all_to_agree(world, 256);
}

// On the floor, in the lamp, in the plane of a wall: no light passes there, or only some.
TEST(render, portals_that_lie_in_a_surface_cost_time_only) {
  const Scene scene = read_gltf(TDPT_TESTDATA "/scenes/window.glb");
  const Portal floor = rectangle({0.2, 0, -0.8}, {0, 0, 1.6}, {1.6, 0, 0});
  const Portal lamp = rectangle({2.8, 1.99, -0.3}, {0.6, 0, 0}, {0, 0, 0.6});
  const Portal wall = rectangle({2.1, 0, -1}, {0, 0, 2}, {0, 2, 0});
  for (const Portal& portal : {floor, lamp, wall})
    expect_all_to_agree(World(scene, scene.camera(""), 32, 24, {portal}), 256);
}

// The power of the lamp from a spot: splats are faint beside its radiance, and are kept.
TEST(render, a_tiny_lamp_of_the_same_power_gives_the_same_picture) {
  const Scene lamp = read_gltf(two_rooms_path());
  Scene spot = lamp;
  const double shrink = 1e-3;
  for (const Triangle& t : lamp.triangles) {
    if (max_component(lamp.materials[t.material].emission) <= 0) continue;
    for (uint32_t v : t.vertex) {
      const Vec3f middle(lamp.frame.to_canonical({3.1, 1.99, 0}));
      spot.positions[v] = middle + (lamp.positions[v] - middle) * static_cast<float>(shrink);
    }
  }
  for (Material& m : spot.materials) m.emission *= static_cast<float>(1 / (shrink * shrink));
  const World world(spot, spot.camera(""), 32, 24, {portal_in_the_hole()});
  expect_all_to_agree(world, 2048);
}

TEST(render, power_heuristic_agrees_with_balance) {
  const Scene scene = read_gltf(two_rooms_path());
  const World world(scene, scene.camera(""), 64, 48, {portal_in_the_hole()});
  const auto run = [&](double beta) {
    RenderSettings settings;
    settings.spp = 128;
    settings.beta = beta;
    return luminance(Vec3f(render(world, tdpt_org, settings).mean()));
  };
  const double balance = run(1), power = run(2);
  EXPECT_NE(balance, power);
  EXPECT_NEAR(power / balance, 1, 0.02);  // the same samples, weighed otherwise
}

// Rims of an opening count in density and in visibility alike, however far rays step off.
TEST(render, the_step_off_the_surface_does_not_change_the_mean) {
  const Scene scene = read_gltf(two_rooms_path());
  World world(scene, scene.camera(""), 64, 48, {portal_in_the_hole()});
  const auto run = [&](double scale) {
    TracerFaults::scale_step(world.tracer, scale);
    RenderSettings settings;
    settings.spp = 128;
    return luminance(Vec3f(render(world, tdpt_ref, settings).mean()));
  };
  const double once = run(1);
  EXPECT_NEAR(run(4) / once, 1, 2e-3);
  EXPECT_GT(std::abs(run(20000) / once - 1), 2e-3);  // twin: a step of 1 cm does
}

TEST(render, same_bytes_for_any_number_of_threads) {
  const Scene scene = read_gltf(two_rooms_path());
  const World world(scene, scene.camera(""), 40, 30, {portal_in_the_hole()});
  RenderSettings settings;
  settings.spp = 8;
  std::vector<Picture> pictures;
  for (size_t threads : {1, 2, 3}) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    pictures.push_back(render(world, tdpt_org, settings).picture);
  }
  EXPECT_EQ(pictures[0].pixels, pictures[1].pixels);
  EXPECT_EQ(pictures[0].pixels, pictures[2].pixels);
}

TEST(render, twin_another_seed_gives_other_pixels) {
  const Scene scene = read_gltf(two_rooms_path());
  const World world(scene, scene.camera(""), 40, 30, {portal_in_the_hole()});
  RenderSettings settings;
  settings.spp = 8;
  const Picture first = render(world, tdpt_org, settings).picture;
  settings.seed = 2;
  EXPECT_NE(first.pixels, render(world, tdpt_org, settings).picture.pixels);
}

TEST(render, no_light_is_a_black_picture) {
  Scene scene = read_gltf(two_rooms_path());
  for (Material& m : scene.materials) m.emission = {};
  const World world(scene, scene.camera(""), 8, 6, {portal_in_the_hole()});
  RenderSettings settings;
  settings.spp = 2;
  for (const Integrator* integrator : integrators()) {
    const RenderResult r = render(world, *integrator, settings);
    EXPECT_EQ(r.nonzero(), 0);
    EXPECT_EQ(r.tally.not_finite, 0u);
  }
}

// In the plane of a surface rounding decides whether a ray meets it; every ray must decide alike.
TEST(render, a_lamp_in_the_plane_of_the_ceiling_shines_for_every_integrator) {
  Scene scene = read_gltf(furnace_path());
  for (Material& m : scene.materials) m.emission = {};
  PunctualLight lamp;
  lamp.position = scene.frame.to_canonical({0.1, 2, 0.2});
  lamp.intensity = Rgb(1);
  scene.lights.push_back(lamp);
  const World world(scene, scene.camera(""), 32, 24, {portal_in_the_furnace()});
  RenderSettings settings;
  settings.spp = 64;
  const double expected = render(world, nee, settings).mean().x;
  EXPECT_GT(expected, 0.01);
  for (const Integrator* integrator : {&bdpt, &tdpt_org, &tdpt_ref})
    EXPECT_NEAR(render(world, *integrator, settings).mean().x / expected, 1, 0.03)
        << integrator->name;
}

// As a device: it takes a while to be ready, and wants many samples at a time.
class Eager : public CpuRenderer {
 public:
  using CpuRenderer::CpuRenderer;
  void prepare(const Integrator&, const SampleRules&, const Film&, bool) override {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    ++prepared;
  }
  void render(const Integrator& integrator, const SampleRules& rules, uint64_t round,
              const SampleRange& samples, Film& film, Tally& tally, Progress& progress) override {
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
  const World world(scene, scene.camera(""), 16, 12, {});
  RenderSettings settings;
  settings.spp = 40;
  const RenderResult by_cpu = render(world, bdpt, settings);
  Eager device(world);
  const RenderResult r = render(device, bdpt, settings);
  EXPECT_EQ(device.calls, std::vector<uint64_t>(5, 8));
  ASSERT_TRUE(r.noise && by_cpu.noise);
  EXPECT_NEAR(r.noise->relmse / by_cpu.noise->relmse, 1, 1e-4);
  EXPECT_EQ(r.picture.pixels, by_cpu.picture.pixels);
  EXPECT_EQ(r.tally.rays.closest, by_cpu.tally.rays.closest);
  // What is there already needs no device to be ready.
  device.calls.clear(), device.prepared = 0;
  Course course;
  course.plan = r.plan;
  course.standing.emplace(std::move(*r.standing));
  EXPECT_EQ(render(device, {{bdpt, bdpt.name}}, settings, {}, std::move(course)).picture.pixels,
            by_cpu.picture.pixels);
  EXPECT_EQ(device.prepared, 0);
  decide(device, {{bdpt, bdpt.name}}, settings, {});
  EXPECT_EQ(device.prepared, 0);
  settings.frames = true;
  EXPECT_EQ(render(device, bdpt, settings).picture.pixels, by_cpu.picture.pixels);
  EXPECT_EQ(device.calls, std::vector<uint64_t>(40, 1));
}

TEST(render, counts_no_time_that_a_device_takes_to_be_ready_and_overruns_little) {
  const Scene scene = read_gltf(two_rooms_path());
  const World world(scene, scene.camera(""), 16, 12, {});
  RenderSettings settings;
  settings.seconds = 0.2;
  Eager device(world);
  const RenderResult r = render(device, bdpt, settings);
  EXPECT_GT(r.spp, 10u);
  EXPECT_GT(r.seconds, 0.1);
  EXPECT_LT(r.seconds, 0.29);
}

}  // namespace
}  // namespace tdpt
