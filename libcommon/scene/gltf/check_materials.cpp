// Checks materials and textures: see gltf/checker.h.
#include <fmt/format.h>

#include "libcommon/scene/gltf/checker.h"
#include "libcommon/scene/gltf/textures.h"

namespace tdpt::gltf {
namespace {

void check_texture(Checker& c, Json& parent, const std::string& at, const char* name) {
  c.check(parent, at, {object(name)});
  if (!parent.contains(name)) return;
  Json& t = parent[name];
  const std::string here = at + "." + name;
  c.check(t, here, {index("index", "textures", true), integer("texCoord"), number("scale")});
  c.check_extension(
      t, here, "KHR_texture_transform",
      {numbers("offset", 2), number("rotation"), numbers("scale", 2), integer("texCoord")});
}

void check_one_of(Checker& c, Json& parent, const std::string& at, const char* name,
                  std::initializer_list<int> values, const std::string& expected) {
  c.check(parent, at, {integer(name)});
  if (!parent.contains(name)) return;
  for (int v : values)
    if (parent[name] == v) return;
  c.fail(at + "." + name, parent[name], expected);
}

void check_extensions_of_material(Checker& c, Json& e, const std::string& at) {
  for (const auto& [name, value] : e.items())
    if (!value.is_object()) c.fail(at + "." + name.substr(0, 60), value, "an object");
  const auto check = [&](const char* name, std::initializer_list<Field> fields,
                         std::initializer_list<const char*> textures = {}) {
    if (!e.contains(name)) return;
    const std::string here = at + "." + name;
    c.check(e[name], here, fields);
    for (const char* texture : textures) check_texture(c, e[name], here, texture);
  };
  check("KHR_materials_emissive_strength", {number("emissiveStrength", false, 0)});
  check("KHR_materials_specular",
        {number("specularFactor", false, 0, 1), numbers("specularColorFactor", 3, 0)},
        {"specularTexture", "specularColorTexture"});
  check("KHR_materials_pbrSpecularGlossiness",
        {numbers("diffuseFactor", 4, 0), numbers("specularFactor", 3, 0),
         number("glossinessFactor", false, 0, 1)},
        {"diffuseTexture", "specularGlossinessTexture"});
  check("KHR_materials_transmission", {number("transmissionFactor", false, 0, 1)},
        {"transmissionTexture"});
  check("KHR_materials_ior", {number("ior", false, 0)});
  check("KHR_materials_clearcoat",
        {number("clearcoatFactor", false, 0, 1), number("clearcoatRoughnessFactor", false, 0, 1)},
        {"clearcoatTexture", "clearcoatRoughnessTexture", "clearcoatNormalTexture"});
  check("KHR_materials_sheen",
        {numbers("sheenColorFactor", 3, 0), number("sheenRoughnessFactor", false, 0, 1)},
        {"sheenColorTexture", "sheenRoughnessTexture"});
  check("KHR_materials_iridescence", {number("iridescenceFactor")});
  check("KHR_materials_anisotropy", {number("anisotropyStrength")});
  check("KHR_materials_dispersion", {number("dispersion")});
  check("KHR_materials_diffuse_transmission", {number("diffuseTransmissionFactor")});
  check("KHR_materials_volume_scatter", {numbers("multiscatterColor", 3)});
  check("KHR_materials_volume",
        {number("thicknessFactor", false, 0), number("attenuationDistance", false, 0),
         numbers("attenuationColor", 3, 0, 1)});
  if (e.contains("KHR_materials_ior") && e["KHR_materials_ior"].contains("ior")) {
    const Json& ior = e["KHR_materials_ior"]["ior"];
    const double n = ior.get<double>();
    if (n != 0 && !(n >= 1 && n <= 1e6))
      c.fail(at + ".KHR_materials_ior.ior", ior, "0 or a number from 1 to 1e6");
  }
  if (e.contains("KHR_materials_volume") &&
      e["KHR_materials_volume"].contains("attenuationDistance")) {
    const Json& distance = e["KHR_materials_volume"]["attenuationDistance"];
    if (!(distance.get<double>() > 0))
      c.fail(at + ".KHR_materials_volume.attenuationDistance", distance, "more than 0");
  }
}

void check_alpha(Checker& c, Json& m, const std::string& at) {
  c.check(m, at, {text("alphaMode"), number("alphaCutoff", false, 0)});
  const auto mode = m.value("alphaMode", "OPAQUE");
  if (mode != "OPAQUE" && mode != "MASK" && mode != "BLEND")
    c.fail(at + ".alphaMode", m["alphaMode"], "OPAQUE, MASK or BLEND");
}

// A complex index of refraction in the extras: both parts or neither.
void check_conductor(Checker& c, Json& m, const std::string& at) {
  if (!m.contains("extras") || !m["extras"].is_object()) return;
  Json& extras = m["extras"];
  const std::string here = at + ".extras";
  const bool eta = extras.contains("tdpt_eta"), k = extras.contains("tdpt_k");
  if (eta != k)
    c.fail_because(here, fmt::format("has {}, expected both or neither",
                                     eta ? "tdpt_eta without tdpt_k" : "tdpt_k without tdpt_eta"));
  c.check(extras, here, {numbers("tdpt_eta", 3, 1e-3, 1e3), numbers("tdpt_k", 3, 0, 1e3)});
}

void check_material(Checker& c, Json& m, const std::string& at) {
  c.check(m, at,
          {text("name"), numbers("emissiveFactor", 3, 0), boolean("doubleSided"),
           object("pbrMetallicRoughness"), object("extensions")});
  check_alpha(c, m, at);
  check_conductor(c, m, at);
  check_texture(c, m, at, "emissiveTexture");
  check_texture(c, m, at, "normalTexture");
  if (m.contains("pbrMetallicRoughness")) {
    Json& pbr = m["pbrMetallicRoughness"];
    const std::string here = at + ".pbrMetallicRoughness";
    c.check(pbr, here,
            {numbers("baseColorFactor", 4, 0), number("metallicFactor", false, 0, 1),
             number("roughnessFactor", false, 0, 1)});
    check_texture(c, pbr, here, "baseColorTexture");
    check_texture(c, pbr, here, "metallicRoughnessTexture");
  }
  if (m.contains("extensions"))
    check_extensions_of_material(c, m["extensions"], at + ".extensions");
}

}  // namespace

void check_materials(Checker& c, Json& root) {
  c.each(root, "", "materials", [&](Json& m, const std::string& at) { check_material(c, m, at); });
}

void check_textures(Checker& c, Json& root) {
  c.each(root, "", "textures", [&](Json& t, const std::string& at) {
    c.check(t, at, {index("source", "images"), index("sampler", "samplers")});
    for (const char* name : kTextureFormats)
      c.check_extension(t, at, name, {index("source", "images")});
  });
  c.each(root, "", "images", [&](Json& i, const std::string& at) {
    c.check(i, at, {text("uri"), index("bufferView", "bufferViews")});
  });
  c.each(root, "", "samplers", [&](Json& s, const std::string& at) {
    check_one_of(c, s, at, "magFilter", {9728, 9729}, "9728 (nearest) or 9729 (linear)");
    for (const char* wrap : {"wrapS", "wrapT"})
      check_one_of(c, s, at, wrap, {10497, 33648, 33071},
                   "10497 (repeat), 33648 (mirrored repeat) or 33071 (clamp to edge)");
  });
}

}  // namespace tdpt::gltf
