// The sky as it is seen through the portals: draws directions in proportion to it from any point of
// the camera's side, so that next events find the bright parts of it that a window shows.
//
// Method: portal-masked environment map sampling (Bitterli, Wyman and Pharr 2015; in pbrt-v4 as
// PortalImageInfiniteLight). Each facet of a portal [portals.h] has a rectangle around it, with
// axes x, y in its plane and z out towards the sky. The sky is laid out anew over
//   a = c(w_x / w_z),  b = c(w_y / w_z),  c(t) = t / (1 + |t|) in (-1, 1),
// in which the rectangle is again one, seen from any point; sums over it are four look-ups of a
// summed-area table. (The paper's c is the arc tangent, which is as even and takes longer.) Its
// cells hold the luminance of the sky there times solid angle.
//
// S_F(x)  what is seen of the sky through the rectangle of facet F from x; 0 behind it, where all
// of
//         it is below the horizon of the surface at x, and where walls are between [window_views.h]
// W_F(w)  content of the cell of w over its size, da db
//   pdf_w(w) = sum over the F whose rectangle the ray (x, w) passes of
//              W_F(w) (da db / dw) / sum_F S_F(x)
//
// What is beside the polygon in its rectangle, or hidden, is a miss. The table is an estimate: what
// shines there is told by the sky itself, and small bright parts are spread over the cells around,
// so that no cell that they touch counts as dark.
#pragma once
#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <vector>

#include "libcommon/scene/sky.h"
#include "tools/tdpt-render/path/light/window_views.h"
#include "tools/tdpt-render/portals/portals.h"

namespace tdpt {

/// The sky over a and b of one frame.
class RectifiedSky {
 public:
  /// In cells: [0, cells] for (-1, 1).
  struct Rect {
    double a0, a1, b0, b1;
  };

  /// `z` unit, out; `x` unit, across it; `cells` of either axis.
  RectifiedSky(const Sky& sky, const Vec3d& x, const Vec3d& z, int cells);

  const Vec3d& x() const { return x_; }
  const Vec3d& y() const { return y_; }
  const Vec3d& z() const { return z_; }
  Vec3d to_local(const Vec3d& w) const { return {dot(x_, w), dot(y_, w), dot(z_, w)}; }
  /// c(t) in cells, t = x / z, z more than 0.
  double in_cells(double x, double z) const { return (x / (z + std::abs(x)) + 1) * 0.5 * n_; }
  double in_cells(double t) const { return in_cells(t, 1); }
  /// Luminance x solid angle within a rectangle, and in all.
  double sum(const Rect& r) const;
  double total() const { return sums_.back(); }
  /// Along either axis, and what one of them holds: luminance x solid angle.
  int cells() const { return n_; }
  double content(int i, int j) const {
    return at(i + 1, j + 1) - at(i, j + 1) - at(i + 1, j) + at(i, j);
  }
  /// Unit, towards the sky, within the rectangle in proportion to the table; u, v in [0,1). Its sum
  /// must be more than 0.
  Vec3d sample(const Rect& r, double u, double v) const;
  /// W(w) (da db / dw) [W/m2/sr], w unit in the frame, w.z > 0.
  double density(const Vec3d& local) const;

 private:
  double at(int i, int j) const { return sums_[static_cast<size_t>(i * (n_ + 1) + j)]; }
  /// A place along b between corners.
  struct Place {
    int j;
    double t;
  };
  Place place(double b) const;
  double at(int i, const Place& b) const {
    return at(i, b.j) + b.t * (at(i, b.j + 1) - at(i, b.j));
  }

  Vec3d x_, y_, z_;
  int n_;
  std::vector<double> sums_;  // [i (n+1) + j]: of cells below column i and row j
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
    std::shared_ptr<const RectifiedSky> sky;
    Vec3d centre;
    double x0, x1, y0, y1, z;  ///< its rectangle, along the sky's axes
  };
  const std::vector<Window>& windows() const { return windows_; }
  const WindowViews& views() const { return views_; }
  /// Whether window i is seen from `x`.
  bool shows(size_t i, const Vec3d& x) const { return views_.at(x) >> i & 1u; }
  /// What all windows show of the sky from `x` (canonical), where the surface faces `facing` (0:
  /// both ways): sum S_F.
  double seen(const Vec3d& x, const Vec3d& facing) const;
  /// Unit, towards the sky; `seen` more than 0, that of `x`. Three numbers in [0,1).
  Vec3d sample(const Vec3d& x, const Vec3d& facing, double seen, double pick, double u,
               double v) const;
  /// Density of sample() [1/sr].
  double pdf_w(const Vec3d& x, const Vec3d& facing, double seen, const Vec3d& towards) const;

 private:
  std::shared_ptr<const RectifiedSky> laid_out(const Vec3d& x, const Vec3d& z,
                                               const WindowSky& before) const;
  void look_around(const Tracer& tracer, const WindowSky& before);

  /// Calls visit(window) for those that may be seen from `x`.
  template <class Visit>
  void for_each(const Vec3d& x, const Visit& visit) const {
    for (uint32_t rest = views_.at(x); rest != 0; rest &= rest - 1) {
      const auto i = static_cast<size_t>(std::countr_zero(rest));
      if (i >= windows_.size()) return;
      visit(windows_[i]);
    }
  }

  const Sky* sky_ = nullptr;
  std::vector<Window> windows_;
  WindowViews views_;
};

}  // namespace tdpt
