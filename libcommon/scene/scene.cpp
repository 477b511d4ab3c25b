#include "libcommon/scene/scene.h"

#include <fmt/format.h>
#include <algorithm>

#include "libcommon/base/file.h"
#include "libcommon/base/words.h"

namespace tdpt {

namespace {

// Farther away, single precision can represent neither the camera's position nor what it sees.
constexpr double kFarthest = 1e6;

const Camera& checked(const std::string& file, const Camera& camera) {
  const double away = length(camera.position);
  if (!(away <= kFarthest))
    throw InputError(file, "cameras",
                     fmt::format("camera \"{}\" stands {:.3g} times the scene's size away, "
                                 "expected at most {:.0g}",
                                 camera.name, away, kFarthest));
  return camera;
}

const Camera* find(const std::vector<Camera>& cameras, const std::string& name) {
  const auto found =
      std::find_if(cameras.begin(), cameras.end(), [&](const Camera& c) { return c.name == name; });
  return found == cameras.end() ? nullptr : &*found;
}

std::string no_camera(const std::vector<Camera>& cameras, const std::string& name) {
  std::string names;
  for (const Camera& c : cameras) names += (names.empty() ? "\"" : ", \"") + c.name + "\"";
  return fmt::format("there is no camera \"{}\", expected {}", shown(name),
                     names.empty() ? "a perspective camera" : "one of " + names);
}

std::string posed(const Scene& scene) {
  return scene.hash + (scene.pose_hash.empty() ? "" : '@' + scene.pose_hash);
}

}  // namespace

std::string Scene::identity() const {
  return posed(*this) + (sky_hash.empty() ? "" : '+' + sky_hash);
}

bool Scene::is_pose_of(const std::string& identity) const {
  return identity.substr(0, identity.find('+')) == posed(*this);
}

bool Scene::is_scene_of(const std::string& identity) const {
  return identity.substr(0, identity.find_first_of("@+")) == hash;
}

bool is_under_sky(const std::string& identity) {
  return identity.find('+') != std::string::npos;
}

void check_made_from(const Scene& scene, const std::string& identity, const std::string& file) {
  if (identity == scene.identity()) return;
  const std::string name = display_name(scene.path);
  throw InputError(
      display_name(file), "",
      !scene.is_scene_of(identity) ? "was made from another scene than " + name
      : scene.is_pose_of(identity)
          ? "was made from " + name + ", but under another environment or other --set light-units"
          : "was made from " + name + ", but at another time of its animations (--at)");
}

const Camera& Scene::camera(const std::string& name) const {
  const std::string file = display_name(path);
  if (cameras.empty())
    throw InputError(file, "cameras",
                     "the scene has no perspective camera, expected one (in Blender's export tick "
                     "Include > Cameras, for lamps Punctual Lights), or --look-from and --look-at, "
                     "or --frame");
  const std::string& wanted = name.empty() ? defaults.camera : name;
  if (wanted.empty()) return checked(file, cameras.front());
  const Camera* const found = find(cameras, wanted);
  if (!found)
    throw InputError(file, name.empty() ? defaults.place_of("tdpt_camera") : "cameras",
                     no_camera(cameras, wanted));
  return checked(file, *found);
}

std::string Scene::missing_camera() const {
  if (defaults.camera.empty() || find(cameras, defaults.camera)) return {};
  return defaults.place_of("tdpt_camera") + ": " + no_camera(cameras, defaults.camera);
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

void open_glass(Scene& scene) {
  for (Material& m : scene.materials) {
    const float share = m.transmission * (1 - m.metallic);
    if (!(share > 0) || m.alpha_mode == Material::Alpha::mask) continue;
    if (m.alpha_mode == Material::Alpha::opaque) {
      m.alpha_mode = Material::Alpha::blend;
      m.alpha = 1;
      m.maps[MAP_BASE] = {};  // its alpha would now become coverage
    }
    m.alpha *= 1 - share;
  }
}

}  // namespace tdpt
