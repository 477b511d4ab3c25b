// Nodes and cameras. Flattens the node hierarchy: every node of the scene with its world transform,
// in double precision. Internal to this room.
#pragma once
#include <string>
#include <vector>

#include "libcommon/math/vec.h"
#include "libcommon/scene/gltf/document.h"

namespace tdpt::gltf {

/// The map of a node into its parent. Throws InputError if it is invalid.
Affine local_map(const Document& document, size_t node);

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

}  // namespace tdpt::gltf
