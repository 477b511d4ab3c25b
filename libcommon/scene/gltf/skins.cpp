#include <fmt/format.h>

#include "libcommon/scene/gltf/accessors.h"
#include "libcommon/scene/gltf/nodes.h"

namespace tdpt::gltf {
namespace {

constexpr Numbers kMatrices = {"inverse bind matrices", 16};
constexpr Numbers kJoints = {"joints", 4, Numbers::Kind::indices};
constexpr Numbers kWeights = {"weights", 4, Numbers::Kind::shares};

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

std::vector<Affine> joint_maps(const Document& d, size_t skin, const PlacedNodes& nodes) {
  const Skin& s = d.skins[skin];
  const size_t count = s.joints.size();
  std::vector<double> m;
  if (s.matrices != kNone) m = read_numbers(d, s.matrices, kMatrices, 0, count);
  std::vector<Affine> out;
  for (size_t k = 0; k < count; ++k) {
    out.push_back(nodes.to_world[s.joints[k]]);
    if (m.empty()) continue;
    const auto column = [&](size_t c) {
      return Vec3d(m[16 * k + 4 * c], m[16 * k + 4 * c + 1], m[16 * k + 4 * c + 2]);
    };
    out.back() = out.back() * Affine{column(0), column(1), column(2), column(3)};
  }
  return out;
}

std::vector<Affine> blend_joints(const Document& d, const std::vector<Affine>& joints,
                                 const std::vector<JointSet>& sets, size_t vertices) {
  std::vector<Affine> out(vertices, {{}, {}, {}, {}});
  std::vector<double> total(vertices), lone;  // lone: the first joint of each vertex
  for (const JointSet& set : sets) {
    const std::vector<double> joint = read_numbers(d, set.joints, kJoints, 0, vertices);
    const std::vector<double> weight = read_numbers(d, set.weights, kWeights, 0, vertices);
    if (lone.empty())
      for (size_t v = 0; v < vertices; ++v) lone.push_back(joint[4 * v]);
    for (size_t i = 0; i < joint.size(); ++i) {
      if (weight[i] == 0) continue;
      const auto k = static_cast<size_t>(joint[i]);
      if (k >= joints.size())
        d.fail(place("accessors", set.joints),
               fmt::format("joint {} of vertex {} is out of range, the skin has {} joints", k,
                           i / 4, joints.size()));
      add_scaled(out[i / 4], joints[k], weight[i]);
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
          joints[lone[v] < static_cast<double>(joints.size()) ? static_cast<size_t>(lone[v]) : 0];
    }
  }
  return out;
}

}  // namespace tdpt::gltf
