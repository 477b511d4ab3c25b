// Where nodes stand: the hierarchy with world transforms in double precision, instances, skins and
// animations. Internal to this room.
#pragma once
#include <vector>

#include "libcommon/math/vec.h"
#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

/// The map of a node into its parent. Throws InputError if it is invalid.
Affine local_map(const Document& document, size_t node);

/// `v` normalised, even if very long or short; 0 if it has no direction or is not finite.
Vec3d direction_of(const Vec3d& v);

struct PlacedNode {
  size_t node;
  Affine to_world;
  bool visible;  ///< neither it nor an ancestor is hidden
};

struct PlacedNodes {
  /// Those of the default scene (else of the first scene, else all), parents first, in file order.
  std::vector<PlacedNode> of_scene;
  std::vector<Affine> to_world;  ///< of all nodes of the file: joints may lie outside of the scene
};

/// A root that is also a child is placed below its parent. Throws InputError for cycles, nodes with
/// two parents and invalid maps.
PlacedNodes place_nodes(const Document& document);

// EXT_mesh_gpu_instancing: a node's mesh, placed several times.

/// Number of instances of the node's mesh: 1 without the extension. As declared, not yet compared
/// with the size of the buffers. Throws InputError if the attributes' counts differ.
size_t instances_declared(const Document& document, size_t node);

/// Their transforms: the node's after that of the instance. Throws InputError for missing numbers
/// and invalid transforms.
std::vector<Affine> place_instances(const Document& document, const PlacedNode& node);

// Skins: vertices that follow joints, by linear blend skinning (glTF 2.0, section 3.7.3).
//   world = sum_k w_k (to_world of joint k) (inverse bind matrix of joint k) vertex, sum_k w_k = 1
// The transform of the node that holds the mesh is ignored.

/// Accessors of one set of up to four joints per vertex.
struct JointSet {
  size_t joints, weights;
  auto operator<=>(const JointSet&) const = default;
};

/// JOINTS_0 with WEIGHTS_0 and the sets that follow.
std::vector<JointSet> joint_sets_of(const Primitive& primitive);

/// World transforms of what follows each joint of a skin. Throws InputError.
std::vector<Affine> joint_maps(const Document& document, size_t skin, const PlacedNodes& nodes);

/// The map of each vertex that follows these joints. Joints of weight 0 are ignored; a vertex
/// without any weight follows its first joint. Throws InputError for joints that do not exist.
std::vector<Affine> blend_joints(const Document& document, const std::vector<Affine>& joints,
                                 const std::vector<JointSet>& sets, size_t vertices);

// Animations: the pose of the nodes at a time (glTF 2.0, section 3.11 and appendix C).
//
// Exporters leave the rest pose in the nodes and put what the user saw into animations, one per
// object (Blender 3.4: the nodes of an animated armature hold nothing else). So each property takes
// its value from the first animation that moves it, as in a viewer that plays all animations that
// belong together. Before its first key and after its last it holds their values.

/// What the animations of a file move.
struct Motion {
  bool moves = false;  ///< some node
  std::vector<AnimationFacts> animations;
};

/// Sets translations, rotations, scales and weights of the nodes to their values at a time
/// [s]. May be repeated for other times. Throws InputError for a malformed channel.
Motion go_to(Document& document, double seconds);

}  // namespace tdpt::gltf
