// PNG, JPEG and WebP images in memory, from anywhere. Internal to this room.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

/// Texels that a PNG, JPEG or WebP declares in its header; nothing where it is no such image, or
/// where so many cannot be held by so few bytes.
std::optional<int64_t> texels_declared(std::string_view bytes);

/// The image; nothing when it cannot be decoded. Equal bytes give equal texels, damaged ones too.
std::optional<Image> decode_image(std::string_view bytes);

/// What one is that cannot be decoded: "KTX2, which is not read", "a PNG that cannot be decoded".
std::string fault_of_image(std::string_view bytes);

}  // namespace tdpt::gltf
