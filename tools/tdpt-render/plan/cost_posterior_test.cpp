// Simulated measurements with known truth: noise wins no choice, and intervals hold the truth. The
// twins, whose noise is understated, fail both.
#include "tools/tdpt-render/plan/cost_posterior.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

namespace tdpt::cost_posterior_test {

constexpr size_t kBatches = 16;

using Rng = std::mt19937_64;

double normal(Rng& rng) {
  return std::normal_distribution<double>()(rng);
}

struct Evidence {
  Traits traits{};
  std::vector<double> costs;
};

// A candidate of that cost: batches of mean 1 with log-normal noise.
Evidence measured(Rng& rng, double cost, double noise, Traits traits = {}) {
  Evidence e{traits, {}};
  for (size_t b = 0; b < kBatches; ++b)
    e.costs.push_back(cost * std::exp(noise * normal(rng) - 0.5 * noise * noise));
  return e;
}

double mean(const Evidence& e) {
  return std::accumulate(e.costs.begin(), e.costs.end(), 0.0) / kBatches;
}

// The same mean, with a tenth of the noise.
Evidence smoothed(Evidence e) {
  const double m = mean(e);
  for (double& c : e.costs) c = m + 0.1 * (c - m);
  return e;
}

// Those with the first trait use portals.
Forecast judged(const std::vector<Evidence>& all) {
  std::vector<CandidateEstimate> estimates;
  std::vector<Traits> traits;
  std::vector<std::vector<double>> costs;
  for (const Evidence& e : all) {
    estimates.push_back({"", e.traits[0], mean(e), 1, mean(e)});
    traits.push_back(e.traits);
    costs.push_back(e.costs);
  }
  return posterior_costs(estimates, traits, costs);
}

// One low-noise candidate, and eight noisy ones that cost more.
struct Lost {
  double plainly = 0, judged = 0, smoothed = 0;  // sums over all trials, as logarithms
};
Lost lost() {
  Lost sum;
  Rng rng(1);
  for (int trial = 0; trial < 400; ++trial) {
    std::vector<Evidence> all{measured(rng, 1, 0.1)}, twin;
    for (int i = 0; i < 8; ++i) all.push_back(measured(rng, 1.5, 1, {true, i > 0}));
    for (const Evidence& e : all) twin.push_back(cost_posterior_test::smoothed(e));
    const auto plain = std::min_element(
        all.begin(), all.end(), [](const auto& a, const auto& b) { return mean(a) < mean(b); });
    const double loss = std::log(1.5);
    sum.plainly += plain == all.begin() ? 0 : loss;
    sum.judged += judged(all).best == 0 ? 0 : loss;
    sum.smoothed += judged(twin).best == 0 ? 0 : loss;
  }
  return sum;
}

TEST(cost_posterior, noise_does_not_win_a_choice) {
  const Lost sum = lost();
  EXPECT_GT(sum.plainly, 80);  // of 162
  EXPECT_LT(sum.judged, 0.55 * sum.plainly);
}

TEST(cost_posterior, twin_noise_wins_where_it_is_not_known) {
  const Lost sum = lost();
  EXPECT_GT(sum.smoothed, 0.7 * sum.plainly);
}

// Share of the trials whose interval holds the true ratio.
double held(bool smooth) {
  int held = 0;
  constexpr int kTrials = 400;
  Rng rng(2);
  for (int trial = 0; trial < kTrials; ++trial) {
    const double portals = normal(rng), own = 0.2 * normal(rng);
    std::vector<Evidence> all{measured(rng, 1, 0.5), measured(rng, 1.2, 0.5),
                              measured(rng, std::exp(portals), 1.2, {true}),
                              measured(rng, std::exp(portals + own), 1.2, {true})};
    const std::array truth{1.0, 1.2, std::exp(portals), std::exp(portals + own)};
    if (smooth)
      for (Evidence& e : all) e = smoothed(e);
    const Forecast f = judged(all);
    const double ratio = truth[f.estimates[1].cost < f.estimates[0].cost] /
                         truth[f.estimates[3].cost < f.estimates[2].cost ? 3 : 2];
    held += f.gain_low <= ratio && ratio <= f.gain_high;
  }
  return static_cast<double>(held) / kTrials;
}

TEST(cost_posterior, intervals_hold_the_truth) {
  const double share = held(false);
  EXPECT_GT(share, 0.85);
  EXPECT_LT(share, 0.99);
}

TEST(cost_posterior, twin_intervals_do_not_where_noise_is_not_known) {
  EXPECT_LT(held(true), 0.75);
}

TEST(cost_posterior, of_what_is_known_well_is_the_measurement) {
  Rng rng(3);
  const Forecast f =
      judged({measured(rng, 1, 0), measured(rng, 0.5, 0, {true, true}), measured(rng, 3, 0)});
  EXPECT_EQ(f.best, 1u);
  EXPECT_NEAR(std::log(f.portals_gain), std::log(2), 0.15);
  EXPECT_NEAR(f.portals_gain, f.estimates[0].cost / f.estimates[1].cost, 1e-9);
  EXPECT_LT(f.gain_low, f.portals_gain);
  EXPECT_NEAR(f.gain_low * f.gain_high, f.portals_gain * f.portals_gain, 1e-9);
  EXPECT_GT(f.estimates[2].cost, f.estimates[0].cost);
}

}  // namespace tdpt::cost_posterior_test
