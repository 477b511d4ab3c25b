// The relMSE of a picture, as exrdiff says it against a converged one, told without that: from
// parts, pictures of the same number of samples whose random numbers have nothing in common.
//
// x_k     part k of K; r the truth, M the mean of all parts
// v       variance of a pixel's component over the parts; m its mean, m_ab that of the parts but a
//         and b
// relMSE  of one part: mean over pixels and components of E[(x_k - r)^2] / (r^2 + 0.01 M^2)
//
//   high  = mean of (x_a - x_b)^2 / 2 / (m_ab^2 + 0.01 M^2), b the part after a, round and round:
//           above and below are independent, but 1/m^2 is convex: too large on average
//   low   = mean of v / (max(m^2 - v/K, 0) + 0.01 M^2): no bias above nor, before it is cut at 0,
//           below, but one bright sample raises both: too small on average
//   relMSE is taken for the geometric mean of the two. Where that of a part is 0.5 or less both are
//   within a fifth of the truth, and their geometric mean within a tenth.
//
// Bright paths that no part met are missing from it, as from any estimate.
#pragma once
#include <cstdint>
#include <vector>

#include "libcommon/math/vec.h"

namespace tdpt {

/// All parts as large; the pixels of each.
using PictureParts = std::vector<std::vector<Rgb>>;

struct ErrorEstimate {
  bool lit = false;   ///< there is a pixel that is not black
  double relmse = 0;  ///< of one part
  /// Relative standard error of that: the larger of what parts and what pixels show.
  double spread = 0;
  double pixels = 1;
};

/// From two parts or more; `high` needs three.
ErrorEstimate estimate_error(const PictureParts& parts);

/// Whether that is within about a tenth of the truth, as far as chance lets it; else it may be many
/// times too large.
inline bool tells(const ErrorEstimate& estimate) {
  return estimate.lit && estimate.relmse <= 0.5;
}

/// About 95 %: the estimate, times and over this.
double interval_factor(const ErrorEstimate& estimate);

/// How many samples of each pixel meet `target`, with about 95 % chance as far as the estimate
/// shows, told from `parts` parts of `samples` samples of each pixel: relMSE falls as 1/N at least,
/// times a safety factor. At most 2^32, and of the form m 2^j, m < 16: of those, blocks of a
/// fourth to an eighth complement each other as samples of powers of two do.
uint64_t samples_needed(const ErrorEstimate& estimate, uint64_t parts, uint64_t samples,
                        double target);

/// Cuts the samples of a picture, as they come, into four to seven blocks of 2^j each. Samples of a
/// pixel complement each other, across blocks too, so the picture is better than blocks tell.
class PictureBlocks {
 public:
  PictureBlocks() = default;
  /// As they were: of `size` samples each, `before` the sums that the last one ended with.
  PictureBlocks(uint64_t size, PictureParts blocks, std::vector<Vec3d> before)
      : size_(size), blocks_(std::move(blocks)), before_(std::move(before)) {}
  /// The number of samples that ends the block that is being made.
  uint64_t next() const { return (blocks_.size() + 1) * size_; }
  /// The sums of the picture's first next() samples.
  void add(const std::vector<Vec3d>& sums);
  const PictureParts& blocks() const { return blocks_; }
  uint64_t size() const { return size_; }  ///< samples of a block
  const std::vector<Vec3d>& before() const { return before_; }

 private:
  uint64_t size_ = 1;
  PictureParts blocks_;
  std::vector<Vec3d> before_;
};

}  // namespace tdpt
