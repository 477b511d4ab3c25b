// Materials of pbrt-v3 and pbrt-v4 as surfaces of glTF: by pbrt-v3's materials/*.cpp and pbrt-v4's
// materials.cpp and bxdfs.h. Kd, Ks, Kr, Kt: reflectance of a diffuse, a glossy and a smooth lobe,
// and transmittance.
#include <algorithm>
#include <array>
#include <cmath>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/materials.h"
#include "tools/tdpt-import/pbrt/pbrt.h"

namespace tdpt::foreign::pbrt {
namespace {

void lose(const Entity& e, const std::string& what) {
  e.lose("material \"{}\": {}", e.kind, what);
}

Colour colour(const Entity& e, const char* name, float absent) {
  return e.colour(name, Rgb(absent));
}

// Without the variation over the surface that glTF does not have for this.
Rgb flat_colour(const Entity& e, const char* name, float absent) {
  const Colour c = colour(e, name, absent);
  if (c.texture) lose(e, fmt::format("the texture of \"{}\" becomes one value", name));
  return c.factor;
}
float flat_number(const Entity& e, const char* name, double absent) {
  const Number n = e.varying(name, absent);
  if (n.texture) lose(e, fmt::format("the texture of \"{}\" becomes one value", name));
  return n.factor;
}

bool is_black(const Rgb& c) {
  return max_component(c) <= 0;
}

float share(float v) {
  return std::clamp(v, 0.0f, 1.0f);
}

// Beckmann-like roughness in 0..1 to GGX alpha.
float alpha_of(float roughness, bool v4) {
  if (v4) return std::sqrt(std::max(roughness, 0.0f));
  const float x = std::log(std::max(roughness, 1e-3f));
  return 1.62142f + x * (0.819955f + x * (0.1734f + x * (0.0171201f + x * 0.000640711f)));
}

// GGX alpha; `prefix` + "roughness" is the default of "uroughness" and "vroughness".
Number alpha(const Entity& e, double absent, const std::string& prefix = "") {
  const auto to_alpha = [remap = e.flag("remaproughness", true), v4 = e.context.v4](float x) {
    return share(remap ? alpha_of(x, v4) : x);
  };
  const Number both = e.varying(prefix + "roughness", absent);
  const auto u = e.varying(prefix + "uroughness"), v = e.varying(prefix + "vroughness");
  const Number n = u ? *u : v ? *v : both;
  if (n.texture) return through(n, to_alpha);
  const float first = (u ? *u : both).factor, second = (v ? *v : both).factor;
  // pbrt-v3's uber takes the roughness along u for both.
  if (first == second || (e.kind == "uber" && !v)) return {to_alpha(first), {}, {}};
  lose(e, "different roughness along u and v becomes their geometric mean");
  return {std::sqrt(to_alpha(first) * to_alpha(second)), {}, {}};
}

Colour scaled(const Colour& c, float k) {
  return k == 1 ? c : through(c, [k](float v) { return share(v * k); });
}

void require_index(const Entity& e, double ior) {
  if (!(ior > 0)) e.fail("the index of refraction is not above 0");
}

// A glossy lobe ks * Fresnel(ior) beside, not above, a Lambertian kd: of the light that enters, the
// part kd / (1 - share reflected) must come out.
Material lobes(const Entity& e, const Colour& kd, const Rgb& ks, double ior, const Number& a) {
  require_index(e, ior);
  const float most = share(max_component(ks));
  if (most <= 0) return diffuse(kd);
  const double eta = ior < 1 ? 1 / ior : ior;
  const float reflected = most * static_cast<float>(diffuse_fresnel(eta));
  Material m = plastic(scaled(kd, 1 / std::max(1 - reflected, 0.1f)), ior, a, false);
  m.specular = most;
  m.specular_colour = ks / most;
  return m;
}

// A dielectric surface between bodies.
Surface body(const Entity& e, double ior, const Colour& tint, const Number& a) {
  require_index(e, ior);
  if (ior >= 1) return {glass(ior, tint, a, true)};
  return {glass(1 / ior, tint, a, true), true};
}

// Conductor of `prefix` + eta and k; copper is the default.
Surface metal_of(const Entity& e, const Number& a, const std::string& prefix = "") {
  const std::array<Rgb, 2> copper = *conductor_named("Cu");
  const auto value = [&](const char* name, const Rgb& absent) {
    const Colour c = e.colour(prefix + name, absent, Use::index);
    if (c.texture) lose(e, "the texture of a metal's index becomes copper's");
    return c.texture ? absent : c.factor;
  };
  const Rgb eta = value("eta", copper[0]);
  return {conductor(eta, value("k", copper[1]), {}, a)};
}

// ---- pbrt-v3 ----

Surface matte(const Entity& e) {
  const Number sigma = e.varying("sigma", 0);
  if (sigma.factor != 0 || sigma.texture)
    lose(e, "the roughness \"sigma\" of the diffuse surface is left out");
  return {diffuse(colour(e, "Kd", 0.5f))};
}

Surface plastic_v3(const Entity& e) {
  const Colour kd = colour(e, "Kd", 0.25f);
  return {lobes(e, kd, flat_colour(e, "Ks", 0.25f), 1.5, alpha(e, 0.1))};
}

double ior_v3(const Entity& e) {
  const auto eta = e.varying("eta");
  const Number n = eta ? *eta : e.varying("index", 1.5);
  if (n.texture) lose(e, "the texture of the index of refraction becomes 1.5");
  return n.texture ? 1.5 : n.factor;
}

Surface uber(const Entity& e) {
  const Number smooth{0.0f, {}, {}};
  const Colour kd = colour(e, "Kd", 0.25f);
  const Rgb ks = flat_colour(e, "Ks", 0.25f), kr = flat_colour(e, "Kr", 0);
  const Colour kt = colour(e, "Kt", 0);
  const Number rough = alpha(e, 0.1);
  const double ior = ior_v3(e);
  if (!is_black(ks) && !is_black(kr)) lose(e, "of \"Ks\" and \"Kr\" only the larger is kept");
  const bool is_smooth = max_component(kr) > max_component(ks);
  Surface s;
  if (is_black(kt.factor)) {
    s.material = lobes(e, kd, is_smooth ? kr : ks, ior, is_smooth ? smooth : rough);
  } else {
    s = body(e, ior, kt, is_smooth || is_black(ks) ? smooth : rough);
    if (!is_black(kd.factor)) {
      lose(e, "diffuse reflection and transmission get one colour");
      const float d = luminance(kd.factor), t = luminance(kt.factor);
      s.material.transmission = t / std::max(d + t, 1e-6f);
      if (!kd.texture && !kt.texture) s.material.base.factor = min(kd.factor + kt.factor, Rgb(1));
    }
  }
  const Colour opacity = colour(e, "opacity", 1);
  const Rgb o = opacity.factor;
  Number& out = s.material.opacity;
  if (!opacity.texture && (o.x != o.y || o.y != o.z)) lose(e, "coloured opacity becomes its mean");
  out = {opacity.texture ? o.x : share((o.x + o.y + o.z) / 3), opacity.texture, {}};
  if (opacity.curve) out.curve = [curve = opacity.curve](float v) { return curve(Rgb(v)).x; };
  return s;
}

// Ashikhmin and Shirley's blend. Of a uniform sky, its diffuse part reflects 23/28 Kd (1 - Ks).
Surface substrate(const Entity& e) {
  const Colour kd = colour(e, "Kd", 0.5f);
  const Rgb ks = flat_colour(e, "Ks", 0.5f);
  const float f0 = std::clamp(max_component(ks), 0.0f, 0.98f), q = std::sqrt(f0);
  const Number a = alpha(e, 0.1);
  if (f0 <= 0) return {diffuse(scaled(kd, 23.0f / 28))};
  const double ior = (1 + q) / (1 - q);
  const float enters = 1 - static_cast<float>(diffuse_fresnel(ior));
  Material m = plastic(scaled(kd, 23.0f / 28 * (1 - f0) / std::max(enters, 0.01f)), ior, a, false);
  m.specular_colour = ks / max_component(ks);
  return {m};
}

Surface translucent(const Entity& e) {
  Colour kd = colour(e, "Kd", 0.25f);
  const Rgb ks = flat_colour(e, "Ks", 0.25f), reflect = flat_colour(e, "reflect", 0.5f);
  if (!is_black(flat_colour(e, "transmit", 0.5f)))
    lose(e, "light that is scattered through the surface is left out");
  kd.factor = kd.factor * reflect;
  return {lobes(e, kd, ks * reflect, 1.5, alpha(e, 0.1))};
}

Surface glass_v3(const Entity& e) {
  const Rgb kr = flat_colour(e, "Kr", 1);
  const Colour kt = colour(e, "Kt", 1);
  Surface s = body(e, ior_v3(e), kt, alpha(e, 0));
  const float most = max_component(kr);
  if (kr.x != 1 || kr.y != 1 || kr.z != 1) {
    lose(e, "reflection of less than all that Fresnel's equations give also changes transmission");
    s.material.specular = share(most);
    if (most > 0) s.material.specular_colour = kr / most;
  }
  return s;
}

Surface disney(const Entity& e) {
  const Colour base = colour(e, "color", 0.5f);
  const double ior = flat_number(e, "eta", 1.5);
  if (!(ior >= 1 && ior < 100)) e.fail("the index of refraction is below 1");
  const float metallic = share(flat_number(e, "metallic", 0));
  const float transmission = share(flat_number(e, "spectrans", 0));
  Material m = burley(base, ior, e.varying("roughness", 0.5), metallic, 1);
  const Number square{m.roughness.factor * m.roughness.factor, m.roughness.texture, {}};
  if (transmission == 1 && metallic == 0)  // coloured by the root at each side
    m.base = through(base, [](float v) { return std::sqrt(v); });
  else if (transmission > 0)
    lose(e, "surfaces between opaque and transparent are mixed as glTF has it");
  else if (metallic < 1 || !lost_of_rough_metal(square).empty())
    lose(
        e,
        "it reflects as much as in pbrt on the whole, but up to a tenth more or less by direction");
  m.transmission = transmission;
  const bool is_thin = e.flag("thin", false);
  m.solid = transmission > 0 && !is_thin;
  m.coat = share(flat_number(e, "clearcoat", 0));
  const float gloss = share(flat_number(e, "clearcoatgloss", 1));
  m.coat_roughness = std::sqrt(0.1f + gloss * (0.001f - 0.1f));
  const float tint = flat_number(e, "speculartint", 0), y = luminance(base.factor);
  if (tint > 0 && y > 0 && !base.texture)
    m.specular_colour = Rgb(1 - tint) + base.factor * (tint / y);
  if (flat_number(e, "sheen", 0) > 0) lose(e, "sheen is left out");
  if (flat_number(e, "anisotropic", 0) > 0) lose(e, "anisotropic roughness is left out");
  if (!is_black(flat_colour(e, "scatterdistance", 0))) lose(e, "subsurface scattering is left out");
  if (is_thin && flat_number(e, "difftrans", 1) > 0)
    lose(e, "light that is scattered through the surface is left out");
  if (is_thin && flat_number(e, "flatness", 0) > 0)
    lose(e, "the flatness of thin surfaces is left out");
  e.ignore({"sheentint", "flatness", "difftrans"});  // of sheen and of thin surfaces alone
  return {m};
}

Surface mirror_v3(const Entity& e) {
  return {mirror(colour(e, "Kr", 0.9f))};
}
Surface metal_v3(const Entity& e) {
  return metal_of(e, alpha(e, 0.01));
}

// ---- pbrt-v4 ----

Surface diffuse_v4(const Entity& e) {
  return {diffuse(colour(e, "reflectance", 0.5f))};
}

double ior_v4(const Entity& e, const char* name) {
  const double ior = e.index(name, 1.5);
  return ior == 0 ? 1 : ior;
}

void lose_in_coat(const Entity& e) {
  if (!is_black(flat_colour(e, "albedo", 0))) lose(e, "scattering in the coat is left out");
  if (e.integer("maxdepth", 10) < 10) lose(e, "light of many bounces in the coat is kept");
  e.ignore({"nsamples", "g"});  // how it is sampled and scatters
}

Surface coateddiffuse(const Entity& e) {
  const float thickness = flat_number(e, "thickness", 0.01);
  lose_in_coat(e);
  const double ior = ior_v4(e, "eta");
  require_index(e, ior);
  return {plastic_under_layer(colour(e, "reflectance", 0.5f), ior, alpha(e, 0),
                              std::clamp(thickness, 0.0f, 100.0f))};
}

Surface conductor_v4(const Entity& e) {
  const Number a = alpha(e, 0);
  return e.find("reflectance") ? Surface{metal(colour(e, "reflectance", 0.5f), a)} : metal_of(e, a);
}

Surface coatedconductor(const Entity& e) {
  const Number a = alpha(e, 0, "conductor."), coat = alpha(e, 0, "interface.");
  Surface s = e.find("reflectance") ? Surface{metal(colour(e, "reflectance", 0.5f), a)}
                                    : metal_of(e, a, "conductor.");
  s.material.coat = 1;
  s.material.coat_roughness = std::sqrt(coat.texture ? 0.5f : coat.factor);
  if (std::abs(ior_v4(e, "interface.eta") - 1.5) > 0.01)
    lose(e, "the coat's index of refraction becomes 1.5");
  if (flat_number(e, "thickness", 0.01) > 0.01f) lose(e, "absorption in the coat is left out");
  lose_in_coat(e);
  lose(e, "the metal's reflectance below the coat becomes that in air");
  return s;
}

Surface dielectric(const Entity& e) {
  return body(e, ior_v4(e, "eta"), {}, alpha(e, 0));
}

Surface thindielectric(const Entity& e) {
  const double ior = ior_v4(e, "eta");
  require_index(e, ior);
  return {glass(ior < 1 ? 1 / ior : ior, {}, {0.0f, {}, {}}, false)};
}

Surface diffusetransmission(const Entity& e) {
  const float scale = static_cast<float>(e.number("scale", 1));
  colour(e, "transmittance", 0.25f);
  lose(e, "light that is scattered through the surface is left out");
  return {diffuse(scaled(colour(e, "reflectance", 0.25f), scale))};
}

// ---- Both versions, or something simple ----

// Between 0 and 1; only blends of what is one value.
Material blend(const Material& a, const Material& b, float t) {
  Material m = t > 0.5f ? b : a;
  const auto mean = [&](auto Material::*value) { m.*value = a.*value * (1 - t) + b.*value * t; };
  const auto mean_factor = [&](auto Material::*value) {
    if (!(a.*value).texture && !(b.*value).texture)
      (m.*value).factor = (a.*value).factor * (1 - t) + (b.*value).factor * t;
  };
  mean_factor(&Material::base), mean_factor(&Material::roughness), mean_factor(&Material::opacity);
  for (const auto value : {&Material::metallic, &Material::specular, &Material::ior,
                           &Material::transmission, &Material::coat})
    mean(value);
  mean(&Material::specular_colour);
  m.eta_k.reset();
  return m;
}

Surface mix(const Entity& e) {
  Context& context = e.context;
  std::vector<std::string> names;
  if (context.v4) {
    const Parameter* both = e.find("materials", {"string"});
    if (!both || both->strings.size() != 2) e.fail("a mixture must name two materials");
    names = both->strings;
  } else {
    names = {e.text("namedmaterial1"), e.text("namedmaterial2")};
  }
  std::array<Surface, 2> both;
  for (size_t i = 0; i < 2; ++i) {
    const auto it = context.named_surfaces.find(names[i]);
    if (it == context.named_surfaces.end()) e.fail("no material is named \"{}\"", shown(names[i]));
    both[i] = context.surfaces[it->second];
    both[i].key.take();
  }
  // The share of the second; pbrt-v3's amount is that of the first and may be coloured.
  const Rgb first = context.v4 ? Rgb() : flat_colour(e, "amount", 0.5f);
  const float amount =
      share(context.v4 ? flat_number(e, "amount", 0.5) : 1 - (first.x + first.y + first.z) / 3);
  if (amount == 0) return both[0];
  if (amount == 1) return both[1];
  for (size_t i = 0; i < 2; ++i)
    if (both[i].material.invisible) {  // there is nothing where the ray passes
      both[1 - i].material.opacity.factor *= i == 0 ? amount : 1 - amount;
      return both[1 - i];
    }
  lose(e, "two materials become one of their mean values");
  Surface s = amount > 0.5f ? both[1] : both[0];
  s.material = blend(both[0].material, both[1].material, amount);
  return s;
}

// Diffuse reflectance of a medium with this albedo behind an interface: Jensen et al. 2001 [eq.
// 15].
float albedo_seen(float absorbed, float scattered, double ior) {
  const float albedo = scattered / std::max(absorbed + scattered, 1e-9f);
  const float inside = static_cast<float>(diffuse_fresnel(1 / ior));
  const float a = (1 + inside) / std::max(1 - inside, 1e-3f);
  const float x = std::sqrt(3 * (1 - albedo));
  return 0.5f * albedo * (1 + std::exp(-4.0f / 3 * a * x)) * std::exp(-x);
}

Surface subsurface(const Entity& e) {
  lose(e, "subsurface scattering becomes diffuse reflection");
  const bool is_kd = e.kind == "kdsubsurface";
  double ior = flat_number(e, "eta", e.context.v4 || !is_kd ? 1.33 : 1.3);
  if (!(ior > 0.01 && ior < 100)) ior = 1.33;
  const Number a = alpha(e, 0);
  const char* direct = is_kd ? "Kd" : "reflectance";
  Colour base{Rgb(0.8f), {}, {}};
  if (e.find(direct) || is_kd) {
    base = colour(e, direct, 0.5f);
  } else if (e.text("name").empty()) {
    const Rgb s = e.colour("sigma_s", {2.55f, 3.21f, 3.77f}).factor;
    const Rgb k = e.colour("sigma_a", {.0011f, .0024f, .014f}).factor;
    base.factor = {albedo_seen(k.x, s.x, ior), albedo_seen(k.y, s.y, ior),
                   albedo_seen(k.z, s.z, ior)};
  } else {
    lose(e, "a preset of subsurface scattering becomes a grey of 0.8");
  }
  e.ignore({"mfp", "g", "scale"});  // of the scattering
  return {plastic(base, ior, a, false)};
}

Surface hair(const Entity& e) {
  lose(e, "hair becomes diffuse");
  const Colour base = colour(e, e.find("reflectance") ? "reflectance" : "color", 0.2f);
  e.ignore_all();
  return {diffuse(base)};
}

Surface measured(const Entity& e) {
  lose(e, "a measured surface becomes a grey diffuse one");
  e.ignore_all();
  return {diffuse({Rgb(0.5f), {}, {}})};
}

Surface invisible(const Entity&) {
  Surface s;
  s.material.invisible = true;
  return s;
}

struct SurfaceKind {
  std::string_view name;
  Surface (*read)(const Entity&);
};
constexpr SurfaceKind kKinds[] = {
    {"", invisible},
    {"coatedconductor", coatedconductor},
    {"coateddiffuse", coateddiffuse},
    {"conductor", conductor_v4},
    {"dielectric", dielectric},
    {"diffuse", diffuse_v4},
    {"diffusetransmission", diffusetransmission},
    {"disney", disney},
    {"fourier", measured},
    {"glass", glass_v3},
    {"hair", hair},
    {"interface", invisible},
    {"kdsubsurface", subsurface},
    {"matte", matte},
    {"measured", measured},
    {"metal", metal_v3},
    {"mirror", mirror_v3},
    {"mix", mix},
    {"none", invisible},
    {"plastic", plastic_v3},
    {"substrate", substrate},
    {"subsurface", subsurface},
    {"thindielectric", thindielectric},
    {"translucent", translucent},
    {"uber", uber},
};

void read_bumps(const Entity& e, Material& m) {
  const auto bump = e.varying(e.context.v4 ? "displacement" : "bumpmap");
  if (bump && bump->texture) {
    if (bump->curve) lose(e, "the curve of the heights of bumps is left out");
    m.bump = bump->texture;
    m.bump_scale = bump->factor;
  }
  if (!e.context.v4) return;
  const std::string normals = e.text("normalmap");
  if (normals.empty()) return;
  const Texture map = picture(e, normals, false);
  if (e.context.source.has(normals, e.place)) m.normal = map;  // grey is no normal
}

}  // namespace

Surface surface_of(const Entity& e) {
  const auto* known = std::find_if(std::begin(kKinds), std::end(kKinds),
                                   [&](const SurfaceKind& k) { return k.name == e.kind; });
  Surface s;
  if (known != std::end(kKinds)) {
    s = known->read(e);
  } else {
    e.lose("the material \"{}\" is not known and becomes grey", shown(e.kind));
    e.ignore_all();
    s.material = diffuse({Rgb(0.5f), {}, {}});
  }
  read_bumps(e, s.material);
  s.key = e.key;
  return s;
}

}  // namespace tdpt::foreign::pbrt
