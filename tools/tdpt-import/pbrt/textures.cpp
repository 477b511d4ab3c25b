// Textures, by pbrt-v3's textures/*.cpp and pbrt-v4's textures.cpp: (s, t) = (uscale u + udelta,
// vscale v + vdelta), (0, 0) is the lower left corner of an image, v grows upwards.
//
// What follows is written once for colours and for numbers: Value is Colour or Number.
#include <algorithm>
#include <cmath>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/materials.h"
#include "tools/tdpt-import/pbrt/pbrt.h"

namespace tdpt::foreign::pbrt {
namespace {

template <class Value>
using Factor = decltype(Value::factor);

float mean_of(const Rgb& c) {
  return (c.x + c.y + c.z) / 3;
}

// One value for all of a texture that glTF cannot have.
template <class Value>
Value flat(const Value& value) {
  return {value.factor, {}, {}};
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

template <class Value>
Value imagemap(const Entity& e) {
  constexpr bool is_number = std::is_same_v<Value, Number>;
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
  Value value;
  value.texture = picture(e, file, srgb);
  Texture& texture = *value.texture;
  texture.map = map_of(e);
  texture.wrap_u = texture.wrap_v = wrap_of(e);
  texture.nearest = e.text("filter", "bilinear") == "point";
  if (is_number && v4)
    texture.alpha = e.context.has_alpha(texture.image);  // pbrt prefers it for numbers
  if (is_number && !v4) {                                // luminance first, then decoded
    texture.luminance = true;
    texture.srgb = false;
    if (srgb) value = through(value, [](float v) { return linear_of(Rgb(v)).x; });
  }
  value.factor = value.factor * static_cast<float>(e.number("scale", 1));
  if (v4 && e.flag("invert", false))
    value = through(value, [](float v) { return std::max(0.0f, 1 - v); });
  e.ignore({"trilinear", "maxanisotropy"});  // how it is filtered
  return value;
}

template <class Value>
Value checkerboard(const Entity& e, const Value& even, const Value& odd) {
  const int dimension = e.integer("dimension", 2);
  e.ignore({"aamode"});  // how it is filtered
  if (dimension != 2 || even.texture || odd.texture) {
    e.lose("checkerboards in space or of textures become one value");
    e.ignore();
    return {(even.factor + odd.factor) * 0.5f, {}, {}};
  }
  const Rgb a(even.factor), b(odd.factor);
  Value value;
  value.texture = Texture{};
  value.texture->image = e.context.scene.images.size();
  value.texture->nearest = true;
  // Two cells are one image: halve (s, t), where 1 - t / 2 = (1 + (1 - t)) / 2.
  const std::array<double, 6> m = map_of(e);
  value.texture->map = {m[0] / 2, 0, m[2] / 2, 0, m[4] / 2, (1 + m[5]) / 2};
  // s and t from 0 to 1 are in the lower left.
  e.context.scene.images.push_back({"checkerboard", {}, 2, 2, {b, a, a, b}});
  return value;
}

// a + (b - a) t of the texels of whichever one of the three has an image. None: t is an alpha.
std::optional<Colour> mix(const Colour& a, const Colour& b, const Number& t) {
  if (t.texture) {
    if (t.texture->alpha) return {};
    return Colour{Rgb(1), t.texture, [=](const Rgb& texel) {
                    const float mean = mean_of(texel);
                    const float u = t.factor * (t.curve ? t.curve(mean) : mean);
                    return a.factor * (1 - u) + b.factor * u;
                  }};
  }
  const Colour& image = b.texture ? b : a;
  const float u = b.texture ? t.factor : 1 - t.factor;
  const Rgb rest = (b.texture ? a : b).factor * (1 - u);
  const auto at = [=](const Rgb& texel) {
    return image.factor * (image.curve ? image.curve(texel) : texel) * u + rest;
  };
  return image.texture ? Colour{Rgb(1), image.texture, at} : Colour{at(Rgb(1)), {}, {}};
}
std::optional<Number> mix(const Number& a, const Number& b, const Number& t) {
  const Number& image = a.texture ? a : b.texture ? b : t;
  const auto at = [a, b, t, image](float texel) {
    const float x = image.curve ? image.curve(texel) : texel;
    const auto of = [x](const Number& n) { return n.texture ? n.factor * x : n.factor; };
    return of(a) + (of(b) - of(a)) * of(t);
  };
  return image.texture ? Number{1, image.texture, at} : Number{at(1), {}, {}};
}

template <class Value>
Value value_of(const Entity& e, const std::string& name, double absent) {
  if constexpr (std::is_same_v<Value, Number>) {
    return e.varying(name, absent);
  } else {
    // pbrt-v4's textures of colours are scaled by numbers.
    const double* v = e.numbers(name, {"float"}, 1);
    return v ? Value{Rgb(static_cast<float>(*v)), {}, {}}
             : e.colour(name, Rgb(static_cast<float>(absent)));
  }
}

template <class Value>
Value texture_of(const Entity& e) {
  const bool v4 = e.context.v4;
  const auto value = [&](const char* name, double absent) {
    return value_of<Value>(e, name, absent);
  };
  const auto one_value = [&](const Factor<Value>& factor) {
    e.lose("textures of the kind \"{}\" become one value", shown(e.kind));
    e.ignore();
    return Value{factor, {}, {}};
  };
  if (e.kind == "constant") return value("value", 1);
  if (e.kind == "imagemap") return imagemap<Value>(e);
  if (e.kind == "checkerboard") {
    const Value even = value("tex1", 1);
    return checkerboard(e, even, value("tex2", 0));
  }
  if (e.kind == "scale") {
    Value a = value(v4 ? "tex" : "tex1", 1), b = value(v4 ? "scale" : "tex2", 1);
    if (a.texture && b.texture) {
      e.lose("of a product of two textures only the first is kept");
      b = flat(b);
    }
    if (b.texture) std::swap(a, b);
    a.factor = a.factor * b.factor;
    return a;
  }
  if (e.kind == "mix") {
    const Value a = value("tex1", 0), b = value("tex2", 1);
    const Number amount = e.varying("amount", 0.5);
    if (!!a.texture + !!b.texture + !!amount.texture <= 1)
      if (const std::optional<Value> mixed = mix(a, b, amount)) return *mixed;
    return one_value((a.factor + b.factor) * 0.5f);
  }
  Factor<Value> factor(0.5f);
  for (const char* first : {"tex1", "inside"})
    if (e.has(first)) factor = value(first, 0.5).factor;
  return one_value(factor);
}

// The texture that a parameter names, now used.
const NamedTexture* texture_named(const Entity& e, const std::string& texture) {
  const auto it = e.context.textures.find(texture);
  if (it == e.context.textures.end() || it->second.depth == 0) return nullptr;
  e.context.deepest_named = std::max(e.context.deepest_named, it->second.depth);
  it->second.key.take();
  return &it->second;
}

}  // namespace

void add_texture(const Entity& e, const std::string& name, const std::string& type) {
  constexpr size_t kDeepest = 100;
  e.context.deepest_named = 0;
  NamedTexture& texture = e.context.textures[name];
  texture.key = e.key;
  if (type == "float")
    texture.number = texture_of<Number>(e);
  else if (type == "spectrum" || type == "color")
    texture.colour = texture_of<Colour>(e);
  else
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

Colour Entity::colour(const std::string& name, const Rgb& absent, Use use) const {
  const std::string named = texture(name);
  if (named.empty()) return {spectrum(name, use).value_or(absent), {}, {}};
  const NamedTexture* t = texture_named(*this, named);
  if (t && t->colour) return *t->colour;
  // pbrt-v4's "scale" multiplies colours by numbers.
  if (t && t->number && !(t->number->texture && t->number->texture->alpha)) {
    const Number& n = *t->number;
    Colour grey{Rgb(n.factor), n.texture, {}};
    if (n.texture)
      grey.curve = [curve = n.curve](const Rgb& texel) {
        const float mean = mean_of(texel);
        return Rgb(curve ? curve(mean) : mean);
      };
    return grey;
  }
  lose("there is no colour texture \"{}\"", shown(named));
  return {absent, {}, {}};
}

std::optional<Number> Entity::varying(const std::string& name) const {
  if (const std::string named = texture(name); !named.empty()) {
    const NamedTexture* t = texture_named(*this, named);
    if (t && t->number) return t->number;
    lose("there is no texture of numbers \"{}\"", shown(named));
    return {};
  }
  const double* v = numbers(name, {"float"}, 1);
  return v ? std::optional<Number>({static_cast<float>(*v), {}, {}}) : std::nullopt;
}

Number Entity::varying(const std::string& name, double absent) const {
  return varying(name).value_or(Number{static_cast<float>(absent), {}, {}});
}

}  // namespace tdpt::foreign::pbrt
