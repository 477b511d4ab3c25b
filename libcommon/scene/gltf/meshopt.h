// bufferViews compressed by meshoptimizer: EXT_meshopt_compression and KHR_meshopt_compression.
// Internal to this room.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "libcommon/scene/gltf/document.h"

namespace tdpt::gltf {

constexpr const char* kMeshopt[] = {"EXT_meshopt_compression", "KHR_meshopt_compression"};

/// Whether a buffer is only a fallback for compressed bufferViews. It may have no bytes.
bool is_meshopt_fallback(const nlohmann::json& buffer);

bool is_meshopt_view(const Document& document, size_t view);

/// Decodes a compressed bufferView. Throws InputError if the data are invalid, shorter than the
/// bufferView or, together with everything decoded before, more than the buffers can hold.
std::string unpack_meshopt_view(const Document& document, size_t view);

/// Upper bound on the decoded bytes of all compressed bufferViews.
size_t most_bytes_of_meshopt(const Document& document);

}  // namespace tdpt::gltf
