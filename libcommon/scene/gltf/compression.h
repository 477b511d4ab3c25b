// Primitives compressed by KHR_draco_mesh_compression become plain ones. Internal to this room.
#pragma once
#include "libcommon/scene/gltf/document.h"

namespace tdpt::gltf {

constexpr const char* kDraco = "KHR_draco_mesh_compression";

bool is_draco(const nlohmann::json& primitive);

/// Decodes the primitives of all placed meshes; from then on their accessors are as any others.
/// One whose accessors all have a bufferView is taken as it stands, unless Draco is required.
/// Throws InputError.
void decode_draco_primitives(Document& document);

}  // namespace tdpt::gltf
