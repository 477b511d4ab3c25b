// Materials: glTF 2.0 metallic-roughness and the supported extensions. Internal to this room.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

/// What a material needs of the meshes that use it, and what they report back.
struct MaterialUse {
  std::array<bool, 2> uv{};  ///< sets of texture coordinates that its maps use
  bool tangents = false;     ///< it has a normal map
  bool colours = true;       ///< vertex colours would change it
  bool alpha = false;        ///< it is not opaque
  bool unlit = false;     ///< its base colour became emission, which vertex colours do not change
  float least_alpha = 1;  ///< factor times the minimum of its texture
  float least_vertex_alpha = 1;  ///< set by the meshes
  bool coloured = false;         ///< set by the meshes: some vertex colour is not white
};

/// Appends a material for each in the file that is `used` (others keep their defaults), with the
/// images that they use, and adds external image files to scene.hash. Absorption is still per
/// metre. The result is parallel to the materials.
std::vector<MaterialUse> read_materials(const Document& document, const std::vector<bool>& used,
                                        Scene& scene, Notes& notes);

/// Call when the vertex colours are known: makes a material opaque if alpha is 1 everywhere, and
/// sets `plain` if nothing but base colour and emission matters.
void finish_material(const MaterialUse& use, Material& material);

}  // namespace tdpt::gltf
