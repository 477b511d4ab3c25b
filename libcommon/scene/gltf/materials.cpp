#include "libcommon/scene/gltf/parts.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <string_view>

#include "libcommon/base/provenance.h"
#include "libcommon/base/words.h"
#include "libcommon/scene/gltf/textures.h"
#include "libcommon/scene/texture.h"
#include "shaders/shared/path/microfacet.h"

namespace tdpt::gltf {
namespace {

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

// Specular-glossiness is read as metallic-roughness with extensions. The extension defines
//   c_diff = diffuse (1 - max specular),  F0 = specular,  F90 = 1,  alpha = (1 - glossiness)^2:
// a dielectric with an infinite index of refraction, `specular` as specular colour and c_diff as
// base colour. One texture holds specular (RGB) and glossiness (A); unless it is uniform, the
// renderer evaluates both at each point [Material::glossy_map].
constexpr const char* kGlossiness = "KHR_materials_pbrSpecularGlossiness";

// An index of refraction of 0 means an infinite one: all light is reflected.
constexpr float kInfiniteIor = 1e6f;

/// A factor as single precision.
float factor(const Value& v, double otherwise, double most = kAny) {
  return static_cast<float>(std::min(v.number(otherwise, 0, most), 1e30));
}

Vec3d triple(const Value& v, double otherwise) {
  return v.triple(Vec3d(otherwise), 0);
}

bool is_black(const Rgb& c) {
  return max_component(c) <= 0;
}

class MaterialReader {
 public:
  MaterialReader(const Document& d, Scene& scene, Notes& notes)
      : notes_(notes), textures_(d, scene) {}

  /// `used`: by a surface; else the values are read to find faults alone.
  Material read(const Value& v, size_t index, bool used, MaterialUse& use) {
    counts_ = used;
    Material m;
    m.name = v["name"].text();
    called_ = m.name.empty() ? place("materials", index) : "material \"" + shown(m.name, 40) + "\"";
    m.double_sided = v["doubleSided"].boolean(false);
    read_left_out(v);
    use.unlit = used && v.extension("KHR_materials_unlit");
    glossy_ = !use.unlit && v.extension(kGlossiness);
    conductor_ = read_conductor(v);
    read_base(v, m);
    if (use.unlit) {
      make_unlit(m);
      counts_ = false;
    }
    Material lit = m;
    read_lobes(v, lit);
    read_coat(v.extension("KHR_materials_clearcoat"), lit);
    read_sheen(v.extension("KHR_materials_sheen"), lit);
    read_normal_map(v, lit);
    read_emission(v, lit);
    if (counts_) m = lit;
    if (used) {
      keep_maps(m, use);
      return m;
    }
    Material out;
    out.name = m.name;
    return out;
  }

  /// Content of external image files, for the scene's hash.
  const std::string& external_bytes() const { return textures_.external_bytes(); }

 private:
  void note(const std::string& sentence) {
    if (counts_) notes_.add(sentence, called_);
  }

  std::optional<Texture> decode(const TextureInfo& info, bool srgb, const std::string& name) {
    std::string fault;
    std::optional<Texture> out = textures_.read(info, srgb, fault);
    if (!fault.empty())
      notes_.add("textures that are not read are left out",
                 fmt::format("{} {} ({})", called_, name, fault));
    return out;
  }

  /// Reads a texture of the current material, if there is one and it `matters`, as its map. Returns
  /// what its factors are to be multiplied by: the value of a uniform texture, which is no map.
  std::array<float, 4> texture(const Value& owner, const char* name, bool matters, uint32_t map) {
    const bool srgb = map == MAP_BASE || map == MAP_EMISSION || map == MAP_SPECULAR_COLOR ||
                      map == MAP_SHEEN_COLOR;
    const TextureInfo info = read_texture_info(owner[name]);
    if (!info || !matters || !counts_) return {1, 1, 1, 1};
    const std::optional<Texture> t = decode(info, srgb, name);
    if (t && t->image->uniform) return t->value;
    maps_[map] = t;
    return {1, 1, 1, 1};
  }
  void texture(const Value& owner, const char* name, bool matters, uint32_t map, Material& m) {
    multiply(m, map, texture(owner, name, matters, map));
  }

  /// A complex index of refraction for red, green and blue, in the extras: both parts or neither.
  struct Index {
    Vec3d eta, k;
  };
  static std::optional<Index> read_conductor(const Value& v) {
    const Value extras = v["extras"];
    if (!extras.json().is_object()) return {};
    const Value eta = extras["tdpt_eta"], k = extras["tdpt_k"];
    if (bool(eta) != bool(k))
      extras.fail_because(fmt::format("has {}, expected both or neither",
                                      eta ? "tdpt_eta without tdpt_k" : "tdpt_k without tdpt_eta"));
    if (!eta) return {};
    return Index{eta.triple({}, 1e-3, 1e3), k.triple({}, 0, 1e3)};
  }

  /// Reflectance at normal incidence; replaces the factors of colour and metal.
  static Vec3d reflectance(const Index& n, Material& m) {
    Vec3d f0;
    for (int c = 0; c < 3; ++c) {
      f0[c] = shader::conductor_reflectance(1.0, n.eta[c], n.k[c]);
      m.dip[c] = static_cast<float>(shader::conductor_dip(n.eta[c], n.k[c]));
    }
    return f0;
  }

  void read_base(const Value& v, Material& m) {
    const Value pbr = v["pbrMetallicRoughness"], glossiness = v.extension(kGlossiness);
    const std::vector<double> base = pbr["baseColorFactor"].numbers(4, 0),
                              diffuse = glossiness["diffuseFactor"].numbers(4, 0);
    std::vector<double> rgba = glossy_ ? diffuse : base;
    if (rgba.empty()) rgba = {1, 1, 1, 1};
    const Vec3d colour =
        conductor_ ? reflectance(*conductor_, m) : Vec3d(rgba[0], rgba[1], rgba[2]);
    if (max_component(colour) > 1) note("base colours above 1 are clamped to 1");
    m.base_color = Rgb(min(colour, Vec3d(1)));
    m.alpha_mode =
        static_cast<Material::Alpha>(v["alphaMode"].one_of({"OPAQUE", "MASK", "BLEND"}, 0));
    const bool opaque = m.alpha_mode == Material::Alpha::opaque;
    m.alpha_cutoff = factor(v["alphaCutoff"], 0.5);
    if (!opaque) m.alpha = static_cast<float>(std::min(rgba[3], 1.0));
    const bool matters = !is_black(m.base_color) || !opaque;
    const std::array<float, 4> texel =
        glossy_ ? texture(glossiness, "diffuseTexture", matters, MAP_BASE)
                : texture(pbr, "baseColorTexture", matters, MAP_BASE);
    multiply(m, MAP_BASE, texel);
    if (!opaque) m.alpha *= texel[3];
  }

  void read_lobes(const Value& v, Material& m) {
    const Value pbr = v["pbrMetallicRoughness"], ior = v.extension("KHR_materials_ior")["ior"],
                specular = v.extension("KHR_materials_specular"),
                transmission = v.extension("KHR_materials_transmission");
    m.metallic = factor(pbr["metallicFactor"], 1, 1);
    m.roughness = factor(pbr["roughnessFactor"], 1, 1);
    m.ior = factor(ior, 1.5);
    if (const double n = ior.number(1.5); n != 0 && !(n >= 1 && n <= 1e6))
      ior.fail("0 or a number from 1 to 1e6");
    m.specular = factor(specular["specularFactor"], 1, 1);
    m.specular_color = Rgb(min(triple(specular["specularColorFactor"], 1), Vec3d(1e6)));
    m.transmission = factor(transmission["transmissionFactor"], 0, 1);
    const Value glossiness = v.extension(kGlossiness);
    const Vec3d glossy_color = min(triple(glossiness["specularFactor"], 1), Vec3d(1e6));
    const double glossy = glossiness["glossinessFactor"].number(1, 0, 1);
    if (glossy_) {  // excludes the other extensions
      m.metallic = m.ior = m.transmission = 0;
      m.specular = 1;
      m.specular_color = Rgb(glossy_color);
      m.roughness = static_cast<float>(1 - glossy);
    }
    if (conductor_) m.metallic = 1;
    if (m.ior == 0) m.ior = kInfiniteIor;
    if (m.ior == 1) m.specular = 0;
    // A metal has no dielectric reflection and no transmission.
    const bool metal_map = !glossy_ && pbr["metallicRoughnessTexture"];
    const bool dielectric = m.metallic < 1 || metal_map;
    const bool reflects = m.specular > 0 && dielectric;
    if (!dielectric) m.transmission = 0;
    if (!glossy_) {
      texture(specular, "specularTexture", reflects, MAP_SPECULAR, m);
      texture(specular, "specularColorTexture", reflects && !is_black(m.specular_color),
              MAP_SPECULAR_COLOR, m);
    }
    texture(transmission, "transmissionTexture", m.transmission > 0, MAP_TRANSMISSION, m);
    const bool shines = m.metallic > 0 || m.specular > 0 || m.transmission > 0;
    texture(pbr, "metallicRoughnessTexture",
            metal_map && (m.metallic > 0 || (shines && m.roughness > 0)), MAP_METALLIC_ROUGHNESS,
            m);
    if (m.metallic >= 1 && !maps_[MAP_METALLIC_ROUGHNESS]) {
      m.transmission = 0;
      for (const uint32_t map : {MAP_SPECULAR, MAP_SPECULAR_COLOR, MAP_TRANSMISSION})
        maps_[map].reset();
    }
    read_volume(v.extension("KHR_materials_volume"), m);
    if (glossy_) read_glossiness_map(glossiness, reflects, m);
  }

  /// Applies the texture's glossiness and the factor (1 - max specular): at once where the texture
  /// is uniform, else at each point.
  void read_glossiness_map(const Value& glossiness, bool reflects, Material& m) {
    const std::array<float, 4> texel =
        texture(glossiness, "specularGlossinessTexture", reflects, MAP_SPECULAR_COLOR);
    multiply(m, MAP_SPECULAR_COLOR, texel);
    m.glossy_map = maps_[MAP_SPECULAR_COLOR].has_value();
    if (m.glossy_map) return;
    m.roughness = 1 - (1 - m.roughness) * texel[3];
    m.base_color = m.base_color * std::max(1 - max_component(m.specular_color), 0.0f);
  }

  /// Absorption per metre: attenuationColor is the transmittance over attenuationDistance.
  static void read_volume(const Value& v, Material& m) {
    const bool solid = v["thicknessFactor"].number(0, 0) > 0;
    const double distance = v["attenuationDistance"].number_above_0(kAny);
    const Vec3d colour = v["attenuationColor"].triple(Vec3d(1), 0, 1);
    if (m.transmission <= 0) return;
    m.solid = solid;
    if (!m.solid || !v["attenuationDistance"]) return;
    for (int c = 0; c < 3; ++c)
      m.absorption[c] = static_cast<float>(
          std::clamp(colour[c] < 1 ? -std::log(colour[c]) / distance : 0.0, 0.0, 1e30));
  }

  void read_coat(const Value& v, Material& m) {
    m.coat = factor(v["clearcoatFactor"], 0, 1);
    const float roughness = factor(v["clearcoatRoughnessFactor"], 0, 1);
    texture(v, "clearcoatTexture", m.coat > 0, MAP_COAT, m);
    if (m.coat > 0) m.coat_roughness = roughness;
    texture(v, "clearcoatRoughnessTexture", m.coat > 0 && roughness > 0, MAP_COAT_ROUGHNESS, m);
    normal_map(v, "clearcoatNormalTexture", m.coat > 0, MAP_COAT_NORMAL, m.coat_normal_scale);
  }

  void read_sheen(const Value& v, Material& m) {
    m.sheen_color = Rgb(min(triple(v["sheenColorFactor"], 0), Vec3d(1)));
    const float roughness = factor(v["sheenRoughnessFactor"], 0, 1);
    texture(v, "sheenColorTexture", m.sheened(), MAP_SHEEN_COLOR, m);
    if (m.sheened()) m.sheen_roughness = roughness;
    texture(v, "sheenRoughnessTexture", m.sheened() && roughness > 0, MAP_SHEEN_ROUGHNESS, m);
  }

  void read_normal_map(const Value& v, Material& m) {
    const bool black = is_black(m.base_color) && m.specular <= 0 && m.metallic <= 0;
    normal_map(v, "normalTexture", !black || m.transmission > 0 || m.sheened(), MAP_NORMAL,
               m.normal_scale);
  }

  /// A normal map, unless it is flat.
  void normal_map(const Value& owner, const char* name, bool matters, uint32_t map, float& scale) {
    const TextureInfo info = read_texture_info(owner[name]);
    if (!info || !matters || !counts_) return;
    scale = static_cast<float>(std::clamp(info.scale, -1e6, 1e6));
    if (scale == 0) return;
    const std::optional<Texture> t = decode(info, false, name);
    // Bytes cannot represent "straight up" exactly: both 127 and 128 mean it.
    const auto level = [](uint8_t b) { return b == 127 || b == 128; };
    const bool flat = t && t->image->uniform && level(t->image->first[0]) &&
                      level(t->image->first[1]) && t->image->first[2] > 128;
    if (!flat) maps_[map] = t;
  }

  void read_left_out(const Value& v) {
    for (const auto& [name, value] : v["extensions"].members()) {
      if (!value.json().is_object()) value.fail("an object");
      const auto known = std::find_if(std::begin(kLeftOut), std::end(kLeftOut),
                                      [&n = name](const LeftOut& l) { return n == l.extension; });
      if (known != std::end(kLeftOut)) {
        const Value factor = value[known->factor];
        const double most = std::string_view(known->factor).ends_with("Color")
                                ? max_component(factor.triple({}))
                                : factor.number(0);
        if (most > 0) note(std::string(known->words) + " is left out");
      } else if (name.find("_materials_") != name.npos && !is_supported(name)) {
        note(shown(name, 60) + " is left out");
      }
    }
  }

  /// Radiance [W/m2/sr]: emissiveFactor x emissiveStrength.
  void read_emission(const Value& v, Material& m) {
    const double strength =
        v.extension("KHR_materials_emissive_strength")["emissiveStrength"].number(1, 0);
    Vec3d radiance = triple(v["emissiveFactor"], 0) * strength;
    const auto texel = texture(v, "emissiveTexture", max_component(radiance) > 0, MAP_EMISSION);
    radiance = radiance * Vec3d(texel[0], texel[1], texel[2]);
    if (!counts_) return;
    if (!(max_component(radiance) <= kBrightestEmission))
      v.fail_because(
          fmt::format("emits a radiance of {}, expected at most 1e30", max_component(radiance)));
    if (max_component(radiance) > 0 && max_component(radiance) < kFaintestEmission) {
      note(kFaint);
      maps_[MAP_EMISSION].reset();
      return;
    }
    m.emission = Rgb(radiance);
  }

  void make_unlit(Material& m) {
    note("unlit materials are taken as black, emitting the base colour");
    m.emission = m.base_color;
    m.base_color = Rgb(0.0f);
    if (base() && !is_black(m.emission)) maps_[MAP_EMISSION] = base();
    if (m.alpha_mode == Material::Alpha::opaque) base().reset();
  }

  void keep_maps(Material& m, MaterialUse& use) {
    const float least = base() ? linear_of_byte()[base()->image->least_alpha] : 1;
    use.least_alpha = m.alpha * least;
    // An opaque texture cuts no holes; if the colour is black, it is not needed.
    if (is_black(m.base_color) && least >= 1) base().reset();
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

  Notes& notes_;
  TextureReader textures_;
  std::array<std::optional<Texture>, MAPS_OF_MATERIAL> maps_;  // of the current material
  std::string called_;                                         // name of the current material
  std::optional<Index> conductor_;                             // of the current one
  bool glossy_ = false;  // the current one is specular-glossiness
  bool counts_ = false;  // what is read of it matters
};

}  // namespace

std::vector<MaterialUse> read_materials(const Document& d, const std::vector<bool>& used,
                                        Scene& scene, Notes& notes) {
  MaterialReader reader(d, scene, notes);
  std::vector<MaterialUse> uses(used.size());
  const std::vector<Value> all = d.root()["materials"].items();
  for (size_t i = 0; i < used.size(); ++i)
    scene.materials.push_back(reader.read(all[i], i, used[i], uses[i]));
  if (!reader.external_bytes().empty())
    scene.hash = content_hash(scene.hash + reader.external_bytes());
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

}  // namespace tdpt::gltf
