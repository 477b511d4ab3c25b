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

// Which terms are 0 and which are taken is anybody's guess: nothing jumps by it.
std::span<const Few::Taken> Few::choose(int count, double u) {
  double total = 0;
  int terms = 0;
  for (const double e : estimates_) {
    total += e;
    terms += e != 0;
  }
  taken_.resize(estimates_.size());
  size_t n = 0;
  const auto take = [&](size_t term, double chance, bool taken) {
    taken_[n] = {term, chance};
    n += taken;
  };
  // What is no number is not weighed against others: it is to be met and counted.
  if (terms <= count || !std::isfinite(total)) {
    for (size_t i = 0; i < estimates_.size(); ++i) take(i, 1, estimates_[i] != 0);
    return {taken_.data(), n};
  }
  const double by_estimate = (1 - kAlike) / total, alike = kAlike / terms;
  double largest = 0;
  for (double& e : estimates_) {
    e = e * by_estimate + (e > 0 ? alike : 0.0);
    largest = std::max(largest, e);
  }
  const double k = count * largest < 1 ? count : factor(estimates_, 1, count);
  double before = u;
  for (size_t i = 0; i < estimates_.size(); ++i) {
    const double chance = std::min(1.0, k * estimates_[i]), after = before + chance;
    take(i, chance, static_cast<int>(after) > static_cast<int>(before));
    before = after;
  }
  return {taken_.data(), n};
}

}  // namespace tdpt
