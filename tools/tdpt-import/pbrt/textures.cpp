// Textures, by pbrt-v3's textures/*.cpp and pbrt-v4's textures.cpp: (s, t) = (uscale u + udelta,
// vscale v + vdelta), (0, 0) is the lower left corner of an image, v grows upwards. Textures of
// numbers are kept as grey ones.
#include <algorithm>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/materials.h"
#include "tools/tdpt-import/pbrt/pbrt.h"

namespace tdpt::foreign::pbrt {
namespace {

float mean_of(const Rgb& c) {
  return (c.x + c.y + c.z) / 3;
}

Colour grey(const Number& n) {
  Colour c{Rgb(n.factor), n.texture, {}};
  if (n.texture)
    c.curve = [curve = n.curve](const Rgb& texel) {
      const float mean = mean_of(texel);
      return Rgb(curve ? curve(mean) : mean);
    };
  return c;
}

// The map from the mesh's coordinates in glTF to (s, 1 - t).
std::array<double, 6> map_of(const Entity& e) {
  const std::string mapping = e.text("mapping", "uv");
  if (mapping != "uv") {
    e.lose("textures with the mapping \"{}\" use the coordinates of the mesh", shown(mapping));
    e.ignore({"v1", "v2", "udelta", "vdelta"});  // of that mapping
    return {1, 0, 0, 0, 1, 0};
  }
  const double su = e.number("uscale", 1), sv = e.number("vscale", 1);
  const double du = e.number("udelta", 0), dv = e.number("vdelta", 0);
  return {su, 0, du, 0, sv, 1 - sv - dv};
}

Texture::Wrap wrap_of(const Entity& e) {
  const std::string wrap = e.text("wrap", "repeat");
  if (wrap == "black") e.lose("textures that are black outside their image repeat its edge");
  if (wrap == "clamp" || wrap == "black") return Texture::Wrap::clamp;
  if (wrap != "repeat")
    e.lose("the texture's wrap mode \"{}\" is not known; it repeats", shown(wrap));
  return Texture::Wrap::repeat;
}

Colour imagemap(const Entity& e, bool is_number) {
  const bool v4 = e.context.v4;
  const std::string file = e.text("filename");
  if (file.empty()) e.fail("the image texture names no file");
  const std::string suffix = suffix_of(file);
  bool srgb = e.flag("gamma", suffix == ".png" || suffix == ".tga");
  if (v4) {
    // Only PNGs heed the encoding; other files of bytes are sRGB.
    const std::string encoding = e.text("encoding", "sRGB");
    srgb = suffix != ".png" || encoding != "linear";
    if (encoding != "sRGB" && encoding != "linear")
      e.lose("the encoding \"{}\" of a picture becomes sRGB", shown(encoding));
  }
  Colour c{Rgb(1), picture(e, file, srgb), {}};
  Texture& texture = *c.texture;
  texture.map = map_of(e);
  texture.wrap_u = texture.wrap_v = wrap_of(e);
  texture.nearest = e.text("filter", "bilinear") == "point";
  if (is_number && v4) {  // pbrt prefers alpha for numbers, if the picture has it
    const std::vector<float> alpha = e.context.texels(texture.image).alpha;
    texture.alpha = std::any_of(alpha.begin(), alpha.end(), [](float a) { return a < 1; });
  }
  if (is_number && !v4) {  // luminance first, then decoded
    texture.luminance = true;
    texture.srgb = false;
    if (srgb) c = through(c, [](const Rgb& v) { return linear_of(v); });
  }
  c.factor = c.factor * static_cast<float>(e.number("scale", 1));
  if (v4 && e.flag("invert", false)) c = through(c, [](float v) { return std::max(0.0f, 1 - v); });
  e.ignore({"trilinear", "maxanisotropy"});  // how it is filtered
  return c;
}

Colour checkerboard(const Entity& e, const Rgb& even, const Rgb& odd) {
  Colour c;
  c.texture = Texture{};
  c.texture->image = e.context.scene.images.size();
  c.texture->nearest = true;
  // Two cells are one image: halve (s, t), where 1 - t / 2 = (1 + (1 - t)) / 2.
  const std::array<double, 6> m = map_of(e);
  c.texture->map = {m[0] / 2, 0, m[2] / 2, 0, m[4] / 2, (1 + m[5]) / 2};
  // s and t from 0 to 1 are in the lower left.
  e.context.scene.images.push_back({"checkerboard", {}, 2, 2, {odd, even, even, odd}});
  return c;
}

// a (1 - t) + b t of the texels of whichever one of the three has an image.
Colour mix(const Colour& a, const Colour& b, const Colour& t) {
  const Colour& image = a.texture ? a : b.texture ? b : t;
  const auto at = [a, b, t, image](const Rgb& texel) {
    const Rgb x = image.curve ? image.curve(texel) : texel;
    const auto value = [&x](const Colour& c) { return c.texture ? c.factor * x : c.factor; };
    const Rgb first = Rgb(1) - value(t);
    return value(a) * first + value(b) * (Rgb(1) - first);
  };
  return image.texture ? Colour{Rgb(1), image.texture, at} : Colour{at(Rgb(1)), {}, {}};
}

Colour texture_of(const Entity& e, bool is_number) {
  const bool v4 = e.context.v4;
  const auto value = [&](const char* name, double absent) {
    if (is_number) return grey(e.varying(name, absent));
    // pbrt-v4's textures of colours are scaled by numbers.
    const double* v = e.numbers(name, {"float"}, 1);
    const Rgb constant(static_cast<float>(v ? *v : absent));
    return v ? Colour{constant, {}, {}} : e.colour(name, constant);
  };
  const auto one_value = [&](const Rgb& factor) {
    e.lose("textures of the kind \"{}\" become one value", shown(e.kind));
    e.ignore();
    return Colour{factor, {}, {}};
  };
  if (e.kind == "constant") return value("value", 1);
  if (e.kind == "imagemap") return imagemap(e, is_number);
  if (e.kind == "checkerboard") {
    const Colour even = value("tex1", 1), odd = value("tex2", 0);
    e.ignore({"aamode"});  // how it is filtered
    return e.integer("dimension", 2) == 2 && !even.texture && !odd.texture
               ? checkerboard(e, even.factor, odd.factor)
               : one_value((even.factor + odd.factor) * 0.5f);
  }
  if (e.kind == "scale") {
    Colour a = value(v4 ? "tex" : "tex1", 1), b = value(v4 ? "scale" : "tex2", 1);
    if (a.texture && b.texture) {
      e.lose("of a product of two textures only the first is kept");
      b.texture.reset();
    }
    if (b.texture) std::swap(a, b);
    a.factor = a.factor * b.factor;
    return a;
  }
  if (e.kind == "mix") {
    const Colour a = value("tex1", 0), b = value("tex2", 1), t = grey(e.varying("amount", 0.5));
    const bool is_colour_by_alpha = !is_number && t.texture && t.texture->alpha;
    return !!a.texture + !!b.texture + !!t.texture <= 1 && !is_colour_by_alpha
               ? mix(a, b, t)
               : one_value((a.factor + b.factor) * 0.5f);
  }
  for (const char* first : {"inside", "tex1"})
    if (e.has(first)) return one_value(value(first, 0.5).factor);
  return one_value(Rgb(0.5f));
}

// The texture that a parameter names, now used.
const NamedTexture* texture_named(const Entity& e, const std::string& texture) {
  const auto it = e.context.textures.find(texture);
  if (it == e.context.textures.end() || it->second.depth == 0) return nullptr;
  e.context.deepest_named = std::max(e.context.deepest_named, it->second.depth);
  it->second.key.take();
  return &it->second;
}

Number number_of(const NamedTexture& t) {
  Number n{t.value.factor.x, t.value.texture, {}};
  if (t.value.curve) n.curve = [curve = t.value.curve](float v) { return curve(Rgb(v)).x; };
  return n;
}

}  // namespace

void add_texture(const Entity& e, const std::string& name, const std::string& type) {
  constexpr size_t kDeepest = 100;
  e.context.deepest_named = 0;
  NamedTexture& texture = e.context.textures[name];
  texture.key = e.key;
  texture.is_number = type == "float";
  texture.value = texture_of(e, texture.is_number);
  if (type != "float" && type != "spectrum" && type != "color")
    e.lose("textures of the type \"{}\" are not known", shown(type));
  texture.depth = std::max(texture.depth, e.context.deepest_named + 1);
  if (texture.depth > kDeepest) e.fail("textures of textures, more than {} deep", kDeepest);
}

Texture picture(const Entity& e, const std::string& file, bool srgb) {
  Texture texture;
  texture.image = e.context.image(file, e.place);
  texture.srgb = srgb;
  return texture;
}

Colour Entity::colour(const std::string& name, const Rgb& absent, Role role) const {
  const std::string named = texture(name);
  if (named.empty()) return {spectrum(name, role).value_or(absent), {}, {}};
  const NamedTexture* t = texture_named(*this, named);
  // pbrt-v4's "scale" multiplies colours by numbers.
  if (t && !t->is_number) return t->value;
  if (t && !(t->value.texture && t->value.texture->alpha)) return grey(number_of(*t));
  lose("there is no colour texture \"{}\"", shown(named));
  return {absent, {}, {}};
}

std::optional<Number> Entity::varying(const std::string& name) const {
  const std::string named = texture(name);
  if (named.empty()) {
    const double* v = numbers(name, {"float"}, 1);
    return v ? std::optional<Number>({static_cast<float>(*v), {}, {}}) : std::nullopt;
  }
  const NamedTexture* t = texture_named(*this, named);
  if (!t || !t->is_number) {
    lose("there is no texture of numbers \"{}\"", shown(named));
    return {};
  }
  return number_of(*t);
}

Number Entity::varying(const std::string& name, double absent) const {
  return varying(name).value_or(Number{static_cast<float>(absent), {}, {}});
}

}  // namespace tdpt::foreign::pbrt
