// Decodes primitives compressed by KHR_draco_mesh_compression. Internal to this room.
#pragma once
#include "libcommon/scene/gltf/document.h"

namespace tdpt::gltf {

constexpr const char* kDraco = "KHR_draco_mesh_compression";

bool is_draco(const nlohmann::json& primitive);

/// Decodes the primitives of all placed meshes, so that their accessors are like any others. A
/// primitive whose accessors all have a bufferView is used uncompressed, unless Draco is required.
/// Throws InputError.
void decode_draco_primitives(Document& document);

}  // namespace tdpt::gltf
