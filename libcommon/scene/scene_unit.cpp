#include "libcommon/scene/scene_unit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace tdpt {
namespace {

constexpr double kHighest = 50, kUsual = 2.7;  // of rooms [m]
constexpr size_t kMostPoints = 16;
constexpr double kNone = std::numeric_limits<double>::infinity();

constexpr std::array kUnits{SceneUnit{"inches", 0.0254, 0}, SceneUnit{"centimetres", 0.01, 0},
                            SceneUnit{"millimetres", 0.001, 0}};

// Where people look from and lamps hang; of many every n-th.
std::vector<Vec3d> points_of(const Scene& scene) {
  std::vector<Vec3d> all, some;
  for (const Camera& camera : scene.cameras)
    if (!camera.fault) all.push_back(camera.position);
  for (const PunctualLight& lamp : scene.lights)
    if (lamp.kind != PunctualLight::Kind::directional) all.push_back(lamp.position);
  const size_t step = (all.size() + kMostPoints - 1) / kMostPoints;
  for (size_t i = 0; i < all.size(); i += step) some.push_back(all[i]);
  return some;
}

// How far the triangle is above the point, on the vertical through it; nothing if it is beside it.
std::optional<double> above(const Scene& scene, uint32_t triangle, const Vec3d& point) {
  std::array<Vec3d, 3> p;
  for (int c = 0; c < 3; ++c) p[c] = Vec3d(scene.vertex(triangle, c)) - point;
  std::array<double, 3> w;  // twice the areas that the point's shadow makes with each side
  for (size_t c = 0; c < 3; ++c) {
    const Vec3d &a = p[(c + 1) % 3], &b = p[(c + 2) % 3];
    w[c] = a.z * b.x - a.x * b.z;
  }
  const double sum = w[0] + w[1] + w[2];
  if (sum == 0 || w[0] * sum < 0 || w[1] * sum < 0 || w[2] * sum < 0) return {};
  return (w[0] * p[0].y + w[1] * p[1].y + w[2] * p[2].y) / sum;
}

double height_at(const Scene& scene, const Vec3d& point) {
  double up = kNone, down = kNone;
  for (uint32_t t = 0; t < scene.triangles.size(); ++t)
    if (const auto height = above(scene, t, point))
      (*height > 0 ? up : down) = std::min(*height > 0 ? up : down, std::abs(*height));
  return up + down;
}

bool is_high(const Scene& scene) {
  double low = kNone, high = -kNone;
  for (const Vec3f& p : scene.positions) {
    low = std::min(low, static_cast<double>(p.y));
    high = std::max(high, static_cast<double>(p.y));
  }
  return high - low > kHighest * scene.frame.scale;
}

}  // namespace

std::optional<SceneUnit> unit_of(const Scene& scene) {
  if (!is_high(scene)) return {};
  std::vector<double> heights;
  for (const Vec3d& point : points_of(scene))
    if (const double height = height_at(scene, point) / scene.frame.scale; height < kNone)
      heights.push_back(height);
  if (heights.empty()) return {};
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  if (*middle < kHighest) return {};
  const auto misfit = [&](const SceneUnit& unit) {
    return std::abs(std::log(*middle * unit.metres / kUsual));
  };
  SceneUnit unit = *std::min_element(
      kUnits.begin(), kUnits.end(),
      [&](const SceneUnit& a, const SceneUnit& b) { return misfit(a) < misfit(b); });
  unit.height = *middle;
  return unit;
}

}  // namespace tdpt
