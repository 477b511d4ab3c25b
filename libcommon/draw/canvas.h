// A vector drawing of lines, discs, polygons, rasters and text, written as PNG, SVG or PDF. Cairo
// draws and Pango sets the text, both behind this header.
//
// Coordinates are in pixels, x to the right and y down from the top left corner: pixel (i, j) spans
// [i, i+1) x [j, j+1). A pixel is a CSS pixel in SVG and a point, 1/72 in, in PDF. Colours are
// sRGB-coded, because that is how they are chosen. The same drawing gives the same bytes wherever
// the same fonts are installed.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libcommon/math/vec.h"

namespace tdpt::draw {

/// sRGB-coded, each component in [0,1].
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

/// A place on the canvas.
struct Pixel {
  double x = 0, y = 0;
};

struct Rectangle {
  double x = 0, y = 0, width = 0, height = 0;
  double right() const { return x + width; }
  double bottom() const { return y + height; }
  bool contains(const Pixel& p) const {
    return p.x >= x && p.x < right() && p.y >= y && p.y < bottom();
  }
};

/// A grid of texels, one ink each.
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
  double room = 0;  ///< wider text ends in an ellipsis [pixels]; 0: no limit
};
/// Throws Error (output) if no font is installed at all, as text_width() and Canvas::text() would
/// do at the end of the work.
void check_fonts();
/// Width of a text [pixels], in regular weight.
double text_width(const std::string& words, double size);

/// Shapes with a coordinate that is not finite or beyond 1e6 are not drawn. alpha in [0,1].
class Canvas {
 public:
  Canvas(int width, int height, const Ink& paper);
  ~Canvas();
  Canvas(Canvas&&) noexcept;

  int width() const { return width_; }
  int height() const { return height_; }

  /// From now on nothing is drawn outside `r`, rounded to whole pixels.
  void clip(const Rectangle& r);
  void unclip();

  /// With round caps; a line of length 0 is a dot.
  void line(Pixel a, Pixel b, double line_width, const Ink& c, double alpha = 1);
  void disc(Pixel centre, double radius, const Ink& c, double alpha = 1);
  void polygon(const std::vector<Pixel>& corners, const Ink& c, double alpha = 1);
  void fill(const Rectangle& r, const Ink& c, double alpha = 1);
  /// Outline of a rectangle, drawn inside it.
  void frame(const Rectangle& r, double line_width, const Ink& c, double alpha = 1);
  /// Each texel becomes a square with side `texel`, without interpolation.
  void raster(Pixel top_left, double texel, const Raster& texels);
  /// UTF-8 in any script for which a font is installed, with `base` on the baseline; a glyph that
  /// no font has is a box with its code. Uses DejaVu Sans if installed.
  void text(Pixel base, const std::string& words, const Lettering& how);

  Raster pixels() const;
  std::string png() const;
  std::string svg() const;
  /// Without a date; the text is searchable.
  std::string pdf() const;
  /// File format by the suffix of `path`: SVG or PDF for .svg or .pdf, PNG otherwise.
  std::string file_named(const std::string& path) const;

 private:
  struct Recording;
  std::unique_ptr<Recording> recording_;
  int width_, height_;
};

}  // namespace tdpt::draw
