// A drawing: lines, discs, polygons, rasters and words, laid over each other and kept as such, then
// written as PNG, SVG or PDF. Cairo draws and Pango sets the words, both behind this header.
//
// Places are in pixels, x to the right and y down from the top left corner: pixel (i, j) spans [i,
// i+1) x [j, j+1). A pixel is a CSS pixel in SVG and a point, 1/72 in, in PDF. Colours are coded as
// on screens (sRGB), because that is how they are chosen. The same drawing gives the same bytes
// wherever the same fonts are installed.
#pragma once
#include <cstdint>
#include <memory>
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

/// Texels of one ink each.
class Raster {
 public:
  Raster(int width, int height, const Ink& all = {})
      : width_(width),
        height_(height),
        texels_(static_cast<size_t>(width) * static_cast<size_t>(height), all) {}
  int width() const { return width_; }
  int height() const { return height_; }
  Ink& at(int x, int y) { return texels_[index(x, y)]; }
  const Ink& at(int x, int y) const { return texels_[index(x, y)]; }

 private:
  size_t index(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
  }
  int width_, height_;
  std::vector<Ink> texels_;
};

enum class Align { left, middle, right };

struct Lettering {
  double size;  ///< height of a capital letter [pixels], exact in DejaVu Sans
  Ink ink;
  Align align = Align::left;
  bool bold = false;
  double room = 0;  ///< words wider than this end in an ellipsis [pixels]; 0: no limit
};
/// Throws Error (output) where no font is installed at all, as text_width() and Canvas::text() do
/// when the work is done.
void check_fonts();
/// Width of words [pixels], in regular weight.
double text_width(const std::string& words, double size);

/// Shapes with a coordinate that is not finite, or further than 1e6 away, are not drawn. alpha in
/// [0,1].
class Canvas {
 public:
  Canvas(int width, int height, const Ink& paper);
  ~Canvas();
  Canvas(Canvas&&) noexcept;

  int width() const { return width_; }
  int height() const { return height_; }

  /// Nothing is drawn outside `box`, rounded to whole pixels, any more.
  void clip(const Box& box);
  void unclip();

  /// With round ends; a line of no length is a dot.
  void line(Point a, Point b, double line_width, const Ink& c, double alpha = 1);
  void disc(Point centre, double radius, const Ink& c, double alpha = 1);
  /// The line of a circle.
  void ring(Point centre, double radius, double line_width, const Ink& c, double alpha = 1);
  void polygon(const std::vector<Point>& corners, const Ink& c, double alpha = 1);
  void fill(const Box& box, const Ink& c, double alpha = 1);
  /// The border of a box, drawn inside it.
  void frame(const Box& box, double line_width, const Ink& c, double alpha = 1);
  /// Each texel a square with side `texel`; never interpolated.
  void raster(Point top_left, double texel, const Raster& texels);
  /// UTF-8 in any script for which a font is installed, `base` on the base line; a letter that no
  /// font has is a box with its code. DejaVu Sans where it is installed.
  void text(Point base, const std::string& words, const Lettering& how);

  Raster pixels() const;
  std::string png() const;
  std::string svg() const;
  /// Without a date; the words can be searched.
  std::string pdf() const;
  /// The file for a name: SVG or PDF where it ends in .svg or .pdf, PNG otherwise.
  std::string file_named(const std::string& path) const;

 private:
  struct Recording;
  std::unique_ptr<Recording> recording_;
  int width_, height_;
};

}  // namespace tdpt::draw
