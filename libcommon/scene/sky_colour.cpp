#include "libcommon/scene/sky_colour.h"

#include <charconv>
#include <string_view>

namespace tdpt {
namespace {

std::optional<float> number(std::string_view text) {
  float value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return value;
}

}  // namespace

bool means_colour(const std::string& text) {
  if (text.find('/') != std::string::npos) return false;
  for (const char* suffix : {".exr", ".hdr", ".pic"})
    if (text.ends_with(suffix)) return false;
  return text.find(',') != std::string::npos || number(text);
}

std::optional<Rgb> parse_colour(const std::string& text, std::string& expected) {
  Rgb colour{};
  size_t start = 0;
  for (int c = 0; c < 3; ++c) {
    const size_t end = c < 2 ? text.find(',', start) : text.size();
    const auto value = end == std::string::npos
                           ? std::nullopt
                           : number(std::string_view(text).substr(start, end - start));
    if (!value || !(*value >= 0 && *value <= kBrightestSky)) {
      expected = "a file, or R,G,B: three numbers from 0 to 1e30";
      return {};
    }
    colour[c] = *value;
    start = end + 1;
  }
  if (max_component(colour) >= kFaintestSky) return colour;
  expected = "a colour that is not black";
  return {};
}

}  // namespace tdpt
