// Where samples add up. Sums do not depend on the order of threads: a pixel's camera samples are
// added by one thread in sample order, splats from light walks as integers in fixed point.
#pragma once
#include <array>
#include <atomic>
#include <memory>
#include <vector>

#include "libcommon/formats/picture.h"
#include "tools/tdpt-render/path/mixture.h"

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

  /// The sums back to zero; what add_other() added stays.
  void clear();
  /// Adds weight * (sums of another film, of this size) to a second account, layer by layer.
  void add_other(const Film& other, double weight);
  /// The sums by themselves, pixel by pixel; without the other account.
  std::vector<Vec3d> sums() const;

  /// The picture is samples * sums + others * the other account.
  struct Shares {
    double samples = 0, others = 0;
  };
  /// The mean of `spp` samples per pixel, and nothing from other films.
  static Shares mean_of(uint64_t spp) { return {spp > 0 ? 1.0 / static_cast<double>(spp) : 0, 0}; }
  Picture resolve(const Shares& shares) const { return resolve(picture_, shares); }
  Picture resolve(uint64_t spp) const { return resolve(mean_of(spp)); }
  /// The same for one technique; black where it has no layer.
  Picture resolve_layer(Technique technique, const Shares& shares) const {
    return resolve(layers_[static_cast<size_t>(technique)], shares);
  }
  Picture resolve_layer(Technique technique, uint64_t spp) const {
    return resolve_layer(technique, mean_of(spp));
  }

  struct Measure {
    Vec3d mean;          ///< over all pixels
    double nonzero = 0;  ///< share of pixels that are not black
  };
  /// Of the picture that resolve(shares) gives, without making it.
  Measure measure(const Shares& shares) const;

 private:
  /// Sums of the upper and the lower 32 bits of every splat, for R, G and B.
  struct Splats {
    std::array<std::atomic<int64_t>, 3> high, low;
  };
  struct Plane {
    std::vector<Vec3d> camera;
    std::unique_ptr<Splats[]> splats;  ///< null: this plane is not kept
    std::vector<Vec3d> others;         ///< empty until something is added
  };

  size_t index(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
  }
  size_t pixels() const { return index(0, height_); }
  Plane make_plane() const;
  static void add_splat(Splats& sums, const std::array<double, 3>& units);
  Vec3d sum(const Plane& plane, size_t i) const;
  Rgb pixel(const Plane& plane, size_t i, const Shares& shares) const;
  Picture resolve(const Plane& plane, const Shares& shares) const;

  int width_, height_;
  double unit_;
  Plane picture_;
  std::array<Plane, kTechniques> layers_;
};

}  // namespace tdpt
