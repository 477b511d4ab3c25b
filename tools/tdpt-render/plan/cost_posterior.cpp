#include "tools/tdpt-render/plan/cost_posterior.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace tdpt {
namespace {

constexpr size_t kTraits = std::tuple_size_v<Traits>;
constexpr double kUnknown = 100;  // variance of the level
// Effects of traits on the logarithm: mean and standard deviation over scenes, and standard
// deviation of the measurement's systematic errors. Chosen with 70 views of rooms and buildings:
// numbers chosen without a building chose nearly as well in it (0.95 of the best instead of 0.96).
constexpr std::array<double, kTraits> kMeans{-1, -0.3, 1.5, 0.2}, kEffects{1, 0.5, 0.7, 0.2},
    kErrors{0.25, 0.15, 0.4, 0.1};
constexpr double kOwn = 0.15, kOwnError = 0.3;  // of the effect of one candidate alone
constexpr double kUnseen = 10;  // variance, per relMSE of a sample over the number of samples
// Standard deviations to either end of the interval. Errors are on the safe side, so that 1.645 of
// them hold the gain in more than nine of ten views.
constexpr double kNinetyOneSided = 1.3;

struct Evidence {
  Traits traits;
  std::vector<double> costs;  // by batch
  double unseen;              // variance for paths that no sample has met
};

// Normal variables; the covariance row by row.
struct Logs {
  std::vector<double> mean, covariance;
};

Logs measured(const std::vector<Evidence>& all) {
  const size_t n = all.size(), batches = n > 0 ? all[0].costs.size() : 0;
  const auto m = static_cast<double>(batches);
  Logs out{std::vector<double>(n), std::vector<double>(n * n)};
  std::vector<std::vector<double>> without(n);  // logs without each batch, less their mean
  for (size_t i = 0; i < n; ++i) {
    double sum = 0, mean = 0;
    for (const double c : all[i].costs) sum += c;
    for (const double c : all[i].costs)
      without[i].push_back(std::log(std::max(sum - c, 1e-3 * sum)));
    for (const double l : without[i]) mean += l / m;
    for (double& l : without[i]) l -= mean;
    out.mean[i] = std::log(sum / m);
  }
  for (size_t i = 0; i < n; ++i)
    for (size_t j = 0; j < n; ++j)
      for (size_t b = 0; b < batches; ++b)
        out.covariance[i * n + j] += without[i][b] * without[j][b] * (m - 1) / m;
  return out;
}

double shared(const Evidence& a, const Evidence& b, const std::array<double, kTraits>& effects,
              double own) {
  double sum = &a == &b ? own * own : 0;
  for (size_t t = 0; t < kTraits; ++t)
    if (a.traits[t] && b.traits[t]) sum += effects[t] * effects[t];
  return sum;
}

double expected(const Evidence& e) {
  double sum = 0;
  for (size_t t = 0; t < kTraits; ++t) sum += e.traits[t] ? kMeans[t] : 0;
  return sum;
}

// Solves A X = B, A positive definite; all n x n, row by row.
std::vector<double> solved(std::vector<double> A, std::vector<double> B, size_t n) {
  for (size_t k = 0; k < n; ++k)
    for (size_t i = 0; i < n; ++i) {
      if (i == k) continue;
      const double f = A[i * n + k] / A[k * n + k];
      for (size_t j = 0; j < n; ++j) {
        A[i * n + j] -= f * A[k * n + j];
        B[i * n + j] -= f * B[k * n + j];
      }
    }
  for (size_t i = 0; i < n; ++i)
    for (size_t j = 0; j < n; ++j) B[i * n + j] /= A[i * n + i];
  return B;
}

Logs posterior(const std::vector<Evidence>& all) {
  const size_t n = all.size();
  const Logs measurement = measured(all);
  std::vector<double> prior(n * n), sum(n * n);
  for (size_t i = 0; i < n; ++i)
    for (size_t j = 0; j < n; ++j) {
      const size_t at = i * n + j;
      prior[at] = kUnknown + shared(all[i], all[j], kEffects, kOwn);
      sum[at] = prior[at] + measurement.covariance[at] +
                shared(all[i], all[j], kErrors, kOwnError) + (i == j ? all[i].unseen : 0);
    }
  const std::vector<double> gain = solved(sum, prior, n);  // transposed
  Logs out{{}, prior};
  for (size_t i = 0; i < n; ++i) {
    double& mean = out.mean.emplace_back(expected(all[i]));
    for (size_t k = 0; k < n; ++k) {
      mean += gain[k * n + i] * (measurement.mean[k] - expected(all[k]));
      for (size_t j = 0; j < n; ++j)
        out.covariance[i * n + j] -= gain[k * n + i] * prior[k * n + j];
    }
  }
  return out;
}

}  // namespace

Forecast posterior_costs(std::vector<CandidateEstimate> estimates,
                         const std::vector<Traits>& traits,
                         const std::vector<std::vector<double>>& costs, uint64_t samples) {
  std::vector<Evidence> evidence;
  std::vector<size_t> judged;  // their candidates
  for (size_t i = 0; i < estimates.size(); ++i) {
    if (!(std::isfinite(estimates[i].cost) && estimates[i].cost > 0)) continue;
    evidence.push_back(
        {traits[i], costs[i], kUnseen * estimates[i].relmse / static_cast<double>(samples)});
    judged.push_back(i);
  }
  const Logs logs = posterior(evidence);
  Forecast out{std::move(estimates)};
  std::optional<size_t> best[2];  // of `judged`: without portals, with them
  for (size_t k = 0; k < judged.size(); ++k) {
    CandidateEstimate& e = out.estimates[judged[k]];
    e.cost = std::exp(logs.mean[k]);
    std::optional<size_t>& rival = best[e.with_portals];
    if (!rival || e.cost < out.estimates[judged[*rival]].cost) rival = k;
  }
  for (const auto& b : best)
    if (b && out.estimates[judged[*b]].cost < out.estimates[out.best].cost) out.best = judged[*b];
  if (!best[0] || !best[1]) return out;
  const size_t i = *best[0], j = *best[1], n = judged.size();
  const std::vector<double>& V = logs.covariance;
  const double variance = V[i * n + i] + V[j * n + j] - 2 * V[i * n + j];
  const double off = kNinetyOneSided * std::sqrt(std::max(variance, 0.0));
  const double log = logs.mean[i] - logs.mean[j];
  out.portals_gain = std::exp(log);
  out.gain_low = std::exp(log - off);
  out.gain_high = std::exp(log + off);
  return out;
}

}  // namespace tdpt
