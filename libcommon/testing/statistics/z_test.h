// Do two estimators have the same mean? Asked of pictures cut into blocks, each rendered several
// times with independent seeds.
//
// Per block b: the means m_1, m_2 over the runs with their standard errors give Welch's t, which is
// turned into the z of a normal distribution by Student's distribution with Welch and
// Satterthwaite's degrees of freedom. Three questions are asked of the blocks:
//   drift    is the picture as a whole brighter or darker? The sum over the blocks of m_b / w_b,
//            w_b a smooth measure of brightness, is compared as one number a run: right however
//            much the blocks of a run depend on each other. Sees faults of a per cent everywhere.
//   rms z    is the picture wrong in places, up here and down there? About 1 when nothing is.
//   largest  is one block wrong? |z| with Sidak's correction for the number of blocks.
// Blocks whose runs scatter by more than 30 % of their mean are skewed, and tell too little about
// their own error: they count for the drift alone.
#pragma once
#include <string>
#include <vector>

namespace tdpt::testing {

/// Values of the blocks of one estimator, run by run.
class BlockRuns {
 public:
  /// One run: a value per block, as many as in the first run.
  void add(const std::vector<double>& blocks);

  size_t runs() const { return runs_.size(); }
  size_t blocks() const { return runs_.empty() ? 0 : runs_[0].size(); }
  const std::vector<double>& run(size_t r) const { return runs_[r]; }
  double mean(size_t block) const;
  /// Over blocks and runs.
  double mean() const;

 private:
  std::vector<std::vector<double>> runs_;
};

/// Two means with their distance in standard errors.
struct Difference {
  double first = 0, second = 0;  ///< means
  double z = 0;                  ///< of first - second, as of a normal distribution
  double freedom = 0;            ///< degrees of freedom that it has come from
};
/// Welch's test of two sets of independent values, two or more in each. Standard errors below 1e-6
/// of the mean are rounding: they are taken to be that.
Difference difference(const std::vector<double>& first, const std::vector<double>& second);

struct Agreement {
  double relative = 0;  ///< mean of the first over that of the second, less 1
  double drift_z = 0;
  double freedom = 0;   ///< of the drift
  size_t tested = 0;    ///< blocks that z was taken of
  double mean_z = 0;    ///< over them
  double rms_z = 1;     ///< over them; 1 when there are none
  double beyond_3 = 0;  ///< share with |z| > 3; 0.0027 is to be expected
  double largest_z = 0;
  std::vector<double> z_of_block;  ///< of all blocks; NaN: none was taken. Empty: both are black

  // Probability of as much by chance.
  double p_drift = 1, p_rms = 1, p_largest = 1;

  /// A false alarm is about three times as likely as this (z_test_test.cpp measures it): a test
  /// that asks more than once shares it.
  static constexpr double kLeast = 1e-5;
  double least = kLeast;
  bool holds() const { return p_drift > least && p_rms > least && p_largest > least; }
  /// One line with all of the above.
  std::string text() const;
};

/// Two runs or more of each, as many blocks in both.
Agreement compare(const BlockRuns& first, const BlockRuns& second);

/// For runs that share their random numbers one by one, so that most of their noise is common: the
/// drift alone, by Student's t of the differences run by run. What tells two such runs apart may be
/// a few samples, so that blocks are not asked.
Agreement compare_paired(const BlockRuns& first, const BlockRuns& second);

}  // namespace tdpt::testing
