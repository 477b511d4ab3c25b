#include "libcommon/scene/gltf/materials.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>

#include "libcommon/base/provenance.h"
#include "libcommon/base/words.h"
#include "libcommon/scene/gltf/textures.h"
#include "libcommon/scene/texture.h"
#include "shaders/shared/path/microfacet.h"

namespace tdpt::gltf {
namespace {

using Json = nlohmann::json;

enum Kind { unlit, far_uv_set, clamped, faint, kinds };

struct Sentence {
  const char *one, *many, *rest;
};
constexpr std::array<Sentence, kinds> kSentences = {{
    {"is unlit", "are unlit", ": taken as black, emitting the base colour"},
    {"has a texture on TEXCOORD_2 or beyond", "have a texture on TEXCOORD_2 or beyond",
     ": its factor alone is used"},
    {"reflects more than all light", "reflect more than all light",
     ": the base colour is clamped to 1"},
    {"emits a radiance below 1e-30", "emit a radiance below 1e-30", ", which counts as none"},
}};

// At most so many textures are named individually; the rest are counted.
constexpr size_t kNamed = 5;

// A feature that is ignored with a warning if its `factor` is above 0.
struct LeftOut {
  const char *extension, *factor, *words;
};
constexpr LeftOut kLeftOut[] = {
    {"KHR_materials_iridescence", "iridescenceFactor", "iridescence"},
    {"KHR_materials_anisotropy", "anisotropyStrength", "anisotropy"},
    {"KHR_materials_dispersion", "dispersion", "dispersion"},
    {"KHR_materials_diffuse_transmission", "diffuseTransmissionFactor", "diffuse transmission"},
    {"KHR_materials_volume_scatter", "multiscatterColor", "scattering in its volume"}};

// An index of refraction of 0 means an infinite one: all light is reflected.
constexpr float kInfiniteIor = 1e6f;

const Json& child(const Json& parent, const char* name) {
  static const Json kNothing = Json::object();
  const auto it = parent.find(name);
  return it == parent.end() ? kNothing : *it;
}

float number(const Json& parent, const char* name, float otherwise) {
  const auto it = parent.find(name);
  return it == parent.end() ? otherwise : static_cast<float>(std::min(it->get<double>(), 1e30));
}

Vec3d triple(const Json& parent, const char* name, double otherwise) {
  const auto it = parent.find(name);
  if (it == parent.end()) return Vec3d(otherwise);
  return {(*it)[0].get<double>(), (*it)[1].get<double>(), (*it)[2].get<double>()};
}

bool is_black(const Rgb& c) {
  return max_component(c) <= 0;
}

bool more_than_0(const Json& parent, const char* name) {
  const auto it = parent.find(name);
  if (it == parent.end()) return false;
  return it->is_number() ? it->get<double>() > 0 : max_component(triple(parent, name, 0)) > 0;
}

/// "material "a"", "materials "a", "b", "c" and 2 more".
std::string listed(const std::vector<std::string>& names) {
  constexpr size_t kMost = 3;
  std::string out = names.size() == 1 ? "material " : "materials ";
  for (size_t i = 0; i < std::min(names.size(), kMost); ++i) {
    const bool last = i > 0 && i + 1 == names.size();
    out += (i == 0 ? "" : last ? " and " : ", ") + names[i];
  }
  if (names.size() > kMost) out += fmt::format(" and {} more", names.size() - kMost);
  return out;
}

class Reader {
 public:
  Reader(const Document& d, Scene& scene) : d_(d), scene_(scene), textures_(d, scene) {}

  Material read(size_t index, MaterialUse& use) {
    const Json j = without_specular_glossiness(d_.json["materials"][index]);
    glossy_ = child(d_.json["materials"][index], "extensions")
                  .contains("KHR_materials_pbrSpecularGlossiness");
    told_.fill(false);
    Material m;
    m.name = j.value("name", "");
    called_ = m.name.empty() ? place("materials", index) : "material \"" + shown(m.name, 40) + "\"";
    m.double_sided = j.value("doubleSided", false);
    conducts_ = child(j, "extras").contains("tdpt_eta");
    read_base(j, m);
    const Json& extensions = child(j, "extensions");
    if (extensions.contains("KHR_materials_unlit")) {
      make_unlit(m);
      use.unlit = true;
    } else {
      read_lobes(j, m);
      if (glossy_)
        finish_specular_glossiness(maps_[MAP_SPECULAR_COLOR].has_value(), glossiness_, m);
      read_coat(child(extensions, "KHR_materials_clearcoat"), m);
      read_sheen(child(extensions, "KHR_materials_sheen"), m);
      read_normal_map(j, m);
      read_emission(j, index, m);
    }
    note_left_out(extensions, index, m);
    keep_maps(m, use);
    return m;
  }

  void finish() {
    tell_left_out();
    for (size_t k = 0; k < kinds; ++k)
      if (count_[k] > 0)
        scene_.warnings.push_back(
            counted(count_[k], "material", kSentences[k].one, kSentences[k].many) +
            kSentences[k].rest);
    tell_undecodable();
    if (!textures_.external_bytes().empty())
      scene_.hash = content_hash(scene_.hash + textures_.external_bytes());
  }

 private:
  void tell(Kind kind) {
    if (!told_[kind]) ++count_[kind];
    told_[kind] = true;
  }

  void note(const char* name, const TextureReader::Fault& fault) {
    if (fault.far_uv_set) tell(far_uv_set);
    if (!fault.image.empty())
      undecodable_.push_back(fmt::format("{}: {} is {}: {}", called_, name, fault.image,
                                         std::string_view(name).ends_with("ormalTexture")
                                             ? "it is left out"
                                             : "its factor alone is used"));
  }

  void tell_undecodable() {
    const size_t named = std::min(undecodable_.size(), kNamed), more = undecodable_.size() - named;
    scene_.warnings.insert(scene_.warnings.end(), undecodable_.begin(),
                           undecodable_.begin() + static_cast<ptrdiff_t>(named));
    if (more > 0)
      scene_.warnings.push_back(
          counted(more, "more texture", "cannot be decoded", "cannot be decoded") +
          ": their factors alone are used");
  }

  /// The texture called `name`, if any; a uniform one is folded into the factors.
  template <class Fold>
  void texture(const Json& parent, const char* name, bool srgb, uint32_t map, const Fold& fold) {
    const auto info = parent.find(name);
    if (info == parent.end()) return;
    TextureReader::Fault fault{};
    const std::optional<Texture> t = textures_.read(*info, srgb, fault);
    note(name, fault);
    if (t && t->uniform)
      fold(t->value);
    else
      maps_[map] = t;
  }
  void texture(const Json& parent, const char* name, bool srgb, uint32_t map, Material& m) {
    texture(parent, name, srgb, map, [&](const std::array<float, 4>& v) { multiply(m, map, v); });
  }

  /// Reflectance at normal incidence from the complex index of refraction for red, green and blue;
  /// replaces the factors of colour and metal.
  static Vec3d conductor(const Json& extras, Material& m) {
    const Vec3d eta = triple(extras, "tdpt_eta", 1), k = triple(extras, "tdpt_k", 0);
    Vec3d f0;
    for (int c = 0; c < 3; ++c) {
      f0[c] = shader::conductor_reflectance(1.0, eta[c], k[c]);
      m.dip[c] = static_cast<float>(shader::conductor_dip(eta[c], k[c]));
    }
    return f0;
  }

  void read_base(const Json& j, Material& m) {
    const Json& pbr = child(j, "pbrMetallicRoughness");
    const Vec3d colour = conducts_ ? conductor(j["extras"], m) : triple(pbr, "baseColorFactor", 1);
    if (max_component(colour) > 1) tell(clamped);
    m.base_color = Rgb(min(colour, Vec3d(1)));
    const std::string mode = j.value("alphaMode", "OPAQUE");
    if (mode == "MASK") m.alpha_mode = Material::Alpha::mask;
    if (mode == "BLEND") m.alpha_mode = Material::Alpha::blend;
    const bool opaque = mode == "OPAQUE";
    m.alpha_cutoff = number(j, "alphaCutoff", 0.5f);
    if (!opaque && pbr.contains("baseColorFactor"))
      m.alpha = static_cast<float>(std::min(pbr["baseColorFactor"][3].get<double>(), 1.0));
    if (is_black(m.base_color) && opaque) return;
    texture(pbr, "baseColorTexture", true, MAP_BASE, [&](const std::array<float, 4>& v) {
      multiply(m, MAP_BASE, v);
      if (!opaque) m.alpha *= v[3];
    });
  }

  void read_lobes(const Json& j, Material& m) {
    const Json& pbr = child(j, "pbrMetallicRoughness");
    const Json& extensions = child(j, "extensions");
    m.metallic = conducts_ ? 1 : number(pbr, "metallicFactor", 1);
    m.roughness = number(pbr, "roughnessFactor", 1);
    // A metal has no dielectric reflection and no transmission.
    const bool dielectric = m.metallic < 1 || pbr.contains("metallicRoughnessTexture");
    m.ior = number(child(extensions, "KHR_materials_ior"), "ior", 1.5f);
    if (m.ior == 0) m.ior = kInfiniteIor;
    const Json& specular = child(extensions, "KHR_materials_specular");
    m.specular = m.ior == 1 ? 0 : number(specular, "specularFactor", 1);
    m.specular_color = Rgb(min(triple(specular, "specularColorFactor", 1), Vec3d(1e6)));
    if (m.specular > 0 && dielectric) texture(specular, "specularTexture", false, MAP_SPECULAR, m);
    glossiness_ = 1;
    if (m.specular > 0 && dielectric && (glossy_ || !is_black(m.specular_color)))
      texture(specular, "specularColorTexture", true, MAP_SPECULAR_COLOR, [&](const auto& v) {
        multiply(m, MAP_SPECULAR_COLOR, v);
        glossiness_ = v[3];
      });
    if (const Json& t = child(extensions, "KHR_materials_transmission"); dielectric) {
      m.transmission = number(t, "transmissionFactor", 0);
      if (m.transmission > 0) texture(t, "transmissionTexture", false, MAP_TRANSMISSION, m);
    }
    const bool glossy = m.metallic > 0 || m.specular > 0 || m.transmission > 0;
    if (m.metallic > 0 || (glossy && m.roughness > 0))
      texture(pbr, "metallicRoughnessTexture", false, MAP_METALLIC_ROUGHNESS, m);
    if (m.metallic >= 1 && !maps_[MAP_METALLIC_ROUGHNESS]) {
      m.transmission = 0;
      for (const uint32_t map : {MAP_SPECULAR, MAP_SPECULAR_COLOR, MAP_TRANSMISSION})
        maps_[map].reset();
    }
    if (m.transmission > 0) read_volume(child(extensions, "KHR_materials_volume"), m);
  }

  /// Absorption per metre: attenuationColor is the transmittance over attenuationDistance.
  void read_volume(const Json& volume, Material& m) {
    m.solid = number(volume, "thicknessFactor", 0) > 0;
    if (!m.solid || !volume.contains("attenuationDistance")) return;
    const double distance = volume["attenuationDistance"].get<double>();
    const Vec3d colour = triple(volume, "attenuationColor", 1);
    for (int c = 0; c < 3; ++c)
      m.absorption[c] = static_cast<float>(
          std::clamp(colour[c] < 1 ? -std::log(colour[c]) / distance : 0.0, 0.0, 1e30));
  }

  void read_coat(const Json& j, Material& m) {
    m.coat = number(j, "clearcoatFactor", 0);
    if (m.coat > 0) texture(j, "clearcoatTexture", false, MAP_COAT, m);
    if (m.coat <= 0) return;
    m.coat_roughness = number(j, "clearcoatRoughnessFactor", 0);
    if (m.coat_roughness > 0) texture(j, "clearcoatRoughnessTexture", false, MAP_COAT_ROUGHNESS, m);
    maps_[MAP_COAT_NORMAL] = bends(j, "clearcoatNormalTexture", m.coat_normal_scale);
  }

  void read_sheen(const Json& j, Material& m) {
    m.sheen_color = Rgb(min(triple(j, "sheenColorFactor", 0), Vec3d(1)));
    if (m.sheened()) texture(j, "sheenColorTexture", true, MAP_SHEEN_COLOR, m);
    if (!m.sheened()) return;
    m.sheen_roughness = number(j, "sheenRoughnessFactor", 0);
    if (m.sheen_roughness > 0) texture(j, "sheenRoughnessTexture", false, MAP_SHEEN_ROUGHNESS, m);
  }

  void read_normal_map(const Json& j, Material& m) {
    const bool black = is_black(m.base_color) && m.specular <= 0 && m.metallic <= 0;
    if (black && m.transmission <= 0 && !m.sheened()) return;
    maps_[MAP_NORMAL] = bends(j, "normalTexture", m.normal_scale);
  }

  /// The normal map called `name`, unless it is flat.
  std::optional<Texture> bends(const Json& parent, const char* name, float& scale) {
    const auto info = parent.find(name);
    if (info == parent.end()) return {};
    scale = static_cast<float>(std::clamp(info->value("scale", 1.0), -1e6, 1e6));
    if (scale == 0) return {};
    TextureReader::Fault fault{};
    const std::optional<Texture> t = textures_.read(*info, false, fault);
    note(name, fault);
    // Bytes cannot represent "straight up" exactly: both 127 and 128 mean it.
    const auto level = [](uint8_t v) { return v == 127 || v == 128; };
    if (t && t->uniform && level(t->encoded[0]) && level(t->encoded[1]) && t->encoded[2] > 128)
      return {};
    return t;
  }

  void note_left_out(const Json& extensions, size_t index, const Material& m) {
    const std::string name =
        m.name.empty() ? place("materials", index) : "\"" + shown(m.name, 60) + "\"";
    for (const auto& [extension, value] : extensions.items()) {
      const auto known =
          std::find_if(std::begin(kLeftOut), std::end(kLeftOut),
                       [&e = extension](const LeftOut& l) { return e == l.extension; });
      if (known != std::end(kLeftOut)) {
        if (more_than_0(value, known->factor)) left_out_[known->words].push_back(name);
      } else if (extension.find("_materials_") != extension.npos && !is_supported(extension)) {
        unknown_[shown(extension, 60)].push_back(name);
      }
    }
  }

  /// Reports ignored features; the number of different extensions in a file is unbounded.
  void tell_left_out() {
    constexpr size_t kMost = 8;
    const auto tell = [&](const std::string& words, const std::vector<std::string>& names) {
      scene_.warnings.push_back(fmt::format("{} is left out: {}", words, listed(names)));
    };
    size_t told = 0;
    for (const auto& [words, names] : unknown_)
      if (told++ < kMost) tell(words, names);
    if (told > kMost)
      scene_.warnings.push_back(counted(told - kMost, "more extension", "of materials is left out",
                                        "of materials are left out"));
    for (const auto& [words, names] : left_out_) tell(words, names);
  }

  /// Radiance [W/m2/sr]: emissiveFactor x emissiveStrength.
  void read_emission(const Json& j, size_t index, Material& m) {
    const Json& extension = child(child(j, "extensions"), "KHR_materials_emissive_strength");
    Vec3d radiance = triple(j, "emissiveFactor", 0) * extension.value("emissiveStrength", 1.0);
    if (max_component(radiance) > 0)
      texture(j, "emissiveTexture", true, MAP_EMISSION, [&](const std::array<float, 4>& v) {
        radiance = radiance * Vec3d(v[0], v[1], v[2]);
      });
    if (!(max_component(radiance) <= kBrightestEmission))
      d_.fail(
          place("materials", index),
          fmt::format("emits a radiance of {}, expected at most 1e30", max_component(radiance)));
    if (max_component(radiance) > 0 && max_component(radiance) < kFaintestEmission) {
      tell(faint);
      maps_[MAP_EMISSION].reset();
      return;
    }
    m.emission = Rgb(radiance);
  }

  void make_unlit(Material& m) {
    tell(unlit);
    m.emission = m.base_color;
    m.base_color = Rgb(0.0f);
    if (base() && !is_black(m.emission)) maps_[MAP_EMISSION] = base();
    if (m.alpha_mode == Material::Alpha::opaque) base().reset();
  }

  void keep_maps(Material& m, MaterialUse& use) {
    use.least_alpha = m.alpha * (base() ? base()->least_alpha : 1);
    // An opaque texture cuts no holes; if the colour is black, it is not needed.
    if (base() && is_black(m.base_color) && base()->least_alpha >= 1) base().reset();
    for (size_t k = 0; k < maps_.size(); ++k) {
      if (!maps_[k]) continue;
      m.maps[k] = textures_.keep(*maps_[k]);
      use.uv[m.maps[k].uv_set] = true;
      maps_[k].reset();
    }
    use.tangents = m.maps[MAP_NORMAL] || m.maps[MAP_COAT_NORMAL];
    use.alpha = m.alpha_mode != Material::Alpha::opaque;
    use.colours = !is_black(m.base_color) || use.alpha;
  }

  std::optional<Texture>& base() { return maps_[MAP_BASE]; }

  const Document& d_;
  Scene& scene_;
  TextureReader textures_;
  std::array<std::optional<Texture>, MAPS_OF_MATERIAL> maps_;  // of the current material
  std::string called_;                                         // name of the current material
  std::vector<std::string> undecodable_;                       // textures, with descriptions
  std::map<std::string, std::vector<std::string>> left_out_, unknown_;  // names of materials
  bool conducts_ = false;  // the current one has a complex index of refraction
  bool glossy_ = false;    // the current one is specular-glossiness
  float glossiness_ = 1;   // alpha of a uniform specular colour texture
  std::array<size_t, kinds> count_{};
  std::array<bool, kinds> told_{};  // for the current material
};

}  // namespace

std::vector<MaterialUse> read_materials(const Document& d, const std::vector<bool>& used,
                                        Scene& scene) {
  Reader reader(d, scene);
  std::vector<MaterialUse> uses(used.size());
  for (size_t i = 0; i < used.size(); ++i) {
    Material& m = scene.materials.emplace_back();
    if (used[i])
      m = reader.read(i, uses[i]);
    else
      m.name = d.json["materials"][i].value("name", "");
  }
  reader.finish();
  return uses;
}

void finish_material(const MaterialUse& use, Material& m) {
  const float least = use.least_alpha * use.least_vertex_alpha;
  const bool covers = m.alpha_mode == Material::Alpha::mask ? least >= m.alpha_cutoff : least >= 1;
  if (covers) m.alpha_mode = Material::Alpha::opaque;
  if (m.alpha_mode == Material::Alpha::opaque) m.alpha = 1;
  const bool lobes =
      m.metallic > 0 || m.specular > 0 || m.transmission > 0 || m.coat > 0 || m.sheened();
  // Maps of other lobes occur only together with their lobes.
  const bool maps = m.maps[MAP_BASE] || m.maps[MAP_EMISSION] || m.maps[MAP_NORMAL];
  m.coloured = use.coloured;
  m.plain = !lobes && !maps && !use.coloured && m.alpha_mode == Material::Alpha::opaque;
}

std::vector<std::string> needs_of(const Scene& scene) {
  const auto any = [&](const auto& wants) {
    return std::any_of(scene.materials.begin(), scene.materials.end(), wants);
  };
  std::vector<std::string> out;
  const auto say = [&](bool needed, const char* word) {
    if (needed) out.push_back(word);
  };
  say(!scene.images.empty(), "textures");
  say(!scene.smooth.empty(), "shading normals");
  say(any([](const Material& m) { return m.metallic > 0 || m.specular > 0; }), "specular");
  say(any([](const Material& m) { return m.transmission > 0; }), "transmission");
  say(any([](const Material& m) { return m.coat > 0; }), "clear coat");
  say(any([](const Material& m) { return m.sheened(); }), "sheen");
  say(any([](const Material& m) { return m.alpha_mode != Material::Alpha::opaque; }), "alpha");
  say(!scene.colours.empty(), "vertex colours");
  say(!scene.lights.empty(), "punctual lights");
  say(any([](const Material& m) { return max_component(m.absorption) > 0; }), "absorption");
  say(any([](const Material& m) { return m.maps[MAP_NORMAL] || m.maps[MAP_COAT_NORMAL]; }),
      "normal maps");
  say(any([](const Material& m) { return bool(m.maps[MAP_EMISSION]); }), "textured emission");
  return out;
}

}  // namespace tdpt::gltf
