// Tables for importance sampling the sky through the portals [shaders/shared/path/window_sky.h].
#pragma once
#include <memory>
#include <vector>

#include "libcommon/scene/sky.h"
#include "tools/tdpt-render/path/light/window_views.h"
#include "tools/tdpt-render/portals/portals.h"

namespace tdpt {

/// Luminance of the sky for windows of one direction, over (a, b), as a summed-area table. Entries
/// are whole numbers modulo 2^32, so that their differences are exact.
struct WindowFrame {
  Vec3d x, y, z;               ///< unit; z points outwards
  uint32_t cells;              ///< along either axis
  std::vector<uint32_t> sums;  ///< [i (cells + 1) + j]: sum over cells below column i and row j
  double unit;                 ///< luminance x solid angle of one unit of the sums

  /// `x` and `z`: unit and perpendicular.
  WindowFrame(const Sky& sky, const Vec3d& x, const Vec3d& z, int cells);
};

class WindowSky {
 public:
  WindowSky() = default;
  /// Uses the kMostWindows largest facets; none if `sky` is null. The sky must outlive this. Tables
  /// and views of `before` are reused for the same sky and the same windows; the scene must be the
  /// same.
  WindowSky(const Sky* sky, const Tracer& tracer, const PortalSet& portals,
            const WindowSky& before);
  static constexpr size_t kMostWindows = WindowViews::kMost;

  bool empty() const { return windows_.empty(); }
  /// The window of one facet.
  struct Window {
    std::shared_ptr<const WindowFrame> frame;
    Vec3d centre;
    double x0, x1, y0, y1, z;  ///< its rectangle in the frame's axes
  };
  const std::vector<Window>& windows() const { return windows_; }
  const WindowViews& views() const { return views_; }
  /// Windows that may be seen from `x`: bit i of a mask.
  uint32_t in_view(const Vec3d& x) const {
    return views_.at(x) & static_cast<uint32_t>((uint64_t{1} << windows_.size()) - 1);
  }
  /// Sum S_F of the sky that all windows show from `x` (canonical) to a surface that faces `facing`
  /// (0: both ways).
  double seen(const Vec3d& x, const Vec3d& facing) const;
  /// Unit direction towards the sky; `seen` is that of `x` and must be positive. Three numbers in
  /// [0,1).
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
