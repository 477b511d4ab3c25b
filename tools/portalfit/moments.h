// Spread of points in a plane: mean and covariance, and the rectangle with the same moments.
#pragma once
#include <vector>

#include "tools/portalfit/polygon.h"

namespace tdpt {

struct Moments {
  double n = 0;  ///< points
  Vec2d mean;
  double xx = 0, xy = 0, yy = 0;  ///< covariance [m2]
  double determinant() const { return xx * yy - xy * xy; }
};
Moments moments_of(const std::vector<Vec2d>& points);

/// Moments without the points farther than 3 standard deviations (a uniform rectangle reaches
/// 2.45); `n` counts all.
Moments trimmed_moments(const std::vector<Vec2d>& points);

/// Coordinates along u and v from an origin.
struct Whitening {
  Vec2d origin, u{1, 0}, v{0, 1};
  Vec2d operator()(Vec2d p) const { return {dot(p - origin, u), dot(p - origin, v)}; }
};

/// The rectangle whose uniform distribution has these moments.
struct Extents {
  Vec2d mean, axis;  ///< axis: unit, of the longer side
  double longer = 0, shorter = 0;
  /// In these coordinates the rectangle is a unit square, so that slits are described as well as
  /// squares.
  Whitening whitening() const {
    return {mean, axis * (1 / longer), Vec2d{-axis.y, axis.x} * (1 / shorter)};
  }
};
/// Needs a point.
Extents extents_of(const std::vector<Vec2d>& points);

}  // namespace tdpt
