// The sky as it is seen through the portals [shaders/shared/path/window_sky.h]: the tables.
#pragma once
#include <memory>
#include <vector>

#include "libcommon/scene/sky.h"
#include "tools/tdpt-render/path/light/window_views.h"
#include "tools/tdpt-render/portals/portals.h"

namespace tdpt {

/// The sky as windows of one direction show it, over a and b. Sums of whole numbers, modulo 2^32:
/// their differences are exact.
struct WindowFrame {
  Vec3d x, y, z;               ///< unit; z: out
  uint32_t cells;              ///< along either axis
  std::vector<uint32_t> sums;  ///< [i (cells + 1) + j], of cells below column i and row j
  double unit;                 ///< luminance x solid angle of one

  /// `x` and `z` unit, across each other.
  WindowFrame(const Sky& sky, const Vec3d& x, const Vec3d& z, int cells);
};

class WindowSky {
 public:
  WindowSky() = default;
  /// Of the first kMostWindows facets by area; `sky` null: none. The sky must outlive this. What
  /// `before` has laid out of the same sky is not laid out again, nor is looked around from the
  /// same windows, of the same scene.
  WindowSky(const Sky* sky, const Tracer& tracer, const PortalSet& portals,
            const WindowSky& before);
  static constexpr size_t kMostWindows = WindowViews::kMost;

  bool empty() const { return windows_.empty(); }
  /// A facet's.
  struct Window {
    std::shared_ptr<const WindowFrame> frame;
    Vec3d centre;
    double x0, x1, y0, y1, z;  ///< its rectangle, along the frame's axes
  };
  const std::vector<Window>& windows() const { return windows_; }
  const WindowViews& views() const { return views_; }
  /// Those that may be seen from `x`: bit i of a mask.
  uint32_t in_view(const Vec3d& x) const {
    return views_.at(x) & static_cast<uint32_t>((uint64_t{1} << windows_.size()) - 1);
  }
  /// What all windows show of the sky from `x` (canonical), where the surface faces `facing` (0:
  /// both ways): sum S_F.
  double seen(const Vec3d& x, const Vec3d& facing) const;
  /// Unit, towards the sky; `seen` more than 0, that of `x`. Three numbers in [0,1).
  Vec3d sample(const Vec3d& x, const Vec3d& facing, double seen, double pick, double u,
               double v) const;
  /// Density of sample() [1/sr].
  double pdf_w(const Vec3d& x, const Vec3d& facing, double seen, const Vec3d& towards) const;

 private:
  std::shared_ptr<const WindowFrame> laid_out(const Vec3d& x, const Vec3d& z,
                                              const WindowSky& before) const;
  void look_around(const Tracer& tracer, const WindowSky& before);

  const Sky* sky_ = nullptr;
  std::vector<Window> windows_;
  WindowViews views_;
};

}  // namespace tdpt
