// Cameras. Internal to this room.
#pragma once
#include <optional>

#include "libcommon/scene/distinct_names.h"
#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/gltf/nodes.h"
#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

/// The camera that a node holds, in metres as yet, with a name of its own among `names`. Nothing
/// when it holds none or one that is not perspective, or when the node's transform leaves it no
/// direction: then `flat` counts it.
std::optional<Camera> read_camera(const Document& document, const PlacedNode& node,
                                  DistinctNames& names, size_t& flat);

}  // namespace tdpt::gltf
