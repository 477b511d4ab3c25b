// Parses arbitrary bytes as a scene of pbrt; what was read must hold together.
#include "tools/tdpt-import/pbrt/pbrt.h"

#include <cmath>

#include "libcommon/testing/files/fuzz.h"

using namespace tdpt;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using testing::require;
  foreign::Described scene;
  if (!testing::reads([&] {
        foreign::Source source(testing::file_of(testing::text_of(data, size)));
        scene = foreign::read_pbrt(source);
      }))
    return 0;
  for (const foreign::Mesh& mesh : scene.meshes) {
    require(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size(),
            "there is a normal for every position");
    require(mesh.uv.empty() || mesh.uv.size() == mesh.positions.size(),
            "there are coordinates for every position");
    for (const auto& t : mesh.triangles)
      for (const uint32_t corner : t) require(corner < mesh.positions.size(), "corners exist");
  }
  for (const foreign::Shape& shape : scene.shapes) {
    require(shape.mesh < scene.meshes.size(), "a shape's mesh exists");
    require(shape.material < scene.materials.size(), "a shape's material exists");
    require(is_finite(shape.to_world.x) && is_finite(shape.to_world.y) &&
                is_finite(shape.to_world.z) && is_finite(shape.to_world.t),
            "a shape's place is finite");
  }
  for (const foreign::Material& m : scene.materials) {
    require(!m.base.texture || m.base.texture->image < scene.images.size(), "an image exists");
    require(std::isfinite(m.roughness.factor) && is_finite(m.base.factor) && m.ior >= 1,
            "a material's numbers are numbers");
  }
  for (const foreign::Camera& camera : scene.cameras)
    require(
        camera.width > 0 && camera.height > 0 && camera.yfov > 0 && is_finite(camera.to_world.z),
        "a camera sees something");
  return 0;
}
