#include "tools/tdpt-import/pbrt/painter.h"

#include <cmath>

#include <fmt/format.h>

namespace tdpt::foreign::pbrt {

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
