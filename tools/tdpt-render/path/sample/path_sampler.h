// Makes one sample of a picture: a walk from the camera, one from a light, one segment through a
// portal, and all paths that the techniques of a mixture connect from them, each with its MIS
// weight.
//
// Method: tri-directional path tracing (sections 3.1 to 3.3), that is, bidirectional path tracing
// with a third kind of sub-path. y_0 y_1 ... are the vertices of the light walk, z_0 z_1 ... of the
// camera walk, x_l and x_c the ends of the segment on the light's and on the camera's side.
//
// Not all pairs are connected. Light walks and segments of several samples are cached
// [light_vertex_cache.h]; the possible connections of a camera vertex, x_l or x_c are estimated
// without visibility, and only a few of them get their ray [light_vertex_cache.h]. These are chosen
// by importance, so the MIS weights ignore the choice; contributions are divided by its
// probability.
#pragma once
#include <functional>

#include "libcommon/film/film.h"
#include "shaders/shared/path/render_layout.h"
#include "tools/tdpt-render/path/sample/light_vertex_cache.h"
#include "tools/tdpt-render/path/sample/path.h"

namespace tdpt {

struct SampleSettings {
  Mixture mixture;
  int max_depth = kMaxDepth;
  double beta = 1;  ///< 1: balance heuristic, 2: power heuristic
  uint64_t seed = 1;
  uint64_t stream = 0;  ///< separates the random numbers of integrators
};

/// A path that a sample has found.
struct Contribution {
  const Path& path;
  Strategy strategy;
  Rgb value;     ///< measurement contribution over density and `times`, unweighted
  double times;  ///< number of samples of this strategy that it stands for: 1 without resampling
};

/// Receives every contribution: for tests, and to learn where the light comes from.
using PathObserver = std::function<void(const Contribution&)>;

/// Makes samples of a mixture: call sample(), or its parts begin(), run() and end().
class PathSampler {
 public:
  PathSampler(const Vista& vista, const SampleSettings& settings, Film& film, Tally& tally,
              const PathObserver* observer = nullptr)
      : PathSampler(vista, settings, Guide(vista, settings.mixture), film, tally, observer) {}
  /// `guide`: of that mixture.
  PathSampler(const Vista& vista, const SampleSettings& settings, const Guide& guide, Film& film,
              Tally& tally, const PathObserver* observer);

  void sample(int x, int y, uint64_t sample) {
    begin(x, y, sample);
    run();
    end();
  }

  /// Starts a sample; random numbers depend on (seed, stream, pixel, sample) only.
  void begin(int x, int y, uint64_t sample);
  /// Runs the walks and techniques of the mixture.
  void run();
  // The same in phases, for samples that share a cache: light walks, kept by the caller, then
  // segments, then all else. Call begin() of the sample before each phase.
  bool has_light_phase() const { return settings_.mixture.techniques.walks_from_light(); }
  void light_phase(Walk& y);
  bool has_segment_phase() const { return settings_.mixture.has(Technique::portal); }
  /// `y`: the sample's own light walk, empty if it makes none; `cache` holds all walks.
  void segment_phase(const Walk& y, LightVertexCache& cache);
  void camera_phase(const Walk& y, LightVertexCache& cache);
  /// Adds what the camera side gathered to the pixel.
  void end();

  // The steps of run(). Each technique adds its weighted share of the paths it makes and needs the
  // walks of its prefixes.

  void walk_from_camera();
  void walk_from_light();  ///< also caches that walk alone, and a segment connected with it
  /// `y`: the sample's own light walk, empty if it makes none.
  void connect_with(const Walk& y, LightVertexCache& cache);

  void run(Technique technique);
  void camera();  ///< the camera walk hits a light; on a transparent film, not the sky behind
                  ///< everything
  void direct();  ///< a point on a light for each camera vertex
  void light();   ///< each light vertex projected to the film
  void bi();      ///< each camera vertex connected with a few light vertices
  void portal();  ///< the camera and its vertices connected with a few segments through a portal

 private:
  Sequence numbers(uint32_t purpose) const;

  const End& camera_end(int j) const { return camera_ends_[static_cast<size_t>(j - 1)]; }

  // Weigh a contribution and add it to the sample's own pixel, or to the place on the film where it
  // falls; return the luminance added.
  double to_pixel(const Contribution& found);
  double to_film(const Contribution& found, double raster_x, double raster_y);
  /// False if it is not finite: then it is counted and left out.
  bool weigh(const Contribution& found, Rgb& weighted);
  /// Whether the sample looks straight into the sky.
  bool looks_out() const { return camera_walk_.size < 2 || camera_walk_[1].at_infinity(); }
  void leave_out() { tally_.leave_out({sample_, y_, x_}); }
  /// Random bits for rounding, new at each call. Layers have their own, so that they do not change
  /// the picture.
  uint64_t coin();
  uint64_t layer_coin();

  bool visible(const Point& a, const Point& b);
  /// Whether the camera sees p, on the side that faces it.
  bool seen(const Point& p);

  /// G times the transmittance of absorbing solids. No visibility.
  Rgb geometry(const Point& a, const Point& b, const Edge& e) const;
  /// Importance of the camera's end for light that leaves p: splatted radiance per unit of f *
  /// throughput. False if p is not in the picture. No visibility.
  bool project(const Point& p, Vec3d& to_camera, Rgb& factor, double& x, double& y) const;
  /// Adds the contributions of drawn_ to `end` to resampling_; 0 if the path would be too long.
  /// `edges`: the length of a path from y_0.
  void connect_drawn(const End& end, int edges);
  /// connect() of two ends whose estimate has this number.
  Rgb connected(const End& l, const End& c, size_t number) const;
  /// Estimates of all segments for z_{t-1}, the i-th at estimates_[(t-2) row + i]: a row for each
  /// t.
  void estimate_segments(int t);
  // Segments [segment_sampler.cpp].
  /// Whether it can carry light.
  bool draw_segment(const PortalSet::SegmentDraw& sample, PortalSegment& segment);
  /// Connects x_l with a few of the vertices that it can be connected with.
  void connect_with_light(PortalSegment& segment, const std::array<double, 2>& u);
  /// Light of prefixes short enough to leave room for t camera vertices.
  Rgb light_of(const PortalSegment& segment, int t) const;
  /// Adds all paths through a segment to z_{t-1}; `value` excludes the light at x_l; each stands
  /// for `times`. `raster`: where x_c falls on the film, if it is connected with the camera.
  void through(PortalSegment& segment, int t, const Rgb& value, double times,
               const std::array<double, 2>& raster);
  void see(PortalSegment& segment);
  void connect_with_segments();

  const Vista& vista_;
  SampleSettings settings_;
  Guide guide_;
  Film& film_;
  Tally& tally_;
  const PathObserver* observer_;
  int x_ = 0, y_ = 0;
  uint64_t sample_ = 0;
  uint64_t coins_ = 0, layer_coins_ = 0;  ///< state of coin(), layer_coin()
  FilmPlane drawn_film_;                  ///< of this sample
  Vec3d pixel_{};
  Walk light_walk_, camera_walk_, light_point_;
  const Walk* light_ = &light_walk_;  ///< the light walk of this sample
  LightVertexCache own_cache_;
  LightVertexCache* cache_ = &own_cache_;
  std::vector<End> camera_ends_;  ///< [j-1]: of z_j
  // Scratch for one vertex at a time.
  std::vector<const LightVertex*> drawn_;
  std::vector<Rgb> values_;  ///< of those that were not estimated in columns
  std::vector<double> estimates_;
  Resampling resampling_;
};

}  // namespace tdpt
