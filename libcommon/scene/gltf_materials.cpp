#include "libcommon/scene/gltf_materials.h"

#include <fmt/format.h>
#include <array>
#include <cmath>
#include <limits>

#include "libcommon/base/hash.h"
#include "libcommon/scene/gltf_images.h"

namespace tdpt::gltf {
namespace {

enum Kind {
  metallic,
  transmissive,
  glossy,
  layered,
  unlit,
  texture,
  no_texture,
  emissive_texture,
  normal_map,
  alpha,
  clamped,
  kinds
};

struct Sentence {
  const char *one, *many, *rest;
};
constexpr std::array<Sentence, kinds> kSentences = {{
    {"is metallic", "are metallic", ": taken as diffuse with the base colour"},
    {"transmits light", "transmit light", ": taken as opaque, diffuse with the base colour"},
    {"has a specular reflection", "have a specular reflection", ", which is left out"},
    {"has a coat, sheen or the like", "have a coat, sheen or the like", ", which is left out"},
    {"is unlit", "are unlit", ": taken as diffuse with the base colour"},
    {"has a base-colour texture", "have a base-colour texture", ": its average colour is used"},
    {"has a texture that cannot be decoded", "have a texture that cannot be decoded",
     ": the colour factor alone is used"},
    {"has an emissive texture", "have an emissive texture", ": its average colour is used"},
    {"has a normal map", "have a normal map", ", which is left out"},
    {"is not opaque (alphaMode)", "are not opaque (alphaMode)", ": taken as opaque"},
    {"reflects more than all light", "reflect more than all light",
     ": the base colour is clamped to 1"},
}};

double extension_number(const tinygltf::Material& m, const char* extension, const char* field,
                        double otherwise) {
  const auto it = m.extensions.find(extension);
  if (it == m.extensions.end() || !it->second.Has(field)) return otherwise;
  return it->second.Get(field).GetNumberAsDouble();
}

class Reader {
 public:
  Reader(const Document& d, Scene& scene) : d_(d), scene_(scene), textures_(d) {}

  Material read(size_t index) {
    const tinygltf::Material& m = d_.model.materials[index];
    Material out;
    out.name = m.name;
    out.double_sided = m.doubleSided;
    out.emission = emission(m, index);
    out.base_color = albedo(m);
    count_approximations(m);
    return out;
  }

  void finish() {
    for (size_t k = 0; k < kinds; ++k)
      if (count_[k] > 0)
        scene_.warnings.push_back(
            counted(count_[k], "material", kSentences[k].one, kSentences[k].many) +
            kSentences[k].rest);
    if (!textures_.external_bytes().empty())
      scene_.hash = content_hash(scene_.hash + textures_.external_bytes());
  }

 private:
  /// Factor times the texture's average, if there is a texture.
  Vec3d textured(Vec3d factor, int texture_index, Kind kind) {
    if (texture_index < 0) return factor;
    const auto average = textures_.average(static_cast<size_t>(texture_index));
    ++count_[average ? kind : no_texture];
    return average ? factor * *average : factor;
  }

  Rgb albedo(const tinygltf::Material& m) {
    const auto& pbr = m.pbrMetallicRoughness;
    Vec3d colour(1);
    for (int c = 0; c < 3 && pbr.baseColorFactor.size() == 4; ++c)
      colour[c] = pbr.baseColorFactor[static_cast<size_t>(c)];
    colour = textured(colour, pbr.baseColorTexture.index, texture);
    if (max_component(colour) > 1) ++count_[clamped];
    return Rgb(min(colour, Vec3d(1)));
  }

  /// Radiance [W/m2/sr]: emissiveFactor x emissiveStrength.
  Rgb emission(const tinygltf::Material& m, size_t index) {
    const double strength =
        extension_number(m, "KHR_materials_emissive_strength", "emissiveStrength", 1);
    Vec3d radiance(m.emissiveFactor[0], m.emissiveFactor[1], m.emissiveFactor[2]);
    if (max_component(radiance) > 0)
      radiance = textured(radiance, m.emissiveTexture.index, emissive_texture);
    radiance *= strength;
    if (!(max_component(radiance) <= 1e30))
      d_.fail(
          place("materials", index),
          fmt::format("emits a radiance of {}, expected at most 1e30", max_component(radiance)));
    return Rgb(radiance);
  }

  void count_approximations(const tinygltf::Material& m) {
    const auto has = [&](const char* extension) { return m.extensions.contains(extension); };
    const auto& pbr = m.pbrMetallicRoughness;
    const bool black = pbr.baseColorFactor.size() == 4 && pbr.baseColorFactor[0] == 0 &&
                       pbr.baseColorFactor[1] == 0 && pbr.baseColorFactor[2] == 0;
    const double specular = extension_number(m, "KHR_materials_specular", "specularFactor", 1);
    if (has("KHR_materials_unlit"))
      ++count_[unlit];
    else if (extension_number(m, "KHR_materials_transmission", "transmissionFactor", 0) > 0)
      ++count_[transmissive];
    else if (pbr.metallicFactor > 0 && !black)
      ++count_[metallic];
    else if (specular > 0)
      ++count_[glossy];
    for (const char* coat :
         {"KHR_materials_clearcoat", "KHR_materials_sheen", "KHR_materials_iridescence"})
      if (has(coat)) {
        ++count_[layered];
        break;
      }
    if (m.normalTexture.index >= 0) ++count_[normal_map];
    if (!m.alphaMode.empty() && m.alphaMode != "OPAQUE") ++count_[alpha];
  }

  const Document& d_;
  Scene& scene_;
  TextureColours textures_;
  std::array<size_t, kinds> count_{};
};

}  // namespace

std::string counted(size_t n, const std::string& noun, const std::string& one,
                    const std::string& many) {
  return fmt::format("{} {}{} {}", n, noun, n == 1 ? "" : "s", n == 1 ? one : many);
}

void read_materials(const Document& d, const std::vector<bool>& used, Scene& scene) {
  Reader reader(d, scene);
  for (size_t i = 0; i < d.model.materials.size(); ++i)
    scene.materials.push_back(used[i] ? reader.read(i) : Material{d.model.materials[i].name});
  reader.finish();
}

}  // namespace tdpt::gltf
