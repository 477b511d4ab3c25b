// Cameras. Internal to this room.
#pragma once
#include <optional>

#include "libcommon/scene/gltf_document.h"
#include "libcommon/scene/gltf_nodes.h"
#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

/// The camera that a node holds, in metres as yet, with a name that none of `others` has. Nothing
/// when it holds none or one that is not perspective. Throws InputError when the node's transform
/// leaves it no direction.
std::optional<Camera> read_camera(const Document& document, const PlacedNode& node,
                                  const std::vector<Camera>& others);

}  // namespace tdpt::gltf
