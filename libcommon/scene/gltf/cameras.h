// Cameras. Internal to this room.
#pragma once
#include <optional>

#include "libcommon/scene/distinct_names.h"
#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/gltf/nodes.h"
#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

/// The camera of a node, still in metres, with a unique name among `names`. Empty if the node has
/// none, if it is not perspective, or if the node's transform leaves it no direction: then `flat`
/// is incremented.
std::optional<Camera> read_camera(const Document& document, const PlacedNode& node,
                                  DistinctNames& names, size_t& flat);

}  // namespace tdpt::gltf
