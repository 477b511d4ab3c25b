// What the oracle knows of light from the sky: the densities with which walks begin there and next
// events look there. By sums over all of the sky where the fast code has tables. For tests.
#pragma once
#include <vector>

#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt::oracle {

struct Rectangle;

class SkyLight {
 public:
  /// `world` must outlive it, with the portals that it has now.
  explicit SkyLight(const World& world);

  /// Density of a direction in which walks begin [1/sr], unit `towards` the sky: a tenth by
  /// luminance alone, the rest by luminance times the portals' area across the direction.
  double start_pdf_w(const Vec3d& towards) const;
  /// Density of a direction of next events at `shaded`, from which a path goes on to `next` [1/sr],
  /// of which the share `q` looks through windows; `through`: factor of their density.
  double next_event_pdf_w(const Vertex& shaded, const Vertex& next, const Vec3d& towards, double q,
                          double through) const;

 private:
  /// Cells in which the sky is laid out as seen through a plane: luminance x solid angle.
  struct Layout {
    const WindowFrame* frame;
    int n;
    std::vector<double> cells;
  };

  double across_portals(const Vec3d& towards) const;
  const Layout& layout_of(const WindowSky::Window& window) const;
  double seen_through(const WindowSky::Window& window, const Rectangle& r) const;

  const World& world_;
  // Parts of a cell between texels' centres, within which the portals count alike.
  int across_ = 0, down_ = 0;
  double total_ = 0, total_across_ = 0;  // of luminance, of luminance times area [per sr]
  std::vector<Layout> layouts_;
};

}  // namespace tdpt::oracle
