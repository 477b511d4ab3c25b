// Systematic sampling of a few terms of a sum: how many are chosen, and that the sum is unbiased.
#include "tools/tdpt-render/path/sample/light_vertex_cache.h"

#include <cmath>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"

namespace tdpt::resampling_test {

constexpr int kDraws = 20000;  // u at equal distances: a rare term has a probability of at least
                               // 0.1

struct Draws {
  std::vector<double> chance;  ///< probability of each term; 0: it was never chosen
  std::vector<double> often;   ///< how often it was chosen
  int fewest = 1 << 30, most = 0;
  bool steady = true;  ///< whether each had the same probability whenever it was chosen
};

Draws draw(const std::vector<double>& estimates, int count) {
  Draws out;
  out.chance.resize(estimates.size());
  out.often.resize(estimates.size());
  Resampling resampling;
  for (int i = 0; i < kDraws; ++i) {
    resampling.clear(estimates.size());
    for (const double e : estimates) resampling.add(e);
    const std::span<const Resampling::Taken> all = resampling.choose(count, (i + 0.5) / kDraws);
    const int taken = static_cast<int>(all.size());
    for (const auto& [k, chance] : all) {
      EXPECT_GT(chance, 0);
      ++out.often[k];
      out.steady = out.steady && (out.chance[k] == 0 || out.chance[k] == chance);
      out.chance[k] = chance;
    }
    out.fewest = std::min(out.fewest, taken);
    out.most = std::max(out.most, taken);
  }
  return out;
}

// Of all sizes, some 0, and some so large that they are always chosen.
std::vector<std::vector<double>> estimates() {
  std::vector<std::vector<double>> all{{1, 1, 1, 1},
                                       {1, 2, 3, 4, 5},
                                       {1e-9, 1e9, 1, 0, 3},
                                       {0, 0, 7, 0, 1e-3, 2},
                                       {5, 5, 1, 1, 1, 1}};
  for (uint64_t i = 0; i < 20; ++i) {
    Rng rng(1, 2, i);
    std::vector<double> e(3 + rng.below(9));
    for (double& x : e) x = rng.uniform() < 0.2 ? 0 : std::exp(10 * rng.uniform());
    all.push_back(e);
  }
  return all;
}

size_t not_0(const std::vector<double>& e) {
  size_t n = 0;
  for (const double x : e) n += x != 0;
  return n;
}

// Largest deviation from 1 of a term's expected contribution over itself; `told`: the probability
// it is divided by, as a function of the true one.
template <class Told>
double worst_mean(const std::vector<double>& e, const Draws& d, const Told& told) {
  double worst = 0;
  for (size_t i = 0; i < e.size(); ++i) {
    if (e[i] == 0)
      EXPECT_EQ(d.often[i], 0) << "of no estimate";
    else
      worst = std::max(worst, std::abs(d.often[i] / told(d.chance[i]) / kDraws - 1));
  }
  return worst;
}

TEST(resampling, as_many_are_taken_as_asked_for_and_each_is_right_in_the_mean) {
  for (const std::vector<double>& e : estimates())
    for (const int count : {1, 2, 3}) {
      const Draws d = draw(e, count);
      // An interval of u, known to 1 / kDraws at either end.
      EXPECT_LT(worst_mean(e, d, [](double chance) { return chance; }), 3e-3);
      EXPECT_TRUE(d.steady);
      if (not_0(e) <= static_cast<size_t>(count)) continue;
      EXPECT_NEAR(std::accumulate(d.chance.begin(), d.chance.end(), 0.0), count, 1e-9);
      EXPECT_EQ(d.fewest, count);
      EXPECT_EQ(d.most, count);
    }
}

TEST(resampling, twin_another_chance_than_they_have_is_caught) {
  const auto alike = [](double) { return 2.0 / 5; };
  const std::vector<double> rising{1, 2, 3, 4, 5}, even{1, 1, 1, 1};
  EXPECT_GT(worst_mean(rising, draw(rising, 2), alike), 0.1);
  const auto off_by_5_percent = [](double chance) { return std::min(1.0, 1.05 * chance); };
  EXPECT_GT(worst_mean(even, draw(even, 2), off_by_5_percent), 0.04);
}

TEST(resampling, where_there_are_no_more_all_are_taken) {
  for (const std::vector<double>& e : {std::vector<double>{}, {0, 0}, {0, 3, 0}, {1e-30, 1e30}}) {
    const Draws d = draw(e, 2);
    for (size_t i = 0; i < e.size(); ++i) EXPECT_EQ(d.chance[i], e[i] != 0);
  }
}

// NaN must be kept, so that it is counted.
TEST(resampling, what_is_not_finite_is_kept_and_all_beside_it) {
  for (const double odd :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const Draws d = draw({1, odd, 0, 2, 3}, 1);
    EXPECT_EQ(d.chance, (std::vector<double>{1, 1, 0, 1, 1}));
    EXPECT_EQ(d.fewest, 4);
  }
  EXPECT_EQ(draw({1e308, 1e308, 1e308}, 1).fewest, 3);  // whose sum is not finite
}

}  // namespace tdpt::resampling_test
