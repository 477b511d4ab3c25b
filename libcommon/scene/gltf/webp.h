// Decodes WebP images in memory, from untrusted sources. Internal to this room.
#pragma once
#include <cstdint>
#include <optional>
#include <string_view>

#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

bool is_webp(std::string_view bytes);
bool is_animated_webp(std::string_view bytes);

/// Texels that a still WebP declares in its header; empty if it is none, or if so many are
/// implausible for so few bytes.
std::optional<int64_t> webp_texels_declared(std::string_view bytes);

/// The image; empty if it cannot be decoded.
std::optional<Image> decode_webp(std::string_view bytes);

}  // namespace tdpt::gltf
