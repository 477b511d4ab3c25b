#include "tools/portalfit/moments.h"

#include <algorithm>
#include <cmath>

namespace tdpt {

Moments moments_of(const std::vector<Vec2d>& points) {
  Moments m;
  m.n = static_cast<double>(points.size());
  if (points.empty()) return m;
  for (const Vec2d& p : points) m.mean = m.mean + p;
  m.mean = m.mean * (1 / m.n);
  for (const Vec2d& p : points) {
    const Vec2d d = p - m.mean;
    m.xx += d.x * d.x, m.xy += d.x * d.y, m.yy += d.y * d.y;
  }
  m.xx /= m.n, m.xy /= m.n, m.yy /= m.n;
  return m;
}

Moments trimmed_moments(const std::vector<Vec2d>& points) {
  const Moments all = moments_of(points);
  const double det = all.determinant();
  if (!(det > 0)) return all;
  std::vector<Vec2d> kept;
  kept.reserve(points.size());
  for (const Vec2d& p : points) {
    const Vec2d d = p - all.mean;
    // Squared Mahalanobis distance.
    if ((all.yy * d.x * d.x - 2 * all.xy * d.x * d.y + all.xx * d.y * d.y) / det <= 9)
      kept.push_back(p);
  }
  Moments m = moments_of(kept);
  m.n = all.n;
  return m;
}

Extents extents_of(const std::vector<Vec2d>& points) {
  const Moments m = moments_of(points);
  // The covariance has the eigenvalues half +- spread; a side of length s has the variance s^2 /
  // 12.
  const double turn = 0.5 * std::atan2(2 * m.xy, m.xx - m.yy), half = 0.5 * (m.xx + m.yy),
               spread = std::hypot(0.5 * (m.xx - m.yy), m.xy);
  return {m.mean,
          {std::cos(turn), std::sin(turn)},
          std::sqrt(12 * (half + spread)),
          std::sqrt(12 * std::max(0.0, half - spread))};
}

}  // namespace tdpt
