// KHR_materials_pbrSpecularGlossiness in the words of the other materials. Internal to this room.
//
// The extension says  c_diff = diffuse (1 - max specular),  F0 = specular,  F90 = 1,
// alpha = (1 - glossiness)^2: a dielectric with an infinite index of refraction and `specular` as
// the colour of its reflection, whose base colour is c_diff. One texture holds specular (RGB) and
// glossiness (A); where it has more than one colour the renderer works both out at each point
// [Material::glossy_map].
#pragma once
#include <nlohmann/json.hpp>

#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

/// The material as metallic-roughness with KHR_materials_specular and _ior, but for the share of
/// diffuse light that the reflection takes; itself when it does not use the extension. The texture
/// of both is the specular colour's, and roughness is 1 less glossinessFactor.
nlohmann::json without_specular_glossiness(const nlohmann::json& material);

/// Takes the reflection's share from the base colour, and the texture's glossiness into account: at
/// once where `alpha` is that of a texture of one colour, already multiplied into the specular
/// colour; else at each point, by `map`.
void finish_specular_glossiness(bool map, float alpha, Material& material);

}  // namespace tdpt::gltf
