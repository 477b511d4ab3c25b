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
  // pbrt-v3's glass is smooth where both are 0; remapping would make it rough.
  if (e.kind == "glass" && first == 0 && second == 0) return {0.0f, {}, {}};
  // pbrt-v3's uber takes the roughness along u for both.
  if (first == second || (e.kind == "uber" && !v)) return {to_alpha(first), {}, {}};
  lose(e, "different roughness along u and v becomes their geometric mean");
  return {std::sqrt(to_alpha(first) * to_alpha(second)), {}, {}};
}

Colour scaled(const Colour& c, float k) {
  return k == 1 ? c : through(c, [k](float v) { return share(v * k); });
}

double index_above_0(const Entity& e, double ior) {
  if (!(ior > 0)) e.fail("the index of refraction is not above 0");
  return ior;
}

double ior_v3(const Entity& e) {
  const auto eta = e.varying("eta");
  const Number n = eta ? *eta : e.varying("index", 1.5);
  if (n.texture) lose(e, "the texture of the index of refraction becomes 1.5");
  return index_above_0(e, n.texture ? 1.5 : n.factor);
}

double ior_v4(const Entity& e, const char* name = "eta") {
  const double ior = e.index(name, 1.5);
  return index_above_0(e, ior == 0 ? 1 : ior);
}

// A glossy lobe ks * Fresnel(ior) beside, not above, a Lambertian kd: of the light that enters, the
// part kd / (1 - share reflected) must come out.
Material lobes(const Colour& kd, const Rgb& ks, double ior, const Number& a) {
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
Surface body(double ior, const Colour& tint, const Number& a) {
  if (ior >= 1) return {glass(ior, tint, a, true)};
  return {glass(1 / ior, tint, a, true), true};
}

// Conductor of `prefix` + eta and k; copper is the default.
Surface metal_of(const Entity& e, const Number& a, const std::string& prefix = "") {
  const std::array<Rgb, 2> copper = *conductor_named("Cu");
  const auto value = [&](const char* name, const Rgb& absent) {
    const Colour c = e.colour(prefix + name, absent, Role::index);
    if (c.texture) lose(e, "the texture of a metal's index becomes copper's");
    return c.texture ? absent : c.factor;
  };
  const Rgb eta = value("eta", copper[0]);
  return {conductor(eta, value("k", copper[1]), {}, a)};
}

// ---- pbrt-v3 ----

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
    s.material = lobes(kd, is_smooth ? kr : ks, ior, is_smooth ? smooth : rough);
  } else {
    s = body(ior, kt, is_smooth || is_black(ks) ? smooth : rough);
    if (!is_black(kd.factor)) {
      lose(e, "diffuse reflection and transmission get one colour");
      const float d = luminance(kd.factor), t = luminance(kt.factor);
      s.material.transmission = t / std::max(d + t, 1e-6f);
      if (!kd.texture && !kt.texture) s.material.base.factor = min(kd.factor + kt.factor, Rgb(1));
    }
  }
  const Colour opacity = colour(e, "opacity", 1);
  const Rgb o = opacity.factor;
  if (!opacity.texture && (o.x != o.y || o.y != o.z)) lose(e, "coloured opacity becomes its mean");
  s.material.opacity = {opacity.texture ? o.x : share((o.x + o.y + o.z) / 3), opacity.texture, {}};
  if (opacity.curve)
    s.material.opacity.curve = [curve = opacity.curve](float v) { return curve(Rgb(v)).x; };
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
  lose(e, "light that is scattered through the surface is left out");
  e.ignore({"transmit"});
  kd.factor = kd.factor * reflect;
  return {lobes(kd, ks * reflect, 1.5, alpha(e, 0.1))};
}

Surface glass_v3(const Entity& e) {
  const Rgb kr = flat_colour(e, "Kr", 1);
  const Colour kt = colour(e, "Kt", 1);
  Surface s = body(ior_v3(e), kt, alpha(e, 0));
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
  e.ignore({"sheentint"});  // of sheen alone
  return {m};
}

// ---- pbrt-v4 ----

Surface coateddiffuse(const Entity& e) {
  const float thickness = flat_number(e, "thickness", 0.01);
  e.ignore({"maxdepth", "nsamples", "g"});  // how it is sampled; of scattering, its albedo's
  return {plastic_under_layer(colour(e, "reflectance", 0.5f), ior_v4(e), alpha(e, 0),
                              std::clamp(thickness, 0.0f, 100.0f))};
}

Surface conductor_of(const Entity& e, const std::string& prefix = "") {
  const Number a = alpha(e, 0, prefix);
  return e.has("reflectance") ? Surface{metal(colour(e, "reflectance", 0.5f), a)}
                              : metal_of(e, a, prefix);
}

Surface coatedconductor(const Entity& e) {
  Surface s = conductor_of(e, "conductor.");
  const Number coat = alpha(e, 0, "interface.");
  s.material.coat = 1;
  s.material.coat_roughness = std::sqrt(coat.texture ? 0.5f : coat.factor);
  lose(e,
       "its coat has an index of refraction of 1.5, absorbs nothing and leaves the metal as it "
       "is in air");
  e.ignore({"albedo", "g", "interface.eta", "maxdepth", "nsamples", "thickness"});
  return s;
}

Surface thindielectric(const Entity& e) {
  const double ior = ior_v4(e);
  return {glass(ior < 1 ? 1 / ior : ior, {}, {0.0f, {}, {}}, false)};
}

Surface diffusetransmission(const Entity& e) {
  lose(e, "light that is scattered through the surface is left out");
  e.ignore({"transmittance"});
  const float scale = static_cast<float>(e.number("scale", 1));
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
  std::vector<std::string> names{e.text("namedmaterial1"), e.text("namedmaterial2")};
  if (const Parameter* both = e.find("materials", {"string"})) names = both->strings;
  if (names.size() != 2) e.fail("a mixture must name two materials");
  std::array<Surface, 2> both;
  for (size_t i = 0; i < 2; ++i) {
    const auto it = e.context.named_surfaces.find(names[i]);
    if (it == e.context.named_surfaces.end())
      e.fail("no material is named \"{}\"", shown(names[i]));
    both[i] = e.context.surfaces[it->second];
    both[i].key.take();
  }
  // The share of the second; pbrt-v3's amount is that of the first and may be coloured.
  const Rgb first = e.context.v4 ? Rgb() : flat_colour(e, "amount", 0.5f);
  const float amount =
      share(e.context.v4 ? flat_number(e, "amount", 0.5) : 1 - (first.x + first.y + first.z) / 3);
  if (amount == 0) return both[0];
  if (amount == 1) return both[1];
  for (size_t i = 0; i < 2; ++i)
    if (both[i].material.invisible) {  // there is nothing where the ray passes
      both[1 - i].material.opacity.factor *= i == 0 ? amount : 1 - amount;
      return both[1 - i];
    }
  lose(e, "two materials become one of their mean values");
  Surface s = both[amount > 0.5f];
  s.material = blend(both[0].material, both[1].material, amount);
  return s;
}

Surface subsurface(const Entity& e) {
  lose(e, "subsurface scattering becomes diffuse reflection");
  const bool is_kd = e.kind == "kdsubsurface";
  double ior = flat_number(e, "eta", e.context.v4 || !is_kd ? 1.33 : 1.3);
  if (!(ior > 0.01 && ior < 100)) ior = 1.33;
  const Number a = alpha(e, 0);
  const Colour base = is_kd ? colour(e, "Kd", 0.5f) : colour(e, "reflectance", 0.8f);
  e.ignore();  // of the scattering
  return {plastic(base, ior, a, false)};
}

Surface invisible(const Entity&) {
  Surface s;
  s.material.invisible = true;
  return s;
}

// What glTF has nothing like: hair, measured surfaces.
Surface unknown(const Entity& e) {
  e.lose("the material \"{}\" becomes diffuse", shown(e.kind));
  const Colour base = colour(e, e.has("reflectance") ? "reflectance" : "color", 0.5f);
  e.ignore();
  return {diffuse(base)};
}

struct SurfaceKind {
  std::string_view name;
  Surface (*read)(const Entity&);
};
constexpr SurfaceKind kKinds[] = {
    {"", invisible},
    {"coatedconductor", coatedconductor},
    {"coateddiffuse", coateddiffuse},
    {"conductor", [](const Entity& e) { return conductor_of(e); }},
    {"dielectric", [](const Entity& e) { return body(ior_v4(e), {}, alpha(e, 0)); }},
    {"diffuse", [](const Entity& e) { return Surface{diffuse(colour(e, "reflectance", 0.5f))}; }},
    {"diffusetransmission", diffusetransmission},
    {"disney", disney},
    {"glass", glass_v3},
    {"interface", invisible},
    {"kdsubsurface", subsurface},
    {"matte", [](const Entity& e) { return Surface{diffuse(colour(e, "Kd", 0.5f))}; }},
    {"metal", [](const Entity& e) { return metal_of(e, alpha(e, 0.01)); }},
    {"mirror", [](const Entity& e) { return Surface{mirror(colour(e, "Kr", 0.9f))}; }},
    {"mix", mix},
    {"none", invisible},
    {"plastic",
     [](const Entity& e) {
       return Surface{
           lobes(colour(e, "Kd", 0.25f), flat_colour(e, "Ks", 0.25f), 1.5, alpha(e, 0.1))};
     }},
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
  Surface s = known == std::end(kKinds) ? unknown(e) : known->read(e);
  read_bumps(e, s.material);
  for (const Parameter& p : e.all)  // such as sheen: nothing is lost of nothing
    if (!p.numbers.empty() &&
        std::count(p.numbers.begin(), p.numbers.end(), 0) == std::ssize(p.numbers))
      p.key.take();
  s.key = e.key;
  return s;
}

}  // namespace tdpt::foreign::pbrt
