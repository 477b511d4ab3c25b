// For tests: sheets in a scene's windows.
#pragma once
#include "libcommon/scene/scene.h"

namespace tdpt {

inline Material clear_pane() {
  Material m;
  m.name = "pane";
  m.plain = false;
  m.base_color = Rgb(1);
  m.specular = 1;
  m.transmission = 1;
  m.roughness = 0;
  return m;
}

/// A sheet of opacity `alpha`.
inline Material veil(float alpha) {
  Material m;
  m.plain = false;
  m.alpha = alpha;
  m.alpha_mode = Material::Alpha::blend;
  return m;
}

/// `scene` with a rectangle p, p+u, p+u+v, p+v (metres).
inline Scene with_sheet(Scene scene, const Material& material, const Vec3d& p, const Vec3d& u,
                        const Vec3d& v) {
  const auto first = static_cast<uint32_t>(scene.positions.size());
  for (const Vec3d& corner : {p, p + u, p + u + v, p + v})
    scene.positions.push_back(Vec3f(scene.frame.to_canonical(corner)));
  const auto m = static_cast<uint32_t>(scene.materials.size());
  scene.materials.push_back(material);
  scene.triangles.push_back({{first, first + 1, first + 2}, m});
  scene.triangles.push_back({{first, first + 2, first + 3}, m});
  if (!scene.smooth.empty()) scene.smooth.resize(scene.triangles.size());
  if (!scene.normals.empty()) scene.normals.resize(scene.positions.size());
  for (auto& uv : scene.uv)
    if (!uv.empty()) uv.resize(scene.positions.size());
  if (!scene.tangents.empty()) scene.tangents.resize(scene.positions.size());
  if (!scene.colours.empty()) scene.colours.resize(scene.positions.size(), {1, 1, 1, 1});
  return scene;
}

}  // namespace tdpt
