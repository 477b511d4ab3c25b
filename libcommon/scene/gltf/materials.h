// Materials: glTF 2.0 metallic-roughness and the supported extensions. Internal to this room.
#pragma once
#include <array>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

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
/// images that they use. Adds one sentence to scene.warnings per kind of approximation, saying how
/// many materials it affects, and adds external image files to scene.hash. Absorption is still per
/// metre. The result is parallel to the materials.
std::vector<MaterialUse> read_materials(const Document& document, const std::vector<bool>& used,
                                        Scene& scene);

/// Call when the vertex colours are known: makes a material opaque if alpha is 1 everywhere, and
/// sets `plain` if nothing but base colour and emission matters.
void finish_material(const MaterialUse& use, Material& material);

/// Words for Scene::needs, always in the same order.
std::vector<std::string> needs_of(const Scene& scene);

// Converts KHR_materials_pbrSpecularGlossiness to metallic-roughness with extensions.
//
// The extension defines  c_diff = diffuse (1 - max specular),  F0 = specular,  F90 = 1, alpha = (1
// - glossiness)^2: a dielectric with an infinite index of refraction, `specular` as specular colour
// and c_diff as base colour. One texture holds specular (RGB) and glossiness (A); unless it is
// uniform, the renderer evaluates both at each point [Material::glossy_map].

/// The material as metallic-roughness with KHR_materials_specular and _ior, except for the factor
/// (1 - max specular) of the base colour; unchanged if it does not use the extension. The texture
/// becomes that of the specular colour, and roughness is 1 - glossinessFactor.
nlohmann::json without_specular_glossiness(const nlohmann::json& material);

/// Applies the factor (1 - max specular) and the texture's glossiness. If `map`, both are evaluated
/// at each point; else at once, with `alpha` that of a uniform texture, which the specular colour
/// already contains.
void finish_specular_glossiness(bool map, float alpha, Material& material);

}  // namespace tdpt::gltf
