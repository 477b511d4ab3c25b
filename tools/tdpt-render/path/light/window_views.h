// From where which window is seen: a mask for each cell of the space behind them.
//
// A place outside the house lies behind the windows of its other walls as a place inside does, and
// so does one in the next room: what their rectangles would show there is behind a wall, and next
// events are to look elsewhere.
//
// Method: visibility cast from the windows. Lines are drawn from each into the house, evenly over
// its area and over all directions. The cells that one passes, until it meets something or leaves
// by another window, see this one, and so do those beside them, so that few are missed between
// lines. What is missed all the same costs no light: the mask is a function of the place alone, and
// so is every density that is made with it. Whether any sky is behind the window is not asked: a
// sliver of it would be missed by all lines through a cell, and where there is none nothing is
// lost.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "libcommon/trace/tracer.h"

namespace tdpt {

class WindowViews {
 public:
  static constexpr size_t kMost = 32;  ///< windows

  /// A rectangle from a corner along two sides, canonical; `out`: unit, towards the sky.
  struct Opening {
    Vec3d corner, across, up, out;
    friend bool operator==(const Opening&, const Opening&) = default;
  };

  /// Nothing is known: all are seen from everywhere.
  WindowViews() = default;
  /// Of kMost openings at most.
  WindowViews(const Tracer& tracer, const std::vector<Opening>& openings);

  bool are_of(const std::vector<Opening>& openings) const { return openings_ == openings; }
  /// Bit i: opening i is seen from a place (canonical).
  uint32_t at(const Vec3d& p) const {
    const Vec3d cell = (p - low_) * per_width_;
    if (!(cell.x >= 0 && cell.y >= 0 && cell.z >= 0)) return beyond_;
    // Beyond what an integer holds nothing is in the grid.
    const Vec3d within(std::min(cell.x, 1e6), std::min(cell.y, 1e6), std::min(cell.z, 1e6));
    const std::array<size_t, 3> i{static_cast<size_t>(within.x), static_cast<size_t>(within.y),
                                  static_cast<size_t>(within.z)};
    return i[0] < size_[0] && i[1] < size_[1] && i[2] < size_[2] ? masks_[index(i)] : beyond_;
  }

  /// Of the cells: a corner, how many there are per unit and along the axes, their masks (x runs
  /// fastest), and the mask outside of them.
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
  double per_width_ = 0;  ///< of a cell
  std::array<size_t, 3> size_{};
  std::vector<uint32_t> masks_;
};

}  // namespace tdpt
