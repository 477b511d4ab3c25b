// A picture to draw on: antialiased lines, discs and convex polygons, blended over each other.
//
// Pixels: x to the right and y down from the top left corner, pixel (i, j) spans [i, i+1) x
// [j, j+1). Colours are coded as on screens (sRGB), because that is how they are chosen.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libcommon/math/vec.h"

namespace tdpt::draw {

/// sRGB-coded, each in [0,1].
using Ink = Vec3f;
/// 0xRRGGBB.
constexpr Ink ink(uint32_t hex) {
  return {static_cast<float>(hex >> 16 & 255) / 255, static_cast<float>(hex >> 8 & 255) / 255,
          static_cast<float>(hex & 255) / 255};
}
/// a at t = 0, b at t = 1.
constexpr Ink mix(const Ink& a, const Ink& b, double t) {
  return a + (b - a) * static_cast<float>(t);
}

struct Point {
  double x = 0, y = 0;
};

struct Box {
  double x = 0, y = 0, width = 0, height = 0;
  double right() const { return x + width; }
  double bottom() const { return y + height; }
  bool contains(const Point& p) const {
    return p.x >= x && p.x < right() && p.y >= y && p.y < bottom();
  }
};

class Canvas {
 public:
  Canvas(int width, int height, const Ink& paper);

  int width() const { return width_; }
  int height() const { return height_; }
  const Ink& at(int x, int y) const { return pixels_[index(x, y)]; }

  /// Nothing is drawn outside `box` any more.
  void clip(const Box& box);
  void unclip() { clip({0, 0, static_cast<double>(width_), static_cast<double>(height_)}); }

  /// Lays `c` over a pixel; outside the clip nothing happens. alpha in [0,1].
  void blend(int x, int y, const Ink& c, double alpha = 1);
  /// With round ends; a line of no length is a dot.
  void line(Point a, Point b, double line_width, const Ink& c, double alpha = 1);
  void disc(Point centre, double radius, const Ink& c, double alpha = 1);
  /// Convex, either way round.
  void polygon(const std::vector<Point>& corners, const Ink& c, double alpha = 1);
  void fill(const Box& box, const Ink& c, double alpha = 1);
  /// The border of a box, drawn inside it.
  void frame(const Box& box, double line_width, const Ink& c, double alpha = 1);

  std::string png() const;

 private:
  size_t index(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
  }
  /// Calls cover(x, y) -> share of the pixel that is inked, for pixels in the clip that the box
  /// touches.
  template <class Cover>
  void ink_where(double left, double top, double right, double bottom, const Ink& c, double alpha,
                 Cover&& cover);

  int width_, height_;
  int clip_left_ = 0, clip_top_ = 0, clip_right_ = 0, clip_bottom_ = 0;
  std::vector<Ink> pixels_;
};

}  // namespace tdpt::draw
