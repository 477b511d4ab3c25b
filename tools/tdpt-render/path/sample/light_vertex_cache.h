// Light walks and portal segments of several samples: what the camera's vertices of those samples
// are connected with, and the segments with the light walks.
//
// Method: bidirectional path tracing with a cache of light vertices (Davidovic et al. 2014). A
// vertex is connected with a few of the cache's, whichever walks they are of, in place of all of
// its own sample's: as many connections know more of the light, and a long walk costs no more of
// them.
//
// W walks, N vertices, M of them drawn as candidates: each vertex stands for
//   times = W M / N
// samples of a walk, or W when all are drawn. What it brings is divided by that, the number really
// used; the MIS weights go by the expected one [Mixture::connected], so that they stay functions of
// the path. Each segment stands for one in every sample of the cache [Mixture::samples_of].
//
// Not every sample makes a light walk [Mixture::light_walks], and a cache has as many walks however
// small that share is: it is one of more samples then. Which of them walk is of no consequence,
// since light walks know nothing of the pixel that they are made for: the first ones do.
#pragma once
#include <span>
#include <vector>

#include "shaders/shared/path/connections.h"
#include "tools/tdpt-render/path/sample/connection_estimates.h"
#include "tools/tdpt-render/path/sample/portal_segment.h"

namespace tdpt {

struct LightVertex : End {
  const Walk* walk;
  int index;  ///< y_index
  LightVertex(const Walk& y, int i)
      : End(y[i], tdpt::way_back(y, i), y.state(i).throughput), walk(&y), index(i) {}
};

class LightVertexCache {
 public:
  /// Light walks that are cached. In veach-ajar 16 instead of 1 took 1.05 times the CPU time, 256
  /// took 1.16 times: walks leave the cache before they are connected.
  static constexpr int kWalks = 16;
  /// Candidates of one vertex that they are connected with.
  static constexpr int kCandidates = static_cast<int>(shader::kCandidates);

  /// For so many samples.
  void clear(uint64_t samples = 1);
  /// `y` must outlive the cache's use, unchanged.
  void add(const Walk& y);

  /// Place for the segment of one sample more; it stays if it is kept before the next is asked for.
  PortalSegment& place_for_segment();
  void keep_segment() { ++kept_; }
  /// Those kept.
  std::span<PortalSegment> segments() { return std::span(segments_).first(kept_); }
  /// After the last of them: their ends on the camera's side, and these in columns, with all the
  /// light that there is at x_l.
  void prepare_segments();
  const End& segment_end(size_t i) const { return segment_ends_[i]; }
  Ends& segment_columns() { return segment_columns_; }

  /// Replaces `drawn` by candidates y_i, i >= 1, or with `starts` i >= 0, spread evenly from u in
  /// [0,1). Returns how many samples of a walk each stands for; 0: there are none.
  double draw(bool starts, double u, std::vector<const LightVertex*>& drawn) const;

  /// Of each that draw() gave what it brings to `end` [connection_estimates.h]; of those that have
  /// no estimates, as all y_0, anything.
  void estimate(const std::vector<const LightVertex*>& drawn, const End& end,
                std::vector<double>& estimates) const;

  double samples() const { return samples_; }
  double walks_per_sample() const { return walks_ / samples_; }

 private:
  std::vector<LightVertex> starts_, scattered_;  ///< y_0, and those after it
  Ends columns_;                                 ///< of scattered_
  double walks_ = 0, samples_ = 1;
  std::vector<PortalSegment> segments_;  ///< the first of them are kept, the others place
  size_t kept_ = 0;
  std::vector<End> segment_ends_;  ///< of those kept
  Ends segment_columns_;
};

/// How many samples cache their light walks.
uint64_t samples_of_cache(const Mixture& mixture);
/// Pixel i of cache `cache`, one of `caches`, in a picture of so many pixels. Each is of a stretch
/// of its own, as long as there are caches, and in every stretch further along, lest those of a
/// cache lie in few columns of the picture.
uint64_t pixel_of_cache(uint64_t cache, uint64_t i, uint64_t caches, uint64_t pixels);
/// How many of a cache's samples make a light walk; one at least, if any technique needs one.
uint64_t light_walks_of(const Mixture& mixture, uint64_t samples);

/// Vertices of a light walk that can be connected, on average.
struct LightVertices {
  double first = 0, later = 0;
};
/// Told by a few walks that are guided so: the same for the same world, guiding and length.
LightVertices expected_light_vertices(const World& world, const Guiding& guiding, int max_depth);
/// `mixture` with the numbers of connections that are to be expected of such walks
/// [Mixture::connected].
Mixture expecting_connections(const LightVertices& vertices, const Mixture& mixture);
Mixture expecting_connections(const World& world, const Mixture& mixture, int max_depth);

}  // namespace tdpt
