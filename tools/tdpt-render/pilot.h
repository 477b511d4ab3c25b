// Integrator `auto`: finds out which of several integrators renders this picture with the least
// error x work, and lets it render the rest.
//
// Method: adaptive selection among unbiased estimators by pilot samples, the worst leaving round by
// round (successive elimination); the pilot's samples are kept, weighed by inverse variance.
//
// i    candidate, r: round, of R; a: share of the pilot in the picture
// S_i  picture of candidate i; v_i its relMSE for one sample per pixel, w_i its weight
// P_r  picture of round r; M: of the chosen candidate after the pilot
//
// The pilot goes in R rounds. A round renders two passes over the picture (a pass is one sample of
// every pixel) with each of the candidates i that are left, and adds one picture to what is kept:
//   P_r = sum_i w_i S_i(r),   sum_i w_i = 1,   w_i ~ 1 / v_i,
// S_i(r) the mean of candidate i's two passes, v_i the relMSE of one of its samples as the rounds
// *before* r measured it. After a round the hopeless candidates leave. As long as fewer than
// kLeastSamples were taken of each, all of the weight is the first candidate's and none leaves.
// After the last round the candidate of the least v_i x work is chosen and renders M, and the
// picture is
//   (1 - a) M + a (P_1 + ... + P_R) / R.
//
// Why no samples have to be thrown away: an integrator chosen because its samples look calm has,
// among these samples, too few of the bright ones, so a picture that weighs samples by what they
// themselves showed is too dark. Here what decides about samples never sees them. Given all rounds
// before r, the weights of round r and the candidates that render it are fixed numbers, and its
// random numbers are its own (a stream for each round), so E[P_r] = sum_i w_i E[S_i] = the picture;
// given the pilot, so is E[M]. R and a are set before the first round, from the budget alone: were
// they to depend on what was measured, sum_r P_r / R would again weigh samples by themselves.
//
// v_i: two passes x, x' of a pixel estimate its variance without bias as (x - x')^2 / 2. Light
// walks of one pixel's sample splat into others, so whole passes are compared and nothing less. The
// variance is divided by (mean^2 + 0.01 (mean of the picture)^2), as in exrdiff's relMSE, of
// luminance. The mean is not that of candidate i in that pixel, which is large just where a rare
// bright sample fell, and would hide it (DESIGN 3.8). It is the larger of two: that of a block of
// pixels, and that of the *other* candidates in the pixel, which knows a lamp or its rim. One pixel
// in 5000, one at least, counts no more than the largest of the rest: a single bright sample in so
// few passes says more about luck than about its integrator.
//
// Few passes miss what is rare. A candidate that never found the light of the next room shows no
// variance there: black, and perfect. So where another one sees more light, by three standard
// errors of the difference, candidate i is given the variance that the excess has if it comes in
// one sample out of as many as were taken: (passes x pixels) x excess^2. This is asked of the
// picture as a whole and of 4 x 4 parts of it; the larger answer counts.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "libcommon/formats/portal.h"
#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/path/world.h"

namespace tdpt {

/// One of those that `auto` chooses among.
struct Candidate {
  Integrator integrator;
  std::string label;  ///< names it in notes and statistics; several may share an integrator's name
};

/// The candidates for this scene; the first is taken when there is no pilot. None that misses light
/// of the scene [light_missed]. With portals: those with portal techniques first, or bdpt first
/// when no portal promises a gain. Portals must have been probed [portal_probe.h].
/// `guided`: those of tdpt-guided that are to be tried, the likeliest first.
std::vector<Candidate> auto_candidates(const World& world, const std::vector<Portal>& portals,
                                       std::span<const Integrator> guided = kGuided);

/// `auto` by name, with all techniques of the candidates; it cannot be run.
Integrator either_of(const std::vector<Candidate>& candidates);

/// Whether the figures of every portal say that it is useless.
bool all_useless(const std::vector<Portal>& portals);

struct PilotPlan {
  size_t candidates = 1;  ///< the first so many take part
  uint64_t rounds = 0;    ///< of two passes each; 0: no pilot
  double kept = 0;        ///< a, the pilot's share of the picture
};
/// For a budget of about `spp` samples per pixel in all: two rounds at least and kLeastSamples of
/// each candidate, with as many candidates as fit into a quarter of the budget; more rounds, up to
/// eight, within a sixteenth of it. None where that leaves less than two candidates. `exact`: spp
/// is what will be rendered, and not only what the first candidate could do in the time.
PilotPlan plan_pilot(double spp, uint64_t pixels, size_t candidates, bool exact);
/// Fewer samples, of all pixels together, cannot tell one integrator from another.
inline constexpr double kLeastSamples = 4000;

/// What a pilot knows about errors. Pictures are sums of one sample per pixel, row by row.
class PilotErrors {
 public:
  PilotErrors(int width, int height, size_t candidates);

  void add_round(size_t candidate, const std::vector<Vec3d>& first,
                 const std::vector<Vec3d>& second);

  /// relMSE of one sample per pixel, by candidate; infinite for one of which there is no round.
  std::vector<double> relmse() const;

 private:
  struct OfCandidate {
    uint64_t rounds = 0;
    // Of luminance, by pixel: over passes, and of (x - x')^2 / 2 over rounds.
    std::vector<float> sum, square;
  };
  struct Grid;

  int width_, height_;
  std::vector<OfCandidate> candidates_;
};

/// w_i ~ 1 / v_i, 0 where `out`; adds up to 1. All of it goes to the first that is not out when no
/// candidate met any light.
std::vector<double> pilot_weights(const std::vector<double>& relmse, const std::vector<bool>& out);

/// What a pilot measured of one candidate.
struct PilotRecord {
  std::string integrator;  ///< its label
  uint64_t spp = 0;        ///< of the pilot
  double relmse = 0;       ///< of one sample per pixel
  double work = 0;         ///< of one sample [ns]
  double share = 0;        ///< its weight in the picture; the chosen one's with all of its samples
};

/// Smallest relmse x work; the first of equals.
size_t best_of(const std::vector<PilotRecord>& pilot);
/// More than this many times the least relmse x work is hopeless. One bright sample can make it ten
/// times.
inline constexpr double kHopeless = 16;
/// Those that are out already and the hopeless ones.
std::vector<bool> hopeless(const std::vector<PilotRecord>& pilot, std::vector<bool> out);

}  // namespace tdpt
