// URIs of files in a scene. Internal to this room.
#pragma once
#include <string>
#include <string_view>

#include "libcommon/base/local_file.h"
#include "libcommon/scene/gltf/document.h"

namespace tdpt::gltf {

/// "%20" becomes a blank, and so on.
std::string percent_decode(std::string_view text);

}  // namespace tdpt::gltf
