// Every path that any technique makes is held against the oracle: its MIS weight, and that its
// unweighted value is the measurement contribution divided by the density of its strategy.
#include <gtest/gtest.h>

#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/path/oracle.h"
#include "tools/tdpt-render/test_rooms.h"

namespace tdpt {
namespace {

using oracle::Fault;

struct Worst {
  double weight = 0;  ///< largest difference of the weights
  double value = 0;   ///< largest relative difference of value * p and the contribution
  std::array<int, kTechniques> paths{};
};

Worst compare(const Integrator& integrator, Fault fault, int max_depth = 6, uint64_t spp = 64) {
  const Scene scene = read_gltf(two_rooms_path());
  const World world(scene, scene.camera(""), 16, 12, two_crossing_portals());
  Film film(16, 12, 1);
  Tally tally;
  Worst worst;
  const PathObserver observer = [&](const Path& path, Strategy strategy, const Rgb& value) {
    ++worst.paths[static_cast<size_t>(strategy.technique)];
    const auto p = oracle::densities(world, path, integrator.techniques, fault);
    const double w = path.weight(integrator.techniques, strategy, 1);
    worst.weight = std::max(worst.weight, std::abs(w - oracle::weight(p, strategy)));
    for (const auto& d : p) {
      if (d.strategy.technique != strategy.technique || d.strategy.split != strategy.split)
        continue;
      const double expected = oracle::contribution(world, path).x;
      const double relative = value.x * std::exp(d.log_p) / expected - 1;
      worst.value = std::max(worst.value, std::abs(relative));
    }
  };
  PathSampler sampler(world, {integrator.techniques, max_depth, 1, 11, integrator.stream}, film,
                      tally, &observer);
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 16; ++x)
      for (uint64_t s = 0; s < spp; ++s) {
        sampler.begin(x, y, s);
        integrator.sample(sampler);
        sampler.end();
      }
  return worst;
}

class paths : public testing::TestWithParam<const Integrator*> {};

TEST_P(paths, weights_and_values_are_the_oracles) {
  const Worst worst = compare(*GetParam(), Fault::none);
  EXPECT_LT(worst.weight, 1e-6);  // hit points lie beside the sampled rays by float rounding
  EXPECT_LT(worst.value, 1e-4);   // values are floats
  for (size_t i = 0; i < kTechniques; ++i) {
    if (GetParam()->techniques.has(static_cast<Technique>(i))) {
      EXPECT_GT(worst.paths[i], i == 0 ? 0 : 50) << kTechniqueNames[i];
    }
  }
}

TEST_P(paths, weights_of_all_strategies_sum_to_1) {
  const Scene scene = read_gltf(two_rooms_path());
  const World world(scene, scene.camera(""), 16, 12, two_crossing_portals());
  Film film(16, 12, 1);
  Tally tally;
  const TechniqueSet set = GetParam()->techniques;
  int crossing = 0;
  const PathObserver observer = [&](const Path& path, Strategy, const Rgb&) {
    double sum = path.weight(set, {Technique::camera, 0}, 1);
    if (path.k() >= 2) {
      sum += path.weight(set, {Technique::direct, 1}, 1);
      sum += path.weight(set, {Technique::light, path.k()}, 1);
      for (int s = 2; s < path.k(); ++s) sum += path.weight(set, {Technique::bi, s}, 1);
      int portals = 0;
      for (int a = 0; a <= path.k() - 2; ++a) {
        const double w = path.weight(set, {Technique::portal, a}, 1);
        portals += w > 0;
        sum += w;
      }
      crossing += portals > 1;
    }
    EXPECT_NEAR(sum, 1, 1e-12);
  };
  PathSampler sampler(world, {set, 6, 1, 5, GetParam()->stream}, film, tally, &observer);
  for (uint64_t s = 0; s < 2000; ++s) {
    sampler.begin(8, 6, s);
    GetParam()->sample(sampler);
    sampler.end();
  }
  if (set.has(Technique::portal)) {
    EXPECT_GT(crossing, 0);  // some paths cross twice
  }
}

INSTANTIATE_TEST_SUITE_P(integrators, paths, testing::ValuesIn(integrators()),
                         [](const auto& integrator) {
                           std::string name = integrator.param->name;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(path_twin, a_portal_density_off_by_5_percent_is_caught) {
  const Worst worst = compare(tdpt_ref, Fault::portal_density_5_percent);
  EXPECT_GT(worst.weight, 1e-3);
  EXPECT_GT(worst.value, 0.04);
}

TEST(path_twin, a_dropped_cosine_is_caught) {
  const Worst worst = compare(bdpt, Fault::missing_cosine);
  EXPECT_GT(worst.weight, 1e-3);
  EXPECT_GT(worst.value, 0.04);
}

TEST(paths_deep, long_paths_keep_finite_weights) {
  const Worst worst = compare(tdpt_org, Fault::none, kMaxDepth, 1);
  EXPECT_LT(worst.weight, 1e-6);
  EXPECT_GT(worst.paths[3], 1000);
}

}  // namespace
}  // namespace tdpt
