// Where samples add up. Sums do not depend on the order of threads: a pixel's camera samples are
// added by one thread in sample order, splats from light walks as integers in fixed point.
#pragma once
#include <array>
#include <atomic>
#include <memory>
#include <vector>

#include "libcommon/formats/picture.h"

namespace tdpt {

class Film {
 public:
  /// `brightest`: largest radiance a light of the scene emits; sets the unit of the fixed point:
  /// a splat is rounded to brightest * 2^-34, and a pixel holds sums up to brightest * 2^29.
  Film(int width, int height, double brightest);

  int width() const { return width_; }
  int height() const { return height_; }

  void add(int x, int y, const Vec3d& radiance) { camera_[index(x, y)] += radiance; }
  /// Any thread. False when the value is too large to be held; then it is left out.
  bool splat(int x, int y, const Rgb& radiance);

  /// Sums divided by samples per pixel.
  Picture resolve(uint64_t spp) const;

 private:
  size_t index(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
  }
  int width_, height_;
  double unit_;
  std::vector<Vec3d> camera_;
  std::unique_ptr<std::array<std::atomic<int64_t>, 3>[]> splats_;
};

}  // namespace tdpt
