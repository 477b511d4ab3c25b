// What holds of every description of a scene, however odd its file: checked by the fuzz targets.
#pragma once
#include <cmath>

#include "libcommon/testing/files/fuzz.h"
#include "tools/tdpt-import/described.h"

namespace tdpt::foreign {

/// Ends the program with a sentence where the description contradicts itself.
inline void require_sound(const Described& scene) {
  using testing::require;
  for (const Mesh& mesh : scene.meshes) {
    require(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size(),
            "there is a normal for every position");
    require(mesh.uv.empty() || mesh.uv.size() == mesh.positions.size(),
            "there are coordinates for every position");
    for (const auto& t : mesh.triangles)
      for (const uint32_t corner : t) require(corner < mesh.positions.size(), "corners exist");
  }
  for (const Shape& shape : scene.shapes) {
    require(shape.mesh < scene.meshes.size(), "a shape's mesh exists");
    require(shape.material < scene.materials.size(), "a shape's material exists");
    require(is_finite(shape.to_world.x) && is_finite(shape.to_world.y) &&
                is_finite(shape.to_world.z) && is_finite(shape.to_world.t),
            "a shape's place is finite");
    require(!shape.emission || is_finite(shape.emission->radiance.factor), "light is finite");
  }
  for (const Material& m : scene.materials) {
    for (const auto* t :
         {&m.base.texture, &m.roughness.texture, &m.opacity.texture, &m.normal, &m.bump})
      require(!*t || (*t)->image < scene.images.size(), "an image exists");
    require(std::isfinite(m.roughness.factor) && is_finite(m.base.factor) && m.ior >= 1 &&
                std::isfinite(m.metallic) && is_finite(m.attenuation) &&
                is_finite(m.specular_colour),
            "a material's numbers are numbers");
  }
  for (const Shape& portal : scene.portals)
    require(portal.mesh < scene.meshes.size(), "a portal's mesh exists");
  for (const Camera& camera : scene.cameras)
    require(
        camera.width > 0 && camera.height > 0 && camera.yfov > 0 && is_finite(camera.to_world.z),
        "a camera sees something");
  for (const Lamp& lamp : scene.lamps)
    require(is_finite(lamp.at) && length(lamp.towards) > 0 && is_finite(lamp.intensity),
            "a lamp shines somewhere");
  if (scene.sky)
    require(is_finite(scene.sky->colour) && is_finite(scene.sky->to_map.x), "a sky is finite");
}

}  // namespace tdpt::foreign
