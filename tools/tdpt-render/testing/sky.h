// For tests: skies, and the rooms of rooms.h opened to them.
#pragma once
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "libcommon/math/rng.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

inline constexpr double kDegree = std::numbers::pi / 180;

inline std::shared_ptr<const Sky> one_colour_sky(const Rgb& radiance) {
  return std::make_shared<Sky>(Sky::Map{1, 1, {radiance}}, 0);
}

/// 32 x 16: brighter towards the top and from one side.
inline Sky::Map graded_map() {
  Sky::Map map{32, 16, {}};
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const float up = 1 - static_cast<float>(y) / 16, side = static_cast<float>(x) / 32;
      map.texels.push_back({0.2f + up * side, 0.2f + up, 0.4f + up});
    }
  return map;
}
/// The same with a bright patch low about +x, and black below the horizon on the side of -z.
inline Sky::Map uneven_map() {
  Sky::Map map = graded_map();
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      Rgb& texel = map.texels[static_cast<size_t>(y * map.width + x)];
      if (y >= 6 && y < 8 && x >= 21 && x < 25) texel = Rgb(30, 25, 20);
      if (y >= 8 && std::abs(x - 16) < 6) texel = {};
    }
  return map;
}
/// 320 x 160, uneven, with one bright texel and a black band.
inline Sky::Map fine_map(const Rgb& brightest = {3000, 2000, 1000}) {
  Sky::Map map{320, 160, {}};
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const float f =
          0.1f + static_cast<float>(mix64(static_cast<uint64_t>(y * map.width + x)) % 64) / 64;
      map.texels.push_back(y > 100 && y < 115 ? Rgb{} : Rgb(f, 0.8f * f, 1.2f * f));
    }
  map.texels[34 * 320 + 250] = brightest;
  return map;
}
/// Rotated by 0.3 rad.
inline std::shared_ptr<const Sky> uneven_sky(std::vector<Sky::Sun> suns = {}) {
  return std::make_shared<Sky>(uneven_map(), 0.3, std::move(suns));
}

/// A disc that gives `irradiance` [W/m2] on a plane perpendicular to it.
inline Sky::Sun sun_of(const Vec3d& towards, double half_angle, float irradiance) {
  const double s = std::sin(half_angle);
  return {normalize(towards), half_angle,
          Rgb(irradiance) * static_cast<float>(1 / (std::numbers::pi * s * s))};
}

/// Removes the triangles whose corners [m] are all `gone`.
template <class Gone>
Scene without(const Scene& scene, const Gone& gone) {
  Scene open = scene;
  open.triangles.clear();
  open.smooth.clear();
  for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
    bool all = true;
    for (int corner = 0; corner < 3; ++corner)
      all = all && gone(scene.frame.to_metres(Vec3d(scene.vertex(t, corner))));
    if (all) continue;
    open.triangles.push_back(scene.triangles[t]);
    if (!scene.smooth.empty()) open.smooth.push_back(scene.smooth[t]);
  }
  return open;
}

/// Removes all that lies beyond `x` [m].
inline Scene open_end(const Scene& scene, double x) {
  return without(scene, [x](const Vec3d& p) { return p.x > x; });
}

/// Without emission and punctual lights.
inline Scene without_lamps(Scene scene) {
  for (Material& m : scene.materials) m.emission = {};
  scene.lights.clear();
  return scene;
}

inline Scene under(Scene scene, std::shared_ptr<const Sky> sky) {
  scene.sky = std::move(sky);
  return scene;
}

}  // namespace tdpt
