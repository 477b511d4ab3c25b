#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "libcommon/math/discrete.h"
#include "libcommon/math/reach.h"
#include "libcommon/math/rng.h"
#include "libcommon/math/streams.h"
#include "libcommon/math/vec.h"

namespace tdpt::math_test {

TEST(rng, depends_on_every_coordinate_and_on_nothing_else) {
  const uint64_t first = Rng(1, 2, 3, 4).bits();
  EXPECT_EQ(first, Rng(1, 2, 3, 4).bits());
  EXPECT_NE(first, Rng(2, 2, 3, 4).bits());
  EXPECT_NE(first, Rng(1, 3, 3, 4).bits());
  EXPECT_NE(first, Rng(1, 2, 4, 4).bits());
  EXPECT_NE(first, Rng(1, 2, 3, 5).bits());
}

TEST(onb, is_orthonormal_and_right_handed_in_every_direction) {
  Rng rng(7, 0, 0);
  for (int i = 0; i < 10000; ++i) {
    const double z = 2 * rng.uniform() - 1, phi = 6.283185307 * rng.uniform();
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    const Vec3d n{r * std::cos(phi), r * std::sin(phi), z};
    const Onb<double> o(n);
    EXPECT_NEAR(dot(o.x, o.y), 0, 1e-12);
    EXPECT_NEAR(dot(o.x, n), 0, 1e-12);
    EXPECT_NEAR(length(cross(o.x, o.y) - n), 0, 1e-9);
  }
  EXPECT_NEAR(dot(Onb<double>(Vec3d{0, 0, -1}).x, Vec3d{0, 0, -1}), 0, 1e-12);
}

// Chi-square test of samples against pdf_1 scaled by `fault`; true if the density fits.
template <typename Table>
bool table_holds(double fault) {
  const std::vector<double> weights{1, 0, 3, 0.5, 10, 2.5};
  const Table table(weights);
  std::vector<double> hits(weights.size());
  Rng rng(3, 0, 0);
  const int n = 200000;
  for (int i = 0; i < n; ++i) hits[table.sample(rng.uniform())] += 1;
  EXPECT_EQ(hits[1], 0);
  double chi2 = 0;
  for (uint32_t i = 0; i < weights.size(); ++i) {
    if (weights[i] == 0) continue;
    const double expected = n * table.pdf_1(i) * (i == 2 ? fault : 1);
    chi2 += (hits[i] - expected) * (hits[i] - expected) / expected;
  }
  return chi2 < 23.5;  // 5 degrees of freedom: p about 3e-4
}
TEST(tables, draws_follow_pdf_1) {
  EXPECT_TRUE(table_holds<AliasTable>(1));
  EXPECT_TRUE(table_holds<CumulativeTable>(1));
  EXPECT_FALSE(table_holds<AliasTable>(1.05));  // twins
  EXPECT_FALSE(table_holds<CumulativeTable>(1.05));
}

TEST(cumulative_table, every_number_finds_an_entry_of_some_weight) {
  for (const std::vector<double>& weights :
       {std::vector<double>{0, 0, 3, 0, 1e-300, 0.1, 0}, std::vector<double>{1e300},
        std::vector<double>{0, 1e-9, 1, 1e-17, 0}, std::vector<double>(49, 1.0 / 49)}) {
    const CumulativeTable table(weights);
    const auto n = static_cast<double>(weights.size());
    for (size_t i = 0; i <= weights.size(); ++i)
      for (const double u : {std::nextafter(static_cast<double>(i) / n, 0.0),
                             static_cast<double>(i) / n, (static_cast<double>(i) + 0.3) / n})
        if (u < 1) {
          EXPECT_GT(weights[table.sample(u)], 0) << u;
        }
  }
}

// Deviation of an entry of weight 7 among `entries` of weight 3 from its share, in samples out of
// 64, whose numbers are one in each 64th at the same offset: like those of a digitally shifted
// sequence.
template <typename Table>
double unevenness(size_t entries) {
  std::vector<double> weights(entries, 3 / static_cast<double>(entries - 1));
  weights[entries / 3] = 7;
  const Table table(weights);
  double worst = 0;
  for (double shift = 0.03125; shift < 1; shift += 0.0625) {
    double hits = 0;
    for (int i = 0; i < 64; ++i) hits += table.sample((i + shift) / 64) == entries / 3 ? 1 : 0;
    worst = std::max(worst, std::abs(hits - 0.7 * 64));
  }
  return worst;
}
TEST(cumulative_table, a_heavy_entry_gets_its_share_of_numbers_that_are_even) {
  for (const size_t entries : {5, 64, 1000, 2048, 2064}) {
    EXPECT_LE(unevenness<CumulativeTable>(entries), 1) << entries;
  }
  EXPECT_GT(unevenness<AliasTable>(2048), 15);  // twin: it spreads them by low bits
}

// Mean of cos over the hemisphere is 2/3 under pdf cos/pi; under a uniform pdf it would be 1/2.
TEST(warp, cosine_hemisphere_has_its_moments) {
  Rng rng(5, 0, 0);
  double sum = 0, square = 0;
  const int n = 200000;
  for (int i = 0; i < n; ++i) {
    const double u = rng.uniform();
    const double v = rng.uniform();
    const double c = cosine_hemisphere(u, v).z;
    sum += c;
    square += c * c;
  }
  EXPECT_NEAR(sum / n, 2.0 / 3, 4 * std::sqrt(1.0 / 18 / n));
  EXPECT_NEAR(square / n, 0.5, 0.003);
}

TEST(Thinned, KeepsOrderAndSpacing) {
  std::vector<int> many(1000);
  std::iota(many.begin(), many.end(), 0);
  EXPECT_EQ(thinned(many, 1000), many);
  EXPECT_EQ(thinned(many, 4), (std::vector<int>{0, 250, 500, 750}));
  EXPECT_EQ(thinned(many, 3), (std::vector<int>{0, 334, 668}));
  for (size_t most = 1; most < 1100; most += 7) EXPECT_LE(thinned(many, most).size(), most);
  EXPECT_TRUE(thinned(std::vector<int>{}, 5).empty());
}

// disjoint() can fail: because of one stream, one of several rounds, a seed.
static_assert(!disjoint(std::array{Streams{0, 4}, Streams{4, 1}, Streams{3, 1}}));
static_assert(!disjoint(streams_of({3, 8}), streams_of({4})));
static_assert(!disjoint(Streams{0, 1, 1}, Streams{0, 1}) &&
              !disjoint(Streams{0, 1, 1}, Streams{0, 1, 1}));

}  // namespace tdpt::math_test
