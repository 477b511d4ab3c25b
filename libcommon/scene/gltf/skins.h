// Skins: vertices that follow joints, by linear blend skinning (glTF 2.0, section 3.7.3). Internal
// to this room.
//   world = sum_k w_k (to_world of joint k) (inverse bind matrix of joint k) vertex, sum_k w_k = 1
// The transform of the node that holds the mesh is ignored.
#pragma once
#include <array>
#include <vector>

#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/gltf/nodes.h"

namespace tdpt::gltf {

/// Accessors of one set of up to four joints per vertex.
struct JointSet {
  size_t joints, weights;
  auto operator<=>(const JointSet&) const = default;
};

/// JOINTS_0 with WEIGHTS_0 and the sets that follow.
std::vector<JointSet> joint_sets_of(const Primitive& primitive);

/// World transforms of nodes that may be joints, inside the scene or outside of it.
class NodeMaps {
 public:
  /// `nodes`: those of the scene, placed.
  NodeMaps(const Document& document, const std::vector<PlacedNode>& nodes);
  /// Throws InputError for a node that is its own ancestor, or whose transform is invalid.
  Affine to_world(size_t node);

 private:
  void find_parents();
  void set(size_t node, const Affine& to_world);

  const Document& d_;
  std::vector<bool> known_;
  std::vector<Affine> to_world_;
  std::vector<size_t> parent_;  // filled on first use
};

/// World transforms of what follows the joints of a skin.
class SkinMaps {
 public:
  /// Throws InputError for an invalid skin.
  SkinMaps(const Document& document, size_t skin, NodeMaps& nodes);

  /// The map of each vertex. Joints of weight 0 are ignored; a vertex without any weight follows
  /// its first joint. Throws InputError for joints that do not exist.
  std::vector<Affine> blend(const std::vector<JointSet>& sets) const;

  /// Map of its first joint.
  const Affine& first() const { return joints_.front(); }

 private:
  const Document& d_;
  size_t skin_;
  std::vector<Affine> joints_;
};

/// Whether the majority of them changes handedness.
bool most_mirror(const std::vector<Affine>& maps);

}  // namespace tdpt::gltf
