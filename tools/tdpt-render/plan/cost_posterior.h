// Which of several candidates is likely to be the cheapest, and how certain that is, from noisy
// measurements of each.
//
// Method: Gaussian posterior (shrinkage). In a plain comparison a measurement that is too low by
// chance would win ("winner's curse"); here each is shrunk towards what is known of the others, the
// more the noisier it is. The least posterior mean of log cost is the least expected loss.
//
// L_i     log of the measured cost of candidate i
// C       covariance of L by the jackknife over batches of samples; it includes the correlation
//         between candidates that see the same bright paths
// prior   log cost = level + sum of the effects of i's traits + an effect of i alone, all
//         independent and normal, the level unknown
// model   systematic errors of the measurement, of the same form
// P       posterior mean; V its covariance
#pragma once
#include <array>
#include <cstddef>
#include <vector>

namespace tdpt {

/// Traits that candidates share: portal segments, walks guided to portals, no light walks, next
/// events through portals, a light walk for every sample.
constexpr size_t kTraits = 5;

struct Evidence {
  std::array<bool, kTraits> traits{};
  std::vector<double> costs;  ///< by batch, finite; the same batches for every candidate
};

/// The ratio of two costs with its 90 % interval.
struct CostRatio {
  double times = 1, low = 1, high = 1;
};

class CostPosterior {
 public:
  /// Each needs a batch that is not 0.
  explicit CostPosterior(const std::vector<Evidence>& all);
  double cost(size_t i) const;
  CostRatio ratio(size_t i, size_t j) const;  ///< of i's cost to j's

 private:
  double covariance(size_t i, size_t j) const { return covariance_[i * logs_.size() + j]; }
  std::vector<double> logs_, covariance_;  // P, V
};

}  // namespace tdpt
