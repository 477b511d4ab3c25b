#include <cmath>
#include <numbers>
#include <optional>

#include "libcommon/base/file.h"
#include "libcommon/base/words.h"
#include "tools/tdpt-import/meshes/meshes.h"
#include "tools/tdpt-import/tungsten/context.h"

namespace tdpt::foreign::tungsten {
namespace {

using std::numbers::pi;

constexpr const char* kMedia = "media (fog, absorption, scattering) are left out";
// From the directions of an infinite sphere to those of the map [described.h].
constexpr Affine kToMap{{0, 0, -1}, {0, 1, 0}, {1, 0, 0}, {}};

// A mesh that several shapes may show.
template <class Make>
size_t shared(Context& in, const std::string& key, const Make& make) {
  const auto [it, is_new] = in.meshes.try_emplace(key, in.scene.meshes.size());
  if (is_new) in.scene.meshes.push_back(make());
  return it->second;
}

std::array<float, 2> in_image(float u, float v) {  // of -1..1
  return {(1 + u) / 2, (1 - v) / 2};
}

Mesh box() {
  Mesh mesh = cube();
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3f p = mesh.positions[i], n = mesh.normals[i];
    mesh.uv[i] = n.x != 0 ? in_image(p.y, p.z) : n.y != 0 ? in_image(p.z, p.x) : in_image(p.x, p.y);
  }
  return mesh;
}

// A cylinder of diameter 1 from z = 0 to 1. Its caps are turned by half as the shape is
// [place_solid()].
Mesh tube(bool is_capped) {
  Mesh mesh = cylinder();
  for (const float z : {1.0f, 0.0f}) {
    const Mesh cap = is_capped ? disc() : Mesh{};
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    for (const Vec3f& p : cap.positions) {
      mesh.positions.push_back({p.x, p.y, z});
      mesh.normals.push_back({0, 0, 2 * z - 1});
      mesh.uv.push_back(in_image(-p.x, -p.y));
    }
    for (auto [a, b, c] : cap.triangles) {
      if (z == 0) std::swap(b, c);
      mesh.triangles.push_back({first + a, first + b, first + c});
    }
  }
  for (Vec3f& p : mesh.positions) p.x /= 2, p.y /= 2;
  return mesh;
}

// The rotation of a map: its axes at length 1.
Affine rotation_in(const Affine& map, const Node& node) {
  for (const Vec3d& axis : {map.x, map.y, map.z})
    if (!(dot(axis, axis) > 0)) node.fail("has an axis of length 0");
  return {normalize(map.x), normalize(map.y), normalize(map.z), {}};
}

// Gives a shape the mesh of its type at its place; false for unknown types. The round meshes have
// phi = 0 where u = 0, so they are turned by half.
bool place_solid(Context& in, const Node& node, const std::string& type, const Affine& map,
                 Shape& shape) {
  const auto put = [&](const std::string& key, const auto& mesh, const Affine& to_world) {
    shape.mesh = shared(in, key, mesh);
    shape.to_world = to_world;
    return true;
  };
  if (type == "quad")
    return put(type, square, map * Affine{{.5, 0, 0}, {0, 0, .5}, {0, .5, 0}, {}});
  if (type == "cube") return put(type, box, map * Affine{{.5, 0, 0}, {0, .5, 0}, {0, 0, .5}, {}});
  if (type != "sphere" && type != "disk" && type != "cylinder") return false;
  const Affine turn = rotation_in(map, node);
  const double across = std::max(length(map.x), length(map.z)), r = std::max(across, length(map.y));
  if (type == "sphere")
    return put(type, [] { return flipped(sphere()); },
               {turn.x * -r, turn.y * -r, turn.z * r, map.t});
  const Onb<double> frame(turn.y);
  if (type == "disk")
    return put(type, [] { return flipped(disc()); },
               {frame.y * -across, frame.x * -across, turn.y, map.t});
  const bool is_capped = node.flag("capped", true);
  return put(is_capped ? "capped" : "open", [&] { return tube(is_capped); },
             {turn.x * -across, turn.z * -across, map.y, map.t - map.y / 2.0});
}

// The light of a lamp, which has one colour.
Rgb without_texture(const Node& node, const Colour& light) {
  if (light.texture) node.lose("the texture of a lamp's light is left out");
  return light.factor;
}

// Radiance from "emission", or from "power" by its factor 1 / (pi area) and the like.
std::optional<Colour> emitted(Context& in, const Node& node, double per_power) {
  const auto power = node.find("power"), emission = node.find("emission");  // the power counts
  if (!power && !emission) return {};
  Colour c = colour(in, power ? *power : *emission);
  if (power) c.factor = c.factor * static_cast<float>(per_power);
  return c;
}

// What an integrator leaves out of the light.
void read_integrator(const Node& node) {
  node.source().lose_longer_paths(node.place(), node.number("max_bounces", 64));
  if (node.number("min_bounces", 0) > 0) node.lose("light of few bounces (min_bounces) is kept");
  if (!node.flag("enable_two_sided_shading", true))
    node.lose("surfaces that are black on their back (enable_two_sided_shading) have two sides");
  node.ignore();  // how it samples
}

void read_camera(Context& in, const Node& node) {
  const std::string type = node.text("type", "pinhole");
  Camera c;
  c.name = "camera";
  node.ignore({"tonemap", "reconstruction_filter", "name"});  // how the picture is written
  if (node.find("medium")) node.lose(kMedia);
  double width = 1000, height = 563;
  if (const auto size = node.find("resolution")) {
    if (size->is_number())
      width = height = size->number();
    else if (size->is_array() && size->json().size() == 2)
      width = size->item(0).number(), height = size->item(1).number();
    else
      size->fail("is neither a number nor an array of two");
    if (!(width >= 1 && height >= 1 && width <= 65536 && height <= 65536))
      size->fail("is {} x {} pixels, expected 1 to 65536", width, height);
  }
  c.width = static_cast<int>(width), c.height = static_cast<int>(height);
  const double fov = node.number("fov", 60);
  if (!(fov > 0 && fov < 180)) node.fail("has a field of view of {} degrees", fov);
  c.yfov = 2 * std::atan(std::tan(fov * pi / 360) * height / width);  // fov is horizontal
  const Affine map = transform_of(node);
  const Affine turn = rotation_in(map, node);
  c.to_world = {-turn.x, turn.y, -turn.z, map.t};
  if (type == "thinlens") {
    c.lens_radius = node.number("aperture_size", 0.001);
    c.focus_distance = node.number("focus_distance", 1);
  } else if (type != "pinhole") {
    node.lose("the camera of type \"{}\" becomes a pinhole camera", shown(type, 40));
  }
  in.scene.cameras.push_back(c);
}

size_t mesh_of(Context& in, const Node& node) {
  const Node file = node.needed("file");
  const std::string name = file.text();
  const bool smoothed = node.flag("smooth", false), again = node.flag("recompute_normals", false);
  return shared(in, fmt::format("{}\n{}{}", name, smoothed, again), [&] {
    const auto bytes = node.source().read_mesh(name, file.place());
    const std::string shown_as = node.source().shown_name(name);
    Mesh mesh = !bytes                   ? Mesh{}
                : name.ends_with(".wo3") ? read_wo3(*bytes, shown_as)
                                         : read_obj(*bytes, shown_as);
    if (!smoothed)
      mesh.normals.clear();
    else if (again || mesh.normals.empty())
      smooth(mesh);
    return mesh;
  });
}

// A disk that shines within a cone about its normal.
void read_cone(Context& in, const Node& node, const Colour& radiance, const Affine& to_world,
               double angle) {
  if (!(angle >= 0)) node.fail("has a cone_angle below 0");
  if (angle == 0) return;  // shines nowhere
  node.lose("a disk that shines within a cone (cone_angle) becomes a spot of the same power");
  const double r = length(to_world.x);
  Lamp spot;
  spot.kind = Lamp::Kind::spot;
  spot.name = node.text("name", "disk");
  spot.at = to_world.t + to_world.z * (1e-3 * r);  // the disk itself casts no shadow
  spot.towards = to_world.z;
  spot.inner = spot.outer = angle;
  // Its mean over the cone: pi sin^2 is that of the cosine.
  const double s = std::sin(angle), mean = s * s / (2 * (1 - std::cos(angle)));
  spot.intensity = without_texture(node, radiance) * static_cast<float>(pi * r * r * mean);
  if (!is_finite(spot.intensity)) node.fail("is too large or too bright");
  in.scene.lamps.push_back(spot);
}

// A sky, a sun or a point.
void read_light(Context& in, const Node& node, const std::string& type, const Affine& map) {
  const bool is_sun = type == "infinite_sphere_cap";
  const double angle = is_sun ? node.number("cap_angle", 10) * pi / 180 : pi;
  if (!(angle > 0 && (angle <= pi / 2 || !is_sun)))
    node.fail("has a cap_angle that is not within 0 to 90");
  const auto radiance = emitted(in, node, 1 / (2 * pi * (1 - std::cos(angle))));
  node.ignore({"sample", "bsdf"});  // how it is sampled; of no surface
  if (!radiance) return;
  if (type == "infinite_sphere") {
    if (in.scene.sky) return node.lose("of several skies the first is taken");
    Sky& sky = in.scene.sky.emplace();
    sky.colour = radiance->factor;
    if (radiance->texture) {
      sky.image = radiance->texture->image;
      sky.srgb = radiance->texture->srgb;
    }
    sky.to_map = kToMap * rotation_in(map, node).transposed();
    return;
  }
  Lamp lamp;
  lamp.name = node.text("name", is_sun ? "sun" : "point");
  lamp.intensity = without_texture(node, *radiance);
  if (is_sun) {
    node.lose("the sun of {0:.4g} degrees becomes a point: give --sun-angle {0:.4g} to tdpt",
              angle * 360 / pi);
    const double s = std::sin(angle);
    lamp.kind = Lamp::Kind::sun;
    lamp.towards = -map.y;
    lamp.intensity = lamp.intensity * static_cast<float>(pi * s * s);
  } else {
    lamp.at = map.t;
  }
  in.scene.lamps.push_back(lamp);
}

void read_primitive(Context& in, const Node& node) {
  if (!node.is_object()) node.fail("is no object");
  const std::string type = node.text("type", "");
  const Affine map = transform_of(node);
  node.ignore({"name", "bump_strength"});  // Tungsten itself does not read bump_strength
  for (const char* side : {"int_medium", "ext_medium"})
    if (node.find(side)) node.lose(kMedia);

  if (type == "infinite_sphere" || type == "infinite_sphere_cap" || type == "point")
    return read_light(in, node, type, map);

  Shape shape;
  shape.name = node.text("name", "");
  if (type == "mesh") {
    shape.mesh = mesh_of(in, node);
    shape.to_world = map;
  } else if (!place_solid(in, node, type, map, shape)) {
    node.lose("primitives of type \"{}\" are not read and left out", shown(type, 40));
    return node.ignore();
  }
  if (in.scene.meshes[shape.mesh].triangles.empty()) return node.ignore();
  // Tungsten takes the front of triangles and quads after they are placed.
  shape.turned = (type == "mesh" || type == "quad") && map.mirrors();
  shape.material = material(in, node.find("bsdf"));
  if (node.find("emission") || node.find("power")) {
    double area = area_of(in.scene.meshes[shape.mesh], shape.to_world);
    if (type == "cylinder" && !node.flag("capped", true))  // its caps count, though none shine
      area += pi / 2 * dot(shape.to_world.x, shape.to_world.x);
    const auto radiance = emitted(in, node, area > 0 ? 1 / (pi * area) : 0);
    const double cone = type == "disk" ? node.number("cone_angle", 90) : 90;
    if (cone > 90) node.lose("a cone_angle above 90 becomes 90");
    if (cone < 90)
      read_cone(in, node, *radiance, shape.to_world, cone * pi / 180);
    else
      shape.emission = Emission{*radiance, false};
  }
  if (type == "disk") node.ignore({"cone_angle"});  // of its light
  in.scene.shapes.push_back(std::move(shape));
}

Json parsed(const Source& source) {
  if (nested_too_deep(source.text()))
    throw InputError(source.path(), "", "is nested too deeply, expected a Tungsten scene");
  try {
    return Json::parse(source.text());
  } catch (const Json::exception& e) {
    std::string why = e.what();
    if (const size_t colon = why.find("at line"); colon != why.npos) why = why.substr(colon);
    throw InputError(source.path(), "", "is no JSON: " + shown(why, 160));
  }
}

}  // namespace
}  // namespace tdpt::foreign::tungsten

namespace tdpt::foreign {

Described read_tungsten(Source& source) {
  using namespace tungsten;
  const Json json = parsed(source);
  Account account{source};
  const Node root(json, account, "");
  if (!root.is_object()) root.fail("is no Tungsten scene: expected an object");
  const auto primitives = root.find("primitives");
  if (!primitives || !primitives->is_array())
    root.fail("is no Tungsten scene: expected an array \"primitives\"");
  root.ignore({"name", "media", "renderer"});  // media are lost where they are used
  if (const auto integrator = root.find("integrator")) read_integrator(*integrator);
  Described scene;
  Context in{scene};
  if (const auto bsdfs = root.find("bsdfs")) name_surfaces(in, *bsdfs);
  if (const auto camera = root.find("camera")) read_camera(in, *camera);
  for (size_t i = 0; i < primitives->json().size(); ++i) read_primitive(in, primitives->item(i));
  return scene;
}

}  // namespace tdpt::foreign
