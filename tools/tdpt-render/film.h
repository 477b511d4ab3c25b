// Where samples add up. Sums do not depend on the order of threads: a pixel's camera samples are
// added by one thread in sample order, splats from light walks as integers in fixed point.
#pragma once
#include <array>
#include <atomic>
#include <memory>
#include <vector>

#include "libcommon/formats/picture.h"
#include "tools/tdpt-render/path/techniques.h"

namespace tdpt {

class Film {
 public:
  /// `power`: of all lamps together [Lights::power]. Walks start in proportion to power, so every
  /// walk carries about that much however small or faint its lamp is: splats are rounded to
  /// power * 2^-40. One may be up to power * 2^36, as when light is scattered 1e-5 of the scene
  /// from the camera; a pixel holds 2^19 of those and 2^31 ordinary ones. `layers`: techniques
  /// whose contributions are kept apart as well, each at the cost of another film; the picture's
  /// sums are the same with and without.
  Film(int width, int height, double power, TechniqueSet layers = TechniqueSet());

  int width() const { return width_; }
  int height() const { return height_; }

  /// What a sample gathered, by all techniques together.
  void add(int x, int y, const Vec3d& radiance) { picture_.camera[index(x, y)] += radiance; }
  /// The part of it that one technique brought; nothing where that has no layer.
  void add_to_layer(Technique technique, int x, int y, const Vec3d& radiance) {
    Plane& plane = layers_[static_cast<size_t>(technique)];
    if (plane.splats) plane.camera[index(x, y)] += radiance;
  }
  /// Any thread; to the picture and to the technique's layer. False when the value is too large to
  /// be held; then it is left out.
  bool splat(Technique technique, int x, int y, const Rgb& radiance);

  /// Sums divided by samples per pixel.
  Picture resolve(uint64_t spp) const { return resolve(picture_, spp); }
  /// The same for one technique; black where it has no layer.
  Picture resolve_layer(Technique technique, uint64_t spp) const {
    return resolve(layers_[static_cast<size_t>(technique)], spp);
  }

  struct Measure {
    Vec3d mean;          ///< over all pixels
    double nonzero = 0;  ///< share of pixels that are not black
  };
  /// Of the picture that resolve(spp) gives, without making it.
  Measure measure(uint64_t spp) const;

 private:
  /// Sums of the upper and the lower 32 bits of every splat, for R, G and B.
  struct Splats {
    std::array<std::atomic<int64_t>, 3> high, low;
  };
  struct Plane {
    std::vector<Vec3d> camera;
    std::unique_ptr<Splats[]> splats;  ///< null: this plane is not kept
  };

  size_t index(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
  }
  size_t pixels() const { return index(0, height_); }
  Plane make_plane() const;
  static void add_splat(Splats& sums, const std::array<double, 3>& units);
  Rgb pixel(const Plane& plane, size_t i, double share) const;
  Picture resolve(const Plane& plane, uint64_t spp) const;

  int width_, height_;
  double unit_;
  Plane picture_;
  std::array<Plane, kTechniques> layers_;
};

}  // namespace tdpt
