#include "libcommon/scene/gltf/nodes.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <optional>

#include "libcommon/scene/gltf/accessors.h"

namespace tdpt::gltf {

namespace {

constexpr size_t kNone = ~size_t{0};

Affine from_matrix(const Document& d, size_t index, const std::vector<double>& m) {
  const auto near = [](double a, double b) { return std::abs(a - b) <= 1e-6; };
  if (!near(m[3], 0) || !near(m[7], 0) || !near(m[11], 0) || !near(m[15], 1))
    d.fail(place("nodes", index) + ".matrix", "is not affine, expected a last row of 0 0 0 1");
  return {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}, {m[12], m[13], m[14]}};
}

/// The nodes listed by the scene, each once; without a scene, the nodes that have no parent.
std::vector<size_t> named_roots(const Document& d) {
  const size_t nodes = d.model.nodes.size();
  std::vector<bool> seen(nodes);
  std::vector<size_t> out;
  if (d.model.scenes.empty()) {
    for (const tinygltf::Node& n : d.model.nodes)
      for (const int child : n.children) seen[static_cast<size_t>(child)] = true;
    for (size_t i = 0; i < nodes; ++i)
      if (!seen[i]) out.push_back(i);
    return out;
  }
  for (const int n : d.model.scenes[static_cast<size_t>(std::max(0, d.model.defaultScene))].nodes) {
    const auto node = static_cast<size_t>(n);
    if (!seen[node]) out.push_back(node);
    seen[node] = true;
  }
  return out;
}

/// The given nodes and all below them.
std::vector<bool> reached_from(const Document& d, std::vector<size_t> next) {
  std::vector<bool> reached(d.model.nodes.size());
  while (!next.empty()) {
    const size_t n = next.back();
    next.pop_back();
    if (reached[n]) continue;
    reached[n] = true;
    for (const int child : d.model.nodes[n].children) next.push_back(static_cast<size_t>(child));
  }
  return reached;
}

/// Parents of the nodes in the scene; kNone for roots.
std::vector<size_t> parents_of(const Document& d, const std::vector<bool>& reached) {
  std::vector<size_t> parent(reached.size(), kNone);
  for (size_t i = 0; i < reached.size(); ++i) {
    if (!reached[i]) continue;
    for (const int child : d.model.nodes[i].children) {
      size_t& p = parent[static_cast<size_t>(child)];
      if (p != kNone)
        d.fail(place("nodes", static_cast<size_t>(child)),
               fmt::format("is reached twice, from nodes[{}] and nodes[{}]", p, i));
      p = i;
    }
  }
  return parent;
}

/// The parent's map times the node's own.
Affine map_below(const Document& d, const Affine& parent, size_t node) {
  const Affine a = parent * local_map(d, node);
  if (!is_finite(a.x) || !is_finite(a.y) || !is_finite(a.z) || !is_finite(a.t))
    d.fail(place("nodes", node), "its transform and those above it exceed double precision");
  return a;
}

}  // namespace

bool is_hidden(const nlohmann::json& node) {
  const auto extensions = node.find("extensions");
  if (extensions == node.end()) return false;
  const auto it = extensions->find(kVisibility);
  return it != extensions->end() && !it->value("visible", true);
}

Affine local_map(const Document& d, size_t index) {
  const tinygltf::Node& n = d.model.nodes[index];
  if (!n.matrix.empty()) return from_matrix(d, index, n.matrix);
  const auto vec = [](const std::vector<double>& v, const Vec3d& otherwise) {
    return v.empty() ? otherwise : Vec3d(v[0], v[1], v[2]);
  };
  const std::vector<double>& r = n.rotation;
  std::array<double, 4> rotation{0, 0, 0, 1};
  if (!r.empty()) rotation = {r[0], r[1], r[2], r[3]};
  const auto map = affine_of(vec(n.translation, {}), rotation, vec(n.scale, Vec3d(1)));
  if (!map) d.fail(place("nodes", index) + ".rotation", "is zero, expected a unit quaternion");
  return *map;
}

std::vector<PlacedNode> place_nodes(const Document& d, std::vector<std::string>& warnings) {
  const std::vector<size_t> named = named_roots(d);
  const std::vector<bool> reached = reached_from(d, named);
  const std::vector<size_t> parent = parents_of(d, reached);
  std::vector<PlacedNode> out;
  std::vector<PlacedNode> stack;  // with the parent's map; explicit, since depth is unbounded
  size_t children = 0;
  for (size_t i = named.size(); i-- > 0;)
    if (parent[named[i]] == kNone)
      stack.push_back({named[i], {}, true});
    else
      ++children;
  std::vector<bool> placed(reached.size());
  while (!stack.empty()) {
    PlacedNode n = std::move(stack.back());
    stack.pop_back();
    n.to_world = map_below(d, n.to_world, n.node);
    n.visible = n.visible && !is_hidden(d.json["nodes"][n.node]);
    placed[n.node] = true;
    const auto& below = d.model.nodes[n.node].children;
    for (size_t i = below.size(); i-- > 0;)
      stack.push_back({static_cast<size_t>(below[i]), n.to_world, n.visible});
    out.push_back(std::move(n));
  }
  for (size_t i = 0; i < reached.size(); ++i)
    if (reached[i] && !placed[i])
      d.fail(place("nodes", i), "is its own ancestor, expected a tree of nodes");
  if (children > 0)
    warnings.push_back(
        counted(children, "node", "is a root of the scene and a child",
                "are roots of the scene and children") +
        (children == 1 ? ": placed once, below its parent" : ": placed once, below their parents"));
  return out;
}

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
    out.push_back(n.to_world * *map);
  }
  return out;
}

}  // namespace tdpt::gltf
