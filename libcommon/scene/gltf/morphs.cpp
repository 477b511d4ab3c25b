#include "libcommon/scene/gltf/morphs.h"

#include <algorithm>

namespace tdpt::gltf {

const std::vector<double>& morph_weights(const Document& d, size_t node) {
  const tinygltf::Node& n = d.model.nodes[node];
  if (!n.weights.empty() || n.mesh < 0) return n.weights;
  return d.model.meshes[static_cast<size_t>(n.mesh)].weights;
}

std::vector<MorphTarget> morph_targets_of(const tinygltf::Primitive& p,
                                          const std::vector<double>& weights) {
  std::vector<MorphTarget> out;
  for (size_t k = 0; k < std::min(p.targets.size(), weights.size()); ++k) {
    if (weights[k] == 0) continue;
    const auto find = [&](const char* name) {
      const auto it = p.targets[k].find(name);
      return it == p.targets[k].end() ? -1 : it->second;
    };
    out.push_back({weights[k],
                   find("POSITION"),
                   find("NORMAL"),
                   find("TANGENT"),
                   find("COLOR_0"),
                   {find("TEXCOORD_0"), find("TEXCOORD_1")}});
  }
  return out;
}

void add_position_deltas(const Document& d, const std::vector<MorphTarget>& targets,
                         std::vector<Vec3d>& positions) {
  for (const MorphTarget& t : targets) {
    if (t.position < 0) continue;
    const std::vector<Vec3d> deltas = read_positions(d, static_cast<size_t>(t.position));
    for (size_t i = 0; i < deltas.size(); ++i) positions[i] += deltas[i] * t.weight;
  }
}

}  // namespace tdpt::gltf
