#include "tools/tdpt-import/pbrt/surface_reader.h"

#include <algorithm>
#include <cmath>

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

bool is_black(const Rgb& c) {
  return max_component(c) <= 0;
}

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

Surface metal_of(const Reader& r, const Number& a, const std::string& prefix) {
  const std::array<Rgb, 2> copper = *conductor_named("Cu");
  const auto value = [&](const std::string& name, const Rgb& absent) {
    const Colour c = r.textures.colour(r.context, r.list, prefix + name, absent, Use::index);
    if (c.texture) r.lose("the texture of a metal's index becomes copper's");
    return c.texture ? absent : c.factor;
  };
  const Rgb eta = value("eta", copper[0]);
  return {conductor(eta, value("k", copper[1]), {}, a)};
}

}  // namespace tdpt::foreign::pbrt
