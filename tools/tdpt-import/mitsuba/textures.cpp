#include <cmath>

#include <fmt/format.h>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/materials.h"
#include "tools/tdpt-import/mitsuba/mitsuba.h"

namespace tdpt::foreign::mitsuba {
namespace {

// ---- Colours ----

using Samples = std::vector<std::array<double, 2>>;

constexpr double kMost = 1e30;  // of a component

// Parses one or three numbers, or #rrggbb.
Rgb rgb_numbers(const Element& value) {
  const auto words = split(value.attribute());
  if (words.size() == 1 && words[0][0] == '#') {
    if (words[0].size() != 7 ||
        words[0].find_first_not_of("0123456789abcdefABCDEF", 1) != std::string::npos)
      value.fail(fmt::format("\"{}\" is no colour #rrggbb", shown(words[0], 40)));
    const auto bits = static_cast<uint32_t>(std::stoul(words[0].substr(1), nullptr, 16));
    return Rgb(single(bits >> 16 & 255), single(bits >> 8 & 255), single(bits & 255)) / 255;
  }
  if (words.size() != 1 && words.size() != 3)
    value.fail(fmt::format("a colour of {} numbers, expected 3", words.size()));
  const auto at = [&](size_t i) {
    return single(value.finite(words[words.size() == 1 ? 0 : i], kMost));
  };
  return {at(0), at(1), at(2)};
}

// The colour of a light whose spectrum is 1 at all wavelengths; it is not white.
Rgb of_equal_energy() {
  return rgb_of_xyz(Rgb(1));
}

// CIE standard illuminant D65 from 380 nm on, every 10 nm.
constexpr double kD65[] = {49.98,  54.65,  82.75,  91.49,  93.43,  86.68,  104.86, 117.01, 117.81,
                           114.86, 115.92, 108.81, 109.35, 107.80, 104.79, 107.69, 104.41, 104.05,
                           100.00, 96.33,  95.79,  88.69,  90.01,  89.60,  87.70,  83.29,  83.70,
                           80.03,  80.21,  82.28,  78.28,  69.72,  71.61,  74.35,  61.60,  69.89,
                           75.09,  63.59,  46.42,  66.81,  63.38};

// The spectrum at a wavelength [nm]; 0 outside its samples.
double value_at(const Samples& samples, double nm) {
  if (nm < samples.front()[0] || nm > samples.back()[0]) return 0;
  for (size_t i = 1; i < samples.size(); ++i)
    if (nm <= samples[i][0]) {
      const double t = (nm - samples[i - 1][0]) / (samples[i][0] - samples[i - 1][0]);
      return samples[i - 1][1] * (1 - t) + samples[i][1] * t;
    }
  return samples.back()[1];
}

// The colour of a surface in the light D65, which is white.
Rgb reflected_colour(const Samples& samples) {
  Samples light, reflected;
  for (int nm = 380; nm <= 780; nm += 2) {
    const int i = (nm - 380) / 10, rest = (nm - 380) % 10;
    const double d65 = rest == 0 ? kD65[i] : kD65[i] + (kD65[i + 1] - kD65[i]) * rest / 10;
    light.push_back({static_cast<double>(nm), d65});
    reflected.push_back({static_cast<double>(nm), d65 * value_at(samples, nm)});
  }
  const Rgb c = rgb_of_spectrum(reflected), white = rgb_of_spectrum(light);
  return {c.x / white.x, c.y / white.y, c.z / white.z};
}

// The colour of a spectrum; `words` are a wavelength [nm] and a value in turn.
Rgb sampled_colour(const std::vector<std::string>& words, const Element& value, Role role) {
  if (words.empty() || words.size() % 2 != 0)
    value.fail(
        fmt::format("a spectrum of {} numbers, expected pairs wavelength:value", words.size()));
  Samples samples;
  for (size_t i = 0; i < words.size(); i += 2) {
    const double nm = value.finite(words[i], kMost);
    if (!(nm > 0 && nm < 1e6)) value.fail(fmt::format("a wavelength of {} nm", nm));
    if (i > 0 && !(nm > samples.back()[0])) value.fail("wavelengths are not in ascending order");
    samples.push_back({nm, value.finite(words[i + 1], kMost)});
  }
  if (!value.old && role == Role::surface) return reflected_colour(samples);
  samples.insert(samples.begin(), {samples.front()[0], 0});
  samples.push_back({samples.back()[0], 0});
  return rgb_of_spectrum(samples) * of_equal_energy();
}

// Reads a file of pairs with comments, pairs with colons, or one number.
Rgb spectrum_colour(const Element& value, Role role) {
  if (value.attributes.contains("filename")) {
    std::string numbers;
    const std::string text = value.source->read(value.attribute("filename"), value.place);
    for (const std::string& line : split(text, "\r\n"))
      numbers += line.substr(0, line.find('#')) + " ";
    return sampled_colour(split(numbers), value, role);
  }
  const std::string& text = value.attribute();
  if (text.find(':') != text.npos) return sampled_colour(split(text, " :,\t\r\n"), value, role);
  const Rgb c = rgb_numbers(value);
  const bool is_even = split(text).size() == 1 && !value.old && role == Role::light;
  return is_even ? c * of_equal_energy() : c;
}

// The radiance of a black body per nanometre [W/m2/sr/nm], as Mitsuba has it.
Rgb blackbody_colour(double kelvin, const Element& value) {
  if (!(kelvin > 0 && kelvin < 1e6)) value.fail(fmt::format("a temperature of {} K", kelvin));
  Samples samples;
  for (double nm = 360; nm <= 830; nm += 5) {
    const double m = nm * 1e-9, c = 299792458, h = 6.62607015e-34, k = 1.380649e-23;
    samples.push_back(
        {nm, 2e-9 * h * c * c / (std::pow(m, 5) * std::expm1(h * c / (m * k * kelvin)))});
  }
  return rgb_of_spectrum(samples) * of_equal_energy();
}

bool is_colour(const Element& value) {
  return is_one_of(value.tag, "float integer rgb srgb spectrum blackbody");
}

// The colour of a float, rgb, srgb, spectrum or blackbody.
Rgb colour_of(const Element& value, Role role) {
  if (value.tag == "rgb") return rgb_numbers(value);
  if (value.tag == "srgb") {
    const auto linear = [](float v) {
      return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
    };
    const Rgb c = rgb_numbers(value);
    return {linear(c.x), linear(c.y), linear(c.z)};
  }
  if (value.tag == "spectrum") return spectrum_colour(value, role);
  if (value.tag == "blackbody") {
    std::string kelvin = value.attribute("temperature");
    kelvin.resize(kelvin.find_last_not_of(" kK") + 1);
    const std::string scale = value.attributes.contains("scale") ? value.attribute("scale") : "1";
    return blackbody_colour(value.finite(kelvin, kMost), value) * single(value.finite(scale));
  }
  return Rgb(single(value.finite(value.attribute(), kMost)));
}

// ---- Textures ----

// The map of texture coordinates. v = 0 is the top row of an image in Mitsuba and in glTF.
std::array<double, 6> uv_map(const Element& texture) {
  std::array<double, 6> map{1, 0, 0, 0, 1, 0};
  if (texture.old) {
    const double both = texture.number("uvscale", 1);
    texture.ignore("coordinates");  // "uv" is the only one
    map = {texture.number("uscale", both), 0,
           texture.number("uoffset", 0),   0,
           texture.number("vscale", both), texture.number("voffset", 0)};
  }
  if (!texture.find("to_uv")) return map;
  const Affine m = texture.transform("to_uv");
  return {m.x.x, m.y.x, m.t.x, m.x.y, m.y.y, m.t.y};
}

Texture::Wrap wrap_of(const Element& texture, const std::string& mode) {
  if (mode == "mirror") return Texture::Wrap::mirror;
  if (mode == "repeat") return Texture::Wrap::repeat;
  if (mode != "clamp")
    texture.lose(fmt::format("the wrap mode \"{}\" becomes clamp", shown(mode, 40)));
  return Texture::Wrap::clamp;
}

Colour read_bitmap(Context& in, const Element& texture) {
  Texture t;
  t.image = image(in, texture);
  t.map = uv_map(texture);
  t.nearest = texture.text("filter_type", "bilinear") == "nearest";
  const std::string mode = texture.text("wrap_mode", "repeat");
  t.wrap_u = wrap_of(texture, texture.text("wrap_mode_u", mode));
  t.wrap_v = wrap_of(texture, texture.text("wrap_mode_v", mode));
  // A gamma of 0 means that of the file.
  const double gamma = texture.number("gamma", 0);
  t.srgb = gamma != 1 && !texture.flag("raw", false);
  if (gamma != 0 && gamma != 1 && gamma != -1)
    texture.lose(fmt::format("a gamma of {:g} becomes that of sRGB", gamma));
  const std::string channel = texture.text("channel", "");
  t.alpha = channel == "a";
  if (!t.alpha && !channel.empty())
    texture.lose(fmt::format("of the picture's channel \"{}\" all three colours are taken",
                             shown(channel, 40)));
  texture.ignore("cache max_anisotropy accel format");  // how it is kept and filtered
  return {Rgb(1), t};
}

Colour read_checkerboard(Context& in, const Element& texture) {
  const Rgb a = plain_colour(in, texture, "color0", Rgb(0.4f));
  const Rgb b = plain_colour(in, texture, "color1", Rgb(0.2f));
  in.scene.images.push_back({"checkerboard", {}, 2, 2, {a, b, b, a}});
  Texture t;
  t.image = in.scene.images.size() - 1;
  t.nearest = true;
  t.map = uv_map(texture);
  return {Rgb(1), t};
}

// Reads a spectrum from a list of wavelengths and a list of values.
Colour read_irregular(const Element& texture, Role role) {
  const auto nm = split(texture.needed_text("wavelengths")),
             values = split(texture.needed_text("values"));
  if (nm.size() != values.size())
    texture.fail(fmt::format("{} wavelengths and {} values", nm.size(), values.size()));
  std::vector<std::string> pairs;
  for (size_t i = 0; i < nm.size(); ++i) pairs.insert(pairs.end(), {nm[i], values[i]});
  return {sampled_colour(pairs, *texture.find("values"), role)};
}

Colour read_texture(Context& in, const Element& texture, Role role) {
  const std::string& type = texture.type;
  texture.ignore("wavelength_min wavelength_max lambda_min lambda_max");  // of what is visible
  // The nested texture, or the value of that name if there is none.
  const auto inner = [&](const std::string& name) {
    const auto nested = texture.nested("texture");
    return nested.empty() ? colour(in, texture, name, Rgb(1), role)
                          : mitsuba::texture(in, *nested[0], role);
  };
  if (is_one_of(type, "bitmap ldrtexture")) return read_bitmap(in, texture);
  if (type == "checkerboard") return read_checkerboard(in, texture);
  if (is_one_of(type, "scale uniform rawconstant d65")) {
    const Rgb scale = plain_colour(in, texture, "scale", Rgb(1), role);
    Colour c = inner(texture.find("color") ? "color" : "value");
    c.factor = c.factor * scale;
    return c;
  }
  if (type == "srgb") {
    texture.ignore("unbounded");  // a check
    return colour(in, texture, "color", Rgb(0), role);
  }
  if (type == "irregular" && texture.find("wavelengths")) return read_irregular(texture, role);
  if (type == "blackbody" && texture.find("temperature"))
    return {blackbody_colour(texture.number("temperature", 0), texture)};
  texture.lose(fmt::format("textures of type \"{}\" are not read: grey of 0.5 in their place",
                           shown(type, 40)));
  texture.ignore_all();
  return {Rgb(0.5f)};
}

}  // namespace

float mean(const Rgb& c) {
  return (c.x + c.y + c.z) / 3;
}
bool is_grey(const Rgb& c) {
  return c.x == c.y && c.y == c.z;
}

Colour colour(Context& in, const Element& object, const std::string& name, const Rgb& otherwise,
              Role role) {
  const Element* v = object.find(name);
  if (!v) return Colour{otherwise};
  if (is_colour(*v)) return {colour_of(*v, role)};
  if (v->tag == "texture") return texture(in, *v->object, role);
  v->fail(fmt::format("\"{}\" is a {}, expected a colour or texture", name, shown(v->tag, 40)));
}

Number number(Context& in, const Element& object, const std::string& name, double otherwise) {
  const Colour c = colour(in, object, name, Rgb(single(otherwise)));
  Number out{object.find(name) ? mean(c.factor) : single(otherwise), c.texture, {}};
  if (out.texture) out.texture->luminance = !object.old;
  return out;
}

Rgb plain_colour(Context& in, const Element& object, const std::string& name, const Rgb& otherwise,
                 Role role) {
  const Colour c = colour(in, object, name, otherwise, role);
  if (!c.texture) return c.factor;
  object.find(name)->lose(
      fmt::format("the texture of \"{}\" of the {} is left out", name, object.described()));
  return otherwise;
}

double plain_number(Context& in, const Element& object, const std::string& name, double otherwise) {
  return mean(plain_colour(in, object, name, Rgb(single(otherwise))));
}

Colour texture(Context& in, const Element& object, Role role) {
  const auto key = std::pair{&object, role};
  if (const auto it = in.textures.find(key); it != in.textures.end()) return it->second;
  return in.textures[key] = read_texture(in, object, role);
}

size_t image(Context& in, const Element& object) {
  const std::string file = object.needed_text("filename");
  const auto it = in.images.find(file);
  if (it != in.images.end()) return it->second;
  const Place& place = object.find("filename")->place;
  in.scene.images.push_back({file, object.source->read_picture(file, place)});
  return in.images[file] = in.scene.images.size() - 1;
}

}  // namespace tdpt::foreign::mitsuba
