// Chooses the terms of a sum that are worth a ray: resampling without bias.
//
// Method: systematic sampling with given probabilities. Each term has an estimate e_i and is chosen
// with probability c_i = min(1, k e_i), k such that the c_i sum to the number wanted. The sum over
// the chosen terms of term / c_i is unbiased for any positive estimates.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "shaders/shared/path/render_layout.h"
#include "tools/tdpt-render/path/sample/connect.h"
#include "tools/tdpt-render/path/sample/walk.h"

namespace tdpt {

class Resampling {
 public:
  /// At most so many terms will be added.
  void clear(size_t most) {
    if (terms_.size() < most + 1) terms_.resize(most + 1);
    added_ = not_zero_ = 0;
  }
  /// Adds the estimate of the next term; 0: it is never chosen. Branch-free: many are 0, and which
  /// cannot be predicted.
  void add(double estimate) {
    terms_[not_zero_] = {added_++, estimate};
    not_zero_ += estimate != 0;
  }

  struct Taken {
    size_t term;    ///< in the order of adding
    double chance;  ///< probability that it was chosen
  };
  /// Chooses `count` terms, or all that are not 0 if there are no more. u in [0,1).
  std::span<const Taken> choose(uint32_t count, double u);

 private:
  struct Term {
    size_t number;  // in the order of adding
    double estimate;
  };
  std::span<const Term> terms() const { return {terms_.data(), not_zero_}; }
  double factor(uint32_t count) const;

  std::vector<Term> terms_;  // the first not_zero_ are in use
  size_t added_ = 0, not_zero_ = 0;
  std::vector<Taken> taken_;
};

// A portal segment that a sample has drawn, with the light that arrives at its end x_l: the third
// kind of sub-path. Section 3.1.1, eq. 2.

/// A prefix of a light walk, connected with x_l.
struct Side {
  const Walk* walk;
  int prefix;  ///< number of its vertices; 0: light begins at x_l
  Rgb value;   ///< throughput and scattering at both ends, over the probability of being chosen
  double chance;
  PortalSet::CrossingDensity crossing{};  ///< of the connecting edge
};

struct PortalSegment {
  Vertex x_l, x_c;
  Vec3d w;  ///< unit, from x_l to x_c
  PortalSet::CrossingDensity crossing{};
  double opacity = 1;  ///< coverage of both ends' surfaces (Hit::opacity)
  /// Throughput of both ends together, the G of edge C2 of [eq. 2] over its density: G / p_AA = 1 /
  /// D, and over the share of samples that draw a segment.
  Rgb through;
  std::vector<Side> light;  ///< the prefixes connected with x_l
  /// The sample that drew it.
  int x = 0, y = 0;
  uint64_t sample = 0;
  uint32_t portal = 0;
  bool lit = false;  ///< has contributed light
};

// The light vertex cache: light walks and portal segments of several samples. The camera vertices
// of those samples are connected with both, and the segments with the light walks.
//
// Method: bidirectional path tracing with a cache of light vertices (Davidovic et al. 2014). A
// vertex is connected with a few cached vertices of any walks, instead of all those of its own
// sample's walk: the same number of connections samples more of the light, and a long walk does not
// cost more of them.
//
// W walks, N vertices, M of them drawn as candidates: a vertex's connections stand for
//   times = W M / N
// samples of a walk, or W if all are drawn. A contribution is divided by the number really used;
// MIS weights use the expected one [Mixture::connected], so that they stay functions of the path.
// Each segment stands for one in every sample of the cache [Mixture::samples_of].
//
// Not every sample makes a light walk [Mixture::light_walks]. A cache always has the same number of
// walks; if the share is smaller, it spans more samples. The first samples of a cache make the
// walks: since light walks do not depend on the pixel, the choice does not matter.

struct LightVertex : End {
  const Walk* walk;
  int index;  ///< y_index
  LightVertex(const Walk& y, int i)
      : End(y[i], tdpt::way_back(y, i), y.state(i).throughput), walk(&y), index(i) {}
};

class LightVertexCache {
 public:
  /// Light walks per cache. In veach-ajar 16 instead of 1 took 1.05 times the CPU time, 256 took
  /// 1.16 times: walks leave the processor's caches before they are connected.
  static constexpr int kWalks = 16;
  /// Candidates drawn for each vertex.
  static constexpr int kCandidates = static_cast<int>(shader::kCandidates);

  /// Empties the cache, for so many samples.
  void clear(uint64_t samples = 1);
  /// `y` must outlive the use of this cache, unchanged.
  void add(const Walk& y);

  /// Place for one more segment; it is kept only if keep_segment() follows.
  PortalSegment& place_for_segment();
  void keep_segment() { ++kept_; }
  /// The segments kept.
  std::span<PortalSegment> segments() { return std::span(segments_).first(kept_); }
  /// Call after the last keep_segment(): prepares the ends x_c of the segments, also in columns,
  /// with all light that arrives at x_l.
  void prepare_segments();
  const End& segment_end(size_t i) const { return segment_ends_[i]; }
  Ends& segment_columns() { return segment_columns_; }

  /// Fills `drawn` with candidates y_i, i >= 1 (i >= 0 if `starts`), spread evenly from u in [0,1).
  /// Returns how many samples of a walk they stand for; 0 if there are none.
  double draw(bool starts, double u, std::vector<const LightVertex*>& drawn) const;

  /// Estimates of the drawn candidates' contributions to `end` [connection_estimates.h]; undefined
  /// for those without estimates, such as all y_0.
  void estimate(const std::vector<const LightVertex*>& drawn, const End& end,
                std::vector<double>& estimates) const;

  double samples() const { return samples_; }
  double walks_per_sample() const { return walks_ / samples_; }

 private:
  std::vector<LightVertex> starts_, scattered_;  ///< y_0, and the later vertices
  Ends columns_;                                 ///< of scattered_
  double walks_ = 0, samples_ = 1;
  std::vector<PortalSegment> segments_;  ///< the first kept_ are in use, the others are spare
  size_t kept_ = 0;
  std::vector<End> segment_ends_;  ///< of the kept segments
  Ends segment_columns_;
};

/// Number of samples that share a cache.
uint64_t samples_of_cache(const Mixture& mixture);
/// Pixel i of cache `cache`, one of `caches`, in a picture of `pixels`. The picture is divided into
/// stretches of `caches` pixels; each cache has one pixel in each, shifted further along in every
/// stretch, so that a cache's pixels do not line up in a few columns.
uint64_t pixel_of_cache(uint64_t cache, uint64_t i, uint64_t caches, uint64_t pixels);
/// How many of a cache's samples make a light walk; at least one if any technique needs one.
uint64_t light_walks_of(const Mixture& mixture, uint64_t samples);

/// Mean number of connectible vertices of a light walk: y_0, and the later ones.
struct LightVertices {
  double first = 0, later = 0;
};
/// Estimated from a few walks with that guiding; always the same for the same vista, guiding and
/// length.
LightVertices expected_light_vertices(const Vista& vista, const Guiding& guiding, int max_depth);
/// `mixture` with the numbers of connections to expect from such walks [Mixture::connected].
Mixture expecting_connections(const LightVertices& vertices, const Mixture& mixture);
Mixture expecting_connections(const Vista& vista, const Mixture& mixture, int max_depth);

}  // namespace tdpt
