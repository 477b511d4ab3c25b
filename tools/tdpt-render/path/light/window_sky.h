// Records from which cells of space each window can be seen: a bit mask per cell.
//
// Points outside the house, or in the next room, also lie behind the planes of windows; a wall
// hides what their rectangles would show there, and next events should not sample it.
//
// Method: visibility cast from the windows. Lines are drawn from each into the house, evenly over
// its area and over all directions. The cells that a line passes, until it hits something or leaves
// by another window, see this window, and so do their neighbours, so that few are missed between
// lines. A missed cell costs no light: the mask is a function of the position alone, and so is
// every density made with it. Whether there is sky behind the window is not tested: lines through a
// cell would miss a sliver of it, and where there is none nothing is lost.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "libcommon/scene/sky.h"
#include "libcommon/trace/tracer.h"
#include "tools/tdpt-render/portals/portals.h"

namespace tdpt {

class WindowViews {
 public:
  static constexpr size_t kMost = 32;  ///< windows

  /// A rectangle given by a corner and two sides, canonical; `out`: unit, towards the sky.
  struct Opening {
    Vec3d corner, across, up, out;
    friend bool operator==(const Opening&, const Opening&) = default;
  };

  /// Without any knowledge: every window is seen from everywhere.
  WindowViews() = default;
  /// For at most kMost openings.
  WindowViews(const Tracer& tracer, const std::vector<Opening>& openings);

  bool are_of(const std::vector<Opening>& openings) const { return openings_ == openings; }
  /// Bit i: opening i may be seen from `p` (canonical).
  uint32_t at(const Vec3d& p) const {
    const Vec3d cell = (p - low_) * per_width_;
    if (!(cell.x >= 0 && cell.y >= 0 && cell.z >= 0)) return beyond_;
    // Clamped to what an integer holds; larger values are outside the grid anyway.
    const Vec3d within(std::min(cell.x, 1e6), std::min(cell.y, 1e6), std::min(cell.z, 1e6));
    const std::array<size_t, 3> i{static_cast<size_t>(within.x), static_cast<size_t>(within.y),
                                  static_cast<size_t>(within.z)};
    return i[0] < size_[0] && i[1] < size_[1] && i[2] < size_[2] ? masks_[index(i)] : beyond_;
  }

  /// The grid: its low corner, cells per unit, cells along each axis, their masks (x runs fastest),
  /// and the mask outside the grid.
  const Vec3d& low() const { return low_; }
  double per_width() const { return per_width_; }
  const std::array<size_t, 3>& size() const { return size_; }
  const std::vector<uint32_t>& masks() const { return masks_; }
  uint32_t beyond() const { return beyond_; }

 private:
  struct Line;
  size_t index(const std::array<size_t, 3>& i) const {
    return (i[2] * size_[1] + i[1]) * size_[0] + i[0];
  }
  void lay_out(const std::vector<Line>& lines);
  void mark(const std::vector<Line>& lines);
  void widen();

  std::vector<Opening> openings_;
  uint32_t beyond_ = ~0u;  ///< outside the grid
  Vec3d low_{};
  double per_width_ = 0;  ///< cells per unit
  std::array<size_t, 3> size_{};
  std::vector<uint32_t> masks_;
};

// Tables for importance sampling the sky through the portals [shaders/shared/path/window_sky.h].

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

}  // namespace tdpt

namespace tdpt::shader {

class WindowSky {
 public:
  WindowSky() = default;
  /// Uses the kMostWindows largest facets; none if `sky` is null. The sky must outlive this. Tables
  /// and views of `before` are reused for the same sky and the same windows; the scene must be the
  /// same.
  WindowSky(const Sky* sky, const Tracer& tracer, const PortalSet& portals,
            const WindowSky& before);
  static constexpr size_t kMostWindows = WindowViews::kMost;

  using WindowFrame = tdpt::WindowFrame;
  bool empty() const { return windows_.empty(); }
  /// The window of one facet.
  struct Window {
    std::shared_ptr<const WindowFrame> frame;
    Vec3d centre;
    double x0, x1, y0, y1, z;  ///< its rectangle in the frame's axes
  };
  const std::vector<Window>& windows() const { return windows_; }
  const WindowViews& views() const { return views_; }

  // What the shared code needs.
  using Real = double;
  using SkyWindow = Window;
  uint windows_in_view(const Vec3d& x) const {
    return views_.at(x) & static_cast<uint32_t>((uint64_t{1} << windows_.size()) - 1);
  }
  const SkyWindow& load_sky_window(uint i) const { return windows_[i]; }
  static const WindowFrame& load_window_frame(const std::shared_ptr<const WindowFrame>& frame) {
    return *frame;
  }
  static uint window_sum(const WindowFrame& frame, uint i) { return frame.sums[i]; }

#include "shaders/shared/path/window_sky.h"

 private:
  std::shared_ptr<const WindowFrame> laid_out(const Vec3d& x, const Vec3d& z,
                                              const WindowSky& before) const;
  void look_around(const Tracer& tracer, const WindowSky& before);

  const Sky* sky_ = nullptr;
  std::vector<Window> windows_;
  WindowViews views_;
};

}  // namespace tdpt::shader

namespace tdpt {
using shader::WindowSky;
}
