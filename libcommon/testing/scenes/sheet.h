// Test only: two-rooms.glb with a sheet in its hole that is not opaque.
#pragma once
#include <vector>

#include "libcommon/scene/scene.h"

namespace tdpt::testing {

inline Scene two_rooms_scene() {
  return read_gltf(TDPT_TESTDATA "/scenes/two-rooms.glb");
}

/// two-rooms.glb with a sheet across the hole; its alpha is its coverage.
inline Scene with_sheet(Material sheet, const Image& image) {
  Scene scene = two_rooms_scene();
  const auto first = static_cast<uint32_t>(scene.positions.size());
  for (const Vec3d& p : {Vec3d(2.05, 0.8, -0.2), Vec3d(2.05, 1.2, -0.2), Vec3d(2.05, 1.2, 0.2),
                         Vec3d(2.05, 0.8, 0.2)})
    scene.positions.push_back(Vec3f(scene.frame.to_canonical(p)));
  const auto material = static_cast<uint32_t>(scene.materials.size());
  scene.triangles.push_back({{first, first + 1, first + 2}, material});
  scene.triangles.push_back({{first, first + 2, first + 3}, material});
  scene.normals.clear(), scene.smooth.clear(), scene.tangents.clear();
  scene.uv[1].assign(scene.positions.size(), {0, 0});
  scene.colours.assign(scene.positions.size(), {1, 1, 1, 1});
  const float uv[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (uint32_t i = 0; i < 4; ++i) {
    scene.uv[1][first + i] = {uv[i][0], uv[i][1]};
    scene.colours[first + i][3] = i < 2 ? 1.0f : 0.75f;
  }
  sheet.plain = false;
  sheet.maps[MAP_BASE].uv_set = 1;
  scene.images = {image};
  scene.materials.push_back(sheet);
  return scene;
}

inline Image small_image() {
  Image image{5, 3, {}};
  for (int i = 0; i < 15; ++i)
    for (int c = 0; c < 4; ++c) image.texels.push_back(static_cast<uint8_t>(i * 53 % 256));
  return image;
}

/// Alpha alone, and with textures in every wrapping and filter mode.
inline std::vector<Material> sheet_materials() {
  using Wrap = TextureMap::Wrap;
  Material m;
  m.alpha_mode = Material::Alpha::blend;
  m.alpha = 0.6f;
  std::vector<Material> all;
  all.push_back(m);  // no texture
  m.alpha = 1;
  m.maps[MAP_BASE].image = 0;
  m.maps[MAP_BASE].transform = {80, 3, -0.3f, -2, 7, 0.2f};
  m.maps[MAP_BASE].wrap_u = Wrap::repeat;
  m.maps[MAP_BASE].wrap_v = Wrap::mirror;
  all.push_back(m);
  m.maps[MAP_BASE].wrap_u = Wrap::clamp;
  m.maps[MAP_BASE].wrap_v = Wrap::repeat;
  m.maps[MAP_BASE].transform = {2, 0, -0.5f, 0, 4, 0};
  m.alpha_mode = Material::Alpha::mask;
  m.alpha_cutoff = 0.4f;
  all.push_back(m);
  m.maps[MAP_BASE].nearest = true;
  m.maps[MAP_BASE].wrap_u = Wrap::mirror;
  all.push_back(m);
  return all;
}

}  // namespace tdpt::testing
