#include "libcommon/scene/gltf/lights.h"

#include <fmt/format.h>
#include <cmath>
#include <numbers>
#include <optional>

#include "libcommon/base/file.h"
#include "libcommon/base/provenance.h"
#include "libcommon/scene/ies.h"

namespace tdpt::gltf {

namespace {

using Json = nlohmann::json;

constexpr const char *kName = "KHR_lights_punctual", *kIes = "EXT_lights_ies",
                     *kAreaLights = "EXT_lights_area";
constexpr double kLeast = 1e-30, kMost = 1e30;
// Memory per byte of a profile's text: a quarter is mirrored to a full circle, and a number takes
// two bytes.
constexpr uint64_t kMostPerByte = 40;

/// `v` normalised, even if very long or short; 0 if it has no direction.
Vec3d direction_of(const Vec3d& v) {
  const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  return largest > 0 ? normalize(v / largest) : Vec3d();
}

/// The light's name, else its node's.
std::string name_of_light(const Document& d, const Json& light, size_t node) {
  const std::string name = light.value("name", "");
  return name.empty() ? d.json["nodes"][node].value("name", "") : name;
}

/// `owner`'s color, white if it has none.
Vec3d colour_of_light(const Json& owner) {
  Vec3d colour(1);
  if (owner.contains("color"))
    for (int c = 0; c < 3; ++c) colour[c] = owner["color"][static_cast<size_t>(c)].get<double>();
  return colour;
}

void check_intensity(const Document& d, const std::string& where, const Vec3d& i) {
  if (!(max_component(i) <= kMost))
    d.fail(where, fmt::format("has an intensity of {}, expected at most 1e30", max_component(i)));
}

/// The map of a node without its scale, shear and mirroring: unit axes, orthogonal and
/// right-handed, Z that of the node. Empty if the node's map destroys its Z or leaves no plane.
std::optional<Affine> axes_of_light(const Affine& map) {
  const Vec3d z = direction_of(map.z), along_x = direction_of(map.x);
  Vec3d x = direction_of(along_x - z * dot(along_x, z));
  if (x == Vec3d()) x = direction_of(cross(direction_of(map.y), z));
  if (z == Vec3d() || x == Vec3d()) return {};
  return Affine{x, cross(z, x), z, map.t};
}

}  // namespace

bool holds_light(const Document& d, size_t node) {
  const Json extensions = d.json["nodes"][node].value("extensions", Json::object());
  return extensions.contains(kName) || extensions.contains(kIes) ||
         extensions.contains(kAreaLights);
}

void LightReader::add(const PlacedNode& n) {
  const Json extensions = d_.json["nodes"][n.node].value("extensions", Json::object());
  if (extensions.contains(kName)) add_punctual(n, extensions[kName]);
  if (extensions.contains(kIes)) add_luminaire(n, extensions[kIes]);
}

void LightReader::add_punctual(const PlacedNode& n, const Json& extension) {
  const auto index = extension["light"].get<size_t>();
  const Json& l = d_.json["extensions"][kName]["lights"][index];
  const std::string type = l["type"].get<std::string>();

  PunctualLight out;
  out.name = name_of_light(d_, l, n.node);
  const Vec3d intensity = colour_of_light(l) * l.value("intensity", 1.0);
  if (max_component(intensity) <= 0) return;
  check_intensity(d_, fmt::format("extensions.{}.{}", kName, place("lights", index)), intensity);
  out.intensity = Rgb(intensity);
  out.position = n.to_world.t;
  if (type == "point") return scene_.lights.push_back(out);
  out.direction = direction_of(-n.to_world.z);
  if (out.direction == Vec3d()) {
    ++flat_;
    return;
  }
  if (type == "directional") {
    out.kind = PunctualLight::Kind::directional;
    return scene_.lights.push_back(out);
  }
  out.kind = PunctualLight::Kind::spot;
  const Json spot = l.value("spot", Json::object());
  out.cos_inner = std::cos(spot.value("innerConeAngle", 0.0));
  out.cos_outer = std::max(std::cos(spot.value("outerConeAngle", std::numbers::pi / 4)), 0.0);
  scene_.lights.push_back(out);
}

std::shared_ptr<const LightProfile> LightReader::profile(size_t index) {
  const Json& json = d_.json["extensions"][kIes]["lights"][index];
  const std::string where = fmt::format("extensions.{}.{}", kIes, place("lights", index));
  const bool in_view = json.contains("bufferView");
  std::shared_ptr<const LightProfile>& known = profiles_[json[in_view ? "bufferView" : "uri"].dump(
      -1, ' ', true, Json::error_handler_t::replace)];
  if (known) return known;
  std::string file, owned;
  if (!in_view) owned = read_uri(d_, json["uri"].get<std::string>(), where + ".uri", file);
  if (!file.empty()) {
    scene_.files.push_back(file);
    scene_.hash = content_hash(scene_.hash + owned);
  }
  const std::string_view text = in_view ? view_bytes(d_, json["bufferView"].get<size_t>()) : owned;
  bytes_of_profiles_ += text.size();
  expect_memory(d_.file, where, fmt::format("{} bytes of profiles", bytes_of_profiles_),
                kMostPerByte * bytes_of_profiles_);
  known = std::make_shared<LightProfile>(
      read_ies(text, file.empty() ? d_.file : file, file.empty() ? where : ""));
  return known;
}

void LightReader::add_luminaire(const PlacedNode& n, const Json& extension) {
  const auto index = extension["light"].get<size_t>();
  PunctualLight out;
  out.name = name_of_light(d_, d_.json["extensions"][kIes]["lights"][index], n.node);
  out.profile = profile(index);
  const Vec3d colour = min(colour_of_light(extension), Vec3d(1));
  const double greatest = extension.value("multiplier", 1.0) * out.profile->peak;
  check_intensity(d_, place("nodes", n.node), Vec3d(greatest));
  const Vec3d intensity = colour * greatest;
  if (max_component(intensity) <= 0) return;
  out.intensity = Rgb(intensity);
  out.position = n.to_world.t;
  const std::optional<Affine> axes = axes_of_light(n.to_world);
  if (!axes) {
    ++flat_;
    return;
  }
  out.direction = normalize(axes->vector(out.profile->pole));
  out.across = normalize(axes->vector(out.profile->zero));
  scene_.lights.push_back(out);
}

std::string generator_of(const Document& d) {
  const Json& asset = d.json["asset"];
  if (!asset.contains("generator") || !asset["generator"].is_string()) return "";
  return asset["generator"].get<std::string>();
}

LampUnits lamp_units_of(const Document& d, bool area_lights) {
  std::vector<LampNumber> numbers;
  const Json all = d.json["extensions"].value(kName, Json::object());
  for (const Json& l : all.value("lights", Json::array()))
    if (const double value = l.value("intensity", 1.0); value > 0)
      numbers.push_back({value, l["type"] == "directional"});
  const std::string generator = generator_of(d);
  // Only luminaires, in candela, and area lights, in nits, beside surfaces in W/m2/sr. The numbers
  // of area lights do not tell the exporter's mode: Blender's writes none.
  if (numbers.empty() && is_blender(generator))
    return {LampUnits::Kind::photometric,
            area_lights ? "area lights are taken as nits, divided by 683 lm/W: so their extension "
                          "defines them"
                        : ""};
  return tdpt::lamp_units_of(generator, numbers);
}

void to_canonical(const Document& d, const Frame& frame, PunctualLight& light) {
  light.position = frame.to_canonical(light.position);
  if (light.kind == PunctualLight::Kind::directional) return;
  const Vec3d canonical = Vec3d(light.intensity) * frame.scale * frame.scale;
  const double most = max_component(canonical);
  if (!(most >= kLeast && most <= kMost))
    d.fail(fmt::format("extensions.{}", light.profile ? kIes : kName),
           fmt::format("an intensity of {} W/sr is {} for a scene {} m long",
                       max_component(light.intensity), most > 1 ? "too much" : "too little",
                       2 / frame.scale));
  light.intensity = Rgb(canonical);
}

// Area lights.

namespace {

constexpr double pi = std::numbers::pi;
constexpr size_t kCorners = 64;  // of a disk
// Of light that meets one. Renderers whose area lights stop none let it pass; a black light over a
// room of albedo 0.7 took 2.5 % of that room's light, one that reflects as the room does 0.1 %.
constexpr float kAlbedo = 0.8f;

size_t index_of(const Json& extension) {
  return extension["light"].get<size_t>();
}

/// The node's extension; null: none.
const Json* extension_of(const Document& d, size_t node) {
  const Json& n = d.json["nodes"][node];
  const auto all = n.find("extensions");
  if (all == n.end()) return nullptr;
  const auto found = all->find(kAreaLights);
  return found == all->end() ? nullptr : &*found;
}

const Json& light_of(const Document& d, const Json& extension) {
  return d.json["extensions"][kAreaLights]["lights"][index_of(extension)];
}

bool is_disk(const Json& light) {
  return light["type"] == "disk";
}

/// The largest factor by which the map stretches an axis.
double scale_of(const Affine& map) {
  return std::max({length(map.x), length(map.y), length(map.z)});
}

/// Circumscribed radius of a regular polygon with the area of a disk of radius 1: n corners have
/// the area n/2 R^2 sin(2 pi / n) = pi.
double radius_of_polygon() {
  const double turn = 2 * pi / kCorners;
  return std::sqrt(turn / std::sin(turn));
}

}  // namespace

Polygon polygon_of_light(const Document& d, size_t node) {
  const Json* const extension = extension_of(d, node);
  if (!extension) return {};
  return is_disk(light_of(d, *extension)) ? Polygon{kCorners + 1, kCorners} : Polygon{4, 2};
}

void AreaLightReader::add(const PlacedNode& n, std::vector<Vec3d>& world) {
  const Json* const extension = extension_of(d_, n.node);
  if (!extension) return;
  const Json& l = light_of(d_, *extension);
  const std::string where =
      fmt::format("extensions.{}.{}", kAreaLights, place("lights", index_of(*extension)));
  const Vec3d radiance = colour_of_light(l) * l.value("intensity", 1000.0);
  check_intensity(d_, where, radiance);
  if (max_component(radiance) <= 0) return;
  if (max_component(radiance) < kFaintestEmission) {
    ++faint_;
    return;
  }
  const std::optional<Affine> axes = axes_of_light(n.to_world);
  if (!axes) {
    ++flat_;
    return;
  }
  const double size = l.value("size", 1.0) * scale_of(n.to_world);
  const double aspect = l.value("rect", Json::object()).value("aspect", 1.0);
  const bool disk = is_disk(l);
  scene_.area_lights.push_back(
      {static_cast<uint32_t>(scene_.materials.size()), size * size * (disk ? pi / 4 : aspect)});
  Material& m = scene_.materials.emplace_back();
  m.name = name_of_light(d_, l, n.node);
  m.base_color = Rgb(kAlbedo);
  m.emission = Rgb(radiance);

  // Counter-clockwise as seen from -Z.
  std::vector<Vec3d> corners;
  const auto add = [&](double x, double y) { corners.push_back(axes->point({x, y, 0})); };
  const double y = 0.5 * size, x = y * aspect;
  if (!disk) {
    add(-x, -y), add(-x, y), add(x, y), add(x, -y);
    return add_corners(n, corners, world);
  }
  const double radius = y * radius_of_polygon();
  add(0, 0);
  for (size_t i = 0; i < kCorners; ++i) {
    const double angle = -2 * pi * static_cast<double>(i) / kCorners;
    add(radius * std::cos(angle), radius * std::sin(angle));
  }
  add_corners(n, corners, world);
}

/// A rectangle, or a disk whose first corner is its centre.
void AreaLightReader::add_corners(const PlacedNode& n, const std::vector<Vec3d>& corners,
                                  std::vector<Vec3d>& world) {
  const auto first = static_cast<uint32_t>(world.size());
  for (const Vec3d& p : corners) {
    if (!is_finite(p))
      d_.fail(place("nodes", n.node), "its transform takes an area light beyond double precision");
    world.push_back(p);
  }
  const uint32_t material = scene_.area_lights.back().material;
  const auto add = [&](uint32_t b, uint32_t c) {
    scene_.triangles.push_back({{first, first + b, first + c}, material});
  };
  const auto last = static_cast<uint32_t>(corners.size()) - 1;
  for (uint32_t i = 1; i < last; ++i) add(i, i + 1);
  if (last == kCorners) add(last, 1);
}

}  // namespace tdpt::gltf
