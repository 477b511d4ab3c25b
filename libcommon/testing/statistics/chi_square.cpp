#include "libcommon/testing/statistics/chi_square.h"

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/special_functions/beta.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <numbers>
#include <numeric>

namespace tdpt {
namespace {

using F2 = std::function<double(double, double)>;

}  // namespace

double chi_square_p(double statistic, size_t dof) {
  return dof == 0 ? 1 : boost::math::gamma_q(0.5 * static_cast<double>(dof), 0.5 * statistic);
}

double binomial_p(uint64_t hits, uint64_t n, double p) {
  if (!(p > 0)) return hits == 0 ? 1 : 0;
  if (!(p < 1)) return hits == n ? 1 : 0;
  const auto k = static_cast<double>(hits), m = static_cast<double>(n);
  const double at_least = hits == 0 ? 1 : boost::math::ibeta(k, m - k + 1, p);
  const double at_most = hits == n ? 1 : boost::math::ibetac(k + 1, m - k, p);
  return std::min(1.0, 2 * std::min(at_least, at_most));
}

double sidak(double level, size_t tests) {
  return -std::expm1(std::log1p(-level) / static_cast<double>(tests));
}

ChiSquare chi_square(const std::vector<uint64_t>& counts, const std::vector<double>& expected,
                     double least) {
  std::vector<size_t> order(expected.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return expected[a] < expected[b]; });
  ChiSquare result;
  double pooled_counts = 0, pooled_expected = 0, impossible = 0;
  const auto close = [&] {
    const double d = pooled_counts - pooled_expected;
    result.statistic += d * d / pooled_expected;
    ++result.bins;
    pooled_counts = pooled_expected = 0;
  };
  for (size_t i : order) {
    if (expected[i] <= 0) impossible += static_cast<double>(counts[i]);
    pooled_counts += static_cast<double>(counts[i]);
    pooled_expected += expected[i];
    if (pooled_expected >= least) close();
  }
  if (impossible > least) return {INFINITY, 0, 0};
  // If everything together is too little for one bin.
  if (pooled_expected > 0) close();
  result.p = chi_square_p(result.statistic, result.bins > 0 ? result.bins - 1 : 0);
  return result;
}

SphereBins::SphereBins(size_t rings, size_t sectors) : sectors_(sectors), frame_(Vec3d(0, 0, 1)) {
  for (size_t i = 0; i <= rings; ++i)
    cosines_.push_back(1 - 2 * static_cast<double>(i) / static_cast<double>(rings));
}

SphereBins::SphereBins(const Vec3d& axis, double width, size_t rings, size_t sectors)
    : sectors_(sectors), frame_(axis) {
  // angle = width (e^(k x) - 1), x in [0,1].
  const double k = std::log1p(std::numbers::pi / width);
  for (size_t i = 0; i <= rings; ++i) {
    const double x = static_cast<double>(i) / static_cast<double>(rings);
    cosines_.push_back(i == rings ? -1 : std::cos(width * std::expm1(k * x)));
  }
}

size_t SphereBins::bin(const Vec3d& w) const {
  const double c = dot(frame_.z, w);
  double phi = std::atan2(dot(frame_.y, w), dot(frame_.x, w)) / (2 * std::numbers::pi);
  if (phi < 0) phi += 1;
  const auto sector =
      std::min(static_cast<size_t>(phi * static_cast<double>(sectors_)), sectors_ - 1);
  const auto below = std::lower_bound(cosines_.begin() + 1, cosines_.end() - 1, c,
                                      [](double edge, double x) { return edge > x; });
  return static_cast<size_t>(below - cosines_.begin() - 1) * sectors_ + sector;
}

std::vector<double> SphereBins::integrate(
    const std::function<double(const Vec3d&)>& density) const {
  const F2 f = [&](double c, double phi) {
    const double r = std::sqrt(std::max(0.0, (1 - c) * (1 + c)));
    return density(frame_.to_world({r * std::cos(phi), r * std::sin(phi), c}));
  };
  std::vector<double> result;
  const double step = 2 * std::numbers::pi / static_cast<double>(sectors_);
  for (size_t i = 0; i + 1 < cosines_.size(); ++i)
    for (size_t j = 0; j < sectors_; ++j)
      result.push_back(tdpt::integrate(f, cosines_[i + 1], cosines_[i],
                                       static_cast<double>(j) * step,
                                       static_cast<double>(j + 1) * step));
  return result;
}

double integrate(const std::function<double(double, double)>& f, double x0, double x1, double y0,
                 double y1, double tolerance) {
  // Maximum number of bisections of an interval. Discontinuities are left to the inner integrals,
  // which can resolve one cheaply; their tolerance is ten times smaller, so that their errors look
  // smooth to the outer integral.
  constexpr unsigned kInner = 6, kOuter = 3;
  using Rule = boost::math::quadrature::gauss_kronrod<double, 15>;
  const auto row = [&](double y) {
    return Rule::integrate([&](double x) { return f(x, y); }, x0, x1, kInner, 0.1 * tolerance);
  };
  return Rule::integrate(row, y0, y1, kOuter, tolerance);
}

}  // namespace tdpt
