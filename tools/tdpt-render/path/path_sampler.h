// One sample of a picture: a walk from the camera, one from a light, one segment through a portal,
// and all paths that the techniques of a mixture join from them, each with its MIS weight.
//
// Method: tri-directional path tracing (sections 3.1 to 3.3), which is bidirectional path tracing
// with a third kind of sub-path. y_0 y_1 ... are the vertices of the light's walk, z_0 z_1 ... of
// the camera's, x_l and x_c the ends of the segment on the light's and on the camera's side.
#pragma once
#include <functional>

#include "tools/tdpt-render/film.h"
#include "tools/tdpt-render/path/path.h"

namespace tdpt {

struct SampleSettings {
  Mixture mixture;
  int max_depth = 6;
  double beta = 1;  ///< 1: balance heuristic, 2: power heuristic
  uint64_t seed = 1;
  uint64_t stream = 0;  ///< keeps integrators apart
};

/// Sees every contribution with its path: for tests, and to learn where the light goes.
using PathObserver = std::function<void(const Path&, Strategy, const Rgb& unweighted)>;

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
  // The same in two phases, for many samples at a time: first the light's walk, kept by the caller,
  // then all else with it. Both after begin() of the sample.
  bool has_light_phase() const { return settings_.mixture.techniques.walks_from_light(); }
  void light_phase(Walk& y);
  void camera_phase(const Walk& y);
  /// Adds what the camera side gathered to the pixel.
  void end();

  // What run() is made of. Each technique adds its weighted share of the paths it makes, and needs
  // the walks of its prefixes.

  void walk_from_camera();
  void walk_from_light();

  void run(Technique technique);
  void camera();  ///< the camera walk hits a light
  void direct();  ///< a point on a light for each camera vertex
  void light();   ///< each light vertex projected to the film
  void bi();      ///< each light vertex with each camera vertex
  void portal();  ///< both walks joined through a segment that crosses a portal

 private:
  enum Purpose : uint64_t { film_place, camera_walk, light_walk, next_event, segment };
  Sequence numbers(Purpose purpose) const;

  // Weigh a contribution and add it to the sample's own pixel, or where it falls on the film;
  // return the luminance that it brought.
  double to_pixel(const Path& path, Strategy strategy, const Rgb& value);
  double to_film(const Path& path, Strategy strategy, double raster_x, double raster_y,
                 const Rgb& value);
  /// False when it is not finite: then it is counted and left out.
  bool weigh(const Path& path, Strategy strategy, const Rgb& value, Rgb& weighted);
  void leave_out() { tally_.leave_out({sample_, y_, x_}); }
  /// Random bits for rounding, others at each call. Layers have their own, so that the picture's
  /// are the same with and without.
  uint64_t coin();
  uint64_t layer_coin();

  bool visible(const Point& a, const Point& b);

  /// G times what absorbing solids let through. No visibility.
  Rgb geometry(const Point& a, const Point& b, const Edge& e) const;
  /// Importance of the pinhole for light leaving p: radiance of a splat per unit of f * throughput.
  /// False when p is not in the picture. No visibility.
  bool project(const Point& p, Vec3d& to_camera, Rgb& factor, double& x, double& y) const;
  /// A segment x_l -> x_c through a portal, its crossing and the coverage of both ends' surfaces
  /// (Hit::presence); false when it joins nothing.
  bool portal_segment(const PortalSet::Sample& sample, Vertex& x_l, Vertex& x_c,
                      PortalSet::Crossing& crossing, double& presence);

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
};

}  // namespace tdpt
