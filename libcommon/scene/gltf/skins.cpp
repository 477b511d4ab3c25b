#include "libcommon/scene/gltf/skins.h"

#include <fmt/format.h>
#include <algorithm>

#include "libcommon/scene/gltf/accessors.h"

namespace tdpt::gltf {
namespace {

constexpr Numbers kMatrices = {"inverse bind matrices", 16};
constexpr Numbers kJoints = {"joints", 4, small_integers};
constexpr Numbers kWeights = {"weights", 4, floats | unsigned_shares};

void add_scaled(Affine& sum, const Affine& a, double weight) {
  sum.x += a.x * weight;
  sum.y += a.y * weight;
  sum.z += a.z * weight;
  sum.t += a.t * weight;
}

}  // namespace

std::vector<JointSet> joint_sets_of(const Primitive& p) {
  std::vector<JointSet> out;
  for (size_t k = 0;; ++k) {
    const size_t joints = find_attribute(p.attributes, fmt::format("JOINTS_{}", k));
    const size_t weights = find_attribute(p.attributes, fmt::format("WEIGHTS_{}", k));
    if (joints == kNone || weights == kNone) return out;
    out.push_back({joints, weights});
  }
}

NodeMaps::NodeMaps(const Document& d, const std::vector<PlacedNode>& nodes)
    : d_(d), known_(d.nodes.size()), to_world_(known_.size()) {
  for (const PlacedNode& n : nodes) set(n.node, n.to_world);
}

void NodeMaps::set(size_t node, const Affine& to_world) {
  known_[node] = true;
  to_world_[node] = to_world;
}

void NodeMaps::find_parents() {
  parent_.assign(known_.size(), kNone);
  for (size_t i = 0; i < parent_.size(); ++i)
    for (const size_t child : d_.nodes[i].children) parent_[child] = i;
}

Affine NodeMaps::to_world(size_t node) {
  if (known_[node]) return to_world_[node];
  if (parent_.empty()) find_parents();
  std::vector<size_t> chain;  // the node and its ancestors
  size_t top = node;
  for (; top != kNone && !known_[top]; top = parent_[top]) {
    if (chain.size() == known_.size())
      d_.fail(place("nodes", node), "is its own ancestor, expected a tree of nodes");
    chain.push_back(top);
  }
  Affine a = top == kNone ? Affine{} : to_world_[top];
  for (size_t i = chain.size(); i-- > 0;) {
    a = a * local_map(d_, chain[i]);
    set(chain[i], a);
  }
  return a;
}

SkinMaps::SkinMaps(const Document& d, size_t skin, NodeMaps& nodes) : d_(d), skin_(skin) {
  const Skin& s = d.skins[skin];
  const size_t count = s.joints.size();
  std::vector<double> m;
  if (s.matrices != kNone) m = read_numbers(d, s.matrices, kMatrices, 0, count);
  for (size_t k = 0; k < count; ++k) {
    joints_.push_back(nodes.to_world(s.joints[k]));
    if (m.empty()) continue;
    const auto column = [&](size_t c) {
      return Vec3d(m[16 * k + 4 * c], m[16 * k + 4 * c + 1], m[16 * k + 4 * c + 2]);
    };
    joints_.back() = joints_.back() * Affine{column(0), column(1), column(2), column(3)};
  }
}

std::vector<Affine> SkinMaps::blend(const std::vector<JointSet>& sets) const {
  std::vector<Affine> out;
  std::vector<double> total, lone;  // lone: the first joint of each vertex
  for (const JointSet& set : sets) {
    const std::vector<double> joint = read_numbers(d_, set.joints, kJoints);
    const std::vector<double> weight = read_numbers(d_, set.weights, kWeights);
    const size_t vertices = joint.size() / 4;
    if (out.empty()) {
      out.assign(vertices, {{}, {}, {}, {}});
      total.assign(vertices, 0);
      for (size_t v = 0; v < vertices; ++v) lone.push_back(joint[4 * v]);
    }
    for (size_t i = 0; i < joint.size(); ++i) {
      if (weight[i] == 0) continue;
      const auto k = static_cast<size_t>(joint[i]);
      if (k >= joints_.size())
        d_.fail(place("accessors", set.joints),
                fmt::format("joint {} of vertex {} is out of range, skins[{}] has {} joints", k,
                            i / 4, skin_, joints_.size()));
      add_scaled(out[i / 4], joints_[k], weight[i]);
      total[i / 4] += weight[i];
    }
  }
  for (size_t v = 0; v < out.size(); ++v) {
    if (total[v] > 0) {
      const double scale = 1 / total[v];
      Affine& a = out[v];
      a = {a.x * scale, a.y * scale, a.z * scale, a.t * scale};
    } else {
      out[v] =
          joints_[lone[v] < static_cast<double>(joints_.size()) ? static_cast<size_t>(lone[v]) : 0];
    }
  }
  return out;
}

bool most_mirror(const std::vector<Affine>& maps) {
  return 2 * std::count_if(maps.begin(), maps.end(), [](const Affine& a) { return a.mirrors(); }) >
         std::ssize(maps);
}

}  // namespace tdpt::gltf
