// Integrator `auto`: decides before rendering, from few samples, which of several integrators
// renders this picture with the least error x work.
//
// Method: second moments of many estimators from the samples of one or two of them (as Grittmann
// et al. 2022, "Efficiency-aware multiple importance sampling for bidirectional rendering
// algorithms", choose numbers of samples). The densities of every path found tell how often each
// candidate would find it and what it would contribute then. All candidates are thus judged by the
// same paths, and one that seldom finds a bright path does not look noise-free because it found
// none.
//
// x         path, f its luminance; s strategies of candidate i: n_s samples of density p_s, with
//           sample weight v_s in the MIS weights
// M_i       = integral f^2 sum_s v_s^2/n_s p_s / (sum_s v_s p_s)^2: second moment of the
//             contributions of single paths to a sample of candidate i (balance heuristic)
// R         runs: the candidates that are rendered. A candidate's `home` is the run whose walks are
//           guided if its own are. Paths of both runs are weighted by the balance heuristic among
//           them
// X, X'     luminance of two independent samples of one pixel, of a candidate, from its home's
//           paths: of the strategies that it has too, with its own weights, without splats
// V_i       variance of one sample of a pixel:
//             V_i = M_i + E[X^2 - sum of squares of its paths, each times c] - E[X X'],
//             unbiased. The second term is the correlation of the paths of one sample, plus the
//             variance of tracing few connections: M_i counts all possible ones, c is the chance
//             that one gets its ray [light_vertex_cache.h]. A candidate whose walks are drawn as in
//             no run takes the last two terms of its home. With portals, the correlation of paths
//             that share a light walk is estimated by the run that guides its light walks, each
//             path as often as the candidate would make it: unguided walks seldom come in, and few
//             samples meet one.
// I         the larger of two brightnesses: the mean of the smallest block of pixels for which it
//           is well known, and that of the other samples of the pixel, which tell a lamp or a
//           window from the wall beside it. Paths that all candidates sample equally, such as those
//           to a visible lamp, do not distinguish them: they are divided by the mean of all samples
//           of the pixel
//
// The error of a candidate is the mean of V_i / (I^2 + 0.01 mean^2): the relMSE of one sample per
// pixel, as exrdiff has it but for I. Its work is modelled from the rays that its walks and
// techniques take [work_model.h], never from the clock. Cost is error x work; it is computed by
// batches of samples, whose scatter says how far each candidate's cost can be trusted
// [cost_posterior.h].
//
// The error is that of independent samples. The samples of a pixel are stratified [sequence.h], and
// low-noise candidates gain most by that.
//
// The samples are thrown away, so that decisions made from them cannot bias the picture.
#pragma once
#include <array>

#include "tools/tdpt-render/integrators/passes.h"
#include "tools/tdpt-render/plan/candidates.h"
#include "tools/tdpt-render/plan/cost_posterior.h"

namespace tdpt {

/// Judges candidates for one picture.
class Pilot {
 public:
  static constexpr size_t kGroup = 4;     ///< samples of a pixel that are drawn together
  static constexpr size_t kBatches = 16;  ///< group k belongs to batch k mod 16

  /// Needs at least one candidate, with its expected connections [expecting_connections()].
  /// `on_device`: whether the picture's renderer is; the pilot itself runs on the CPU.
  Pilot(const Vista& vista, const std::vector<Candidate>& candidates, const SampleRules& rules,
        bool on_device = false);

  /// Draws more groups of samples in each run. They accumulate in `film`, of the picture's size.
  void draw(uint64_t groups, Film& film);
  uint64_t groups() const { return blocks_.size(); }
  /// Samples in a group, over all runs.
  uint64_t samples_of_group() const { return kGroup * runs_.size(); }

  Forecast forecast() const;
  /// Work of a group, over all runs [ns]; needs a group.
  double work_of_group() const;

 private:
  friend class PilotSample;
  /// Blocks across the picture, and down; row by row.
  static constexpr int kAcross = 16;
  static constexpr size_t kBlocks = size_t{kAcross} * kAcross;
  /// Sums over all samples, for splats to other pixels and for all that needs no pairs of samples:
  /// luminance of all paths by block; its squares, path by path; luminance of paths that a
  /// candidate cannot make, by candidate; then for each candidate M_i of splats [batch, block].
  using Sums = std::vector<std::vector<double>>;
  enum SumRow : size_t { kLuminance, kSquares, kMissed, kSplats };
  /// The rays of camera walks, of light walks, of segments until they are connected with the
  /// camera's side, then by technique.
  using Rays = std::array<RayCounts, 3 + kTechniques>;

  Sums no_sums() const;
  void draw_run(size_t run, uint64_t first, uint64_t end, Film& film, Sums& sums, Rays& rays);
  double work_of(size_t candidate, bool on_device) const;
  std::vector<double> block_luminance() const;
  /// relMSE by candidate and batch of the groups.
  std::vector<std::vector<double>> errors() const;

  const Vista& vista_;
  const std::vector<Candidate>& candidates_;
  const SampleRules rules_;
  const bool on_device_;
  std::vector<size_t> runs_;  ///< candidates that are rendered
  std::vector<size_t> home_;  ///< by candidate: index of a run
  /// By candidate: the run that estimates the correlation of paths of one light walk; with portals,
  /// a run that guides its light walks. Unguided, they seldom come in, and few samples see one.
  std::vector<size_t> lit_by_;
  std::vector<Guide> guides_;  ///< by candidate
  Sums sums_;
  std::vector<Rays> rays_;        ///< by run
  std::vector<uint32_t> blocks_;  ///< by group: block of its pixel

  // By group, run and sample: luminance that the run adds to the sample's own pixel; second moment
  // of paths that all candidates sample equally.
  std::vector<double> luminance_, equal_;
  // By group, run, sample and candidate: second moment of the other paths of its own pixel; X,
  // where the run is the candidate's home; its term X^2 less the squares of its paths.
  std::vector<double> moments_, x_, correlation_;
};

/// Share of a picture's work that a pilot may take. Measured in 70 views, with errors as they are
/// modelled here: from 0.05 to 0.2 the choice is no better than with 0.025, and the price is paid.
inline constexpr double kPilotShare = 0.02;
/// Fewer groups give no estimate, more add nothing.
inline constexpr uint64_t kFewestGroups = Pilot::kBatches, kMostGroups = 8192;
/// Whether kFewestGroups fit into the pilot's share of a picture of so many samples.
bool can_spare(double samples, const Pilot& pilot);
/// How many groups fit, at most kMostGroups, by the work of those drawn so far. A multiple of
/// kBatches.
uint64_t groups_for(double samples, const Pilot& pilot);
/// The same for a picture of so much work [ns of one core].
uint64_t groups_for_work(double work, const Pilot& pilot);

}  // namespace tdpt
