#include "libcommon/formats/picture.h"

#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/math/rng.h"

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
std::string complaint(const std::string& file) {
  try {
    read(file);
    return "";
  } catch (const InputError& e) {
    return e.what();
  }
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
  // White stays white, also that of Radiance, equal energy.
  for (const std::string& p : {wide, std::string("0.64 0.33 0.29 0.6 0.15 0.06 0.333 0.333")})
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(colour(p, grey)[c], 1, 1e-6f);
  // Its red is outside the gamut: green and blue would be negative.
  EXPECT_NEAR(colour(wide, red).x, 1.6605f, 1e-3f);
  EXPECT_EQ(colour(wide, red).y, 0);
  // Rec.709 itself, and what Photoshop writes.
  for (const char* p : {"0.64 0.33 0.3 0.6 0.15 0.06 0.3127 0.329", "0 0 0 0 0 0 0 0"})
    EXPECT_EQ(colour(p, kTexel), Rgb(1, 0.5f, 0));
  EXPECT_EQ(complaint(header(1, 1, "PRIMARIES=0.64 0.33 0.3\n") + red),
            "a.hdr:header: \"0.64 0.33 0.3\" as primaries: no eight numbers");
  EXPECT_EQ(complaint(header(1, 1, "PRIMARIES=1 1 1 1 1 1 1 1\n") + red),
            "a.hdr:header: \"1 1 1 1 1 1 1 1\" as primaries: primaries that do not surround their "
            "white");
}

TEST(RadianceHdr, SaysWhatIsWrongAndWhere) {
  const std::string right = header(2, 1) + kTexel + kTexel;
  EXPECT_EQ(complaint(right), "");
  EXPECT_EQ(complaint("#?RADIANCE"),
            "a.hdr:header: ends before its first line, expected text lines");
  EXPECT_EQ(complaint("#?RADIANCE\nGAMMA=1\n"),
            "a.hdr:header: ends before an empty line, expected text lines");
  EXPECT_EQ(complaint("#?RADIANCE\n\n"),
            "a.hdr:header: ends before the size of the picture, expected text lines");
  EXPECT_EQ(complaint("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n"),
            "a.hdr:header: \"FORMAT=32-bit_rle_xyze\", expected FORMAT=32-bit_rle_rgbe");
  for (const char* size : {"+X 2 -Y 1", "-Y 1", "", "-Y 1 +X 2 ", "-Y 1 +X two"})
    EXPECT_EQ(complaint(std::string("#?RADIANCE\n\n") + size + "\n"),
              std::string("a.hdr:header: \"") + size + "\", expected \"-Y HEIGHT +X WIDTH\"");
  EXPECT_EQ(complaint(header(0, 1)), "a.hdr:header: 0 x 1 pixels, expected at most 8192 x 4096");
  EXPECT_EQ(complaint(header(16384, 8192)),
            "a.hdr:header: 16384 x 8192 pixels, expected at most 8192 x 4096");
  EXPECT_EQ(complaint(header(2, -1)), "a.hdr:header: 2 x -1 pixels, expected at most 8192 x 4096");
  for (const char* exposure : {"0", "-1", "nan", "x", "1e99"})
    EXPECT_EQ(
        complaint(header(1, 1, std::string("EXPOSURE=") + exposure + "\n")),
        std::string("a.hdr:header: \"") + exposure + "\" as exposure, expected a number above 0");
  EXPECT_EQ(complaint(header(1, 1, "COLORCORR=1 2\n")),
            "a.hdr:header: \"1 2\" as exposure, expected three numbers above 0");
  EXPECT_EQ(complaint(header(2, 3) + repeated(kTexel, 5)), "a.hdr:row 2: the file ends");
  EXPECT_EQ(complaint(right + "123"), "a.hdr: 3 bytes after the last of 2 x 1 pixels");
  EXPECT_EQ(complaint(header(10, 1) + bytes({2, 2, 0, 9})),
            "a.hdr:row 0: declares 9 pixels, the header 10");
  for (const auto& run : {bytes({139, 1}), bytes({11, 1}), bytes({0, 1})})
    EXPECT_EQ(complaint(header(10, 1) + bytes({2, 2, 0, 10}) + run),
              "a.hdr:row 0: a run that does not fit the row");
  EXPECT_EQ(complaint(header(3, 1) + bytes({1, 1, 1, 1})),
            "a.hdr:row 0: a run that does not fit the row");
  EXPECT_EQ(complaint(header(3, 1) + kTexel + bytes({1, 1, 1, 3})),
            "a.hdr:row 0: a run that does not fit the row");
  EXPECT_EQ(complaint(header(3, 1) + kTexel + repeated(bytes({1, 1, 1, 0}), 4)),
            "a.hdr:row 0: a run that does not fit the row");
  EXPECT_EQ(complaint("#?RADIANCE\n\n-Y\r\x1b[2J\n"),
            "a.hdr:header: \"-Y??[2J\", expected \"-Y HEIGHT +X WIDTH\"");
}

TEST(RadianceHdr, TakesNoMoreThanTheLimitOfMemory) {
  const uint64_t machine = memory_limit();
  limit_memory(100);
  EXPECT_EQ(complaint(header(3, 3)),
            "a.hdr:header: 3 x 3 pixels take 108 bytes of memory, expected at most the 100 bytes "
            "of --max-memory");
  limit_memory(machine);
}

// Damaged files are read or refused; sanitizers check for anything else.
TEST(RadianceHdr, DamagedFilesAreReadOrRefused) {
  const std::string row =
      bytes({2, 2, 0, 10, 138, 128, 138, 9, 131, 7, 7, 1, 2, 3, 4, 5, 6, 0, 138, 129});
  const std::string file = header(10, 3) + repeated(row, 3);
  Rng rng(1, 0, 0);
  for (int i = 0; i < 4000; ++i) {
    std::string damaged = file;
    const int changes = 1 + static_cast<int>(3 * rng.uniform());
    for (int k = 0; k < changes; ++k) {
      const auto at = static_cast<size_t>(rng.uniform() * static_cast<double>(file.size()));
      damaged[at] = static_cast<char>(256 * rng.uniform());
    }
    if (rng.uniform() < 0.3)
      damaged.resize(static_cast<size_t>(rng.uniform() * static_cast<double>(file.size())));
    complaint(damaged);
  }
}

}  // namespace tdpt::radiance_hdr_test
