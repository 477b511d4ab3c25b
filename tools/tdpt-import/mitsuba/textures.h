// Numbers and colours of Mitsuba scenes as linear Rec.709, and those that may have a texture.
#pragma once
#include <map>
#include <unordered_map>

#include "tools/tdpt-import/described.h"
#include "tools/tdpt-import/mitsuba/object.h"

namespace tdpt::foreign::mitsuba {

/// What a colour is of: Mitsuba 3 lets a spectrum of equal energy reflect white light as white and
/// shine yellowish.
enum class Of { surface, light };

bool is_colour(const Value& value);
/// Of a float, rgb, srgb, spectrum or blackbody.
Rgb colour_of(const Value& value, bool old, Of of, Source& source);

float mean(const Rgb& c);
bool is_grey(const Rgb& c);

class Textures {
 public:
  Textures(Described& scene, Source& source) : scene_(scene), source_(source) {}

  /// The value of that name of an object; `otherwise` without one.
  Colour colour(const Object& object, const std::string& name, const Rgb& otherwise,
                Of of = Of::surface);
  Number number(const Object& object, const std::string& name, double otherwise);
  /// The same where a texture cannot stand: it is named as lost and `otherwise` taken.
  Rgb plain_colour(const Object& object, const std::string& name, const Rgb& otherwise,
                   Of of = Of::surface);
  double plain_number(const Object& object, const std::string& name, double otherwise);
  /// A texture object itself. `raw`: 8-bit files without a gamma of their own are numbers.
  Colour of(const Object& texture, Of of, bool raw = false);
  /// Index of the image in a file.
  size_t image(const std::string& file, const Place& place);

 private:
  Colour value_of(const Value& value, bool old, Of of);
  Colour read(const Object& texture, Of of, bool raw);
  Colour bitmap(const Object& texture, bool raw);
  Colour checkerboard(const Object& texture);
  void place(const Object& texture, Texture& out);
  Texture::Wrap wrap(const Object& texture, const std::string& mode);

  Described& scene_;
  Source& source_;
  std::map<std::string, size_t> images_;
  std::map<std::tuple<const Object*, Of, bool>, Colour> made_;
};

}  // namespace tdpt::foreign::mitsuba
