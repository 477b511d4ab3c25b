// Decodes PNG, JPEG and WebP images in memory, from untrusted sources. Internal to this room.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

/// Texels that a PNG, JPEG or WebP declares in its header; empty if it is no such image, or if so
/// few bytes cannot hold so many.
std::optional<int64_t> texels_declared(std::string_view bytes);

/// The image; empty if it cannot be decoded. Equal bytes give equal texels, even if damaged.
std::optional<Image> decode_image(std::string_view bytes);

/// Describes an image that cannot be decoded: "KTX2, which is not read", "a PNG that cannot be
/// decoded".
std::string fault_of_image(std::string_view bytes);

}  // namespace tdpt::gltf
