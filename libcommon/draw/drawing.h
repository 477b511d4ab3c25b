// A preview as data: panels that show 3D shapes over a picture of what is behind them, with labels,
// a key and notes. A stage fills it in; draw() projects and draws it.
//
// Places are in metres, in the axes of the scene's file; pixels as in canvas.h.
#pragma once
#include <cmath>
#include <string>
#include <vector>

#include "libcommon/draw/canvas.h"
#include "libcommon/draw/palette.h"
#include "libcommon/draw/shapes.h"
#include "libcommon/scene/scene.h"

namespace tdpt::draw {

/// Width of every preview, the margin around its panels, its heading, and the room below a panel
/// for caption and scale [pixels].
inline constexpr int kSheetWidth = 1600;
inline constexpr double kMargin = 36, kHeading = 92, kCaptionRoom = 46;

/// Maps places to pixels of a panel: through a pinhole, or parallel to `forward`. The directions
/// are unit and orthogonal.
struct Projection {
  Rectangle panel;
  Vec3d eye, right, up, forward;
  double half_width = 1;  ///< half the panel's width [m]; through a pinhole at distance 1
  bool pinhole = true;

  /// Shows the camera's whole vertical angle; the panel should have its aspect.
  static Projection of_camera(const Camera& camera, const Frame& frame, const Rectangle& panel);
  /// Parallel, with `middle` at the panel's centre; shows at least half_right and half_up around
  /// it.
  static Projection flat(const Vec3d& middle, const Vec3d& right, const Vec3d& up,
                         double half_right, double half_up, const Rectangle& panel);

  double pixels_per_metre() const { return 0.5 * panel.width / half_width; }
  /// Distance from the eye along forward.
  double depth(const Vec3d& place) const { return dot(place - eye, forward); }
  /// Undefined through a pinhole if depth() <= 0.
  Pixel project(const Vec3d& place) const;
  /// Origin and unit direction of the ray through a point of the canvas.
  void ray(const Pixel& at, Vec3d& from, Vec3d& w) const;
};

struct Label {
  Vec3d place;
  std::string words;
  Ink ink = kInk;
};

struct Panel {
  Projection view;
  std::string caption{};
  /// Behind the shapes, `texel` pixels per texel.
  Raster backdrop{0, 0};
  double texel = 1;
  /// Of the surface in each texel of the backdrop, or infinity: shapes behind it are pale. Empty:
  /// nothing hides a shape.
  std::vector<float> depth{};
  double bottom = -INFINITY, top = INFINITY;  ///< heights of what it shows
  std::vector<Shape> shapes{};                ///< before the drawing's, in this panel only
  std::vector<Label> labels{};

  bool shows(const Vec3d& place) const { return place.y >= bottom && place.y < top; }
};

/// Fills the backdrop: colour(place) for the place of each texel in the plane of a flat view.
template <class Colour>
void fill_backdrop(Panel& panel, double texel, const Colour& colour) {
  const Rectangle& r = panel.view.panel;
  panel.texel = texel;
  panel.backdrop = Raster(static_cast<int>(std::ceil(r.width / texel)),
                          static_cast<int>(std::ceil(r.height / texel)));
  for (int y = 0; y < panel.backdrop.height(); ++y)
    for (int x = 0; x < panel.backdrop.width(); ++x) {
      Vec3d place, w;
      panel.view.ray({r.x + (x + 0.5) * texel, r.y + (y + 0.5) * texel}, place, w);
      panel.backdrop.at(x, y) = colour(place);
    }
}

/// Several inks are a scale from left to right.
struct KeyEntry {
  std::vector<Ink> inks;
  std::string words;
};

struct Drawing {
  std::string title, sentence;
  std::vector<Panel> panels{};
  std::vector<Shape> shapes{};  ///< in all panels
  std::vector<Label> labels{};
  std::vector<KeyEntry> key{};
  std::vector<std::string> notes{};  ///< lines below the key
};
Canvas draw(const Drawing& drawing);

/// Panels of these aspects (width / height) in rows of one height: large, and with little of the
/// sheet left empty.
std::vector<Rectangle> arranged(const std::vector<double>& aspects);

}  // namespace tdpt::draw
