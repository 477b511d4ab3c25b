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
  /// `power`: of all lamps together [Emitters::power]. Walks start in proportion to power, so every
  /// walk carries about that much however small or faint its lamp is: splats are rounded to
  /// power * 2^-40 and may be up to power * 2^23. A pixel holds 2^31 of them.
  Film(int width, int height, double power);

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
  /// Sums of the upper and the lower 32 bits of every splat, for R, G and B.
  struct Splats {
    std::array<std::atomic<int64_t>, 3> high, low;
  };
  std::unique_ptr<Splats[]> splats_;
};

}  // namespace tdpt
