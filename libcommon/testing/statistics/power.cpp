#include "libcommon/testing/statistics/power.h"

#include <fmt/format.h>

#include <boost/math/distributions/non_central_chi_squared.hpp>
#include <boost/math/distributions/non_central_t.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

namespace tdpt::testing {
namespace {

using boost::math::cdf, boost::math::complement, boost::math::quantile;

/// The smallest x with `seen(x)`, which is monotonic.
template <class Seen>
double least(const Seen& seen) {
  double low = 0, high = 1;
  while (!seen(high)) high *= 2;
  for (int i = 0; i < 60; ++i) (seen(0.5 * (low + high)) ? high : low) = 0.5 * (low + high);
  return high;
}

}  // namespace

double least_shift(double freedom, const Question& q) {
  const double alarm = quantile(complement(boost::math::students_t(freedom), 0.5 * q.least));
  return least([&](double shift) {
    return cdf(complement(boost::math::non_central_t(freedom, shift), alarm)) >= q.power;
  });
}

double least_noncentrality(size_t blocks, const Question& q) {
  const auto n = static_cast<double>(blocks);
  const double alarm = quantile(complement(boost::math::chi_squared(n), q.least));
  return least([&](double noncentrality) {
    return cdf(complement(boost::math::non_central_chi_squared(n, noncentrality), alarm)) >=
           q.power;
  });
}

double samples_by_drift(double samples, double z, double freedom, const Question& q) {
  const double tail = cdf(complement(boost::math::normal(), std::abs(z)));
  const double t = quantile(complement(boost::math::students_t(freedom), tail));
  return samples * std::pow(least_shift(freedom, q) / t, 2);
}

double samples_by_rms(double samples, double rms_z, size_t blocks, const Question& q) {
  const double noncentrality = static_cast<double>(blocks) * (rms_z * rms_z - 1);
  if (!(noncentrality > 0)) throw std::invalid_argument("no more than chance gives");
  return samples * least_noncentrality(blocks, q) / noncentrality;
}

uint64_t fresh(uint64_t seed) {
  static const char* asked = std::getenv("TDPT_SEED");
  return asked ? seed + (std::strtoull(asked, nullptr, 10) << 20) : seed;
}

void tell_answer(const Agreement& a, uint64_t samples, size_t k) {
  if (fresh(0) == 0) return;
  fmt::print("answer {} {} {} {} {} {} {}\n", k, samples, a.drift_z, a.freedom, a.rms_z, a.tested,
             a.least);
}

}  // namespace tdpt::testing
