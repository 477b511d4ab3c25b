// Tests whether samples follow their claimed density: Pearson's chi-square test over bins of the
// sphere or of anything else that can be binned.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "libcommon/math/vec.h"

namespace tdpt {

/// Probability that chi-square with `dof` degrees of freedom is at least `statistic`.
double chi_square_p(double statistic, size_t dof);
/// Two-sided p-value of `hits` successes in `n` trials with success probability `p`.
double binomial_p(uint64_t hits, uint64_t n, double p);
/// Level for each of `tests` tests such that a correct program passes all of them with probability
/// 1 - `level` (Sidak).
double sidak(double level, size_t tests);

struct ChiSquare {
  double statistic = 0;
  size_t bins = 0;  ///< after pooling; one more than the degrees of freedom
  double p = 1;
};
/// Counts against expected counts with the same sum: the last bin of both collects the samples
/// outside all other bins. Bins with fewer than `least` expected are pooled. p = 0 if more than
/// `least` samples fell where nothing is expected: quadrature may miss the corner of a bin.
ChiSquare chi_square(const std::vector<uint64_t>& counts, const std::vector<double>& expected,
                     double least = 5);

/// Bins of directions: rings about an axis, by cosine, and sectors of azimuth.
class SphereBins {
 public:
  /// `rings` of equal solid angle about z.
  SphereBins(size_t rings, size_t sectors);
  /// Rings about a narrow lobe with unit axis `axis` and half width of about `width` [rad]: fine
  /// near the axis, then wider and wider, to the opposite pole.
  SphereBins(const Vec3d& axis, double width, size_t rings, size_t sectors);

  size_t size() const { return (cosines_.size() - 1) * sectors_; }
  size_t bin(const Vec3d& w) const;
  /// Integral of `density` [1/sr] over each bin, by integrate() below.
  std::vector<double> integrate(const std::function<double(const Vec3d&)>& density) const;

 private:
  size_t sectors_;
  Onb<double> frame_;
  std::vector<double> cosines_;  // descending, 1 ... -1
};

/// Integral over [x0,x1] x [y0,y1] by nested 15-point adaptive Gauss-Kronrod quadrature (Boost);
/// `tolerance` is relative. For a discontinuous integrand expect a relative error of 1e-3. Peaks
/// narrower than a twelfth of a side may be missed.
double integrate(const std::function<double(double, double)>& f, double x0, double x1, double y0,
                 double y1, double tolerance = 1e-3);

/// Draws `n` samples, bins them and compares the counts with the `probability` of each bin.
/// `draw(i)` returns the bin of sample i, or probability.size() for a sample outside all bins. p =
/// 0 if the probabilities sum to more than 1.
template <class Draw>
ChiSquare chi_square_of_samples(uint64_t n, const std::vector<double>& probability, Draw draw) {
  std::vector<uint64_t> counts(probability.size() + 1);
  for (uint64_t i = 0; i < n; ++i) ++counts[draw(i)];
  std::vector<double> expected;
  double rest = 1;
  for (double p : probability) {
    expected.push_back(static_cast<double>(n) * p);
    rest -= p;
  }
  if (rest < -1e-3) return {INFINITY, 0, 0};
  expected.push_back(static_cast<double>(n) * std::max(rest, 0.0));
  return chi_square(counts, expected);
}

}  // namespace tdpt
