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
// model   errors of the measurement that no scatter between batches shows, of the same form: the
//         modelled work, the correlation of samples that repeat, and above all bright paths that no
//         sample has met. The noisier the estimate itself, relMSE of one sample over their number,
//         the more of those there are
// P       posterior mean; V its covariance. Of P_i - P_j = log of a ratio of costs comes its
// interval
#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace tdpt {

/// What is known of one candidate.
struct CandidateEstimate {
  std::string integrator;     ///< its label
  bool with_portals = false;  ///< whether it uses them
  double relmse = 0;          ///< of one sample per pixel; infinite if it misses light
  double work = 0;            ///< of one sample [ns]
  double cost = 0;            ///< error x work, as measured; posterior after posterior_costs()
};

struct Forecast {
  std::vector<CandidateEstimate> estimates;
  size_t best = 0;  ///< the first if none met light
  /// Gain by portals: the cost of the best candidate without them over that of the best with them,
  /// and its 90 % interval. 0: one kind is missing, or none met light.
  double portals_gain = 0, gain_low = 0, gain_high = 0;
};

/// Traits that candidates share: portal segments, walks guided to portals, no light walks, a light
/// walk for every sample.
using Traits = std::array<bool, 4>;

/// `costs`: as measured, by candidate and batch; the same batches for every candidate. `samples`:
/// behind each of them. Candidates without a finite cost above 0 keep theirs and are never the
/// best.
Forecast posterior_costs(std::vector<CandidateEstimate> estimates,
                         const std::vector<Traits>& traits,
                         const std::vector<std::vector<double>>& costs, uint64_t samples);

}  // namespace tdpt
