#include "tools/tdpt-import/pbrt/surface_kinds.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "tools/tdpt-import/materials.h"

namespace tdpt::foreign::pbrt {
namespace {

// Beckmann-like roughness in 0..1 to GGX alpha.
float alpha_of(float roughness, bool v4) {
  if (v4) return std::sqrt(std::max(roughness, 0.0f));
  const float x = std::log(std::max(roughness, 1e-3f));
  return 1.62142f + x * (0.819955f + x * (0.1734f + x * (0.0171201f + x * 0.000640711f)));
}

// Each of red, green and blue passed through f.
Colour through(const Colour& c, const std::function<float(float)>& f) {
  return foreign::through(c, [f](const Rgb& v) { return Rgb(f(v.x), f(v.y), f(v.z)); });
}

}  // namespace

Colour Reader::colour(const std::string& name, float absent) const {
  return textures.colour(context, list, name, Rgb(absent));
}

Number Reader::number(const std::string& name, double absent) const {
  return textures.number(context, list, name, absent);
}

Rgb Reader::flat_colour(const std::string& name, float absent) const {
  const Colour c = colour(name, absent);
  if (c.texture) lose(fmt::format("the texture of \"{}\" becomes one value", name));
  return c.factor;
}

float Reader::flat_number(const std::string& name, double absent) const {
  const Number n = number(name, absent);
  if (n.texture) lose(fmt::format("the texture of \"{}\" becomes one value", name));
  return n.factor;
}

void Reader::lose(const std::string& what) const {
  context.source.lose(list.place, fmt::format("material \"{}\": {}", kind, what));
}

Number alpha(const Reader& r, double absent, const std::string& prefix) {
  const bool remap = r.list.flag("remaproughness", true);
  const Number both = r.number(prefix + "roughness", absent);
  const auto u = r.textures.number(r.context, r.list, prefix + "uroughness");
  const auto v = r.textures.number(r.context, r.list, prefix + "vroughness");
  Number n = u ? *u : v ? *v : both;
  const auto to_alpha = [remap, v4 = r.context.v4](float x) {
    return std::clamp(remap ? alpha_of(x, v4) : x, 0.0f, 1.0f);
  };
  if (n.texture) {
    n.curve = [to_alpha, factor = n.factor, before = n.curve](float texel) {
      return to_alpha(factor * (before ? before(texel) : texel));
    };
    n.factor = 1;
  } else {
    const float first = (u ? *u : both).factor, second = (v ? *v : both).factor;
    n.factor = to_alpha(first);
    // pbrt-v3's uber takes the roughness along u for both.
    const bool is_one = first == second || (r.kind == "uber" && !v);
    if (!is_one) {
      r.lose("different roughness along u and v becomes their geometric mean");
      n.factor = std::sqrt(to_alpha(first) * to_alpha(second));
    }
  }
  return n;
}

Colour scaled(const Colour& c, float k) {
  if (k == 1) return c;
  return through(c, [k](float v) { return std::clamp(v * k, 0.0f, 1.0f); });
}

namespace {

bool is_black(const Rgb& c) {
  return max_component(c) <= 0;
}

}  // namespace

Material lobes(const Reader& r, const Colour& kd, const Rgb& ks, double ior, const Number& a) {
  if (!(ior > 0)) Source::fail(r.list.place, "the index of refraction is not above 0");
  const float most = std::clamp(max_component(ks), 0.0f, 1.0f);
  if (most <= 0) return diffuse(kd);
  const double eta = ior < 1 ? 1 / ior : ior;
  const float reflected = most * static_cast<float>(diffuse_fresnel(eta));
  Material m = plastic(scaled(kd, 1 / std::max(1 - reflected, 0.1f)), ior, a, false);
  m.specular = most;
  m.specular_colour = ks / most;
  return m;
}

Surface body(const Reader& r, double ior, const Colour& tint, const Number& a) {
  if (!(ior > 0)) Source::fail(r.list.place, "the index of refraction is not above 0");
  if (ior >= 1) return {glass(ior, tint, a, true)};
  return {glass(1 / ior, tint, a, true), true};
}

namespace {

// Conductor of `prefix` + eta and k; copper is the default.
Surface metal_of(const Reader& r, const Number& a, const std::string& prefix = "") {
  const std::array<Rgb, 2> copper = *conductor_named("Cu");
  const auto value = [&](const std::string& name, const Rgb& absent) {
    const Colour c = r.textures.colour(r.context, r.list, prefix + name, absent, Use::index);
    if (c.texture) r.lose("the texture of a metal's index becomes copper's");
    return c.texture ? absent : c.factor;
  };
  const Rgb eta = value("eta", copper[0]);
  return {conductor(eta, value("k", copper[1]), {}, a)};
}

// ---- pbrt-v3 ----

// By pbrt-v3's materials/*.cpp. Kd, Ks, Kr, Kt: reflectance of a diffuse, a glossy and a smooth
// lobe, and transmittance.

Surface matte(const Reader& r) {
  const Number sigma = r.number("sigma", 0);
  if (sigma.factor != 0 || sigma.texture)
    r.lose("the roughness \"sigma\" of the diffuse surface is left out");
  return {diffuse(r.colour("Kd", 0.5f))};
}

Surface plastic_v3(const Reader& r) {
  const Colour kd = r.colour("Kd", 0.25f);
  return {lobes(r, kd, r.flat_colour("Ks", 0.25f), 1.5, alpha(r, 0.1))};
}

double ior_v3(const Reader& r) {
  const auto eta = r.textures.number(r.context, r.list, "eta");
  const Number n = eta ? *eta : r.number("index", 1.5);
  if (n.texture) r.lose("the texture of the index of refraction becomes 1.5");
  return n.texture ? 1.5 : n.factor;
}

Surface uber(const Reader& r) {
  const Colour kd = r.colour("Kd", 0.25f);
  const Rgb ks = r.flat_colour("Ks", 0.25f), kr = r.flat_colour("Kr", 0);
  const Colour kt = r.colour("Kt", 0);
  const Number rough = alpha(r, 0.1);
  const double ior = ior_v3(r);
  if (!is_black(ks) && !is_black(kr)) r.lose("of \"Ks\" and \"Kr\" only the larger is kept");
  const bool smooth = max_component(kr) > max_component(ks);
  const Number a = smooth ? Number{0.0f, {}, {}} : rough;
  Surface s;
  if (is_black(kt.factor)) {
    s.material = lobes(r, kd, smooth ? kr : ks, ior, a);
  } else {
    s = body(r, ior, kt, smooth || is_black(ks) ? Number{0.0f, {}, {}} : a);
    if (!is_black(kd.factor)) {
      r.lose("diffuse reflection and transmission get one colour");
      const float d = luminance(kd.factor), t = luminance(kt.factor);
      s.material.transmission = t / std::max(d + t, 1e-6f);
      if (!kd.texture && !kt.texture) s.material.base.factor = min(kd.factor + kt.factor, Rgb(1));
    }
  }
  const Colour opacity = r.colour("opacity", 1);
  const Rgb o = opacity.factor;
  if (!opacity.texture && (o.x != o.y || o.y != o.z)) r.lose("coloured opacity becomes its mean");
  if (opacity.texture) {
    s.material.opacity.texture = opacity.texture;
    s.material.opacity.factor = o.x;
    if (opacity.curve)
      s.material.opacity.curve = [curve = opacity.curve](float v) { return curve(Rgb(v)).x; };
  } else {
    s.material.opacity.factor = std::clamp((o.x + o.y + o.z) / 3, 0.0f, 1.0f);
  }
  return s;
}

// Ashikhmin and Shirley's blend. Of a uniform sky, its diffuse part reflects 23/28 Kd (1 - Ks).
Surface substrate(const Reader& r) {
  const Colour kd = r.colour("Kd", 0.5f);
  const Rgb ks = r.flat_colour("Ks", 0.5f);
  const float f0 = std::clamp(max_component(ks), 0.0f, 0.98f), q = std::sqrt(f0);
  const Number a = alpha(r, 0.1);
  if (f0 <= 0) return {diffuse(scaled(kd, 23.0f / 28))};
  const double ior = (1 + q) / (1 - q);
  const float enters = 1 - static_cast<float>(diffuse_fresnel(ior));
  Material m = plastic(scaled(kd, 23.0f / 28 * (1 - f0) / std::max(enters, 0.01f)), ior, a, false);
  m.specular_colour = ks / max_component(ks);
  return {m};
}

Surface translucent(const Reader& r) {
  const Colour kd = r.colour("Kd", 0.25f);
  const Rgb ks = r.flat_colour("Ks", 0.25f), reflect = r.flat_colour("reflect", 0.5f);
  const Rgb transmit = r.flat_colour("transmit", 0.5f);
  if (!is_black(transmit)) r.lose("light that is scattered through the surface is left out");
  Colour seen = kd;
  seen.factor = kd.factor * reflect;
  return {lobes(r, seen, ks * reflect, 1.5, alpha(r, 0.1))};
}

Surface glass_v3(const Reader& r) {
  const Rgb kr = r.flat_colour("Kr", 1);
  const Colour kt = r.colour("Kt", 1);
  Surface s = body(r, ior_v3(r), kt, alpha(r, 0));
  const float most = max_component(kr);
  if (kr.x != 1 || kr.y != 1 || kr.z != 1) {
    r.lose("reflection of less than all that Fresnel's equations give also changes transmission");
    s.material.specular = std::clamp(most, 0.0f, 1.0f);
    if (most > 0) s.material.specular_colour = kr / most;
  }
  return s;
}

Surface disney(const Reader& r) {
  Surface s;
  Material& m = s.material;
  const Colour base = r.colour("color", 0.5f);
  const double ior = r.flat_number("eta", 1.5);
  if (!(ior >= 1 && ior < 100)) Source::fail(r.list.place, "the index of refraction is below 1");
  const float metallic = std::clamp(r.flat_number("metallic", 0), 0.0f, 1.0f);
  const float transmission = std::clamp(r.flat_number("spectrans", 0), 0.0f, 1.0f);
  m = burley(base, ior, r.number("roughness", 0.5), metallic, 1);
  const Number square{m.roughness.factor * m.roughness.factor, m.roughness.texture, {}};
  if (transmission == 1 && metallic == 0)  // coloured by the root at each side
    m.base = through(
        base, [](const Rgb& c) { return Rgb(std::sqrt(c.x), std::sqrt(c.y), std::sqrt(c.z)); });
  else if (transmission > 0)
    r.lose("surfaces between opaque and transparent are mixed as glTF has it");
  else if (metallic < 1 || !lost_of_rough_metal(square).empty())
    r.lose(
        "it reflects as much as in pbrt on the whole, but up to a tenth more or less by direction");
  m.transmission = transmission;
  const bool is_thin = r.list.flag("thin", false);
  m.solid = m.transmission > 0 && !is_thin;
  m.coat = std::clamp(r.flat_number("clearcoat", 0), 0.0f, 1.0f);
  const float gloss = std::clamp(r.flat_number("clearcoatgloss", 1), 0.0f, 1.0f);
  m.coat_roughness = std::sqrt(0.1f + gloss * (0.001f - 0.1f));
  const float tint = r.flat_number("speculartint", 0), y = luminance(base.factor);
  if (tint > 0 && y > 0 && !base.texture)
    m.specular_colour = Rgb(1 - tint) + base.factor * (tint / y);
  if (r.flat_number("sheen", 0) > 0) r.lose("sheen is left out");
  if (r.flat_number("anisotropic", 0) > 0) r.lose("anisotropic roughness is left out");
  if (!is_black(r.flat_colour("scatterdistance", 0))) r.lose("subsurface scattering is left out");
  if (is_thin && r.flat_number("difftrans", 1) > 0)
    r.lose("light that is scattered through the surface is left out");
  if (is_thin && r.flat_number("flatness", 0) > 0)
    r.lose("the flatness of thin surfaces is left out");
  r.list.ignore({"sheentint", "flatness", "difftrans"});  // of sheen and of thin surfaces alone
  return s;
}

Surface mirror_v3(const Reader& r) {
  return {mirror(r.colour("Kr", 0.9f))};
}
Surface metal_v3(const Reader& r) {
  return metal_of(r, alpha(r, 0.01));
}

constexpr SurfaceKind kKindsV3[] = {
    {"matte", matte},         {"plastic", plastic_v3},      {"uber", uber},
    {"substrate", substrate}, {"translucent", translucent}, {"glass", glass_v3},
    {"mirror", mirror_v3},    {"metal", metal_v3},          {"disney", disney},
};

}  // namespace

const SurfaceKind* kind_v3(const std::string& name) {
  const auto* it = std::find_if(std::begin(kKindsV3), std::end(kKindsV3),
                                [&](const SurfaceKind& k) { return name == k.name; });
  return it == std::end(kKindsV3) ? nullptr : it;
}

namespace {

// ---- pbrt-v4 ----

// By pbrt-v4's materials.cpp and bxdfs.h.

Surface diffuse_v4(const Reader& r) {
  return {diffuse(r.colour("reflectance", 0.5f))};
}

double ior_v4(const Reader& r, const std::string& name, double absent) {
  const double ior = index_of(r.context, r.list, name, absent);
  return ior == 0 ? 1 : ior;
}

void lose_in_coat(const Reader& r) {
  if (!is_black(r.flat_colour("albedo", 0))) r.lose("scattering in the coat is left out");
  if (r.list.integer("maxdepth", 10) < 10) r.lose("light of many bounces in the coat is kept");
  r.list.ignore({"nsamples", "g"});  // how it is sampled and scatters
}

Surface coateddiffuse(const Reader& r) {
  const float thickness = r.flat_number("thickness", 0.01);
  lose_in_coat(r);
  const double ior = ior_v4(r, "eta", 1.5);
  if (!(ior > 0)) Source::fail(r.list.place, "the index of refraction is not above 0");
  return {plastic_under_layer(r.colour("reflectance", 0.5f), ior, alpha(r, 0),
                              std::clamp(thickness, 0.0f, 100.0f))};
}

Surface conductor_v4(const Reader& r) {
  const Number a = alpha(r, 0);
  if (r.list.find("reflectance")) return {metal(r.colour("reflectance", 0.5f), a)};
  return metal_of(r, a);
}

Surface coatedconductor(const Reader& r) {
  const Number a = alpha(r, 0, "conductor."), coat = alpha(r, 0, "interface.");
  Surface s = r.list.find("reflectance") ? Surface{metal(r.colour("reflectance", 0.5f), a)}
                                         : metal_of(r, a, "conductor.");
  s.material.coat = 1;
  s.material.coat_roughness = std::sqrt(coat.texture ? 0.5f : coat.factor);
  if (std::abs(ior_v4(r, "interface.eta", 1.5) - 1.5) > 0.01)
    r.lose("the coat's index of refraction becomes 1.5");
  if (r.flat_number("thickness", 0.01) > 0.01f) r.lose("absorption in the coat is left out");
  lose_in_coat(r);
  r.lose("the metal's reflectance below the coat becomes that in air");
  return s;
}

Surface dielectric(const Reader& r) {
  return body(r, ior_v4(r, "eta", 1.5), {}, alpha(r, 0));
}

Surface thindielectric(const Reader& r) {
  const double ior = ior_v4(r, "eta", 1.5);
  if (!(ior > 0)) Source::fail(r.list.place, "the index of refraction is not above 0");
  return {glass(ior < 1 ? 1 / ior : ior, {}, {0.0f, {}, {}}, false)};
}

Surface diffusetransmission(const Reader& r) {
  const float scale = static_cast<float>(r.list.number("scale", 1));
  r.colour("transmittance", 0.25f);
  r.lose("light that is scattered through the surface is left out");
  return {diffuse(scaled(r.colour("reflectance", 0.25f), scale))};
}

constexpr SurfaceKind kKindsV4[] = {
    {"diffuse", diffuse_v4},
    {"coateddiffuse", coateddiffuse},
    {"conductor", conductor_v4},
    {"coatedconductor", coatedconductor},
    {"dielectric", dielectric},
    {"thindielectric", thindielectric},
    {"diffusetransmission", diffusetransmission},
};

}  // namespace

const SurfaceKind* kind_v4(const std::string& name) {
  const auto* it = std::find_if(std::begin(kKindsV4), std::end(kKindsV4),
                                [&](const SurfaceKind& k) { return name == k.name; });
  return it == std::end(kKindsV4) ? nullptr : it;
}

}  // namespace tdpt::foreign::pbrt
