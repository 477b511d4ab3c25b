// Materials: glTF 2.0 metallic-roughness and those of its extensions that are read. Internal to
// this room.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

/// What a material asks of the meshes that use it, and what they answer.
struct MaterialUse {
  std::array<bool, 2> uv{};      ///< sets of texture coordinates that its maps look up
  bool tangents = false;         ///< it has a normal map
  bool colours = true;           ///< vertex colours would change it
  bool alpha = false;            ///< is not opaque
  bool unlit = false;            ///< its base colour became emission, which they do not change
  float least_alpha = 1;         ///< factor times the least of its texture
  float least_vertex_alpha = 1;  ///< set by the meshes
  bool coloured = false;         ///< set by the meshes: some vertex colour is not white
};

/// Appends a material for each of the file's that is `used` (others keep their defaults), with the
/// images that they look up, and one sentence to scene.warnings for each kind of approximation,
/// saying how many it concerns. Adds external image files to scene.hash. Absorption is per metre as
/// yet. The result is parallel to the materials.
std::vector<MaterialUse> read_materials(const Document& document, const std::vector<bool>& used,
                                        Scene& scene);

/// Once the vertex colours are known: an alpha that is 1 everywhere makes a material opaque, and
/// `plain` is set where nothing beyond base colour and emission matters.
void finish_material(const MaterialUse& use, Material& material);

/// Words for Scene::needs, always in the same order.
std::vector<std::string> needs_of(const Scene& scene);

}  // namespace tdpt::gltf
