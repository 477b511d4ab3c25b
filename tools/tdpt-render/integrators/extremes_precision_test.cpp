// Which quantities need double precision or more: the same computation in single precision is
// wrong.
#include <bit>

#include "tools/tdpt-render/testing/extremes.h"
#include "tools/tdpt-render/testing/oracle.h"
#include "tools/tdpt-render/testing/variant.h"

namespace tdpt::extremes_precision_test {

/// Paths of a furnace in a range of lengths.
template <class Visit>
void each_path(float albedo, int pixels, int least_edges, int most_edges, const Visit& visit) {
  Scene scene = read_gltf(furnace_path());
  for (Material& m : scene.materials) m.base_color = Rgb(albedo);
  const Vista vista(scene, scene.camera(""), 8, 6, {});
  const PathObserver observer = [&](const Contribution& found) {
    if (found.path.k() >= least_edges && found.path.k() <= most_edges) visit(vista, found);
  };
  const Variant variant(bdpt);
  Film film(8, 6, 1);
  Tally tally;
  PathSampler sampler(vista, variant.settings(kMaxDepth, 1), film, tally, &observer);
  for (int i = 0; i < pixels; ++i) variant.sample(sampler, i % 8, i / 8, 0);
}

const Mixture kConnections{TechniqueSet(Technique::camera, Technique::light, Technique::bi)};

/// Weight of `used` by the balance heuristic, from products of densities as written in [eq. 7].
template <class Real>
Real weight_by_plain_products(const Path& path, Strategy used) {
  const int k = path.k();
  Real total = 0, mine = 0;
  for (int s = 0; s <= k; ++s) {
    if (s == 1) continue;
    const Technique technique = s == 0   ? Technique::camera
                                : s == k ? Technique::light
                                         : Technique::bi;
    Real p = static_cast<Real>(kConnections.sample_weight(technique, s, k));
    for (int i = 0; i < k; ++i) {
      const WalkDensities::At& at = path.walks()[i];
      p *= static_cast<Real>(i < s ? at.light_A : at.camera_A);
    }
    total += p;
    if (Strategy{technique, s} == used) mine = p;
  }
  return mine / total;
}

struct Wrong {
  int paths = 0, in_floats = 0, in_doubles = 0, by_ratios = 0;
};

/// How many weights of some paths in a range of lengths differ from the oracle's.
Wrong weights_of_paths(float albedo, int pixels, int most, int least_edges, int most_edges) {
  Wrong wrong;
  each_path(
      albedo, pixels, least_edges, most_edges, [&](const Vista& vista, const Contribution& found) {
        if (found.strategy.technique == Technique::direct || wrong.paths == most) return;
        ++wrong.paths;
        const double expected =
            oracle::weight(oracle::densities(vista, found.path, kConnections), found.strategy, 1);
        const auto off = [&](double weight) {
          return !(std::abs(weight - expected) < 1e-3 * expected);
        };
        wrong.in_floats += off(double{weight_by_plain_products<float>(found.path, found.strategy)});
        wrong.in_doubles += off(weight_by_plain_products<double>(found.path, found.strategy));
        wrong.by_ratios += off(found.path.weight(kConnections, found.strategy, 1));
      });
  std::printf("%d paths, wrong in floats %d, in doubles %d, by ratios %d\n", wrong.paths,
              wrong.in_floats, wrong.in_doubles, wrong.by_ratios);
  return wrong;
}

TEST(precision, densities_over_64_edges_need_doubles) {
  const Wrong wrong = weights_of_paths(0.99f, 48, 200, 64, 80);
  EXPECT_GT(wrong.paths, 100);
  EXPECT_GT(wrong.in_floats, 50);
  EXPECT_EQ(wrong.in_doubles, 0);
  EXPECT_EQ(wrong.by_ratios, 0);
}

// Without a depth limit the products exceed even doubles.
TEST(precision, densities_of_the_longest_paths_need_ratios) {
  const Wrong wrong = weights_of_paths(1, 1, 10, 900, kMaxDepth);
  EXPECT_GT(wrong.paths, 0);
  EXPECT_GT(wrong.in_doubles, 0);
  EXPECT_EQ(wrong.by_ratios, 0);
}

constexpr uint64_t kMany = 1'000'000'000, kLast = 1 << 20;

/// A sum of 1e9 samples, of which the last 1e6 are added here.
template <class Real>
double sum_of_many(double sample) {
  volatile Real sum = static_cast<Real>(sample * static_cast<double>(kMany - kLast));
  for (uint64_t i = 0; i < kLast; ++i) sum = sum + static_cast<Real>(sample);
  return sum;
}

TEST(precision, sums_of_1e9_samples_need_more_than_floats) {
  constexpr double sample = 0.7, unit = 0x1p-64, expected = sample * kMany;
  EXPECT_GT(std::abs(sum_of_many<float>(sample) - expected), 7e5);  // they are lost
  EXPECT_LT(std::abs(sum_of_many<double>(sample) - expected), 1);
  FixedSum sum;
  Units units;
  ASSERT_TRUE(to_units(sample, 1 / unit, 0, units));
  sum.set(units * (kMany - kLast));
  for (uint64_t i = 0; i < kLast; ++i) ASSERT_TRUE(sum.add(units));
  EXPECT_EQ(sum.units(), units * kMany);  // exact, hence independent of the order
  EXPECT_NEAR(from_units(sum.units(), unit), expected, 1e-6);
}

// Doubles hold the sum, but it depends on the order: bytes would depend on threads.
TEST(precision, sums_in_doubles_depend_on_their_order) {
  double up = 0, down = 0;
  FixedSum fixed_up, fixed_down;
  const auto sample = [](int i) { return std::ldexp(1.0 + i % 7, -(i % 60)); };
  for (int i = 0; i < 1000; ++i) {
    Units a, b;
    up += sample(i), down += sample(999 - i);
    ASSERT_TRUE(to_units(sample(i), 0x1p64, 0, a) && to_units(sample(999 - i), 0x1p64, 0, b));
    fixed_up.add(a), fixed_down.add(b);
  }
  EXPECT_NE(up, down);
  EXPECT_EQ(fixed_up.units(), fixed_down.units());
}

// World-space vertices, before conversion to the canonical frame.
TEST(precision, places_1e7_sizes_away_need_double) {
  const double away = 2e7;
  int lost = 0;
  for (int i = 0; i < 1000; ++i) {
    const double x = i / 500.0 - 1;
    EXPECT_NEAR((x + away) - away, x, 4e-9);
    lost += std::abs((static_cast<float>(x + away) - static_cast<float>(away)) - x) > 1e-3;
  }
  EXPECT_GT(lost, 900);
}

}  // namespace tdpt::extremes_precision_test
