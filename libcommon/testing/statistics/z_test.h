// Tests whether two estimators have the same mean. Pictures are divided into blocks; each is
// rendered several times with independent seeds.
//
// Per block b, the means m_1, m_2 over the runs and their standard errors give Welch's t, which is
// converted to a normal z by Student's distribution with Welch and Satterthwaite's degrees of
// freedom. The blocks answer three questions:
//   drift    is the picture as a whole brighter or darker? The sum over the blocks of m_b / w_b,
//            w_b a smooth measure of brightness, is compared as one number per run: valid however
//            correlated the blocks of a run are. Detects faults of a per cent everywhere.
//   rms z    is the picture wrong in places, up here and down there? About 1 if nothing is.
//   largest  is one block wrong? |z| with Sidak's correction for the number of blocks.
// Blocks whose runs scatter by more than 30 % of their mean are skewed, so their standard errors
// are unreliable: they count for the drift only.
#pragma once
#include <string>
#include <vector>

namespace tdpt::testing {

/// Values of one estimator's blocks, run by run.
class BlockRuns {
 public:
  /// One run: one value per block, as many as in the first run.
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

/// Two means and their difference in standard errors.
struct Difference {
  double first = 0, second = 0;  ///< means
  double z = 0;                  ///< of first - second, converted to a normal distribution
  double freedom = 0;            ///< degrees of freedom before the conversion
};
/// Welch's test of two sets of independent values, at least two in each. Standard errors below 1e-6
/// of the mean are rounding, and are raised to that.
Difference difference(const std::vector<double>& first, const std::vector<double>& second);

struct Agreement {
  double relative = 0;  ///< mean of the first / mean of the second - 1
  double drift_z = 0;
  double freedom = 0;   ///< of the drift
  size_t tested = 0;    ///< blocks that have a z
  double mean_z = 0;    ///< over those
  double rms_z = 1;     ///< over those; 1 if there are none
  double beyond_3 = 0;  ///< share with |z| > 3; 0.0027 is expected
  double largest_z = 0;
  std::vector<double> z_of_block;  ///< per block; NaN: no z. Empty: both are black

  // p-values.
  double p_drift = 1, p_rms = 1, p_largest = 1;

  /// A false alarm is about three times as likely as this where noise is skewed: a test
  /// that asks several questions divides it among them.
  static constexpr double kLeast = 1e-5;
  double least = kLeast;
  bool holds() const { return p_drift > least && p_rms > least && p_largest > least; }
  /// All of the above on one line.
  std::string text() const;
};

/// At least two runs of each, with the same number of blocks.
Agreement compare(const BlockRuns& first, const BlockRuns& second);

/// For pairs of runs with the same random numbers, so that most of their noise cancels: only the
/// drift, by Student's t of the differences run by run. Two such runs may differ by a few samples
/// only, so blocks are not tested.
Agreement compare_paired(const BlockRuns& first, const BlockRuns& second);

}  // namespace tdpt::testing
