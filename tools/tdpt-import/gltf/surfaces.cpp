#include "tools/tdpt-import/gltf/surfaces.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/materials.h"

namespace tdpt::foreign {
namespace {

bool is_white(const Rgb& c) {
  return c.x == 1 && c.y == 1 && c.z == 1;
}
GltfJson three(const Rgb& c) {
  return {c.x, c.y, c.z};
}

Rgb within_1(const Rgb& c) {
  return min(max(c, Rgb(0)), Rgb(1));
}

// Factors above 1, which glTF does not have, are put into the texels.
Material with_factors_within_1(Material m) {
  if (m.base.texture && max_component(m.base.factor) > 1)
    m.base = through(m.base, [](const Rgb& c) { return c; });
  for (Number* n : {&m.roughness, &m.opacity})
    if (n->texture && n->factor > 1) {
      n->curve = [factor = n->factor, before = n->curve](float texel) {
        return factor * (before ? before(texel) : texel);
      };
      n->factor = 1;
    }
  return m;
}

}  // namespace

GltfJson& Surfaces::extension(GltfJson& out, const char* name) {
  extensions_.insert(name);
  GltfJson& e = out["extensions"][name];
  if (e.is_null()) e = GltfJson::object();
  return e;
}

void Surfaces::add_layers(const Material& m, GltfJson& out) {
  if (m.metallic < 1) {
    if (m.specular != 1) extension(out, "KHR_materials_specular")["specularFactor"] = m.specular;
    if (m.specular > 0 && !is_white(m.specular_colour))
      extension(out, "KHR_materials_specular")["specularColorFactor"] = three(m.specular_colour);
    if (m.ior != 1.5f && (m.specular > 0 || m.transmission > 0))
      extension(out, "KHR_materials_ior")["ior"] = std::max(m.ior, 1.0f);
  }
  if (m.transmission > 0) {
    extension(out, "KHR_materials_transmission")["transmissionFactor"] = m.transmission;
    if (m.solid) {
      GltfJson& volume = extension(out, "KHR_materials_volume");
      volume["thicknessFactor"] = 1;
      if (!is_white(m.attenuation)) {
        volume["attenuationColor"] = three(within_1(m.attenuation));
        volume["attenuationDistance"] = 1;
      }
    }
  }
  if (m.coat > 0) {
    GltfJson& coat = extension(out, "KHR_materials_clearcoat");
    coat["clearcoatFactor"] = m.coat;
    coat["clearcoatRoughnessFactor"] = m.coat_roughness;
  }
}

void Surfaces::add_emission(const Emission& e, GltfJson& out) {
  // Texels of a file that are at most 1 pass as they are.
  const float texel = textures_.largest(e.radiance), scale = texel > 1 ? texel : 1;
  const Rgb radiance = max(e.radiance.factor, Rgb(0)) * scale;
  const float strength = max_component(radiance);
  out["emissiveFactor"] = three(strength > 0 ? radiance / strength : Rgb(0));
  if (strength > 0 && strength != 1)
    extension(out, "KHR_materials_emissive_strength")["emissiveStrength"] = strength;
  if (GltfJson t = textures_.colour(e.radiance, nullptr, scale); !t.is_null())
    out["emissiveTexture"] = std::move(t);
}

GltfJson Surfaces::surface(const Material& m) {
  GltfJson out;
  if (!m.name.empty()) out["name"] = shown(m.name, 200);
  GltfJson& pbr = out["pbrMetallicRoughness"];
  const Rgb base = within_1(m.base.factor);
  if (max_component(m.base.factor) > 1)
    source_.lose({source_.path(), ""}, "reflectances above 1 are taken as 1");
  const bool see_through = m.opacity.factor < 1 || m.opacity.texture;
  pbr["baseColorFactor"] = {base.x, base.y, base.z, std::clamp(m.opacity.factor, 0.0f, 1.0f)};
  if (GltfJson t = textures_.colour(m.base, &m.opacity); !t.is_null())
    pbr["baseColorTexture"] = std::move(t);
  pbr["metallicFactor"] = m.metallic;
  pbr["roughnessFactor"] = std::clamp(m.roughness.factor, 0.0f, 1.0f);
  if (GltfJson t = textures_.roughness(m.roughness); !t.is_null())
    pbr["metallicRoughnessTexture"] = std::move(t);
  if (see_through) out["alphaMode"] = "BLEND";
  // Glass must not be, by its extension.
  if (!(m.transmission > 0 && m.solid)) out["doubleSided"] = true;
  if (m.normal)
    if (GltfJson t = textures_.normal_map(*m.normal); !t.is_null())
      out["normalTexture"] = std::move(t);
  if (m.tinted)
    source_.lose(
        {source_.path(), ""},
        "metals and mirrors that are darkened at all angles reflect all light at grazing ones");
  if (m.bump) source_.lose({source_.path(), ""}, "bump maps are left out");
  if (m.eta_k) {
    out["extras"]["tdpt_eta"] = three((*m.eta_k)[0]);
    out["extras"]["tdpt_k"] = three((*m.eta_k)[1]);
  }
  add_layers(m, out);
  return out;
}

Surfaces::Written Surfaces::of(size_t material, const std::optional<Emission>& emission) {
  if (const auto it = dark_.find(material); !emission && it != dark_.end()) return it->second;
  GltfJson out = surface(with_factors_within_1(scene_.materials[material]));
  if (emission) {
    add_emission(*emission, out);
    if (emission->both_sides)
      out["doubleSided"] = true;
    else
      out.erase("doubleSided");
  }
  const std::string text = out.dump(-1, ' ', false, GltfJson::error_handler_t::replace);
  const bool textured = text.find("Texture\":") != text.npos;
  if (text.find("KHR_texture_transform") != text.npos) extensions_.insert("KHR_texture_transform");
  const auto [it, is_new] = written_.try_emplace(text, written_.size());
  if (is_new) root_["materials"].push_back(std::move(out));
  if (!emission) dark_[material] = {it->second, textured};
  return {it->second, textured};
}

}  // namespace tdpt::foreign
