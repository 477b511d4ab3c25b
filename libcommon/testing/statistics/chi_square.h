// Whether samples follow the density they claim: Pearson's chi-square over bins of the sphere or of
// anything else that has bins.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "libcommon/math/vec.h"

namespace tdpt {

/// Probability that chi-square with `dof` degrees of freedom is `statistic` or more.
double chi_square_p(double statistic, size_t dof);
/// Probability that of `n` trials, each a success with probability `p`, the number of successes is
/// as far out as `hits` or further, on either side.
double binomial_p(uint64_t hits, uint64_t n, double p);
/// Level for each of `tests` tests, all of which a right program passes with probability
/// 1 - `level` (Sidak).
double sidak(double level, size_t tests);

struct ChiSquare {
  double statistic = 0;
  size_t bins = 0;  ///< after pooling; one more than the degrees of freedom
  double p = 1;
};
/// Counts against expected counts with the same sum: the last bin of both is what the others leave
/// out. Bins in which fewer than `least` are expected are pooled. p = 0 when more than `least` fell
/// where nothing can: quadrature may miss the corner of a bin.
ChiSquare chi_square(const std::vector<uint64_t>& counts, const std::vector<double>& expected,
                     double least = 5);

/// Bins of directions: rings about an axis, by cosine, and sectors of azimuth.
class SphereBins {
 public:
  /// `rings` of equal solid angle about z.
  SphereBins(size_t rings, size_t sectors);
  /// Rings about a narrow lobe with unit axis `axis` and half width about `width` [rad]: fine near
  /// the axis, then ever wider, to the opposite pole.
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

/// Integral over [x0,x1] x [y0,y1] by Boost's adaptive Gauss-Kronrod rule of 15 points, nested;
/// `tolerance` is relative. Where the integrand jumps inside, a thousandth is what can be counted
/// on. Peaks narrower than a twelfth of a side may be missed.
double integrate(const std::function<double(double, double)>& f, double x0, double x1, double y0,
                 double y1, double tolerance = 1e-3);

/// Draws `n` samples, sorts them into bins and compares with the `probability` of each. `draw(i)`
/// gives the bin of sample i, or probability.size() for a sample that is none. p = 0 when the
/// probabilities add up to more than 1.
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
