// A closed box with uniform emission 1 and albedo a shows 1/(1 - a), by walks that only Russian
// roulette ends.
#include <gtest/gtest.h>

#include "tools/tdpt-render/testing/means.h"
#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/variant.h"

namespace tdpt::furnace_test {

struct Furnace {
  explicit Furnace(float albedo, int width = 16, int height = 12)
      : scene(with_albedo(albedo)),
        vista(scene, scene.camera(""), width, height, {portal_in_the_furnace()}) {}

  Scene scene;
  Vista vista;

 private:
  static Scene with_albedo(float albedo) {
    Scene scene = read_gltf(furnace_path());
    for (Material& m : scene.materials) m.base_color = Rgb(albedo);
    return scene;
  }
};

// 1 + a + a^2 + ... up to the longest path.
double radiance(double albedo, int depth = kMaxDepth) {
  return (1 - std::pow(albedo, depth)) / (1 - albedo);
}

TEST(furnace, of_albedo_0_9_shows_10) {
  const Furnace f(0.9f);
  for (const Integrator* integrator : integrators()) {
    const MeanAndError r = rendered(f.vista, *integrator, 8);
    EXPECT_LT(r.z(radiance(double{0.9f})), 5) << integrator->name;
    EXPECT_LT(r.error, 0.01 * r.mean) << integrator->name;
  }
}

TEST(furnace, of_paths_of_1_2_and_64_edges_shows_as_many_terms) {
  const Furnace f(0.9f, 8, 6);
  for (const int depth : {1, 2, 64})
    for (const Integrator* integrator : integrators()) {
      const MeanAndError r = rendered(f.vista, *integrator, 8, 16, depth);
      EXPECT_LT(r.z(radiance(double{0.9f}, depth)), 5) << integrator->name << " " << depth;
      EXPECT_LT(r.error, 0.02 * r.mean) << integrator->name << " " << depth;
    }
}

// Each path of a strategy that connects walks of a hundred edges takes time in proportion to its
// length: few samples.
void expect_100(const std::vector<const Integrator*>& chosen) {
  const Furnace f(0.99f, 8, 6);
  for (const Integrator* integrator : chosen) {
    const double light_walks = integrator->mixture.light_walks;  // the same number in all
    const MeanAndError r =
        rendered(f.vista, *integrator,
                 integrator->mixture.has(Technique::light) ? std::lround(2 / light_walks) : 16);
    EXPECT_LT(r.z(radiance(double{0.99f})), 5) << integrator->name;
    EXPECT_LT(r.error, 0.04 * r.mean) << integrator->name;
  }
  // Twin: walks that are cut at 64 edges.
  EXPECT_GT(rendered(f.vista, pt, 4, 16, 64).z(radiance(double{0.99f})), 10);
}
TEST(furnace, of_albedo_0_99_shows_100) {
  expect_100({&pt, &tdpt_guided});
}
TEST(long_furnace, of_albedo_0_99_shows_100) {
  expect_100(integrators());
}

// Product of the survival probabilities of the walks that made a path by that strategy.
double survived(const Path& path, const Strategy& strategy) {
  double all = 1;
  const bool portal = strategy.technique == Technique::portal;
  for (int i = 1; i < strategy.split; ++i) all *= path.survives(From::light, i - 1);
  for (int i = portal ? strategy.split + 2 : strategy.split; i < path.k(); ++i)
    all *= path.survives(From::camera, i + 1);
  return all;
}

// Mean of all contributions, each times `factor`.
MeanAndError observed(const Vista& vista, const Integrator& integrator, uint64_t spp, int max_depth,
                      double (*factor)(const Path&, const Strategy&)) {
  std::vector<double> runs;
  const int width = vista.view.film.width(), height = vista.view.film.height();
  for (uint64_t seed = 1; seed <= 16; ++seed) {
    double sum = 0;
    const PathObserver observer = [&](const Contribution& found) {
      sum += luminance(found.value) * found.path.weight(integrator.mixture, found.strategy, 1) *
             factor(found.path, found.strategy);
    };
    const Variant variant(integrator);
    Film film(width, height, 1);
    Tally tally;
    PathSampler sampler(vista, variant.settings(max_depth, seed), film, tally, &observer);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        for (uint64_t s = 0; s < spp; ++s) variant.sample(sampler, x, y, s);
    runs.push_back(sum / (static_cast<double>(spp) * width * height));
  }
  return mean_and_error(runs);
}

double divided(const Path&, const Strategy&) {
  return 1;
}

TEST(furnace_twin, walks_that_end_without_dividing_by_their_survival_are_caught) {
  const Furnace f(0.9f);
  for (const Integrator* integrator : {&nee, &tdpt_guided}) {
    EXPECT_LT(observed(f.vista, *integrator, 4, kMaxDepth, divided).z(radiance(double{0.9f})), 5)
        << integrator->name;
    EXPECT_GT(observed(f.vista, *integrator, 4, kMaxDepth, survived).z(radiance(double{0.9f})), 20)
        << integrator->name;
  }
}

// Only the depth limit ends it.
TEST(furnace, of_albedo_1_ends) {
  const Furnace f(1);
  for (const Integrator* integrator : {&pt, &bdpt}) {
    Film film(16, 12, 1);
    Tally tally;
    int longest = 0;
    double sum = 0;
    const PathObserver observer = [&](const Contribution& found) {
      longest = std::max(longest, found.path.k());
      sum += luminance(found.value) * found.path.weight(integrator->mixture, found.strategy, 1);
    };
    const Variant variant(*integrator);
    PathSampler sampler(f.vista, variant.settings(kMaxDepth, 1), film, tally, &observer);
    variant.sample(sampler, 8, 6, 0);
    EXPECT_EQ(longest, kMaxDepth) << integrator->name;
    EXPECT_EQ(tally.not_finite, 0u) << integrator->name;
    EXPECT_GT(sum, 0) << integrator->name;
    if (integrator == &pt) {
      EXPECT_NEAR(sum, kMaxDepth, 1e-3 * kMaxDepth);  // each vertex emits
    }
  }
}

}  // namespace tdpt::furnace_test
