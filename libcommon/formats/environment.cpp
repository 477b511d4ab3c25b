#include "libcommon/formats/environment.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/formats/picture.h"

namespace tdpt {
namespace {

constexpr int kMostWidth = 8192, kMostHeight = 4096;
// Limits as for emissive surfaces. Fainter values become black, lest luminance underflow before
// radiance does.
constexpr float kBrightest = 1e30f, kFaintest = 1e-30f;
// Excludes unfolded cubes (4:3, 3:4) and mirrored balls (1:1), which would be misread as
// latitude-longitude maps; tolerates a missing row or column.
constexpr double kLeastAspect = 1.9, kMostAspect = 2.1;

Picture read(std::string_view bytes, const std::string& name) {
  if (is_radiance_hdr(bytes)) return parse_radiance_hdr(bytes, name, kMostWidth, kMostHeight);
  if (bytes.starts_with("\x76\x2f\x31\x01"))
    return parse_exr_picture(bytes, name, kMostWidth, kMostHeight);
  throw InputError(name, "", "is no environment, expected OpenEXR (.exr) or Radiance (.hdr)");
}

void check(Picture& p, const std::string& name) {
  const double aspect = static_cast<double>(p.width) / p.height;
  if (!(aspect >= kLeastAspect && aspect <= kMostAspect))
    throw InputError(name, "",
                     fmt::format("{} x {} pixels, expected a latitude-longitude map, twice as wide "
                                 "as high",
                                 p.width, p.height));
  bool shines = false;
  for (size_t i = 0; i < p.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      float& value = p.pixels[i][c];
      if (!(value >= 0 && value <= kBrightest))
        throw InputError(
            name,
            fmt::format("pixel {} {}", i % static_cast<size_t>(p.width),
                        i / static_cast<size_t>(p.width)),
            fmt::format("{} is {}, expected a radiance from 0 to {:.0e}{}", "RGB"[c], value,
                        kBrightest, std::isinf(value) ? " (half pixels end at 65504)" : ""));
      if (value < kFaintest) value = 0;
      shines |= value > 0;
    }
  if (!shines) throw InputError(name, "", "holds no light: every pixel is black");
}

}  // namespace

Sky::Map parse_environment(std::string_view bytes, const std::string& name) {
  Picture p = read(bytes, name);
  check(p, name);
  return {p.width, p.height, std::move(p.pixels)};
}

}  // namespace tdpt
