#include "tools/tdpt-render/path/sample/resampling.h"

#include <algorithm>
#include <cmath>

namespace tdpt {
namespace {

// Share of the probability spread equally over all terms: an estimate knows neither shadows nor
// weights.
constexpr double kAlike = 0.5;

}  // namespace

// k for which the sum of min(1, k e_i) is `count`, if more terms than that are not 0 and their e_i
// sum to 1.
double Resampling::factor(uint32_t count) const {
  double k = count;
  for (;;) {
    double rest = 0;
    uint32_t sure = 0;
    for (const auto& [number, e] : terms())
      if (k * e < 1)
        rest += e;
      else
        ++sure;
    if (sure >= count) return k;
    const double next = (count - sure) / rest;
    if (!(next > k)) return k;
    k = next;
  }
}

// Branch-free: which terms are chosen cannot be predicted.
std::span<const Resampling::Taken> Resampling::choose(uint32_t count, double u) {
  if (taken_.size() < not_zero_ + 1) taken_.resize(not_zero_ + 1);
  double total = 0;
  for (const auto& [number, e] : terms()) total += e;
  // NaN must not be importance-sampled away: keep it, so that it is counted and reported.
  if (not_zero_ <= count || !std::isfinite(total)) {
    for (size_t i = 0; i < not_zero_; ++i) taken_[i] = {terms_[i].number, 1};
    return {taken_.data(), not_zero_};
  }
  const double by_estimate = (1 - kAlike) / total;
  const double alike = kAlike / static_cast<double>(not_zero_);
  double largest = 0;
  for (size_t i = 0; i < not_zero_; ++i) {
    double& e = terms_[i].estimate;
    e = e * by_estimate + alike;
    largest = std::max(largest, e);
  }
  const double k = count * largest < 1 ? count : factor(count);
  double before = u;
  size_t n = 0;
  for (const auto& [number, e] : terms()) {
    const double chance = std::min(1.0, k * e), after = before + chance;
    taken_[n] = {number, chance};
    n += static_cast<int>(after) > static_cast<int>(before);
    before = after;
  }
  return {taken_.data(), n};
}

}  // namespace tdpt
