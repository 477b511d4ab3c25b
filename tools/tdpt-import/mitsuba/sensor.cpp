#include "tools/tdpt-import/mitsuba/sensor.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/mitsuba/transforms.h"

namespace tdpt::foreign::mitsuba {
namespace {

constexpr int kMostPixels = 65535;  // on a side

// Whether Mitsuba cuts something away that lies ahead of the camera.
bool is_clipped(const Described& scene, const Camera& camera, double near, double far) {
  for (const Shape& shape : scene.shapes)
    for (const Vec3f& p : scene.meshes[shape.mesh].positions) {
      const double ahead =
          -dot(shape.to_world.point({p.x, p.y, p.z}) - camera.to_world.t, camera.to_world.z);
      if ((ahead > 0 && ahead < near) || ahead > far) return true;
    }
  return false;
}

// Width and height of the picture.
void read_film(const Object& sensor, Source& source, Camera& camera) {
  camera.width = 768, camera.height = 576;
  const auto films = sensor.nested("film");
  if (films.empty()) return;
  const Object& film = *films[0];
  camera.width = film.integer("width", camera.width);
  camera.height = film.integer("height", camera.height);
  if (camera.width < 1 || camera.height < 1 || camera.width > kMostPixels ||
      camera.height > kMostPixels)
    film.fail(fmt::format("a picture of {} x {} pixels", camera.width, camera.height));
  if (film.integer("crop_width", camera.width) != camera.width ||
      film.integer("crop_height", camera.height) != camera.height ||
      film.integer("crop_offset_x", 0) != 0 || film.integer("crop_offset_y", 0) != 0)
    source.lose(film.place, "the crop window is left out");
  for (const Object* filter : film.nested("rfilter"))
    filter->ignore({"B", "C", "lobes", "radius", "stddev"});  // other than this renderer's
  film.ignore({"attach_log", "banner", "burn", "channel_names", "compensate", "component_format",
               "digits", "exposure", "file_format", "filename", "gamma", "high_quality_edges",
               "key", "pixel_format", "sample_border", "tonemap_method",
               "variable"});  // of the file that is written
}

double in_radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}

// Full vertical angle.
double yfov(const Object& sensor, double aspect) {
  double degrees = 0;
  std::string axis = sensor.text("fov_axis", "x");
  if (sensor.find("fov")) {
    degrees = sensor.number("fov", 0);
  } else {  // of a picture of 36 x 24 mm
    std::string mm = sensor.text("focal_length", "50mm");
    if (mm.ends_with("mm")) mm.resize(mm.size() - 2);
    const auto f = number_of(mm);
    if (!f || !(*f > 0)) sensor.fail(fmt::format("a focal_length of \"{}\"", shown(mm, 40)));
    degrees = 2 * std::atan(std::hypot(36, 24) / (2 * *f)) * 180 / std::numbers::pi;
    axis = "diagonal";
  }
  if (!(degrees > 0 && degrees < 180)) sensor.fail(fmt::format("a fov of {} degrees", degrees));
  const double t = std::tan(in_radians(degrees) / 2);
  if (axis == "smaller") axis = aspect > 1 ? "y" : "x";
  if (axis == "larger") axis = aspect > 1 ? "x" : "y";
  if (axis == "x") return 2 * std::atan(t / aspect);
  if (axis == "y") return 2 * std::atan(t);
  if (axis == "diagonal") return 2 * std::atan(t / std::hypot(1, aspect));
  sensor.find("fov_axis")->fail(fmt::format("a fov_axis \"{}\"", shown(axis, 40)));
}

}  // namespace

void add_camera(const Object& sensor, Described& scene, Source& source) {
  if (sensor.type != "perspective" && sensor.type != "thinlens")
    return source.lose(sensor.place, fmt::format("sensors of type \"{}\" are not read and left out",
                                                 shown(sensor.type, 40)));
  Camera camera;
  camera.name = sensor.id.empty() ? sensor.type : sensor.id;
  read_film(sensor, source, camera);
  camera.yfov = yfov(sensor, static_cast<double>(camera.width) / camera.height);
  const Affine map = sensor.map("to_world", source), axes = axes_of(map, sensor.place);
  // Mitsuba looks along +z with +x to the left.
  camera.to_world = {-axes.x, axes.y, -axes.z, map.t};
  camera.shift_x = sensor.number("principal_point_offset_x", 0);
  camera.shift_y = sensor.number("principal_point_offset_y", 0);
  if (sensor.type == "thinlens") {
    camera.lens_radius = sensor.number("aperture_radius", 0);
    camera.focus_distance = sensor.number("focus_distance", sensor.number("far_clip", 1e4));
    if (!(camera.lens_radius >= 0) || !(camera.focus_distance > 0))
      sensor.fail(fmt::format("a lens of radius {} focused at {}", camera.lens_radius,
                              camera.focus_distance));
  }
  if (is_clipped(scene, camera, sensor.number("near_clip", 1e-2), sensor.number("far_clip", 1e4)))
    source.lose(sensor.place,
                "what is nearer than near_clip or farther than far_clip is not cut away");
  sensor.ignore({"focus_distance", "shutter_open", "shutter_close"});  // nothing moves
  for (const Object* sampler : sensor.nested("sampler"))
    sampler->ignore({"dimension", "jitter", "sample_count", "scramble", "seed", "strength"});
  for (const Object* medium : sensor.nested("medium"))
    source.lose(medium->place, "media (fog, absorption, scattering) are left out");
  scene.cameras.push_back(camera);
}

}  // namespace tdpt::foreign::mitsuba
