#include "libcommon/formats/environment.h"

#include <gtest/gtest.h>
#include <cmath>
#include <limits>

#include "libcommon/base/error.h"
#include "libcommon/formats/picture.h"
#include "libcommon/math/rng.h"

namespace tdpt::environment_test {

Picture grey(int width, int height, float value = 1) {
  return {width, height,
          std::vector<Rgb>(static_cast<size_t>(width) * static_cast<size_t>(height), Rgb(value))};
}
std::string exr(const Picture& picture) {
  ExrFile file;
  file.picture = picture;
  return exr_bytes(file);
}
std::string complaint(std::string_view bytes) {
  try {
    parse_environment(bytes, "sky");
    return "";
  } catch (const InputError& e) {
    return e.what();
  }
}

TEST(Environment, OpenExrAndRadianceAreKnownByTheirBytes) {
  Picture p = grey(4, 2);
  p.pixels[5] = {1e6f, 2, 0};
  const Sky::Map map = parse_environment(exr(p), "sky");
  EXPECT_EQ(map.width, 4);
  EXPECT_EQ(map.height, 2);
  EXPECT_EQ(map.texels, p.pixels);
  const std::string hdr = "#?RGBE\n\n-Y 1 +X 2\n\x80\x80\x80\x81\x80\x40\x20\x82";
  EXPECT_EQ(parse_environment(hdr, "sky").texels, (std::vector<Rgb>{Rgb(1), Rgb(2, 1, 0.5f)}));
}

TEST(Environment, WhatIsNoPictureIsRefused) {
  for (const std::string bytes : {"", "hello", "\x89PNG\r\n\x1a\n", "glTF\2"})
    EXPECT_EQ(complaint(bytes),
              "sky: is no environment, expected OpenEXR (.exr) or Radiance (.hdr)");
}

TEST(Environment, WhatIsTwiceAsWideAsHighIsAMapOfAllDirections) {
  for (const auto& [width, height] : {std::pair(2, 1), {512, 256}, {511, 256}, {512, 257}})
    EXPECT_EQ(complaint(exr(grey(width, height))), "");
  for (const auto& [width, height] :
       {std::pair(1, 1), {1, 2}, {400, 300}, {300, 400}, {600, 100}, {64, 64}, {3, 2}})
    EXPECT_EQ(complaint(exr(grey(width, height))),
              "sky: " + std::to_string(width) + " x " + std::to_string(height) +
                  " pixels, expected a latitude-longitude map, twice as wide as high");
}

TEST(Environment, TheLargestSize) {
  EXPECT_EQ(complaint(exr(grey(8194, 1))),
            "sky:header: 8194 x 1 pixels, expected at most 8192 x 4096");
  EXPECT_EQ(complaint(exr(grey(2, 4097))),
            "sky:header: 2 x 4097 pixels, expected at most 8192 x 4096");
}

TEST(Environment, ValuesAreNamedThatAreNoRadiance) {
  const auto with = [](float value, int channel) {
    Picture p = grey(8, 4);
    p.pixels[13][channel] = value;
    return complaint(exr(p));
  };
  constexpr float inf = std::numeric_limits<float>::infinity();
  EXPECT_EQ(with(1e29f, 0), "");
  EXPECT_EQ(with(NAN, 0), "sky:pixel 5 1: R is nan, expected a radiance from 0 to 1e+30");
  EXPECT_EQ(with(-0.5f, 1), "sky:pixel 5 1: G is -0.5, expected a radiance from 0 to 1e+30");
  EXPECT_EQ(with(1e31f, 2), "sky:pixel 5 1: B is 1e+31, expected a radiance from 0 to 1e+30");
  EXPECT_EQ(with(inf, 2),
            "sky:pixel 5 1: B is inf, expected a radiance from 0 to 1e+30 (half pixels end at "
            "65504)");
}

TEST(Environment, BlackHoldsNoLight) {
  EXPECT_EQ(complaint(exr(grey(8, 4, 0))), "sky: holds no light: every pixel is black");
  EXPECT_EQ(complaint(exr(grey(8, 4, 1e-31f))), "sky: holds no light: every pixel is black");
}

TEST(Environment, CutShortAnywhereItIsRefused) {
  Picture p = grey(64, 32);
  Rng rng(1, 0, 0);
  for (Rgb& texel : p.pixels) texel = Rgb(static_cast<float>(rng.uniform()));
  const std::string bytes = exr(p);
  for (size_t n = 0; n < bytes.size(); n += 97)
    EXPECT_TRUE(complaint(bytes.substr(0, n)).starts_with("sky: is ")) << n;
}

TEST(Environment, DamagedFilesAreReadOrRefused) {
  const std::string bytes = exr(grey(16, 8));
  Rng rng(2, 0, 0);
  for (int i = 0; i < 2000; ++i) {
    std::string damaged = bytes;
    for (int k = 0; k < 3; ++k) {
      const auto at = static_cast<size_t>(rng.uniform() * static_cast<double>(bytes.size()));
      damaged[at] = static_cast<char>(256 * rng.uniform());
    }
    complaint(damaged);
  }
}

}  // namespace tdpt::environment_test
