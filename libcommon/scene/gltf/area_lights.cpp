#include "libcommon/scene/gltf/area_lights.h"

#include <fmt/format.h>
#include <cmath>
#include <numbers>
#include <optional>

#include "libcommon/scene/gltf/lights.h"

namespace tdpt::gltf {
namespace {

using Json = nlohmann::json;

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
  const std::optional<Affine> axes = axes_of_light(n.to_world());
  if (!axes) {
    ++flat_;
    return;
  }
  const double size = l.value("size", 1.0) * scale_of(n.to_world());
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
