// Test only: random triangles, and a closed mesh.
#pragma once
#include <cmath>
#include <string>

#include "libcommon/math/rng.h"
#include "libcommon/scene/scene.h"

namespace tdpt::testing {

inline Vec3d random_direction(Rng& rng) {
  const double z = 2 * rng.uniform() - 1;
  const double phi = 6.283185307179586 * rng.uniform();
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}
inline Vec3d random_place(Rng& rng, double size) {
  const double x = rng.uniform();
  const double y = rng.uniform();
  const double z = rng.uniform();
  return (Vec3d(x, y, z) * 2.0 - Vec3d(1)) * size;
}

inline void add(Scene& scene, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const auto first = static_cast<uint32_t>(scene.positions.size());
  scene.positions.insert(scene.positions.end(), {a, b, c});
  scene.triangles.push_back({{first, first + 1, first + 2}, 0});
}
inline Scene no_triangles() {
  Scene scene;
  scene.materials.resize(1);
  return scene;
}
/// Random triangles in the frame, with corners up to `size` from their middle.
inline Scene soup(uint32_t count, double size) {
  Scene scene = no_triangles();
  Rng rng(11, 0, 0);
  for (uint32_t i = 0; i < count; ++i) {
    const Vec3d middle = random_place(rng, 1 - size);
    const Vec3f a(middle + random_place(rng, size));
    const Vec3f b(middle + random_place(rng, size));
    const Vec3f c(middle + random_place(rng, size));
    add(scene, a, b, c);
  }
  return scene;
}
/// A closed sphere facing outwards; neighbours share their corners.
inline Scene sphere(uint32_t rows, double radius) {
  Scene scene = no_triangles();
  const uint32_t columns = 2 * rows;
  const auto place = [&](uint32_t i, uint32_t j) {
    const double a = 3.141592653589793 * i / rows, b = 6.283185307179586 * j / columns;
    return Vec3f(Vec3d(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)) * radius);
  };
  scene.positions = {Vec3f(0, 0, static_cast<float>(radius)),
                     Vec3f(0, 0, -static_cast<float>(radius))};
  for (uint32_t i = 1; i < rows; ++i)
    for (uint32_t j = 0; j < columns; ++j) scene.positions.push_back(place(i, j));
  const auto at = [&](uint32_t i, uint32_t j) {
    return i == 0 ? 0 : i == rows ? 1 : 2 + (i - 1) * columns + j % columns;
  };
  for (uint32_t i = 0; i < rows; ++i)
    for (uint32_t j = 0; j < columns; ++j) {
      if (i > 0) scene.triangles.push_back({{at(i, j), at(i + 1, j), at(i, j + 1)}, 0});
      if (i + 1 < rows)
        scene.triangles.push_back({{at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)}, 0});
    }
  return scene;
}
inline Scene file(const std::string& name) {
  return read_gltf(TDPT_TESTDATA "/scenes/" + name);
}

}  // namespace tdpt::testing
