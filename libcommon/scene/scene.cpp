#include "libcommon/scene/scene.h"

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"

namespace tdpt {

const Camera& Scene::camera(const std::string& name) const {
  const std::string file = display_name(path);
  if (cameras.empty())
    throw InputError(file, "cameras", "the scene has no camera, expected a perspective camera");
  if (name.empty()) return cameras.front();
  std::string names;
  for (const Camera& c : cameras) {
    if (c.name == name) return c;
    names += (names.empty() ? "\"" : ", \"") + c.name + "\"";
  }
  throw InputError(file, "cameras",
                   fmt::format("there is no camera \"{}\", expected one of {}", name, names));
}

TriangleShape shape_of(const Scene& scene, uint32_t triangle) {
  TriangleShape s;
  s.p0 = Vec3d(scene.vertex(triangle, 0));
  s.e1 = Vec3d(scene.vertex(triangle, 1)) - s.p0;
  s.e2 = Vec3d(scene.vertex(triangle, 2)) - s.p0;
  const Vec3d n = cross(s.e1, s.e2);
  const double l = length(n);
  s.area = 0.5 * l;
  s.normal = l > 0 ? n / l : Vec3d{};
  return s;
}

}  // namespace tdpt
