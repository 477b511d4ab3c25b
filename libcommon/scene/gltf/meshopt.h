// bufferViews compressed by meshoptimizer: EXT_meshopt_compression and KHR_meshopt_compression.
// Internal to this room.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "libcommon/scene/gltf/document.h"

namespace tdpt::gltf {

constexpr const char* kMeshopt[] = {"EXT_meshopt_compression", "KHR_meshopt_compression"};

/// Whether a buffer holds nothing but what others hold compressed. It may have no bytes.
bool is_meshopt_fallback(const nlohmann::json& buffer);

bool is_meshopt_view(const Document& document, size_t view);

/// What a compressed bufferView stands for. Throws InputError where that is no such data, shorter
/// than the bufferView or, with all that was decoded before, more than its buffers can hold.
std::string unpack_meshopt_view(const Document& document, size_t view);

/// More bytes than all compressed bufferViews stand for.
size_t most_bytes_of_meshopt(const Document& document);

}  // namespace tdpt::gltf
