#include "libcommon/formats/picture.h"

#include <gtest/gtest.h>

#include "libcommon/base/file.h"
#include "libcommon/testing/files/refusal.h"

namespace tdpt::radiance_hdr_test {

std::string bytes(std::initializer_list<int> values) {
  std::string text;
  for (const int v : values) text += static_cast<char>(v);
  return text;
}
std::string header(int width, int height, const std::string& lines = "") {
  return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n" + lines + "\n-Y " + std::to_string(height) +
         " +X " + std::to_string(width) + "\n";
}
const std::string kTexel = bytes({128, 64, 0, 129});  // 1, 0.5, 0

std::string repeated(const std::string& text, int n) {
  std::string all;
  for (int i = 0; i < n; ++i) all += text;
  return all;
}

Picture read(const std::string& file) {
  return parse_radiance_hdr(file, "a.hdr", 8192, 4096);
}

TEST(RadianceHdr, FlatPixels) {
  const Picture p = read(header(2, 1) + kTexel + bytes({200, 100, 50, 136}));
  EXPECT_EQ(p.width, 2);
  EXPECT_EQ(p.height, 1);
  EXPECT_EQ(p.pixels, (std::vector<Rgb>{Rgb(1, 0.5f, 0), Rgb(200, 100, 50)}));
}

TEST(RadianceHdr, NoExponentIsBlack) {
  EXPECT_EQ(read(header(1, 1) + bytes({9, 9, 9, 0})).pixels[0], Rgb(0));
}

TEST(RadianceHdr, RunsOfEachByte) {
  // 10 pixels: red 128 throughout, green 0..9, blue 3 x 7 and then literals, exponent 129.
  const std::string row = bytes({2,   2,   0, 10,                       //
                                 138, 128,                              //
                                 10,  0,   1, 2,  3, 4, 5, 6, 7, 8, 9,  //
                                 131, 7,   7, 1,  2, 3, 4, 5, 6, 0,     //
                                 138, 129});
  const Picture p = read(header(10, 2) + row + row);
  ASSERT_EQ(p.pixels.size(), 20u);
  for (size_t i = 0; i < 20; ++i) {
    EXPECT_EQ(p.pixels[i].x, 1);
    EXPECT_EQ(p.pixels[i].y, static_cast<float>(i % 10) / 128);
  }
  EXPECT_EQ(p.pixels[2].z, 7.0f / 128);
  EXPECT_EQ(p.pixels[8].z, 6.0f / 128);
  EXPECT_EQ(p.pixels[19].z, 0);
}

TEST(RadianceHdr, RunsOfPixelsAsOldFilesHaveThem) {
  // One, 2 repetitions, another, 256 * 1 + 3 repetitions.
  const std::string other = bytes({128, 128, 128, 129});
  const Picture p =
      read(header(263, 1) + kTexel + bytes({1, 1, 1, 2}) + other + bytes({1, 1, 1, 3, 1, 1, 1, 1}));
  ASSERT_EQ(p.pixels.size(), 263u);
  for (size_t i = 0; i < 263; ++i) EXPECT_EQ(p.pixels[i], i < 3 ? Rgb(1, 0.5f, 0) : Rgb(1));
}

TEST(RadianceHdr, ExposuresAreDividedOut) {
  const std::string lines = "EXPOSURE=2\n# a comment\nCOLORCORR= 1 0.5 4\nEXPOSURE= 0.25\n";
  EXPECT_EQ(read(header(1, 1, lines) + kTexel).pixels[0], Rgb(2, 2, 0));
}

TEST(RadianceHdr, ColoursOfOtherPrimariesBecomeRec709) {
  const std::string grey = bytes({128, 128, 128, 129}), red = bytes({128, 0, 0, 129});
  const auto colour = [](const std::string& primaries, const std::string& texel) {
    return read(header(1, 1, "PRIMARIES=" + primaries + "\n") + texel).pixels[0];
  };
  const std::string wide = " .708 .292 .170 .797 .131 .046 .3127 .329";  // Rec.2020
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(colour(wide, grey)[c], 1, 1e-6f) << "white stays white";
  EXPECT_NEAR(colour(wide, red).x, 1.6605f, 1e-3f);
  EXPECT_EQ(colour("0 0 0 0 0 0 0 0", kTexel), Rgb(1, 0.5f, 0)) << "what Photoshop writes";
}

TEST(RadianceHdr, SaysWhatIsWrongAndWhere) {
  const std::string right = header(2, 1) + kTexel + kTexel, first = "#?RADIANCE\n";
  EXPECT_NO_THROW(read(right));
  testing::expect_refused(
      {{"#?RADIANCE", "header", "its first line"},
       {first + "GAMMA=1\n", "header", "an empty line"},
       {first + "\n", "header", "the size of the picture"},
       {first + "FORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n", "header", "32-bit_rle_xyze"},
       {first + "\n-Y\r\x1b[2J\n", "header", "\"-Y??[2J\""},
       {header(0, 1), "header", "0 x 1 pixels"},
       {header(16384, 8192), "header", "16384 x 8192 pixels"},
       {header(2, -1), "header", "2 x -1 pixels"},
       {header(1, 1, "COLORCORR=1 2\n"), "header", "three numbers above 0"},
       {header(1, 1, "PRIMARIES=0.64 0.33 0.3\n") + kTexel, "header", "no eight numbers"},
       {header(1, 1, "PRIMARIES=1 1 1 1 1 1 1 1\n") + kTexel, "header", "surround their white"},
       {header(2, 3) + repeated(kTexel, 5), "row 2", "the file ends"},
       {right + "123", "", "3 bytes after the last"},
       {header(10, 1) + bytes({2, 2, 0, 9}), "row 0", "declares 9 pixels"},
       {header(10, 1) + bytes({2, 2, 0, 10, 139, 1}), "row 0", "does not fit"},
       {header(10, 1) + bytes({2, 2, 0, 10, 11, 1}), "row 0", "does not fit"},
       {header(10, 1) + bytes({2, 2, 0, 10, 0, 1}), "row 0", "does not fit"},
       {header(3, 1) + bytes({1, 1, 1, 1}), "row 0", "does not fit"},
       {header(3, 1) + kTexel + bytes({1, 1, 1, 3}), "row 0", "does not fit"},
       {header(3, 1) + kTexel + repeated(bytes({1, 1, 1, 0}), 4), "row 0", "does not fit"}},
      read);
  for (const std::string size : {"+X 2 -Y 1", "-Y 1", "", "-Y 1 +X 2 ", "-Y 1 +X two"})
    testing::expect_refused({{first + "\n" + size + "\n", "header", "\"" + size + "\""}}, read);
  for (const std::string exposure : {"0", "-1", "nan", "x", "1e99"})
    testing::expect_refused(
        {{header(1, 1, "EXPOSURE=" + exposure + "\n"), "header", "a number above 0"}}, read);
}

TEST(RadianceHdr, TakesNoMoreThanTheLimitOfMemory) {
  const uint64_t machine = memory_limit();
  limit_memory(100);
  testing::expect_refused({{header(3, 3), "header", "take 108 bytes of memory"}}, read);
  limit_memory(machine);
}

}  // namespace tdpt::radiance_hdr_test
