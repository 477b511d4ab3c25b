// The oracle's densities of next events and of where walks begin: for light from the sky by sums
// over the whole sky where the fast code has tables, for rectangular lights from their four corners
// alone. For tests.
#pragma once
#include <vector>

#include "tools/tdpt-render/path/sample/path.h"

namespace tdpt::oracle {

struct Rectangle;

class SkyLight {
 public:
  /// `vista` must outlive it and keep its present portals.
  explicit SkyLight(const Vista& vista);

  /// Density of the direction in which a walk begins [1/sr], `towards`: unit, to the sky. A tenth
  /// of it by luminance alone, the rest by luminance times the portals' area projected along the
  /// direction.
  double start_pdf_w(const Vec3d& towards) const;
  /// Density [1/sr] of a direction of next events at `shaded`, on a path that goes on to `next`.
  /// `q`: share that looks through windows; `through`: factor of their density.
  double next_event_pdf_w(const Vertex& shaded, const Vertex& next, const Vec3d& towards, double q,
                          double through) const;

 private:
  /// The sky in the cells of a window's frame: luminance x solid angle.
  struct Layout {
    const WindowFrame* frame;
    int n;
    std::vector<double> cells;
  };

  double across_portals(const Vec3d& towards) const;
  const Layout& layout_of(const WindowSky::Window& window) const;
  double seen_through(const WindowSky::Window& window, const Rectangle& r) const;

  const Vista& vista_;
  // Parts of a cell between texels' centres, within which the portals' weight is constant.
  int across_ = 0, down_ = 0;
  double total_ = 0, total_across_ = 0;  // of luminance, and of luminance times area [per sr]
  std::vector<Layout> layouts_;
};

/// p_A of x_0, on a rectangular light, as a next event among rectangular lights at x_1 of a path
/// that goes on to x_2.
double rect_light_pdf_A(const Vista& vista, const Vertex& x0, const Vertex& x1, const Vertex& x2);

}  // namespace tdpt::oracle
