// Skins: vertices that follow joints, by linear blending (glTF 2.0, section 3.7.3). Internal to
// this room.
//   world = sum_k w_k (to_world of joint k) (inverse bind matrix of joint k) vertex,   sum_k w_k =
//   1
// The transform of the node that holds the mesh means nothing.
#pragma once
#include <array>
#include <vector>

#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/gltf/nodes.h"

namespace tdpt::gltf {

/// Accessors of one set of up to four joints per vertex.
struct JointSet {
  int joints, weights;
  auto operator<=>(const JointSet&) const = default;
};

/// JOINTS_0 with WEIGHTS_0 and the sets that follow.
std::vector<JointSet> joint_sets_of(const tinygltf::Primitive& primitive);

/// Maps of the nodes that joints may be: those in the scene, and those out of it by the nodes above
/// them.
class NodeMaps {
 public:
  /// `nodes`: those of the scene, placed.
  NodeMaps(const Document& document, const std::vector<PlacedNode>& nodes);
  /// Throws InputError for a node that is its own ancestor, and for one without a map.
  Affine to_world(size_t node);

 private:
  void find_parents();
  void set(size_t node, const Affine& to_world);

  const Document& d_;
  std::vector<bool> known_;
  std::vector<Affine> to_world_;
  std::vector<size_t> parent_;  // once it is asked for
};

class Skin {
 public:
  /// Throws InputError for a skin that is wrong.
  Skin(const Document& document, size_t skin, NodeMaps& nodes);

  /// The map of each vertex. What weighs nothing is not looked at; a vertex without any weight
  /// follows its first joint. Throws InputError for joints that are not there.
  std::vector<Affine> blend(const std::vector<JointSet>& sets) const;

  /// What its first joint does.
  const Affine& first() const { return joints_.front(); }

 private:
  const Document& d_;
  size_t skin_;
  std::vector<Affine> joints_;
};

/// Whether most of them turn left hands into right ones.
bool most_mirror(const std::vector<Affine>& maps);

}  // namespace tdpt::gltf
