// Textures, by pbrt-v3's textures/*.cpp and pbrt-v4's textures.cpp: (s, t) = (uscale u + udelta,
// vscale v + vdelta), (0, 0) is the lower left corner of an image, v grows upwards.
#include "tools/tdpt-import/pbrt/textures.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/images.h"

namespace tdpt::foreign::pbrt {
namespace {

// One way to write what follows for colours and numbers.
template <class Value>
struct Of;
template <>
struct Of<Colour> {
  using Plain = Rgb;
  static float mean(const Rgb& c) { return (c.x + c.y + c.z) / 3; }
};
template <>
struct Of<Number> {
  using Plain = float;
};

float each(float v, const std::function<float(float)>& f) {
  return f(v);
}
Rgb each(const Rgb& v, const std::function<float(float)>& f) {
  return {f(v.x), f(v.y), f(v.z)};
}

// Passes the value through f, componentwise.
template <class Value>
void pass(Value& value, const std::function<float(float)>& f) {
  if (!value.texture) {
    value.factor = each(value.factor, f);
    return;
  }
  value.curve = [f, factor = value.factor, before = value.curve](const auto& texel) {
    return each((before ? before(texel) : texel) * factor, f);
  };
  value.factor = typename Of<Value>::Plain(1);
}

bool is_file_of(const std::string& name, const char* extension) {
  if (name.size() < 4) return false;
  std::string end = name.substr(name.size() - 4);
  std::transform(end.begin(), end.end(), end.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return end == extension;
}

// The map from the mesh's coordinates in glTF to (s, 1 - t).
std::array<double, 6> map_of(Context& context, const Parameters& list) {
  const std::string mapping = list.text("mapping", "uv");
  if (mapping != "uv") {
    context.source.lose(list.place, fmt::format("textures with the mapping \"{}\" use the "
                                                "coordinates of the mesh",
                                                shown(mapping)));
    list.ignore({"v1", "v2", "udelta", "vdelta"});  // of that mapping
    return {1, 0, 0, 0, 1, 0};
  }
  const double su = list.number("uscale", 1), sv = list.number("vscale", 1);
  const double du = list.number("udelta", 0), dv = list.number("vdelta", 0);
  return {su, 0, du, 0, sv, 1 - sv - dv};
}

Texture::Wrap wrap_of(Context& context, const Parameters& list) {
  const std::string wrap = list.text("wrap", "repeat");
  if (wrap == "black")
    context.source.lose(list.place, "textures that are black outside their image repeat its edge");
  if (wrap == "clamp" || wrap == "black") return Texture::Wrap::clamp;
  if (wrap != "repeat")
    context.source.lose(list.place, fmt::format("the texture's wrap mode \"{}\" is not known; "
                                                "it repeats",
                                                shown(wrap)));
  return Texture::Wrap::repeat;
}

template <class Value>
Value imagemap(Context& context, const Parameters& list) {
  constexpr bool is_number = std::is_same_v<Value, Number>;
  const std::string file = list.text("filename");
  if (file.empty()) Source::fail(list.place, "the image texture names no file");
  const bool is_png = is_file_of(file, ".png");
  bool srgb = true;
  double gamma = 0;
  if (context.v4) {
    // Only PNGs heed the encoding; other files of bytes are sRGB.
    const std::string encoding = list.text("encoding", "sRGB");
    srgb = !is_png || encoding == "sRGB";
    if (!srgb && encoding != "linear") {
      if (encoding.starts_with("gamma ")) gamma = std::strtod(encoding.c_str() + 6, nullptr);
      if (!(gamma > 0 && gamma < 100))
        Source::fail(list.place, fmt::format("\"{}\" is not an encoding", shown(encoding)));
    }
  } else {
    srgb = list.flag("gamma", is_png || is_file_of(file, ".tga"));
  }
  Value value;
  value.texture = picture(context, file, list.place, srgb);
  Texture& texture = *value.texture;
  texture.map = map_of(context, list);
  texture.wrap_u = texture.wrap_v = wrap_of(context, list);
  texture.nearest = list.text("filter", "bilinear") == "point";
  if constexpr (is_number)
    if (!context.v4) {  // luminance first, then decoded
      texture.luminance = true;
      texture.srgb = false;
      if (srgb) pass(value, [](float v) { return linear_of(Rgb(v)).x; });
    }
  if (is_number && context.v4)
    texture.alpha = context.has_alpha(texture.image);  // pbrt prefers it for numbers
  if (gamma > 0)
    pass(value,
         [gamma](float v) { return std::pow(std::max(v, 0.0f), static_cast<float>(gamma)); });
  value.factor = value.factor * static_cast<float>(list.number("scale", 1));
  if (context.v4 && list.flag("invert", false))
    pass(value, [](float v) { return std::max(0.0f, 1 - v); });
  list.ignore({"trilinear", "maxanisotropy"});  // how it is filtered
  return value;
}

template <class Value>
void lose(Context& context, const Parameters& list, const std::string& kind) {
  context.source.lose(list.place,
                      fmt::format("textures of the kind \"{}\" become one value", shown(kind)));
  list.ignore_all();
}

// A value for all of a texture that glTF cannot have.
template <class Value>
Value flat(Value value) {
  value.texture.reset();
  value.curve = nullptr;
  return value;
}

template <class Value>
Value checkerboard(Context& context, const Parameters& list, const Value& even, const Value& odd) {
  using Plain = typename Of<Value>::Plain;
  const int dimension = list.integer("dimension", 2);
  list.ignore({"aamode"});  // how it is filtered
  if (dimension != 2 || even.texture || odd.texture) {
    context.source.lose(list.place, "checkerboards in space or of textures become one value");
    list.ignore_all();
    Value mean;
    mean.factor = (flat(even).factor + flat(odd).factor) * 0.5f;
    return mean;
  }
  Image image;
  image.name = "checkerboard";
  image.width = image.height = 2;
  const Rgb a = Rgb(Plain(even.factor)), b = Rgb(Plain(odd.factor));
  image.texels = {b, a, a, b};  // s and t from 0 to 1 are in the lower left
  Value value;
  value.factor = Plain(1);
  value.texture = Texture{};
  value.texture->image = context.scene.images.size();
  value.texture->nearest = true;
  // Two cells are one image: halve (s, t), where 1 - t / 2 = (1 + (1 - t)) / 2.
  const std::array<double, 6> m = map_of(context, list);
  value.texture->map = {m[0] / 2, 0, m[2] / 2, 0, m[4] / 2, (1 + m[5]) / 2};
  context.scene.images.push_back(std::move(image));
  return value;
}

// a + (b - a) t of the texels, whichever one of the three has an image; false if several have one.
bool mix(Colour& out, const Colour& a, const Colour& b, const Number& t) {
  if (!!a.texture + !!b.texture + !!t.texture > 1) return false;
  if (t.texture) {
    if (t.texture->alpha) return false;
    out = {Rgb(1), t.texture, [=](const Rgb& texel) {
             const float mean = Of<Colour>::mean(texel);
             const float u = t.factor * (t.curve ? t.curve(mean) : mean);
             return a.factor * (1 - u) + b.factor * u;
           }};
    return true;
  }
  const Colour& image = b.texture ? b : a;
  const float u = b.texture ? t.factor : 1 - t.factor;
  const Rgb rest = (b.texture ? a : b).factor * (1 - u);
  const auto at = [=](const Rgb& texel) {
    return image.factor * (image.curve ? image.curve(texel) : texel) * u + rest;
  };
  out = image.texture ? Colour{Rgb(1), image.texture, at} : Colour{at(Rgb(1)), {}, {}};
  return true;
}
bool mix(Number& out, const Number& a, const Number& b, const Number& t) {
  if (!!a.texture + !!b.texture + !!t.texture > 1) return false;
  const Number& image = a.texture ? a : b.texture ? b : t;
  const auto at = [a, b, t, image](float texel) {
    const float x = image.curve ? image.curve(texel) : texel;
    const auto of = [x](const Number& n) { return n.texture ? n.factor * x : n.factor; };
    return of(a) + (of(b) - of(a)) * of(t);
  };
  out = image.texture ? Number{1, image.texture, at} : Number{at(1), {}, {}};
  return true;
}

}  // namespace

Texture picture(Context& context, const std::string& file, const Place& place, bool srgb) {
  Texture texture;
  texture.image = context.image(file, place);
  texture.srgb = srgb;
  return texture;
}

template <>
Colour Textures::get(Context& context, const Parameters& list, const std::string& name,
                     double absent) const {
  // pbrt-v4's textures of colours are scaled by textures of numbers.
  const Parameter* p = list.find(name);
  if (p && p->type == "float") {
    const float v = static_cast<float>(list.number(name, 1));
    return {Rgb(v), {}, {}};
  }
  return colour(context, list, name, Rgb(static_cast<float>(absent)));
}
template <>
Number Textures::get(Context& context, const Parameters& list, const std::string& name,
                     double absent) const {
  return number(context, list, name, absent);
}

template <class Value>
Value Textures::made(Context& context, const std::string& kind, const Parameters& list) {
  using Plain = typename Of<Value>::Plain;
  if (kind == "constant") return get<Value>(context, list, "value", 1);
  if (kind == "imagemap") return imagemap<Value>(context, list);
  if (kind == "checkerboard") {
    const Value even = get<Value>(context, list, "tex1", 1);
    return checkerboard(context, list, even, get<Value>(context, list, "tex2", 0));
  }
  if (kind == "scale") {
    Value a = get<Value>(context, list, context.v4 ? "tex" : "tex1", 1);
    Value b = get<Value>(context, list, context.v4 ? "scale" : "tex2", 1);
    if (a.texture && b.texture) {
      context.source.lose(list.place, "of a product of two textures only the first is kept");
      b = flat(b);
    }
    if (b.texture) std::swap(a, b);
    a.factor = a.factor * b.factor;
    return a;
  }
  if (kind == "mix") {
    const Value a = get<Value>(context, list, "tex1", 0), b = get<Value>(context, list, "tex2", 1);
    Value out;
    if (mix(out, a, b, number(context, list, "amount", 0.5))) return out;
    lose<Value>(context, list, "mix");
    out = flat(a);
    out.factor = (flat(a).factor + flat(b).factor) * 0.5f;
    return out;
  }
  if (kind == "bilerp") {
    Plain sum{};
    for (const char* corner : {"v00", "v01", "v10", "v11"})
      sum = sum + get<Value>(context, list, corner, corner[2] == '0' ? 0 : 1).factor * 0.25f;
    lose<Value>(context, list, kind);
    Value mean;
    mean.factor = sum;
    return mean;
  }
  Value value;
  value.factor = Plain(0.5f);
  for (const char* first : {"tex1", "inside"})
    if (list.find(first)) value = flat(get<Value>(context, list, first, 0.5));
  lose<Value>(context, list, kind);
  return value;
}

void Textures::make(Context& context, const std::string& name, const std::string& type,
                    const std::string& kind, const Parameters& list, const Key& key) {
  below_ = 0;
  keys_[name] = key;
  if (type == "float")
    numbers_[name] = made<Number>(context, kind, list);
  else if (type == "spectrum" || type == "color")
    colours_[name] = made<Colour>(context, kind, list);
  else
    context.source.lose(list.place,
                        fmt::format("textures of the type \"{}\" are not known", shown(type)));
  constexpr size_t kDeepest = 100;
  size_t& depth = depths_[name];
  depth = std::max(depth, below_ + 1);
  if (depth > kDeepest)
    Source::fail(list.place, fmt::format("textures of textures, more than {} deep", kDeepest));
}

// The texture that a parameter names, now used; empty: none.
std::string Textures::named(const Parameters& list, const std::string& name) const {
  const std::string texture = list.texture(name);
  if (const auto depth = depths_.find(texture); depth != depths_.end()) {
    below_ = std::max(below_, depth->second);
    keys_.at(texture).take();
  }
  return texture;
}

Colour Textures::colour(Context& context, const Parameters& list, const std::string& name,
                        const Rgb& absent, Use use) const {
  const std::string texture = named(list, name);
  if (!texture.empty()) {
    const auto it = colours_.find(texture);
    if (it != colours_.end()) return it->second;
    // pbrt-v4's "scale" multiplies colours by numbers.
    const auto number = numbers_.find(texture);
    if (number != numbers_.end() && !(number->second.texture && number->second.texture->alpha)) {
      const Number& n = number->second;
      Colour grey{Rgb(n.factor), n.texture, {}};
      if (n.texture)
        grey.curve = [curve = n.curve](const Rgb& texel) {
          const float mean = Of<Colour>::mean(texel);
          return Rgb(curve ? curve(mean) : mean);
        };
      return grey;
    }
    context.source.lose(list.place,
                        fmt::format("there is no colour texture \"{}\"", shown(texture)));
    return {absent, {}, {}};
  }
  return {colour_of(context, list, name, use, absent), {}, {}};
}

std::optional<Number> Textures::number(Context& context, const Parameters& list,
                                       const std::string& name) const {
  const std::string texture = named(list, name);
  if (!texture.empty()) {
    const auto it = numbers_.find(texture);
    if (it != numbers_.end()) return it->second;
    context.source.lose(list.place,
                        fmt::format("there is no texture of numbers \"{}\"", shown(texture)));
    return {};
  }
  const Parameter* p = list.find(name);
  if (!p || p->type != "float") return {};
  return Number{static_cast<float>(list.number(name, 0)), {}, {}};
}

Number Textures::number(Context& context, const Parameters& list, const std::string& name,
                        double absent) const {
  const auto found = number(context, list, name);
  return found ? *found : Number{static_cast<float>(absent), {}, {}};
}

}  // namespace tdpt::foreign::pbrt
