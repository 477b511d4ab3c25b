#include "tools/tdpt-import/pbrt/surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/materials.h"
#include "tools/tdpt-import/pbrt/surface_kinds.h"

namespace tdpt::foreign::pbrt {
namespace {

// Materials that both versions of pbrt have, or that become something simple.

// Between 0 and 1; only blends of what is one value.
Material blend(const Material& a, const Material& b, float t) {
  const auto mean = [t](auto x, auto y) { return x * (1 - t) + y * t; };
  Material m = t > 0.5f ? b : a;
  if (!a.base.texture && !b.base.texture) m.base.factor = mean(a.base.factor, b.base.factor);
  if (!a.roughness.texture && !b.roughness.texture)
    m.roughness.factor = mean(a.roughness.factor, b.roughness.factor);
  if (!a.opacity.texture && !b.opacity.texture)
    m.opacity.factor = mean(a.opacity.factor, b.opacity.factor);
  m.metallic = mean(a.metallic, b.metallic);
  m.specular = mean(a.specular, b.specular);
  m.specular_colour = mean(a.specular_colour, b.specular_colour);
  m.ior = mean(a.ior, b.ior);
  m.transmission = mean(a.transmission, b.transmission);
  m.coat = mean(a.coat, b.coat);
  m.eta_k.reset();
  return m;
}

Surface mix(const Reader& r) {
  std::array<std::string, 2> names;
  if (r.context.v4) {
    const std::vector<std::string>* both = r.list.texts("materials");
    if (!both || both->size() != 2) Source::fail(r.list.place, "a mixture must name two materials");
    names = {(*both)[0], (*both)[1]};
  } else {
    names = {r.list.text("namedmaterial1"), r.list.text("namedmaterial2")};
  }
  std::array<Surface, 2> both;
  for (size_t i = 0; i < 2; ++i) {
    const auto it = r.named.find(names[i]);
    if (it == r.named.end())
      Source::fail(r.list.place, fmt::format("no material is named \"{}\"", shown(names[i])));
    both[i] = it->second;
    it->second.key.take();
  }
  // The share of the second; pbrt-v3's amount is that of the first and may be coloured.
  float amount = 0.5f;
  if (r.context.v4) {
    amount = r.flat_number("amount", 0.5);
  } else {
    const Rgb first = r.flat_colour("amount", 0.5f);
    amount = 1 - (first.x + first.y + first.z) / 3;
  }
  amount = std::clamp(amount, 0.0f, 1.0f);
  if (amount == 0) return both[0];
  if (amount == 1) return both[1];
  for (size_t i = 0; i < 2; ++i)
    if (both[i].material.invisible) {  // there is nothing where the ray passes
      Surface s = both[1 - i];
      s.material.opacity.factor *= i == 0 ? amount : 1 - amount;
      return s;
    }
  r.lose("two materials become one of their mean values");
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

Surface subsurface(const Reader& r) {
  r.lose("subsurface scattering becomes diffuse reflection");
  double ior = r.flat_number("eta", r.context.v4 || r.kind == "subsurface" ? 1.33 : 1.3);
  if (!(ior > 0.01 && ior < 100)) ior = 1.33;
  const Number a = alpha(r, 0);
  const char* direct = r.kind == "kdsubsurface" ? "Kd" : "reflectance";
  Colour base{Rgb(0.8f), {}, {}};
  if (r.list.find(direct) || r.kind == "kdsubsurface") {
    base = r.colour(direct, 0.5f);
  } else if (r.list.text("name").empty()) {
    const Rgb s = r.textures.colour(r.context, r.list, "sigma_s", {2.55f, 3.21f, 3.77f}).factor;
    const Rgb k = r.textures.colour(r.context, r.list, "sigma_a", {.0011f, .0024f, .014f}).factor;
    base.factor = {albedo_seen(k.x, s.x, ior), albedo_seen(k.y, s.y, ior),
                   albedo_seen(k.z, s.z, ior)};
  } else {
    r.lose("a preset of subsurface scattering becomes a grey of 0.8");
  }
  r.list.ignore({"mfp", "g", "scale"});  // of the scattering
  return {plastic(base, ior, a, false)};
}

Surface hair(const Reader& r) {
  r.lose("hair becomes diffuse");
  const char* name = r.list.find("reflectance") ? "reflectance" : "color";
  const Colour base = r.colour(name, 0.2f);
  r.list.ignore_all();
  return {diffuse(base)};
}

Surface measured(const Reader& r) {
  r.lose("a measured surface becomes a grey diffuse one");
  r.list.ignore_all();
  return {diffuse({Rgb(0.5f), {}, {}})};
}

Surface invisible(const Reader&) {
  Surface s;
  s.material.invisible = true;
  return s;
}

constexpr SurfaceKind kKinds[] = {
    {"", invisible},
    {"none", invisible},
    {"interface", invisible},
    {"mix", mix},
    {"hair", hair},
    {"subsurface", subsurface},
    {"kdsubsurface", subsurface},
    {"fourier", measured},
    {"measured", measured},
};

const SurfaceKind* kind_of(const std::string& name) {
  for (const SurfaceKind& k : kKinds)
    if (name == k.name) return &k;
  const SurfaceKind* of_v3 = kind_v3(name);
  return of_v3 ? of_v3 : kind_v4(name);
}

void read_bumps(const Reader& r, Material& m) {
  const auto bump = r.textures.number(r.context, r.list, r.context.v4 ? "displacement" : "bumpmap");
  if (bump && bump->texture) {
    if (bump->curve) r.lose("the curve of the heights of bumps is left out");
    m.bump = bump->texture;
    m.bump_scale = bump->factor;
  }
  if (!r.context.v4) return;
  const std::string normals = r.list.text("normalmap");
  if (normals.empty()) return;
  const Texture map = picture(r.context, normals, r.list.place, false);
  if (r.context.source.has(normals, r.list.place)) m.normal = map;  // grey is no normal
}

}  // namespace

Surface surface_of(Context& context, const Textures& textures, const Surfaces& named,
                   const std::string& kind, const Parameters& list) {
  const Reader reader{context, textures, named, kind, list};
  const SurfaceKind* known = kind_of(kind);
  Surface s;
  if (!known) {
    context.source.lose(
        list.place, fmt::format("the material \"{}\" is not known and becomes grey", shown(kind)));
    list.ignore_all();
    s.material = diffuse({Rgb(0.5f), {}, {}});
  } else {
    s = known->read(reader);
  }
  read_bumps(reader, s.material);
  return s;
}

// ---- The materials of the scene ----

void Painter::add_medium(Context& context, const std::string& name, const Parameters& list) {
  const Rgb scattered = colour_of(context, list, "sigma_s", Use::index, {2.55f, 3.21f, 3.77f});
  const Rgb absorbed = colour_of(context, list, "sigma_a", Use::index, {.0011f, .0024f, .014f});
  const auto scale = static_cast<float>(list.number("scale", 1));
  const std::string kind = list.text("type"), preset = list.text("preset");
  absorbing_[name] = {};
  if (kind != "homogeneous" || !preset.empty() || max_component(scattered) > 0 || list.find("Le"))
    return list.ignore_all();  // lost where it is used
  absorbing_[name] = Rgb(std::exp(-absorbed.x * scale), std::exp(-absorbed.y * scale),
                         std::exp(-absorbed.z * scale));
  list.ignore({"g"});  // nothing scatters
}

size_t Painter::material(Context& context, const Textures& textures, size_t surface,
                         const Parameters& shape, const std::string& inside,
                         const std::string& outside) {
  const auto alpha = textures.number(context, shape, "alpha");
  Material m = surfaces_[surface].material;
  std::optional<Rgb> attenuation;
  if (!inside.empty() && m.solid && absorbing_[inside]) attenuation = absorbing_[inside];
  // Behind an opaque surface a medium is never seen.
  const bool is_open = m.transmission > 0 || m.invisible || m.opacity.factor < 1 || alpha;
  if (!inside.empty() && !attenuation && is_open)
    context.source.lose(shape.place, "media other than absorbing ones within glass are left out");
  if (!outside.empty())
    context.source.lose(shape.place, "media in front of a surface are left out");

  const std::string alpha_key =
      alpha ? alpha->texture ? shape.texture("alpha") : fmt::format("{}", alpha->factor) : "";
  const std::string key = fmt::format("{} {} {}", surface, attenuation ? inside : "", alpha_key);
  const auto [it, is_new] = made_.try_emplace(key, context.scene.materials.size());
  if (!is_new) return it->second;
  if (attenuation) m.attenuation = *attenuation;
  if (alpha && alpha->texture) {
    if (m.opacity.texture) context.source.lose(shape.place, "of two opacities the shape's is kept");
    const float under = m.opacity.texture ? 1 : m.opacity.factor;
    m.opacity = *alpha;
    if (!context.v4)  // only zero is transparent
      m.opacity.curve = [curve = alpha->curve](float texel) {
        return (curve ? curve(texel) : texel) > 0 ? 1.0f : 0.0f;
      };
    m.opacity.factor = (context.v4 ? alpha->factor : alpha->factor > 0 ? 1 : 0) * under;
  } else if (alpha) {
    const bool is_whole = !context.v4 && alpha->factor != 0;
    m.opacity.factor *= is_whole ? 1 : std::min(std::max(alpha->factor, 0.0f), 1.0f);
  }
  context.scene.materials.push_back(std::move(m));
  return it->second;
}

}  // namespace tdpt::foreign::pbrt
