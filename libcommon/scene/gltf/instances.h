// EXT_mesh_gpu_instancing: a node's mesh, placed many times. Internal to this room.
#pragma once
#include <vector>

#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/gltf/nodes.h"

namespace tdpt::gltf {

/// How often the node's mesh is there: once without the extension. A count of the file, not yet
/// compared with what its buffers hold. Throws InputError where the attributes' counts differ.
size_t instances_declared(const Document& document, size_t node);

/// Where: the node's map, after that of each instance. Throws InputError for numbers that are not
/// there or no transform.
std::vector<Affine> place_instances(const Document& document, const PlacedNode& node);

}  // namespace tdpt::gltf
