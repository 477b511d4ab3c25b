// One sample of a picture: a walk from the camera, one from a light, one segment through a portal,
// and all paths that the techniques of a mixture connect from them, each with its MIS weight.
//
// Method: tri-directional path tracing (sections 3.1 to 3.3), which is bidirectional path tracing
// with a third kind of sub-path. y_0 y_1 ... are the vertices of a light's walk, z_0 z_1 ... of
// the camera's, x_l and x_c the ends of the segment on the light's and on the camera's side.
//
// Not all are connected with all. Light walks and segments of several samples are cached
// [light_vertex_cache.h]; what a camera vertex, x_l or x_c could be connected with is estimated
// without visibility, and few of those get their ray [resampling.h]. Those are the ones that
// matter, so that the weights take no notice of the choice; what is brought is divided by its
// chance.
#pragma once
#include <functional>

#include "libcommon/film/film.h"
#include "shaders/shared/path/purposes.h"
#include "tools/tdpt-render/path/sample/light_vertex_cache.h"
#include "tools/tdpt-render/path/sample/path.h"
#include "tools/tdpt-render/path/sample/resampling.h"

namespace tdpt {

struct SampleSettings {
  Mixture mixture;
  int max_depth = kMaxDepth;
  double beta = 1;  ///< 1: balance heuristic, 2: power heuristic
  uint64_t seed = 1;
  uint64_t stream = 0;  ///< keeps integrators apart
};

/// What a sample has found.
struct Contribution {
  const Path& path;
  Strategy strategy;
  Rgb value;     ///< measurement contribution over density and `times`, unweighted
  double times;  ///< samples of this strategy that it stands for: 1 without choices
};

/// Sees every contribution: for tests, and to learn where the light goes.
using PathObserver = std::function<void(const Contribution&)>;

/// Makes samples of a mixture: sample(), or its parts begin(), run() and end().
class PathSampler {
 public:
  PathSampler(const World& world, const SampleSettings& settings, Film& film, Tally& tally,
              const PathObserver* observer = nullptr)
      : PathSampler(world, settings, Guide(world, settings.mixture), film, tally, observer) {}
  /// `guide`: of that mixture.
  PathSampler(const World& world, const SampleSettings& settings, const Guide& guide, Film& film,
              Tally& tally, const PathObserver* observer);

  void sample(int x, int y, uint64_t sample) {
    begin(x, y, sample);
    run();
    end();
  }

  /// Starts a sample; random numbers depend on (seed, stream, pixel, sample) only.
  void begin(int x, int y, uint64_t sample);
  /// The walks and techniques that the mixture has.
  void run();
  // The same in phases, for samples that cache what comes from the light: their walks, kept by the
  // caller, then their segments, then all else. Each after begin() of the sample.
  bool has_light_phase() const { return settings_.mixture.techniques.walks_from_light(); }
  void light_phase(Walk& y);
  bool has_segment_phase() const { return settings_.mixture.has(Technique::portal); }
  /// `y`: the sample's own walk, of no vertices where it makes none; `cache` has all walks.
  void segment_phase(const Walk& y, LightVertexCache& cache);
  void camera_phase(const Walk& y, LightVertexCache& cache);
  /// Adds what the camera side gathered to the pixel.
  void end();

  // What run() is made of. Each technique adds its weighted share of the paths it makes, and needs
  // the walks of its prefixes.

  void walk_from_camera();
  void walk_from_light();  ///< and caches that walk alone, and a segment that is connected with it
  /// `y`: the sample's own light walk, of no vertices where it makes none.
  void connect_with(const Walk& y, LightVertexCache& cache);

  void run(Technique technique);
  void camera();  ///< the camera walk hits a light; on a transparent film not the sky behind all
  void direct();  ///< a point on a light for each camera vertex
  void light();   ///< each light vertex projected to the film
  void bi();      ///< each camera vertex connected with a few light vertices
  void portal();  ///< the camera and its vertices connected with few segments that cross a portal

 private:
  Sequence numbers(uint32_t purpose) const;

  const End& camera_end(int j) const { return camera_ends_[static_cast<size_t>(j - 1)]; }

  // Weigh a contribution and add it to the sample's own pixel, or where it falls on the film;
  // return the luminance that it brought.
  double to_pixel(const Contribution& found);
  double to_film(const Contribution& found, double raster_x, double raster_y);
  /// False when it is not finite: then it is counted and left out.
  bool weigh(const Contribution& found, Rgb& weighted);
  /// Whether nothing lies before the sky where the sample looks.
  bool looks_out() const { return camera_walk_.size < 2 || camera_walk_[1].at_infinity(); }
  void leave_out() { tally_.leave_out({sample_, y_, x_}); }
  /// Random bits for rounding, others at each call. Layers have their own, so that the picture's
  /// are the same with and without.
  uint64_t coin();
  uint64_t layer_coin();

  bool visible(const Point& a, const Point& b);
  /// Whether the camera sees p, on the side that looks at it.
  bool seen(const Point& p);

  /// G times what absorbing solids let through. No visibility.
  Rgb geometry(const Point& a, const Point& b, const Edge& e) const;
  /// Importance of the pinhole for light leaving p: radiance of a splat per unit of f * throughput.
  /// False when p is not in the picture. No visibility.
  bool project(const Point& p, Vec3d& to_camera, Rgb& factor, double& x, double& y) const;
  /// What drawn_ bring to `end`, to resampling_; nothing where the path would be too long: of y_0
  /// it would have so many edges.
  void connect_drawn(const End& end, int edges);
  /// connect() of two ends that were estimated under this number.
  Rgb connected(const End& l, const End& c, size_t number) const;
  /// What all segments bring to z_{t-1}, the i-th to estimates_[(t-2) row + i]: a row for each t.
  void estimate_segments(int t);
  // Of segments [segment_sampler.cpp].
  /// Whether it connects anything.
  bool draw_segment(const PortalSet::Sample& sample, PortalSegment& segment);
  /// What x_l can be connected with, few of it.
  void connect_with_light(PortalSegment& segment, const std::array<double, 2>& u);
  /// Light of prefixes that leave room for t vertices from the camera.
  Rgb light_of(const PortalSegment& segment, int t) const;
  /// All paths through a segment to z_{t-1}, `value` of them but for the light at x_l, each
  /// `times`. `raster`: where it is the camera that sees x_c.
  void through(PortalSegment& segment, int t, const Rgb& value, double times,
               const std::array<double, 2>& raster);
  void see(PortalSegment& segment);
  void connect_with_segments();

  const World& world_;
  SampleSettings settings_;
  Guide guide_;
  Film& film_;
  Tally& tally_;
  const PathObserver* observer_;
  int x_ = 0, y_ = 0;
  uint64_t sample_ = 0;
  uint64_t coins_ = 0, layer_coins_ = 0;  ///< state of coin(), layer_coin()
  Vec3d pixel_{};
  Walk light_walk_, camera_walk_, light_point_;
  const Walk* light_ = &light_walk_;  ///< that of the sample
  LightVertexCache own_cache_;
  LightVertexCache* cache_ = &own_cache_;
  std::vector<End> camera_ends_;  ///< [j-1] of z_j
  // Of one vertex at a time.
  std::vector<const LightVertex*> drawn_;
  std::vector<Rgb> values_;  ///< of those that were not estimated in columns
  std::vector<double> estimates_;
  Resampling resampling_;
};

}  // namespace tdpt
