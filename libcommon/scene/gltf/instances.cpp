#include "libcommon/scene/gltf/instances.h"

#include <fmt/format.h>
#include <optional>

#include "libcommon/scene/gltf/accessors.h"

namespace tdpt::gltf {
namespace {

constexpr const char* kName = "EXT_mesh_gpu_instancing";
constexpr const char* kAttributes[] = {"TRANSLATION", "ROTATION", "SCALE"};
constexpr Numbers kTranslations = {"translations", 3, true, false, false, false};
constexpr Numbers kRotations = {"rotations", 4, true, false, true, false};
constexpr Numbers kScales = {"scales", 3, true, false, false, false};

/// Accessors of the three attributes, -1 if absent.
struct Attributes {
  std::array<int, 3> accessor{-1, -1, -1};
  size_t count = 1;
};

Attributes attributes_of(const Document& d, size_t index) {
  Attributes out;
  const nlohmann::json& node = d.json["nodes"][index];
  if (!node.contains("extensions") || !node["extensions"].contains(kName)) return out;
  const nlohmann::json& attributes = node["extensions"][kName]["attributes"];
  const char* first = nullptr;
  for (size_t k = 0; k < 3; ++k) {
    const char* name = kAttributes[k];
    if (!attributes.contains(name)) continue;
    out.accessor[k] = attributes[name].get<int>();
    const size_t count = d.model.accessors[static_cast<size_t>(out.accessor[k])].count;
    if (first && count != out.count)
      d.fail(fmt::format("nodes[{}].extensions.{}.attributes.{}", index, kName, name),
             fmt::format("count is {}, expected {} as of {}", count, out.count, first));
    if (!first) first = name;
    out.count = count;
  }
  return out;
}

}  // namespace

size_t instances_declared(const Document& d, size_t node) {
  return attributes_of(d, node).count;
}

std::vector<Affine> place_instances(const Document& d, const PlacedNode& n) {
  const Attributes a = attributes_of(d, n.node);
  const auto read = [&](size_t k, const Numbers& numbers) {
    return a.accessor[k] < 0 ? std::vector<double>{}
                             : read_numbers(d, static_cast<size_t>(a.accessor[k]), numbers);
  };
  const std::vector<double> t = read(0, kTranslations), r = read(1, kRotations),
                            s = read(2, kScales);
  std::vector<Affine> out;
  out.reserve(a.count);
  for (size_t i = 0; i < a.count; ++i) {
    const auto vec = [&](const std::vector<double>& v, double otherwise) {
      return v.empty() ? Vec3d(otherwise) : Vec3d(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
    };
    std::array<double, 4> rotation{0, 0, 0, 1};
    if (!r.empty()) rotation = {r[4 * i], r[4 * i + 1], r[4 * i + 2], r[4 * i + 3]};
    const auto map = affine_of(vec(t, 0), rotation, vec(s, 1));
    if (!map)
      d.fail(place("accessors", static_cast<size_t>(a.accessor[1])),
             fmt::format("rotation {} is zero, expected a unit quaternion", i));
    out.push_back(n.to_world() * *map);
  }
  return out;
}

}  // namespace tdpt::gltf
