// Morph targets: weighted deltas added to a primitive's attributes. Internal to this room.
#pragma once
#include <array>
#include <vector>

#include "libcommon/math/vec.h"
#include "libcommon/scene/gltf/accessors.h"
#include "libcommon/scene/gltf/document.h"

namespace tdpt::gltf {

/// A morph target with non-zero weight: accessors of its deltas, -1 if absent.
struct MorphTarget {
  double weight = 0;
  int position = -1, normal = -1, tangent = -1, colour = -1;
  std::array<int, 2> uv{-1, -1};
  auto operator<=>(const MorphTarget&) const = default;
};

/// Weights of the targets of a node's mesh: the node's own, else the mesh's; missing ones are 0.
const std::vector<double>& morph_weights(const Document& document, size_t node);

/// The targets with non-zero weight, with all their deltas.
std::vector<MorphTarget> morph_targets_of(const tinygltf::Primitive& primitive,
                                          const std::vector<double>& weights);

/// Adds weight times delta of each target to the positions of a primitive.
void add_position_deltas(const Document& document, const std::vector<MorphTarget>& targets,
                         std::vector<Vec3d>& positions);

/// The same for another attribute: `accessor` selects it in a target; `values` has `components` per
/// vertex.
template <class AccessorOf>
void add_deltas(const Document& document, const std::vector<MorphTarget>& targets,
                const AccessorOf& accessor, const Attribute& delta, size_t components,
                std::vector<float>& values) {
  for (const MorphTarget& t : targets) {
    if (accessor(t) < 0) continue;
    const std::vector<float> d = read_attribute(document, static_cast<size_t>(accessor(t)), delta);
    const size_t n = delta.components;
    for (size_t i = 0; i < d.size(); ++i) {
      float& v = values[components * (i / n) + i % n];
      v = static_cast<float>(double{v} + t.weight * double{d[i]});
    }
  }
}

}  // namespace tdpt::gltf
