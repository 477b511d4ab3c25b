#include "libcommon/scene/gltf/materials.h"

#include <algorithm>

namespace tdpt::gltf {
namespace {

using Json = nlohmann::json;

constexpr const char* kName = "KHR_materials_pbrSpecularGlossiness";

void move(const Json& from, const char* name, Json& to, const char* new_name) {
  if (from.contains(name)) to[new_name] = from[name];
}

}  // namespace

Json without_specular_glossiness(const Json& material) {
  if (!material.contains("extensions") || !material["extensions"].contains(kName) ||
      material["extensions"].contains("KHR_materials_unlit"))
    return material;
  Json out = material;
  Json& extensions = out["extensions"];
  const Json model = extensions[kName];
  // The extension excludes these others.
  for (const char* name : {kName, "KHR_materials_specular", "KHR_materials_ior",
                           "KHR_materials_transmission", "KHR_materials_volume"})
    extensions.erase(name);
  Json& pbr = out["pbrMetallicRoughness"] = {{"metallicFactor", 0}};
  pbr["roughnessFactor"] = 1 - model.value("glossinessFactor", 1.0);
  move(model, "diffuseFactor", pbr, "baseColorFactor");
  move(model, "diffuseTexture", pbr, "baseColorTexture");
  Json& specular = extensions["KHR_materials_specular"] = Json::object();
  move(model, "specularFactor", specular, "specularColorFactor");
  move(model, "specularGlossinessTexture", specular, "specularColorTexture");
  extensions["KHR_materials_ior"] = {{"ior", 0}};
  return out;
}

void finish_specular_glossiness(bool map, float alpha, Material& m) {
  m.glossy_map = map;
  if (map) return;
  m.roughness = 1 - (1 - m.roughness) * alpha;
  m.base_color = m.base_color * std::max(1 - max_component(m.specular_color), 0.0f);
}

}  // namespace tdpt::gltf
