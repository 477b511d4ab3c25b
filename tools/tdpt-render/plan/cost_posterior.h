// Which of several candidates is likely to be the cheapest, and how sure that is, from noisy
// measurements of each.
//
// Method: a Gaussian posterior. A measurement that is too low by chance would win a plain
// comparison ("winner's curse"); here each is drawn towards what is known of the others, the more
// the noisier it is. The least posterior mean of log cost is the least expected loss.
//
// L_i     log of what candidate i is measured to cost
// C       covariance of L by the jackknife over batches of the samples; it has what all candidates
//         owe to the same bright path
// prior   log cost = level + sum of the effects of i's traits + what is its own, all independent
//         and normal, the level unknown
// model   systematic errors of the measurement, of the same form
// P       posterior mean; V its covariance
#pragma once
#include <array>
#include <cstddef>
#include <vector>

namespace tdpt {

/// What candidates have in common: portal segments, walks aimed at portals, no light walks, next
/// events through portals, a light walk for every sample.
constexpr size_t kTraits = 5;

struct Evidence {
  std::array<bool, kTraits> traits{};
  std::vector<double> costs;  ///< by batch; of all as many, finite; the same batches of all
};

/// The ratio of two costs, with an interval that holds it with 90 % chance.
struct CostRatio {
  double times = 1, low = 1, high = 1;
};

class CostPosterior {
 public:
  /// Each has a batch that is not 0.
  explicit CostPosterior(const std::vector<Evidence>& all);
  double cost(size_t i) const;
  CostRatio ratio(size_t i, size_t j) const;  ///< of i's cost to j's

 private:
  double covariance(size_t i, size_t j) const { return covariance_[i * logs_.size() + j]; }
  std::vector<double> logs_, covariance_;  // P, V
};

}  // namespace tdpt
