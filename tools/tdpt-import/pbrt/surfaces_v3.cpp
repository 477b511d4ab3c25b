// By pbrt-v3's materials/*.cpp. Kd, Ks, Kr, Kt: reflectance of a diffuse, a glossy and a smooth
// lobe, and transmittance.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "tools/tdpt-import/materials.h"
#include "tools/tdpt-import/pbrt/surface_reader.h"

namespace tdpt::foreign::pbrt {
namespace {

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

constexpr SurfaceKind kKinds[] = {
    {"matte", matte},         {"plastic", plastic_v3},      {"uber", uber},
    {"substrate", substrate}, {"translucent", translucent}, {"glass", glass_v3},
    {"mirror", mirror_v3},    {"metal", metal_v3},          {"disney", disney},
};

}  // namespace

const SurfaceKind* kind_v3(const std::string& name) {
  const auto* it = std::find_if(std::begin(kKinds), std::end(kKinds),
                                [&](const SurfaceKind& k) { return name == k.name; });
  return it == std::end(kKinds) ? nullptr : it;
}

}  // namespace tdpt::foreign::pbrt
