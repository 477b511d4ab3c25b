#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/meshes/meshes.h"
#include "tools/tdpt-import/mitsuba/mitsuba.h"

namespace tdpt::foreign::mitsuba {
namespace {

// These integrators compute all light.
constexpr const char* kWhole =
    "adaptive aov bdpt erpt irrcache mlt moment path ppm photonmapper prb pssmlt ptracer sppm "
    "stokes vpl volpath prb_basic prb_projective prbvolpath volpath_simple volpathmis";
// Names the light that an integrator leaves out.
void read_integrator(const Element& integrator) {
  Source& source = *integrator.source;
  if (integrator.type == "direct")
    source.lose_longer_paths(integrator.place, 2);
  else if (!is_one_of(integrator.type, kWhole))
    return integrator.lose(
        fmt::format("the {}, which shows other light than all that there is, is left out",
                    integrator.described()));
  source.lose_longer_paths(integrator.place, integrator.integer("max_depth", -1));
  if (integrator.flag("hide_emitters", false))
    integrator.lose("lamps that the camera does not see (hide_emitters) are seen");
  for (const Element* inner : integrator.nested("integrator")) read_integrator(*inner);
  integrator.ignore_all();  // how it samples
}

// ---- Sensors as cameras ----

constexpr int kMostPixels = 65535;  // on a side

// Reads the width and height of the picture.
void read_film(const Element& sensor, Camera& camera) {
  camera.width = 768, camera.height = 576;
  const auto films = sensor.nested("film");
  if (films.empty()) return;
  const Element& film = *films[0];
  camera.width = film.integer("width", camera.width);
  camera.height = film.integer("height", camera.height);
  if (camera.width < 1 || camera.height < 1 || camera.width > kMostPixels ||
      camera.height > kMostPixels)
    film.fail(fmt::format("a picture of {} x {} pixels", camera.width, camera.height));
  if (film.integer("crop_width", camera.width) != camera.width ||
      film.integer("crop_height", camera.height) != camera.height ||
      film.integer("crop_offset_x", 0) != 0 || film.integer("crop_offset_y", 0) != 0)
    film.lose("the crop window is left out");
  film.ignore_all();  // the filter, and how the file is written
}

double in_radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}

// The full vertical angle [rad].
double yfov(const Element& sensor, double aspect) {
  double degrees = 0;
  std::string axis = sensor.text("fov_axis", "x");
  if (sensor.find("fov")) {
    degrees = sensor.number("fov", 0);
  } else {  // of a picture of 36 x 24 mm
    std::string mm = sensor.text("focal_length", "50mm");
    if (mm.ends_with("mm")) mm.resize(mm.size() - 2);
    const double f = sensor.finite(mm);
    if (!(f > 0)) sensor.fail(fmt::format("a focal_length of {} mm", f));
    degrees = 2 * std::atan(std::hypot(36, 24) / (2 * f)) * 180 / std::numbers::pi;
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

void add_camera(Described& scene, const Element& sensor) {
  if (sensor.type != "perspective" && sensor.type != "thinlens")
    return sensor.lose(
        fmt::format("sensors of type \"{}\" are not read and left out", shown(sensor.type, 40)));
  Camera camera;
  camera.name = sensor.id.empty() ? sensor.type : sensor.id;
  read_film(sensor, camera);
  camera.yfov = yfov(sensor, static_cast<double>(camera.width) / camera.height);
  const Affine map = sensor.transform("to_world"), axes = axes_of(map, sensor.place);
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
  sensor.ignore("near_clip far_clip focus_distance shutter_open shutter_close");
  sensor.nested("sampler");
  for (const Element* medium : sensor.nested("medium")) medium->lose(kMedia);
  scene.cameras.push_back(camera);
}

// ---- Emitters that are no shapes ----

// The centre of Mitsuba's maps is +z, not -z.
constexpr Affine kHalfTurn{{-1, 0, 0}, {0, 1, 0}, {0, 0, -1}, {}};

void add_lamp(Context& in, const Element& e) {
  Lamp lamp;
  lamp.name = e.id.empty() ? e.type : e.id;
  lamp.intensity = plain_colour(in, e, e.type == "directional" ? "irradiance" : "intensity", Rgb(1),
                                Role::light);
  const Affine map = e.transform("to_world");
  lamp.at = map.t;
  if (e.type == "point") {
    lamp.at = e.vector("position").value_or(map.t);
  } else if (e.type == "spot") {
    lamp.kind = Lamp::Kind::spot;
    lamp.towards = axes_of(map, e.place).z;
    const double outer = e.number("cutoff_angle", 20), inner = e.number("beam_width", outer * 0.75);
    if (!(outer > 0 && outer <= 180 && inner >= 0 && inner <= outer))
      e.fail(fmt::format("a spot of beam_width {} and cutoff_angle {}", inner, outer));
    lamp.outer = in_radians(outer), lamp.inner = in_radians(inner);
    if (inner < outer)
      e.lose(
          "between beam_width and cutoff_angle spots fade as glTF has it, not linearly in the "
          "angle");
    if (e.find("texture")) e.lose("the textures of spots are left out");
  } else {
    lamp.kind = Lamp::Kind::sun;
    const auto direction = e.vector("direction");
    lamp.towards = direction ? *direction : axes_of(map, e.place).z;
    if (!(length(lamp.towards) > 0)) e.fail("a direction of length 0");
  }
  in.scene.lamps.push_back(lamp);
}

void add_sky(Context& in, const Element& e) {
  Sky sky;
  if (e.type == "constant") {
    sky.colour = plain_colour(in, e, "radiance", Rgb(1), Role::light);
    e.ignore("to_world");  // the same all around
  } else {
    sky.image = image(in, e);
    sky.colour = Rgb(static_cast<float>(e.number("scale", 1)));
    if (e.number("gamma", 0) != 0) e.lose("the gamma of an envmap is left out");
    sky.to_map = kHalfTurn * inverse(axes_of(e.transform("to_world"), e.place), e.place);
  }
  if (in.scene.sky)
    e.lose("of several skies the first is taken");
  else
    in.scene.sky = sky;
}

void add_emitter(Context& in, const Element& e) {
  if (is_one_of(e.type, "point spot directional")) {
    add_lamp(in, e);
  } else if (is_one_of(e.type, "constant envmap")) {
    add_sky(in, e);
  } else if (e.type == "portal") {  // the square of a rectangle; +z leads into the room
    Shape out;
    out.mesh = in.scene.meshes.size();
    out.to_world = e.transform("to_world");
    in.scene.meshes.push_back(square());
    in.scene.portals.push_back(out);
  } else {
    return e.lose(
        fmt::format("emitters of type \"{}\" are not read and left out", shown(e.type, 40)));
  }
  e.ignore("mis_compensation cache");
  for (const Element* medium : e.nested("medium")) medium->lose(kMedia);
}

}  // namespace
}  // namespace tdpt::foreign::mitsuba

namespace tdpt::foreign {

Described read_mitsuba(Source& source, const std::map<std::string, std::string>& parameters) {
  using namespace mitsuba;
  const std::deque<Element> elements = parse(source, parameters);
  const Element& root = elements.front();
  Described scene;
  Context in{scene};
  for (const Element* shape : root.nested("shape")) add_shape(in, *shape);
  for (const Element* emitter : root.nested("emitter"))
    if (emitter->type != "area" && !in.portals.contains(emitter))  // those of shapes
      add_emitter(in, *emitter);
  for (const Element* sensor : root.nested("sensor")) add_camera(scene, *sensor);
  for (const Element* integrator : root.nested("integrator")) read_integrator(*integrator);
  for (const Element* scattering : root.nested("subsurface"))
    scattering->lose("subsurface scattering is left out");
  root.ignore_all();  // what waits for a reference to it, and how to render
  return scene;
}

}  // namespace tdpt::foreign
