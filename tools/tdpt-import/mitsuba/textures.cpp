#include "tools/tdpt-import/mitsuba/textures.h"

#include <fmt/format.h>

#include "libcommon/base/words.h"

namespace tdpt::foreign::mitsuba {
namespace {

float single(double v) {
  return static_cast<float>(v);
}

Colour plain(const Rgb& c) {
  return {c, {}, {}};
}

}  // namespace

size_t Textures::image(const std::string& file, const Place& place) {
  const auto it = images_.find(file);
  if (it != images_.end()) return it->second;
  scene_.images.push_back({file, source_.read_picture(file, place)});
  return images_[file] = scene_.images.size() - 1;
}

Colour Textures::value_of(const Value& value, bool old, Of of) {
  if (is_colour(value)) return plain(colour_of(value, old, of, source_));
  if (value.object && value.object->tag == "texture") return this->of(*value.object, of);
  value.fail(fmt::format("\"{}\" is a {}, expected a colour or texture", shown(value.name, 40),
                         shown(value.tag, 40)));
}

Colour Textures::colour(const Object& object, const std::string& name, const Rgb& otherwise,
                        Of of) {
  const Value* v = object.find(name);
  return v ? value_of(*v, object.old, of) : plain(otherwise);
}

Number Textures::number(const Object& object, const std::string& name, double otherwise) {
  const Value* v = object.find(name);
  if (!v) return {single(otherwise), {}, {}};
  const Colour c = value_of(*v, object.old, Of::surface);
  Number out{mean(c.factor), c.texture, {}};
  if (out.texture) out.texture->luminance = !object.old;
  return out;
}

Rgb Textures::plain_colour(const Object& object, const std::string& name, const Rgb& otherwise,
                           Of of) {
  const Colour c = colour(object, name, otherwise, of);
  if (!c.texture) return c.factor;
  source_.lose(object.find(name)->place,
               fmt::format("the texture of \"{}\" of the {} is left out", name, described(object)));
  return otherwise;
}

double Textures::plain_number(const Object& object, const std::string& name, double otherwise) {
  return mean(plain_colour(object, name, Rgb(single(otherwise))));
}

Colour Textures::of(const Object& texture, Of of, bool raw) {
  const auto key = std::tuple{&texture, of, raw};
  if (const auto it = made_.find(key); it != made_.end()) return it->second;
  Colour c = read(texture, of, raw);
  return made_[key] = c;
}

Colour Textures::read(const Object& texture, Of of, bool raw) {
  const std::string& type = texture.type;
  const auto inner = [&](const char* name, double otherwise) {
    const Value* v = texture.find(name);
    return v ? value_of(*v, texture.old, of) : plain(Rgb(single(otherwise)));
  };
  if (type == "bitmap" || type == "ldrtexture") return bitmap(texture, raw);
  if (type == "checkerboard") return checkerboard(texture);
  if (type == "scale") {
    const Rgb scale = plain_colour(texture, "scale", Rgb(1), of);
    const auto nested = texture.nested("texture");
    Colour c =
        nested.empty() ? colour(texture, "value", Rgb(1), of) : this->of(*nested[0], of, raw);
    c.factor = c.factor * scale;
    return c;
  }
  if (type == "uniform" || type == "rawconstant" || type == "d65") {
    const auto nested = texture.nested("texture");
    const Colour c = nested.empty() ? inner(texture.find("color") ? "color" : "value", 1)
                                    : this->of(*nested[0], of, raw);
    // Outside of what is visible.
    texture.ignore({"wavelength_min", "wavelength_max", "lambda_min", "lambda_max"});
    return {c.factor * single(texture.number("scale", 1)), c.texture, {}};
  }
  if (type == "srgb") {
    texture.ignore({"unbounded"});  // a check
    return inner("color", 0);
  }
  if (type == "irregular" && texture.find("wavelengths")) {
    const auto nm = split(texture.needed_text("wavelengths")),
               v = split(texture.needed_text("values"));
    if (nm.size() != v.size() || nm.empty())
      texture.fail(fmt::format("{} wavelengths and {} values", nm.size(), v.size()));
    std::string pairs;
    for (size_t i = 0; i < nm.size(); ++i) pairs += nm[i] + ":" + v[i] + " ";
    return plain(
        colour_of({"spectrum", "", texture.place, {{"value", {pairs}}}}, texture.old, of, source_));
  }
  if (type == "blackbody") {
    if (!texture.find("temperature")) texture.fail("the blackbody has no \"temperature\"");
    // Outside of what is visible.
    texture.ignore({"wavelength_min", "wavelength_max", "lambda_min", "lambda_max"});
    const std::string kelvin = fmt::format("{}", texture.number("temperature", 0));
    return plain(colour_of({"blackbody", "", texture.place, {{"temperature", {kelvin}}}},
                           texture.old, of, source_));
  }
  source_.lose(texture.place, fmt::format("textures of type \"{}\" are not read: grey of 0.5 in "
                                          "their place",
                                          shown(type, 40)));
  texture.ignore_all();
  return plain(Rgb(0.5f));
}

// Mitsuba's v = 0 is the top row of an image, as glTF's.
void Textures::place(const Object& texture, Texture& out) {
  if (texture.old) {
    const double both = texture.number("uvscale", 1);
    texture.ignore({"coordinates"});  // "uv" is the only one
    out.map = {texture.number("uscale", both), 0,
               texture.number("uoffset", 0),   0,
               texture.number("vscale", both), texture.number("voffset", 0)};
  }
  if (texture.find("to_uv")) {
    const Affine m = texture.map("to_uv", source_);
    out.map = {m.x.x, m.y.x, m.t.x, m.x.y, m.y.y, m.t.y};
  }
}

Texture::Wrap Textures::wrap(const Object& texture, const std::string& mode) {
  if (mode == "mirror") return Texture::Wrap::mirror;
  if (mode == "clamp") return Texture::Wrap::clamp;
  if (mode != "repeat")
    source_.lose(texture.place, fmt::format("the wrap mode \"{}\" becomes clamp", shown(mode, 40)));
  return mode == "repeat" ? Texture::Wrap::repeat : Texture::Wrap::clamp;
}

Colour Textures::bitmap(const Object& texture, bool raw) {
  Texture t;
  const std::string file = texture.needed_text("filename");
  t.image = image(file, texture.find("filename")->place);
  place(texture, t);
  t.nearest = texture.text("filter_type", "bilinear") == "nearest";
  const std::string mode = texture.text("wrap_mode", "repeat");
  t.wrap_u = wrap(texture, texture.text("wrap_mode_u", mode));
  t.wrap_v = wrap(texture, texture.text("wrap_mode_v", mode));
  // 0: as the file says.
  const double gamma = texture.number("gamma", texture.old && raw ? 1 : 0);
  t.srgb = gamma != 1 && !texture.flag("raw", false);
  if (gamma != 0 && gamma != 1 && gamma != -1)
    source_.lose(texture.place, fmt::format("a gamma of {:g} becomes that of sRGB", gamma));
  const std::string channel = texture.text("channel", "");
  if (channel == "a")
    t.alpha = true;
  else if (!channel.empty())
    source_.lose(texture.place,
                 fmt::format("of the picture's channel \"{}\" all three colours are taken",
                             shown(channel, 40)));
  texture.ignore({"cache", "max_anisotropy", "accel", "format"});  // how it is kept and filtered
  return {Rgb(1), t, {}};
}

Colour Textures::checkerboard(const Object& texture) {
  const Rgb a = plain_colour(texture, "color0", Rgb(0.4f));
  const Rgb b = plain_colour(texture, "color1", Rgb(0.2f));
  scene_.images.push_back({"checkerboard", {}, 2, 2, {a, b, b, a}});
  Texture t;
  t.image = scene_.images.size() - 1;
  t.nearest = true;
  place(texture, t);
  return {Rgb(1), t, {}};
}

}  // namespace tdpt::foreign::mitsuba
