#include "tools/tdpt-render/path/few.h"

#include <algorithm>
#include <cmath>

namespace tdpt {
namespace {

// Share of the chances that all terms have alike: an estimate knows neither shadows nor weights.
constexpr double kAlike = 0.5;

// k for which the sum of min(1, k e_i) is `count`; less than as many e_i are not 0.
double factor(std::span<const double> estimates, double total, int count) {
  double k = count / total;
  for (;;) {
    double rest = 0;
    int sure = 0;
    for (const double e : estimates)
      if (k * e < 1)
        rest += e;
      else
        ++sure;
    const double next = (count - sure) / rest;
    if (sure >= count || !(next > k)) return k;
    k = next;
  }
}

}  // namespace

std::span<const double> Few::choose(int count, double u) {
  double total = 0;
  int terms = 0;
  for (const double e : estimates_) {
    total += e;
    terms += e != 0;
  }
  chances_.assign(estimates_.size(), 0);
  // What is no number is not weighed against others: it is to be met and counted.
  if (terms <= count || !std::isfinite(total)) {
    for (size_t i = 0; i < estimates_.size(); ++i) chances_[i] = estimates_[i] != 0;
    return chances_;
  }
  for (double& e : estimates_)
    if (e > 0) e = (1 - kAlike) * e / total + kAlike / terms;
  const double k = factor(estimates_, 1, count);
  double before = u;
  for (size_t i = 0; i < estimates_.size(); ++i) {
    const double chance = std::min(1.0, k * estimates_[i]), after = before + chance;
    if (static_cast<int>(after) > static_cast<int>(before)) chances_[i] = chance;
    before = after;
  }
  return chances_;
}

}  // namespace tdpt
