// Parses arbitrary bytes as a scene of Mitsuba; what was read must hold together.
#include "tools/tdpt-import/mitsuba/mitsuba.h"

#include <cmath>

#include "libcommon/testing/files/fuzz.h"

using namespace tdpt;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using testing::require;
  // Files that inputs may name; the input itself is another, for includes.
  static const testing::TempFolder folder;
  static const bool written = [] {
    folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n");
    folder.write("a.ply",
                 "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                 "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                 "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    folder.write("a.png", "");
    folder.write("a.spd", "400 0.5\n700 1\n");
    return true;
  }();
  require(written, "there are files");
  const std::string path = folder.write("a.xml", std::string(testing::text_of(data, size)));
  foreign::Described scene;
  if (!testing::reads([&] {
        foreign::Source source(path);
        scene = foreign::read_mitsuba(source, {{"given", "1"}});
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
    require(!shape.emission || is_finite(shape.emission->radiance.factor), "light is finite");
  }
  for (const foreign::Material& m : scene.materials) {
    for (const auto* t :
         {&m.base.texture, &m.roughness.texture, &m.opacity.texture, &m.normal, &m.bump})
      require(!*t || (*t)->image < scene.images.size(), "an image exists");
    require(std::isfinite(m.roughness.factor) && is_finite(m.base.factor) && m.ior >= 1 &&
                std::isfinite(m.metallic) && is_finite(m.attenuation) &&
                is_finite(m.specular_colour),
            "a material's numbers are numbers");
  }
  for (const foreign::Camera& camera : scene.cameras)
    require(
        camera.width > 0 && camera.height > 0 && camera.yfov > 0 && is_finite(camera.to_world.z),
        "a camera sees something");
  for (const foreign::Lamp& lamp : scene.lamps)
    require(is_finite(lamp.at) && length(lamp.towards) > 0 && is_finite(lamp.intensity),
            "a lamp shines somewhere");
  if (scene.sky)
    require(is_finite(scene.sky->colour) && is_finite(scene.sky->to_map.x), "a sky is finite");
  return 0;
}
