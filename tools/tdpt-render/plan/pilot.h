// Integrator `auto`: finds out which of several integrators renders this picture with the least
// error x work, before it renders, from few samples.
//
// Method: second moments of many estimators from the samples of one or two (as Grittmann et al.
// 2022, "Efficiency-aware multiple importance sampling for bidirectional rendering algorithms",
// choose numbers of samples). Every path that is found says by its densities how often each
// candidate would find it and what it would then bring, so all candidates are judged by the same
// paths, and one that seldom finds a bright path does not look calm because it found none.
//
// x         path, f its luminance, s strategies of candidate i: n_s samples of density p_s, counted
//           v_s times in the weights
// M_i       = integral f^2 sum_s v_s^2/n_s p_s / (sum_s v_s p_s)^2: second moments of what
//           candidate i makes of a sample, path by path (balance heuristic)
// R         runs: candidates that are rendered, `home` of those whose walks, and whose next events
//           towards a sky, are like theirs; paths of several runs are weighed by the balance
//           heuristic among them
// X, X'     luminance of two independent samples of one pixel, of a candidate, as its home makes
//           them: the home's strategies that it has, with its own weights; without splats
// V_i       variance of one sample of a pixel:
//             V_i = M_i + E[X^2 - sum of squares of its paths, each times c] - E[X X'],
//           no bias: the second term is what the paths of one sample have in common, and what it
//           adds that few connections are made: M_i counts all that come into question, c is the
//           chance of one to get its ray [resampling.h]. A candidate whose walks are like none of a
//           run takes its home's last two terms. What paths have in common that begin with a light
//           walk is told, where there are portals, by the run that directs those, each path as
//           often as the candidate would make it: few samples of walks that are not directed, and
//           seldom come in, meet one.
// I         the larger of two brightnesses: the mean of a block of pixels, the smallest that is
//           known well, and that of the other samples of the pixel, which know a lamp or a window
//           from the wall beside it. Paths that all candidates make alike, as those to a lamp in
//           sight, tell nothing of these: they count by the mean of all samples of the pixel
//
// The error of a candidate is the mean of V_i / (I^2 + 0.01 mean^2): the relMSE of one sample per
// pixel, as exrdiff has it but for I. Its work is told from the rays that its walks and techniques
// take [work_model.h], never from the clock.
//
// What that costs, error x work, is told by batches of the samples, and candidates are weighed by
// how far these agree [cost_posterior.h].
//
// What is told is the error of independent samples. Samples of a pixel complement each other
// [sequence.h], and candidates gain most by that where they are calm.
//
// The samples are thrown away, so nothing that is decided by them can bias the picture.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "tools/tdpt-render/integrators/passes.h"
#include "tools/tdpt-render/plan/candidates.h"
#include "tools/tdpt-render/plan/cost_posterior.h"
#include "tools/tdpt-render/plan/work_model.h"

namespace tdpt {

/// What is known of one candidate.
struct CandidateEstimate {
  std::string integrator;     ///< its label
  bool with_portals = false;  ///< whether it uses them
  double relmse = 0;          ///< of one sample per pixel; infinite where it misses light
  double work = 0;            ///< of one sample [ns]
  double cost = 0;            ///< error x work, as it is judged
};

/// What portals are worth: the cost of the best without them over that of the best with them.
struct PortalsGain : CostRatio {
  size_t with = 0, without = 0;  ///< which candidates these are
};

struct Forecast {
  std::vector<CandidateEstimate> estimates;
  size_t best = 0;                     ///< the first where none met light
  std::optional<PortalsGain> portals;  ///< none: there are not both, or none met light
};

/// Samples of a pixel that are drawn together.
inline constexpr size_t kPilotGroup = 4;

/// What a sample of a run says of each candidate.
struct PilotRecord {
  double brought = 0;           ///< luminance, as the run brings it to the sample's own pixel
  double alike = 0;             ///< moment of paths that all candidates make alike
  std::vector<double> moments;  ///< of its own pixel
  // X, where the run is the candidate's home; what it tells of X^2 less the squares of its paths.
  std::vector<double> x, common;
};

/// Sums over all samples, of what they bring to other pixels or need no others for.
struct PilotSums {
  /// Of the picture in blocks, row by row.
  static constexpr int kAcross = 16;
  static constexpr size_t kBlocks = size_t{kAcross} * kAcross;
  static constexpr size_t kBatches = 16;  ///< of the groups, k-th of each sixteen
  /// Rays of each run: those of the walks from the camera and from the light, of segments until
  /// they are connected with the camera's side, then by technique.
  static constexpr size_t kParts = 3 + kTechniques;

  PilotSums() = default;
  PilotSums(size_t candidates, size_t runs);
  void merge(const PilotSums& other);

  std::vector<std::vector<double>> splats;  ///< M_i of splats [candidate][batch, block]
  std::vector<double> luminance, squares;   ///< of all paths, by block; those of each, squared
  std::vector<double> missed;               ///< of those that a candidate cannot make
  std::vector<std::array<RayCounts, kParts>> rays;
};

/// Judges candidates for one picture.
class Pilot {
 public:
  /// At least one candidate, with the connections that are to be expected of it
  /// [expecting_connections()]. `work`: of who is to render; the pilot itself runs on the CPU.
  Pilot(const World& world, const std::vector<Candidate>& candidates, const SampleRules& rules,
        const WorkTables& work = kCpuWork);

  /// Draws more groups of samples in each run. They are left in `film`, as large as the picture.
  void draw(uint64_t groups, Film& film);
  uint64_t groups() const { return blocks_.size(); }
  /// Samples of a group, in all runs.
  uint64_t samples_of_group() const { return kPilotGroup * runs_.size(); }

  Forecast forecast() const;
  /// Of a group, in all runs [ns], once one is drawn.
  double work_of_group() const;

 private:
  friend class PilotSample;
  void draw_run(size_t run, uint64_t first, uint64_t end, Film& film, PilotSums& sums);
  double work_of(size_t candidate, const WorkTables& tables) const;
  /// relMSE by candidate, from each batch of the groups.
  std::array<std::vector<double>, PilotSums::kBatches> errors() const;
  PilotRecord& record(uint64_t group, size_t run, size_t sample) {
    return records_[(group * runs_.size() + run) * kPilotGroup + sample];
  }

  const World& world_;
  const std::vector<Candidate>& candidates_;
  const SampleRules rules_;
  const WorkTables work_;
  std::vector<size_t> runs_;  ///< candidates that are rendered
  std::vector<size_t> home_;  ///< of each candidate: which of the runs
  /// And that which tells what paths of one light walk have in common: with portals, one that
  /// directs its light walks. Where those seldom come in by themselves, few samples see none.
  std::vector<size_t> lit_by_;
  std::vector<Guide> guides_;  ///< of each candidate
  PilotSums sums_;
  std::vector<uint32_t> blocks_;      ///< of each group's pixel
  std::vector<PilotRecord> records_;  ///< by group, run, sample
};

/// Share of the work of a picture that a pilot may take up.
inline constexpr double kPilotShare = 0.025;
/// Fewer groups tell nothing, more tell enough.
inline constexpr uint64_t kFewestGroups = PilotSums::kBatches, kMostGroups = 8192;
/// Whether a picture of `spp` samples of each pixel can spare the fewest.
bool can_spare(double spp, uint64_t pixels, const Pilot& pilot);
/// How many it can spare, kMostGroups at most, from what those that were drawn tell. As many in
/// each batch.
uint64_t groups_for(double spp, uint64_t pixels, const Pilot& pilot);

}  // namespace tdpt
