// Light walks and portal segments of several samples: what the camera's vertices of those samples
// are joined with, and the segments with the light walks.
//
// Method: bidirectional path tracing with a cache of light vertices (Davidovic et al. 2014). A
// vertex is joined with a few of the pool's, whichever walks they are of, in place of all of its
// own sample's: as many connections know more of the light, and a long walk costs no more of them.
//
// W walks, N vertices, M of them drawn as candidates: each vertex stands for
//   times = W M / N
// samples of a walk, or W when all are drawn. What it brings is divided by that, the number really
// used; the MIS weights go by the expected one [Mixture::joined], so that they stay functions of
// the path. Each segment stands for one in every sample of the pool [Mixture::samples_of].
#pragma once
#include <span>
#include <vector>

#include "tools/tdpt-render/path/join.h"
#include "tools/tdpt-render/path/portal_segment.h"

namespace tdpt {

struct LightVertex : End {
  const Walk* walk;
  int index;  ///< y_index
  LightVertex(const Walk& y, int i)
      : End(y[i], tdpt::back(y, i), y.state(i).throughput), walk(&y), index(i) {}
};

class LightPool {
 public:
  /// Samples that pool their light walks. In veach-ajar 16 instead of 1 took 1.05 times the CPU
  /// time, 256 took 1.16 times: walks leave the cache before they are joined.
  static constexpr int kWalks = 16;
  /// Candidates of one vertex that they are joined with.
  static constexpr int kCandidates = 8;

  void clear();
  /// `y` must outlive the pool's use, unchanged.
  void add(const Walk& y);

  /// Place for the segment of one sample more; it stays if it is kept before the next is asked for.
  PortalSegment& place_for_segment();
  void keep_segment() { ++kept_; }
  /// Counts a sample whose segment, if it had one, was kept.
  void end_segment() { ++drawn_; }
  /// Those kept.
  std::span<PortalSegment> segments() { return std::span(segments_).first(kept_); }
  /// Samples that might have drawn one.
  double segments_drawn() const { return drawn_; }

  /// Replaces `drawn` by candidates y_i, i >= 1, or with `starts` i >= 0, spread evenly from u in
  /// [0,1). Returns how many samples of a walk each stands for; 0: there are none.
  double draw(bool starts, double u, std::vector<const LightVertex*>& drawn) const;

 private:
  std::vector<LightVertex> starts_, scattered_;  ///< y_0, and those after it
  double walks_ = 0;
  std::vector<PortalSegment> segments_;  ///< the first of them are kept, the others place
  size_t kept_ = 0;
  double drawn_ = 0;
};

/// `mixture` with the numbers of joins that are to be expected of its light walks
/// [Mixture::joined], told by a few of them: the same for the same world, mixture and length.
Mixture expecting_joins(const World& world, const Mixture& mixture, int max_depth);

}  // namespace tdpt
