#include "libcommon/scene/gltf_nodes.h"

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

Affine local_map(const Document& d, size_t index) {
  const tinygltf::Node& n = d.model.nodes[index];
  if (!n.matrix.empty()) return from_matrix(d, index, n.matrix);
  Affine a;
  if (!n.rotation.empty()) {
    double x = n.rotation[0], y = n.rotation[1], z = n.rotation[2], w = n.rotation[3];
    const double l = std::hypot(std::hypot(x, y), std::hypot(z, w));
    if (!(l > 0))
      d.fail(place("nodes", index) + ".rotation", "is zero, expected a unit quaternion");
    x /= l, y /= l, z /= l, w /= l;
    a.x = {1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)};
    a.y = {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)};
    a.z = {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)};
  }
  if (!n.scale.empty()) a.x *= n.scale[0], a.y *= n.scale[1], a.z *= n.scale[2];
  if (!n.translation.empty()) a.t = {n.translation[0], n.translation[1], n.translation[2]};
  return a;
}

/// Parent of each node, kNone for roots. A node has one parent at most and is not its own ancestor.
std::vector<size_t> parents(const Document& d) {
  const auto& nodes = d.model.nodes;
  std::vector<size_t> parent(nodes.size(), kNone);
  for (size_t i = 0; i < nodes.size(); ++i)
    for (int child : nodes[i].children) {
      size_t& p = parent[static_cast<size_t>(child)];
      if (p != kNone)
        d.fail(place("nodes", static_cast<size_t>(child)),
               fmt::format("is reached twice, from nodes[{}] and nodes[{}]", p, i));
      p = i;
    }
  // Walking up from every node ends at a root, unless there is a cycle.
  std::vector<uint8_t> state(nodes.size(), 0);  // 1: on this walk, 2: known to end
  for (size_t i = 0; i < nodes.size(); ++i) {
    size_t k = i;
    for (; k != kNone && state[k] == 0; k = parent[k]) state[k] = 1;
    if (k != kNone && state[k] == 1)
      d.fail(place("nodes", k), "is its own ancestor, expected a tree of nodes");
    for (k = i; k != kNone && state[k] == 1; k = parent[k]) state[k] = 2;
  }
  return parent;
}

std::vector<size_t> roots(const Document& d, const std::vector<size_t>& parent) {
  std::vector<size_t> out;
  if (d.model.scenes.empty()) {
    for (size_t i = 0; i < parent.size(); ++i)
      if (parent[i] == kNone) out.push_back(i);
    return out;
  }
  const auto scene = static_cast<size_t>(std::max(0, d.model.defaultScene));
  std::vector<bool> seen(parent.size());
  for (int n : d.model.scenes[scene].nodes) {
    const auto node = static_cast<size_t>(n);
    const std::string where = place("nodes", node);
    if (seen[node]) d.fail(where, fmt::format("is reached twice, as a root of scenes[{}]", scene));
    if (parent[node] != kNone)
      d.fail(where, fmt::format("is reached twice, as a root of scenes[{}] and from nodes[{}]",
                                scene, parent[node]));
    seen[node] = true;
    out.push_back(node);
  }
  return out;
}

}  // namespace

bool Affine::mirrors() const {
  // The sign alone matters, so each column may be scaled: products stay in range.
  const auto scaled = [](const Vec3d& v) {
    const double s = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    return s > 0 ? v / s : v;
  };
  return dot(cross(scaled(x), scaled(y)), scaled(z)) < 0;
}

std::vector<PlacedNode> place_nodes(const Document& d) {
  const std::vector<size_t> parent = parents(d);
  std::vector<PlacedNode> out;
  std::vector<PlacedNode> stack;  // to_world of the parent; a stack of our own: depth is unbounded
  const auto push = [&](size_t node, const Affine& to_world) { stack.push_back({node, to_world}); };
  const std::vector<size_t> first = roots(d, parent);
  for (size_t i = first.size(); i-- > 0;) push(first[i], {});
  while (!stack.empty()) {
    PlacedNode n = stack.back();
    stack.pop_back();
    n.to_world = n.to_world * local_map(d, n.node);
    const Affine& a = n.to_world;
    if (!is_finite(a.x) || !is_finite(a.y) || !is_finite(a.z) || !is_finite(a.t))
      d.fail(place("nodes", n.node), "its transform and those above it exceed double precision");
    out.push_back(n);
    const auto& children = d.model.nodes[n.node].children;
    for (size_t i = children.size(); i-- > 0;) push(static_cast<size_t>(children[i]), a);
  }
  return out;
}

}  // namespace tdpt::gltf
