// Materials as this toolchain has them: diffuse, emitting. Internal to this room.
#pragma once
#include <string>
#include <vector>

#include "libcommon/scene/gltf_document.h"
#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

/// Appends a material for each of the file's that is `used` (others keep their defaults) and one
/// sentence to scene.warnings for each kind of approximation, saying how many it concerns. Adds
/// external image files to scene.hash.
void read_materials(const Document& document, const std::vector<bool>& used, Scene& scene);

/// "1 material is", "3 materials are".
std::string counted(size_t n, const std::string& noun, const std::string& one,
                    const std::string& many);

}  // namespace tdpt::gltf
