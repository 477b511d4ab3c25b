// Converts KHR_materials_pbrSpecularGlossiness to metallic-roughness with extensions. Internal to
// this room.
//
// The extension defines  c_diff = diffuse (1 - max specular),  F0 = specular,  F90 = 1, alpha = (1
// - glossiness)^2: a dielectric with an infinite index of refraction, `specular` as specular colour
// and c_diff as base colour. One texture holds specular (RGB) and glossiness (A); unless it is
// uniform, the renderer evaluates both at each point [Material::glossy_map].
#pragma once
#include <nlohmann/json.hpp>

#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

/// The material as metallic-roughness with KHR_materials_specular and _ior, except for the factor
/// (1 - max specular) of the base colour; unchanged if it does not use the extension. The texture
/// becomes that of the specular colour, and roughness is 1 - glossinessFactor.
nlohmann::json without_specular_glossiness(const nlohmann::json& material);

/// Applies the factor (1 - max specular) and the texture's glossiness. If `map`, both are evaluated
/// at each point; else at once, with `alpha` that of a uniform texture, which the specular colour
/// already contains.
void finish_specular_glossiness(bool map, float alpha, Material& material);

}  // namespace tdpt::gltf
