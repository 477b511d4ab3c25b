#include "libcommon/formats/environment.h"

#include <gtest/gtest.h>
#include <cmath>

#include "libcommon/formats/picture.h"
#include "libcommon/testing/files/refusal.h"

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
void read(const std::string& bytes) {
  parse_environment(bytes, "sky");
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

TEST(Environment, IsAMapOfAllDirectionsTwiceAsWideAsHigh) {
  for (const auto& [width, height] : {std::pair(2, 1), {512, 256}, {511, 256}, {512, 257}})
    EXPECT_NO_THROW(read(exr(grey(width, height))));
  for (const auto& [width, height] :
       {std::pair(1, 1), {1, 2}, {400, 300}, {300, 400}, {600, 100}, {64, 64}, {3, 2}})
    testing::expect_refused({{exr(grey(width, height)), "", "a latitude-longitude map"}}, read);
}

TEST(Environment, WhatIsNoneIsRefused) {
  const auto with = [](float value, int channel) {
    Picture p = grey(8, 4);
    p.pixels[13][channel] = value;
    return exr(p);
  };
  EXPECT_NO_THROW(read(with(1e29f, 0)));
  testing::expect_refused({{"", "", "is no environment"},
                           {"hello", "", "is no environment"},
                           {"\x89PNG\r\n\x1a\n", "", "is no environment"},
                           {exr(grey(8194, 1)), "header", "8194 x 1"},
                           {exr(grey(2, 4097)), "header", "2 x 4097"},
                           {with(NAN, 0), "pixel 5 1", "R is nan"},
                           {with(-0.5f, 1), "pixel 5 1", "G is -0.5"},
                           {with(1e31f, 2), "pixel 5 1", "B is 1e+31"},
                           {with(INFINITY, 2), "pixel 5 1", "half pixels end at 65504"},
                           {exr(grey(8, 4, 0)), "", "holds no light"},
                           {exr(grey(8, 4, 1e-31f)), "", "holds no light"}},
                          read);
}

}  // namespace tdpt::environment_test
