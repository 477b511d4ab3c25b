// WebP images in memory, from anywhere. Internal to this room.
#pragma once
#include <cstdint>
#include <optional>
#include <string_view>

#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

bool is_webp(std::string_view bytes);
bool is_animated_webp(std::string_view bytes);

/// Texels that a still WebP declares in its header; nothing where it is none, or where so many are
/// not expected of so few bytes.
std::optional<int64_t> webp_texels_declared(std::string_view bytes);

/// The image; nothing when it cannot be decoded.
std::optional<Image> decode_webp(std::string_view bytes);

}  // namespace tdpt::gltf
