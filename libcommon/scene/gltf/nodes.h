// Nodes and cameras. Flattens the node hierarchy: every node of the scene with its world transform,
// in double precision. Internal to this room.
#pragma once
#include <string>
#include <vector>

#include "libcommon/math/vec.h"
#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

/// The map of a node into its parent. Throws InputError if it is invalid.
Affine local_map(const Document& document, size_t node);

/// `v` normalised, even if very long or short; 0 if it has no direction.
Vec3d direction_of(const Vec3d& v);

struct PlacedNode {
  size_t node;
  Affine to_world;
  bool visible;  ///< neither it nor an ancestor is hidden
};

/// Nodes of the default scene (else of the first scene, else all roots and what is below), parents
/// first, in file order. Throws InputError for cycles, nodes with two parents and invalid maps.
/// Adds a sentence to `warnings` about roots that are also children.
std::vector<PlacedNode> place_nodes(const Document& document, std::vector<std::string>& warnings);

// EXT_mesh_gpu_instancing: a node's mesh, placed several times.

/// Number of instances of the node's mesh: 1 without the extension. As declared, not yet compared
/// with the size of the buffers. Throws InputError if the attributes' counts differ.
size_t instances_declared(const Document& document, size_t node);

/// Their transforms: the node's after that of the instance. Throws InputError for missing numbers
/// and invalid transforms.
std::vector<Affine> place_instances(const Document& document, const PlacedNode& node);

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
