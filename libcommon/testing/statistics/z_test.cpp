#include "libcommon/testing/statistics/z_test.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace tdpt::testing {
namespace {

struct Moments {
  double mean = 0, variance_of_mean = 0;
};

Moments moments(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  double sum = 0, square = 0;
  for (double v : values) sum += v;
  const double mean = sum / n;
  for (double v : values) square += (v - mean) * (v - mean);
  const double rounding = 1e-6 * mean;
  return {mean, std::max(square / (n - 1) / n, rounding * rounding)};
}

std::vector<double> values_of(const BlockRuns& runs, size_t block) {
  std::vector<double> values;
  for (size_t r = 0; r < runs.runs(); ++r) values.push_back(runs.run(r)[block]);
  return values;
}

bool scattered(const std::vector<double>& values) {
  const Moments m = moments(values);
  const double variance = m.variance_of_mean * static_cast<double>(values.size());
  return !(m.mean > 0) || variance > 0.09 * m.mean * m.mean;
}

/// Converts a two-sided tail of Student's t to a normal z; saturates at 37.
double z_of_t(double t, double freedom) {
  const double tail = boost::math::cdf(complement(boost::math::students_t(freedom), std::abs(t)));
  const double z =
      tail > 1e-300 ? boost::math::quantile(complement(boost::math::normal(), tail)) : 37;
  return std::copysign(z, t);
}

double two_sided(double z) {
  return 2 * boost::math::cdf(complement(boost::math::normal(), std::abs(z)));
}

}  // namespace

void BlockRuns::add(const std::vector<double>& blocks) {
  if (!runs_.empty() && blocks.size() != runs_[0].size())
    throw std::invalid_argument("runs of different numbers of blocks");
  runs_.push_back(blocks);
}

double BlockRuns::mean(size_t block) const {
  double sum = 0;
  for (const auto& run : runs_) sum += run[block];
  return sum / static_cast<double>(runs());
}

double BlockRuns::mean() const {
  double sum = 0;
  for (size_t b = 0; b < blocks(); ++b) sum += mean(b);
  return sum / static_cast<double>(std::max<size_t>(blocks(), 1));
}

Difference difference(const std::vector<double>& first, const std::vector<double>& second) {
  if (first.size() < 2 || second.size() < 2) throw std::invalid_argument("two runs at least");
  const Moments a = moments(first), b = moments(second);
  const double variance = a.variance_of_mean + b.variance_of_mean;
  if (!(variance > 0)) return {a.mean, b.mean};  // all values are zero
  const double freedom =
      variance * variance /
      (a.variance_of_mean * a.variance_of_mean / (static_cast<double>(first.size()) - 1) +
       b.variance_of_mean * b.variance_of_mean / (static_cast<double>(second.size()) - 1));
  return {a.mean, b.mean, z_of_t((a.mean - b.mean) / std::sqrt(variance), freedom), freedom};
}

std::string Agreement::text() const {
  if (tested == 0)
    return fmt::format("{:+.3f} %, drift z {:+.2f} (p {:.1e})", 100 * relative, drift_z, p_drift);
  return fmt::format(
      "{:+.2f} %, drift z {:+.2f} (p {:.1e}), {} blocks: mean z {:+.2f}, rms z {:.2f} (p {:.1e}), "
      "{:.1f} % beyond 3, largest {:+.2f} (p {:.1e})",
      100 * relative, drift_z, p_drift, tested, mean_z, rms_z, p_rms, 100 * beyond_3, largest_z,
      p_largest);
}

namespace {

/// Per run: the sum over the blocks of value / brightness. The brightness has a floor, so that the
/// noise of very dark blocks does not dominate.
std::vector<double> sums(const BlockRuns& runs, const BlockRuns& first, const BlockRuns& second) {
  std::vector<double> values(runs.runs());
  const double brightness = 0.5 * (first.mean() + second.mean());
  for (size_t b = 0; b < runs.blocks(); ++b) {
    const double weight = 1 / (0.5 * (first.mean(b) + second.mean(b)) + 0.2 * brightness);
    for (size_t r = 0; r < runs.runs(); ++r) values[r] += runs.run(r)[b] * weight;
  }
  return values;
}

/// Student's t of the paired differences, as z.
double z_of_pairs(std::vector<double> first, const std::vector<double>& second) {
  const double rounding = 1e-6 * moments(first).mean;
  for (size_t r = 0; r < first.size(); ++r) first[r] -= second[r];
  const Moments m = moments(first);
  const double variance = std::max(m.variance_of_mean, rounding * rounding);
  if (!(variance > 0)) return 0;  // all values are zero
  return z_of_t(m.mean / std::sqrt(variance), static_cast<double>(first.size()) - 1);
}

}  // namespace

Agreement compare(const BlockRuns& first, const BlockRuns& second) {
  if (first.blocks() != second.blocks()) throw std::invalid_argument("different blocks");
  Agreement out;
  if (!(first.mean() + second.mean() > 0)) return out;  // both black
  out.relative = first.mean() / second.mean() - 1;
  const Difference drift = difference(sums(first, first, second), sums(second, first, second));
  out.drift_z = drift.z, out.freedom = drift.freedom;
  out.p_drift = two_sided(out.drift_z);

  double sum = 0, square = 0;
  size_t beyond = 0;
  for (size_t b = 0; b < first.blocks(); ++b) {
    const std::vector<double> x = values_of(first, b), y = values_of(second, b);
    out.z_of_block.push_back(std::numeric_limits<double>::quiet_NaN());
    if (scattered(x) || scattered(y)) continue;
    const double z = difference(x, y).z;
    out.z_of_block.back() = z;
    ++out.tested;
    sum += z;
    square += z * z;
    beyond += std::abs(z) > 3;
    if (std::abs(z) > std::abs(out.largest_z)) out.largest_z = z;
  }
  if (out.tested == 0) return out;
  const auto n = static_cast<double>(out.tested);
  out.mean_z = sum / n;
  out.rms_z = std::sqrt(square / n);
  out.beyond_3 = static_cast<double>(beyond) / n;
  out.p_rms = boost::math::cdf(complement(boost::math::chi_squared(n), square));
  // 1 - (1 - p)^n, accurate for tiny p.
  out.p_largest = -std::expm1(n * std::log1p(-std::min(two_sided(out.largest_z), 1 - 1e-16)));
  return out;
}

Agreement compare_paired(const BlockRuns& first, const BlockRuns& second) {
  if (first.runs() != second.runs() || first.blocks() != second.blocks())
    throw std::invalid_argument("runs that make no pairs");
  Agreement out;
  if (!(first.mean() + second.mean() > 0)) return out;
  out.relative = first.mean() / second.mean() - 1;
  out.drift_z = z_of_pairs(sums(first, first, second), sums(second, first, second));
  out.freedom = static_cast<double>(first.runs()) - 1;
  out.p_drift = two_sided(out.drift_z);
  for (size_t b = 0; b < first.blocks(); ++b)
    out.z_of_block.push_back(z_of_pairs(values_of(first, b), values_of(second, b)));
  return out;
}

}  // namespace tdpt::testing
