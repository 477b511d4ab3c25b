// EXT_mesh_gpu_instancing: a node's mesh, placed several times. Internal to this room.
#pragma once
#include <vector>

#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/gltf/nodes.h"

namespace tdpt::gltf {

/// Number of instances of the node's mesh: 1 without the extension. As declared, not yet compared
/// with the size of the buffers. Throws InputError if the attributes' counts differ.
size_t instances_declared(const Document& document, size_t node);

/// Their transforms: the node's after that of the instance. Throws InputError for missing numbers
/// and invalid transforms.
std::vector<Affine> place_instances(const Document& document, const PlacedNode& node);

}  // namespace tdpt::gltf
