// The region where most of a set of points lies, by robust quantiles of their coordinates: the part
// that matters of a scene whose floor or sky may extend a hundred times as far.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "libcommon/math/vec.h"

namespace tdpt {

/// An axis-aligned box; empty while low > high.
struct Extent {
  Vec3d low{1e300}, high{-1e300};

  void add(const Vec3d& p) { low = min(low, p), high = max(high, p); }
  void add(const Extent& e) { low = min(low, e.low), high = max(high, e.high); }
  bool empty() const { return !(low.x <= high.x); }
  Vec3d size() const { return empty() ? Vec3d{} : high - low; }
  /// By `by` on every side.
  Extent widened(const Vec3d& by) const { return {low - by, high + by}; }
  Extent within(const Extent& e) const { return {max(low, e.low), min(high, e.high)}; }
};

inline constexpr double kFarShare = 0.02;  ///< of the weight, cut off at either end of each axis
inline constexpr double kFarMargin = 0.1;  ///< of a side: how far a few points may lie outside

/// The box from quantile `far_share` of the places to 1 - far_share along each axis, widened by
/// kFarMargin of its sides: points that fill a room give the whole room.
inline Extent reach_of(const std::vector<Vec3d>& places, double far_share = kFarShare) {
  Extent reach;
  if (places.empty()) return reach;
  const auto n = static_cast<double>(places.size());
  const auto low = static_cast<std::ptrdiff_t>(far_share * n);
  const auto high = std::max(low, static_cast<std::ptrdiff_t>(std::ceil((1 - far_share) * n)) - 1);
  std::vector<double> at(places.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (size_t i = 0; i < places.size(); ++i) at[i] = places[i][axis];
    std::nth_element(at.begin(), at.begin() + low, at.end());
    reach.low[axis] = at[static_cast<size_t>(low)];
    std::nth_element(at.begin() + low, at.begin() + high, at.end());
    reach.high[axis] = at[static_cast<size_t>(high)];
  }
  return reach.widened(reach.size() * kFarMargin);
}

/// Every k-th item, from the first one on, with the smallest k that leaves at most `most` > 0.
template <class T>
std::vector<T> thinned(const std::vector<T>& items, size_t most) {
  std::vector<T> some;
  const size_t k = std::max<size_t>(1, (items.size() + most - 1) / most);
  for (size_t i = 0; i < items.size(); i += k) some.push_back(items[i]);
  return some;
}

}  // namespace tdpt
