// How noisy a picture is: estimated without a reference, before it is rendered and from itself.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "libcommon/film/film.h"
#include "libcommon/math/streams.h"

namespace tdpt {

// ---- By an error pilot ----
//
// Estimates the relMSE of a picture (as exrdiff reports it against a converged one) without a
// reference: from parts, which are pictures of equally many samples with independent random
// numbers.
//
// x_k     part k of K; r the truth, M the mean of all parts
// v       variance of a pixel's component over the parts; m its mean, m_ab the mean without parts a
//         and b
// relMSE  of one part: mean over pixels and components of E[(x_k - r)^2] / (r^2 + 0.01 M^2)
//
//   high  = mean of (x_a - x_b)^2 / 2 / (m_ab^2 + 0.01 M^2), b the part after a, cyclically:
//           numerator and denominator are independent, but 1/m^2 is convex: biased high
//   low   = mean of v / (max(m^2 - v/K, 0) + 0.01 M^2): numerator unbiased, and the denominator too
//           before it is clamped at 0, but one bright sample raises both: biased low
//   The estimate is the geometric mean of the two. Where the relMSE of a part is at most 0.5, both
//   are within a fifth of the truth and their geometric mean is within a tenth.
//
// Like any estimate it misses bright paths that no part met.
//
// From it follows, before a picture is rendered, how many samples it needs to meet a given relMSE:
// two-stage sampling, as Stein's for a mean, so that the stopping point does not depend on the
// picture's own samples. Eight parts with random numbers of their own are rendered with doubling
// numbers of samples until their estimate suffices; they are thrown away.

/// The pixels of each part; all parts have the same size.
using PictureParts = std::vector<std::vector<Rgb>>;

struct ErrorEstimate {
  bool lit = false;   ///< some pixel is not black
  double relmse = 0;  ///< of one part
  /// Its relative standard error: the larger of those over parts and over pixels.
  double spread = 0;
  double pixels = 1;
  uint64_t samples = 0;  ///< per pixel of a part
};

/// Needs two parts or more, of `samples` per pixel; `high` needs three.
ErrorEstimate estimate_error(const PictureParts& parts, uint64_t samples);

/// Whether the estimate is within about a tenth of the truth, apart from chance; otherwise it may
/// be many times too large.
inline bool is_reliable(const ErrorEstimate& estimate) {
  return estimate.lit && estimate.relmse <= 0.5;
}

/// Multiply and divide the estimate by this for its interval of about 95 %.
double interval_factor(const ErrorEstimate& estimate);

/// Samples per pixel that meet `target` with about 95 % chance, by the estimate e from K parts of n
/// samples: 1.1 q n e / target, q the 95 % quantile of a gamma distribution of mean 1 and variance
/// spread^2 (1 + K target / e) + 2 / pixels. At most 2^32, and of the form m 2^j, m < 16: blocks of
/// a fourth to an eighth of such a number are stratified like powers of two. 0: no light was met.
uint64_t samples_needed(const ErrorEstimate& estimate, uint64_t parts, double target);

/// Cuts the samples of a picture, as they arrive, into four to seven blocks of 2^j each. The
/// samples of a pixel are stratified, across blocks too, so the picture is better than the blocks
/// predict.
class PictureBlocks {
 public:
  PictureBlocks() = default;
  /// Restores blocks of `size` samples each; `before`: the picture's sums at the end of the last
  /// one.
  PictureBlocks(uint64_t size, PictureParts blocks, std::vector<Vec3d> before)
      : size_(size), blocks_(std::move(blocks)), before_(std::move(before)) {}
  /// Number of samples at which the current block ends.
  uint64_t next() const { return (blocks_.size() + 1) * size_; }
  /// `sums`: of the picture's first next() samples.
  void add(const std::vector<Vec3d>& sums);
  const PictureParts& blocks() const { return blocks_; }
  uint64_t size() const { return size_; }  ///< samples per block
  const std::vector<Vec3d>& before() const { return before_; }

 private:
  uint64_t size_ = 1;
  PictureParts blocks_;
  std::vector<Vec3d> before_;
};

/// Parts of an error pilot.
inline constexpr uint64_t kErrorPilotParts = kErrorPilotRounds.count;
/// Sums over those samples of a part, by pixel; nothing to give up.
using DrawPart =
    std::function<std::optional<std::vector<Vec3d>>(uint64_t part, const SampleRange& samples)>;
/// What an error pilot found out.
struct ErrorPilot {
  ErrorEstimate estimate{};  ///< by its last round; of no samples if there was none
  uint64_t needed = 0;       ///< samples per pixel for the target error; 0: unknown
  double cpu_seconds = 0;
  /// Samples per pixel that were drawn and thrown away.
  uint64_t samples() const { return kErrorPilotParts * estimate.samples; }
};
/// Draws rounds, each of twice as many samples, until their estimate suffices or `draw` gives up.
/// `most`: upper limit of the picture's samples per pixel.
ErrorPilot run_error_pilot(uint64_t pixels, double target, uint64_t most, const DrawPart& draw);

// ---- From the picture itself ----
//
// How noisy a picture is, estimated from the picture alone: its relMSE as exrdiff reports it
// against a converged one, with an interval that holds in nine of ten pictures; nothing where that
// is not known. For display, and to judge a target: no sample depends on it.
//
// It uses blocks of the picture's own samples at some of its pixels, so that it costs next to
// nothing.
//
// x_k   block k of K of a pixel's component; m the mean of all, M that of all pixels
// n     mean of the 24 pixels around it
// r     the brightness: relMSE = mean of E[(m - r)^2] / (r^2 + 0.01 M^2)
//
//   V    = variance of m, from that of the blocks
//   r    = n + (m - n) max(0, 1 - V / (m - n)^2), the estimator of James and Stein: a pixel is as
//          bright as those around it unless it differs by more than its noise. So one bright sample
//          does not pass for brightness, nor a pixel without one for black
//   high = mean of V / (r^2 + 0.01 M^2). Samples are stratified, across blocks too, so the picture
//          is better than its blocks show
//   low  = the same of (m - n)^2 24/25 in the place of V in those runs of pixels where its sum is
//          less: what differs no more from its surroundings cannot be noisier
//   The estimate is the geometric mean of the two. The interval reaches from one to the other and
//   on each side as far as chance goes: the errors of the pixels, of which few may hold most, are
//   known no better than the error itself.
//
// Paths that no sample met are in neither.

struct Noise {
  double relmse = 0;         ///< of the picture
  double low = 0, high = 0;  ///< its interval, 90 %
};

/// From one pixel that is watched to the next: at most 2^14 are, in every column.
size_t watched_step(const Film& film);
/// `blocks`: of the film's samples from the first on, at the watched pixels.
std::optional<Noise> noise_of(const Film& film, const PictureBlocks& blocks);

/// "relMSE 0.012, 0.011 to 0.014".
std::string words_of(const Noise& noise);
/// At the end: how noisy the picture is, and what a clean one takes.
/// `seconds`: that it took on this machine.
std::string noise_sentence(const std::optional<Noise>& noise, double seconds);

}  // namespace tdpt
