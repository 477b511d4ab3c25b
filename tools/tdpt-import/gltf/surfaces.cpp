// Writes textures and materials.
#include "tools/tdpt-import/gltf/gltf.h"

#include <algorithm>
#include <cmath>

#include "libcommon/base/provenance.h"
#include "libcommon/base/words.h"
#include "libcommon/formats/png.h"
#include "tools/tdpt-import/materials.h"

namespace tdpt::foreign {
namespace {

// ---- Textures ----

uint8_t byte_of(float v) {
  return static_cast<uint8_t>(std::lround(255 * std::clamp(v, 0.0f, 1.0f)));
}

uint8_t coded_of(float linear) {
  const float v = std::clamp(linear, 0.0f, 1.0f);
  return byte_of(v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f);
}

// The linear colour of a texel.
Rgb colour_at(const Texels& t, const Texture& how, size_t i) {
  const Rgb& c = t.rgb[i];
  return t.is_8bit && how.srgb ? linear_of(c) : c;
}

float number_at(const Texels& t, const Texture& how, size_t i) {
  if (how.alpha && !t.alpha.empty()) return t.alpha[i];
  const Rgb c = colour_at(t, how, i);
  return how.luminance ? luminance(c) : (c.x + c.y + c.z) / 3;
}

// The index of the texel at image coordinates (u, v); the image repeats.
size_t nearest(const Texels& t, double u, double v) {
  const auto cell = [](double x, int size) {
    const double f = (x - std::floor(x)) * size;
    return static_cast<size_t>(std::clamp(f, 0.0, size - 1.0));
  };
  return cell(v, t.height) * static_cast<size_t>(t.width) + cell(u, t.width);
}

// Converts image coordinates of one texture to those of another on the same mesh.
std::array<double, 2> in_other(const Texture& from, double u, double v, const Texture& to) {
  const auto& m = from.map;
  const double det = m[0] * m[4] - m[1] * m[3];
  const double x = u - m[2], y = v - m[5];
  const double mu = det != 0 ? (m[4] * x - m[1] * y) / det : 0;
  const double mv = det != 0 ? (m[0] * y - m[3] * x) / det : 0;
  const auto& n = to.map;
  return {n[0] * mu + n[1] * mv + n[2], n[3] * mu + n[4] * mv + n[5]};
}

// A picture of the four channels of `at(x, y)`, averaged over square boxes so that no side exceeds
// `longest`. `coded`: its colours are written in sRGB.
template <class At>
std::string png_of(int width, int height, int longest, bool coded, bool with_alpha, const At& at) {
  const int step = longest > 0 ? std::max(1, (std::max(width, height) + longest - 1) / longest) : 1;
  const int columns = std::max(1, width / step), rows = std::max(1, height / step);
  std::vector<uint8_t> bytes;
  bytes.reserve(static_cast<size_t>(columns) * static_cast<size_t>(rows) * 4);
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      std::array<float, 4> sum{};
      int n = 0;
      for (int j = y * step; j < std::min(height, (y + 1) * step); ++j)
        for (int i = x * step; i < std::min(width, (x + 1) * step); ++i, ++n) {
          const std::array<float, 4> p = at(i, j);
          for (size_t c = 0; c < 4; ++c) sum[c] += p[c];
        }
      for (float& s : sum) s /= static_cast<float>(n);
      for (size_t c = 0; c < 3; ++c) bytes.push_back(coded ? coded_of(sum[c]) : byte_of(sum[c]));
      if (with_alpha) bytes.push_back(byte_of(sum[3]));
    }
  return png_of_rgb8(columns, rows, bytes);
}

bool is_png(const std::string& bytes) {
  return bytes.starts_with("\x89PNG");
}
bool is_jpeg(const std::string& bytes) {
  return bytes.starts_with("\xff\xd8\xff");
}

const Texels* texels_of(GltfFile& f, const Texture& texture) {
  const auto [it, is_new] = f.decoded.try_emplace(texture.image);
  Texels& t = it->second;
  if (is_new) {
    try {
      t = decode(f.scene.images[texture.image], f.source);
    } catch (const InputError& e) {
      f.lose(std::string("a picture is left out: ") + e.what());
    }
    bool is_mended = false;
    for (Rgb& c : t.rgb)
      if (!is_finite(c) || !(max_component(c) <= 1e30f)) c = Rgb(0), is_mended = true;
    if (is_mended) f.lose("texels that are not finite or above 1e30 become 0");
  }
  return t.rgb.empty() ? nullptr : &t;
}

// KHR_texture_transform of a texture; empty for the identity.
GltfJson texture_transform(GltfFile& f, const Texture& texture) {
  const auto& m = texture.map;
  double r = 0, su = m[0], sv = m[4];
  if (m[1] != 0 || m[3] != 0) {
    r = std::atan2(-m[3], m[0]);
    su = std::hypot(m[0], m[3]);
    sv = m[1] * std::sin(r) + m[4] * std::cos(r);
    const double off = std::hypot(m[1] - sv * std::sin(r), m[4] - sv * std::cos(r));
    if (off > 1e-5 * std::hypot(m[1], m[4]))
      f.lose("texture coordinates that shear are not sheared");
  }
  GltfJson t = GltfJson::object();
  if (m[2] != 0 || m[5] != 0) t["offset"] = {m[2], m[5]};
  if (r != 0) t["rotation"] = r;
  if (su != 1 || sv != 1) t["scale"] = {su, sv};
  return t;
}

// A textureInfo of glTF for a file of these bytes.
GltfJson texture_info(GltfFile& f, const Texture& texture, const std::string& bytes) {
  const auto [image, is_new] = f.images.try_emplace(content_hash(bytes), f.images.size());
  if (is_new) {
    f.glb.add("images", {{"name", shown(f.scene.images[texture.image].name, 200)},
                         {"mimeType", is_jpeg(bytes) ? "image/jpeg" : "image/png"}});
    const size_t view = f.glb.add_bytes(bytes);
    f.glb.root["images"].back()["bufferView"] = view;
  }
  GltfJson t = {{"source", image->second}};
  GltfJson sampler = GltfJson::object();
  if (texture.nearest) sampler["magFilter"] = 9728, sampler["minFilter"] = 9728;
  for (const auto& [key, wrap] : {std::pair{"wrapS", texture.wrap_u}, {"wrapT", texture.wrap_v}})
    if (wrap != Texture::Wrap::repeat) sampler[key] = wrap == Texture::Wrap::mirror ? 33648 : 33071;
  if (!sampler.empty()) t["sampler"] = f.index_of("samplers", sampler);
  GltfJson out = {{"index", f.index_of("textures", t)}};
  f.is_textured = true;
  if (GltfJson map = texture_transform(f, texture); !map.empty())
    f.extension(out, "KHR_texture_transform") = std::move(map);
  return out;
}

// The same for the texture's own file; null if it cannot be used as it is.
GltfJson unchanged_texture(GltfFile& f, const Texture& texture) {
  const std::string& bytes = f.scene.images[texture.image].bytes;
  const Texels* t = is_png(bytes) || is_jpeg(bytes) ? texels_of(f, texture) : nullptr;
  const int longest = f.how.longest_texture;
  if (!t || (longest > 0 && std::max(t->width, t->height) > longest)) return nullptr;
  return texture_info(f, texture, plain_file(bytes));
}

float largest_component(GltfFile& f, const Colour& colour) {
  if (!colour.texture) return 1;
  const Texels* t = texels_of(f, *colour.texture);
  float most = 0;
  for (size_t i = 0; t && i < t->rgb.size(); ++i) {
    const Rgb c = colour_at(*t, *colour.texture, i);
    most = std::max(most, max_component(colour.curve ? colour.curve(c) : c));
  }
  return most;
}

// Each of these returns a textureInfo of glTF, null without a texture. Base colour or emission has
// the opacity in alpha if its texture is given; texels are divided by `scale`.
GltfJson colour_texture(GltfFile& f, const Colour& colour, const Number* opacity, float scale = 1) {
  const Texture* cut = opacity && opacity->texture ? &*opacity->texture : nullptr;
  if (!colour.texture && !cut) return nullptr;
  const Texture& lead = colour.texture ? *colour.texture : *cut;
  if (colour.texture && !cut && !colour.curve && scale == 1 && lead.srgb)
    if (GltfJson file = unchanged_texture(f, lead); !file.is_null()) return file;
  const Texels* t = texels_of(f, lead);
  const Texels* holes = cut ? texels_of(f, *cut) : nullptr;
  if (!t || (cut && !holes)) return nullptr;
  bool above_1 = false;
  const auto at = [&](int x, int y) -> std::array<float, 4> {
    const size_t i = t->index(x, y);
    Rgb c(1);
    if (colour.texture) c = colour_at(*t, lead, i);
    if (colour.texture && colour.curve) c = colour.curve(c);
    above_1 |= max_component(c) > 1.0001f * scale;
    float alpha = 1;
    if (cut) {
      const auto [u, v] = in_other(lead, (x + 0.5) / t->width, (y + 0.5) / t->height, *cut);
      alpha = number_at(*holes, *cut, nearest(*holes, u, v));
      if (opacity->curve) alpha = opacity->curve(alpha);
    }
    return {c.x / scale, c.y / scale, c.z / scale, alpha};
  };
  const std::string png = png_of(t->width, t->height, f.how.longest_texture, true, cut, at);
  if (above_1) f.lose("reflectances above 1 are taken as 1");
  return texture_info(f, lead, png);
}

GltfJson roughness_texture(GltfFile& f, const Number& roughness) {
  if (!roughness.texture) return nullptr;
  const Texels* t = texels_of(f, *roughness.texture);
  if (!t) return nullptr;
  const auto at = [&](int x, int y) -> std::array<float, 4> {
    const size_t i = t->index(x, y);
    const float r = number_at(*t, *roughness.texture, i);
    return {1, roughness.curve ? roughness.curve(r) : r, 1, 1};
  };
  return texture_info(f, *roughness.texture,
                      png_of(t->width, t->height, f.how.longest_texture, false, false, at));
}

GltfJson normal_texture(GltfFile& f, const Texture& texture) {
  if (!texture.green_down)
    if (GltfJson file = unchanged_texture(f, texture); !file.is_null()) return file;
  const Texels* t = texels_of(f, texture);
  if (!t) return nullptr;
  const auto at = [&](int x, int y) -> std::array<float, 4> {
    const Rgb& c = t->rgb[t->index(x, y)];
    return {c.x, texture.green_down ? 1 - c.y : c.y, c.z, 1};
  };
  return texture_info(f, texture,
                      png_of(t->width, t->height, f.how.longest_texture, false, false, at));
}

// ---- Materials ----

bool is_white(const Rgb& c) {
  return c.x == 1 && c.y == 1 && c.z == 1;
}
GltfJson three(const Rgb& c) {
  return {c.x, c.y, c.z};
}

void put_texture(GltfJson& out, const char* key, GltfJson&& texture) {
  if (!texture.is_null()) out[key] = std::move(texture);
}

Rgb within_1(const Rgb& c) {
  return min(max(c, Rgb(0)), Rgb(1));
}

// Moves factors above 1, which glTF does not have, into the texels.
Material with_factors_within_1(Material m) {
  if (m.base.texture && max_component(m.base.factor) > 1)
    m.base = through(m.base, [](const Rgb& c) { return c; });
  for (Number* n : {&m.roughness, &m.opacity})
    if (n->texture && n->factor > 1) *n = through(*n, [](float v) { return v; });
  return m;
}

void add_layers(GltfFile& f, const Material& m, GltfJson& out) {
  if (m.metallic < 1) {
    if (m.specular != 1) f.extension(out, "KHR_materials_specular")["specularFactor"] = m.specular;
    if (m.specular > 0 && !is_white(m.specular_colour))
      f.extension(out, "KHR_materials_specular")["specularColorFactor"] = three(m.specular_colour);
    if (m.ior != 1.5f && (m.specular > 0 || m.transmission > 0))
      f.extension(out, "KHR_materials_ior")["ior"] = std::max(m.ior, 1.0f);
  }
  if (m.transmission > 0) {
    f.extension(out, "KHR_materials_transmission")["transmissionFactor"] = m.transmission;
    if (m.solid) {
      GltfJson& volume = f.extension(out, "KHR_materials_volume");
      volume["thicknessFactor"] = 1;
      if (!is_white(m.attenuation)) {
        volume["attenuationColor"] = three(within_1(m.attenuation));
        volume["attenuationDistance"] = 1;
      }
    }
  }
  if (m.coat > 0) {
    GltfJson& coat = f.extension(out, "KHR_materials_clearcoat");
    coat["clearcoatFactor"] = m.coat;
    coat["clearcoatRoughnessFactor"] = m.coat_roughness;
  }
}

void add_emission(GltfFile& f, const Emission& e, GltfJson& out) {
  // Texels up to 1 need no scale, so that their file can be used as it is.
  const float texel = largest_component(f, e.radiance), scale = texel > 1 ? texel : 1;
  const Rgb radiance = max(e.radiance.factor, Rgb(0)) * scale;
  const float strength = max_component(radiance);
  out["emissiveFactor"] = three(strength > 0 ? radiance / strength : Rgb(0));
  if (strength > 0 && strength != 1)
    f.extension(out, "KHR_materials_emissive_strength")["emissiveStrength"] = strength;
  put_texture(out, "emissiveTexture", colour_texture(f, e.radiance, nullptr, scale));
}

GltfJson material_json(GltfFile& f, const Material& m) {
  GltfJson out;
  if (!m.name.empty()) out["name"] = shown(m.name, 200);
  GltfJson& pbr = out["pbrMetallicRoughness"];
  const Rgb base = within_1(m.base.factor);
  if (max_component(m.base.factor) > 1) f.lose("reflectances above 1 are taken as 1");
  const bool see_through = m.opacity.factor < 1 || m.opacity.texture;
  pbr["baseColorFactor"] = {base.x, base.y, base.z, std::clamp(m.opacity.factor, 0.0f, 1.0f)};
  put_texture(pbr, "baseColorTexture", colour_texture(f, m.base, &m.opacity));
  pbr["metallicFactor"] = m.metallic;
  pbr["roughnessFactor"] = std::clamp(m.roughness.factor, 0.0f, 1.0f);
  put_texture(pbr, "metallicRoughnessTexture", roughness_texture(f, m.roughness));
  if (see_through) out["alphaMode"] = "BLEND";
  // The extension for volumes requires that solid glass has one side.
  if (!(m.transmission > 0 && m.solid)) out["doubleSided"] = true;
  if (m.normal) put_texture(out, "normalTexture", normal_texture(f, *m.normal));
  if (m.tinted)
    f.lose("metals and mirrors that are darkened at all angles reflect all light at grazing ones");
  if (m.bump) f.lose("bump maps are left out");
  if (m.eta_k) {
    out["extras"]["tdpt_eta"] = three((*m.eta_k)[0]);
    out["extras"]["tdpt_k"] = three((*m.eta_k)[1]);
  }
  add_layers(f, m, out);
  return out;
}

}  // namespace

std::pair<size_t, bool> material_index(GltfFile& f, size_t material,
                                       const std::optional<Emission>& emission) {
  const auto it = f.dark_surfaces.find(material);
  if (!emission && it != f.dark_surfaces.end()) return it->second;
  f.is_textured = false;
  GltfJson out = material_json(f, with_factors_within_1(f.scene.materials[material]));
  if (emission) {
    add_emission(f, *emission, out);
    if (emission->both_sides)
      out["doubleSided"] = true;
    else
      out.erase("doubleSided");
  }
  const std::pair written{f.index_of("materials", out), f.is_textured};
  if (!emission) f.dark_surfaces[material] = written;
  return written;
}

}  // namespace tdpt::foreign
