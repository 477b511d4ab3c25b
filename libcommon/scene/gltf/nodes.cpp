#include "libcommon/scene/gltf/nodes.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

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

/// Multiplies the parent's map by the node's own.
void move_by_its_own(const Document& d, PlacedNode& n) {
  if (n.fault) return;
  try {
    n.map = n.map * local_map(d, n.node);
    const Affine& a = n.map;
    if (!is_finite(a.x) || !is_finite(a.y) || !is_finite(a.z) || !is_finite(a.t))
      d.fail(place("nodes", n.node), "its transform and those above it exceed double precision");
  } catch (const InputError& e) {
    n.fault = std::make_shared<const InputError>(e);
  }
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
    move_by_its_own(d, n);
    n.visible = n.visible && !is_hidden(d.json["nodes"][n.node]);
    placed[n.node] = true;
    const auto& below = d.model.nodes[n.node].children;
    for (size_t i = below.size(); i-- > 0;)
      stack.push_back({static_cast<size_t>(below[i]), n.map, n.visible, n.fault});
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

}  // namespace tdpt::gltf
