// Half floats and DWA.
#include <cmath>
#include <fstream>
#include <vector>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <gtest/gtest.h>

#include "libcommon/formats/picture.h"
#include "libcommon/math/rng.h"

namespace tdpt::picture_write_test {
namespace {

constexpr Storage kHalf{Storage::half, Storage::zip}, kDwaa{Storage::real, Storage::dwaa},
    kDwab{Storage::half, Storage::dwab};
constexpr int kWidth = 64, kHeight = 48;

// A picture with a little noise, a layer, alpha, depth and a channel that DWA would take for
// luminance.
ExrFile sample() {
  ExrFile file;
  file.picture = {kWidth, kHeight, {}};
  Rng rng(1, 0, 0);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const float r = 0.1f + static_cast<float>(x) / kWidth + 0.01f * rng.uniform_float(),
                  g = static_cast<float>(y) / kHeight;
      file.picture.pixels.emplace_back(r, g, r * g);
      file.picture.alpha.push_back(0.25f);
      file.channels["depth.Z"].push_back(1e10f);
      file.channels["position.Y"].push_back(100 + 1e-4f * static_cast<float>(x * y));
      file.channels["albedo.G"].push_back(1.0f / 3);
    }
  file.layers["direct"] = file.picture;
  file.layers["direct"].alpha.clear();
  return file;
}

ExrFile back(const ExrFile& file, const Storage& storage) {
  return parse_exr(exr_bytes(file, storage), "a.exr");
}

// The types of the channels of all parts: "R half, depth.Z float".
std::string types_of(const std::string& bytes) {
  const std::string path = ::testing::TempDir() + "picture_write_test.exr";
  std::ofstream(path, std::ios::binary) << bytes;
  Imf::MultiPartInputFile file(path.c_str());
  std::string text;
  for (int part = 0; part < file.parts(); ++part) {
    const Imf::ChannelList& channels = file.header(part).channels();
    for (auto c = channels.begin(); c != channels.end(); ++c)
      text += std::string(text.empty() ? "" : ", ") + c.name() +
              (c.channel().type == Imf::HALF ? " half" : " float");
  }
  return text;
}

double largest_error(const Picture& a, const Picture& b) {
  double largest = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c)
      largest = std::max(largest, static_cast<double>(std::abs(a.pixels[i][c] - b.pixels[i][c])));
  return largest;
}

TEST(PictureWrite, ColoursAreHalfFloatsIfAskedFor) {
  EXPECT_EQ(types_of(exr_bytes(sample(), kHalf)),
            "A half, B half, G half, R half, albedo.G half, depth.Z float, direct.B half, direct.G "
            "half, direct.R half, position.Y float");
  EXPECT_EQ(types_of(exr_bytes(sample())).find("half"), std::string::npos);
}

TEST(PictureWrite, HalfFloatsHaveElevenBits) {
  ExrFile file = sample();
  file.picture.pixels[3] = {0.1f, 1000, -3};
  const ExrFile read = back(file, kHalf);
  for (size_t i = 0; i < file.picture.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      const float is = file.picture.pixels[i][c];
      EXPECT_NEAR(read.picture.pixels[i][c], is, std::abs(is) / 2048);
    }
  EXPECT_NE(read.picture.pixels, file.picture.pixels);
  EXPECT_EQ(read.layers.at("direct").pixels[9], read.picture.pixels[9]);
}

TEST(PictureWrite, WhatIsTooLargeForHalfFloatsIsTheLargest) {
  ExrFile file = sample();
  file.picture.pixels[0] = {65519, 65520, 3e38f};
  file.picture.pixels[1] = {-1e6f, std::numeric_limits<float>::infinity(), 65504};
  const ExrFile read = back(file, kHalf);
  EXPECT_EQ(read.picture.pixels[0], Rgb(65504));
  EXPECT_EQ(read.picture.pixels[1], Rgb(-65504, 65504, 65504));
}

// DWA oscillates about the edges of what is bright.
TEST(PictureWrite, DwaMakesNothingInfinite) {
  ExrFile file = sample();
  Rng rng(2, 0, 0);
  for (Rgb& c : file.picture.pixels)
    for (int i = 0; i < 3; ++i) c[i] = rng.uniform_float() < 0.3f ? 1e30f : 0.0f;
  for (const Storage& storage : {kDwaa, kDwab})
    for (const Rgb& c : back(file, storage).picture.pixels) {
      EXPECT_TRUE(is_finite(c));
      EXPECT_LT(max_component(c), 1.03f * storage.largest());
    }
}

TEST(PictureWrite, DwaIsCloseAndSmall) {
  const ExrFile file = sample();
  for (const Storage& storage : {kDwaa, kDwab}) {
    const ExrFile read = back(file, storage);
    EXPECT_LT(largest_error(read.picture, file.picture), 0.02);
    EXPECT_GT(largest_error(read.picture, file.picture), 0);
    EXPECT_LT(largest_error(read.layers.at("direct"), file.picture), 0.02);
    EXPECT_EQ(read.attributes, file.attributes);
  }
  ExrFile colours = file;
  colours.channels.clear();
  EXPECT_LT(4 * exr_bytes(colours, kDwaa).size(), exr_bytes(colours).size());
}

// DWA takes every channel Y for luminance.
TEST(PictureWrite, DwaLeavesDataAlone) {
  ExrFile file = sample();
  std::vector<unsigned> numbers(kWidth * kHeight, 4000000001u);
  file.words.push_back({"sum.0", reinterpret_cast<unsigned char*>(numbers.data()), sizeof(unsigned),
                        WordChannel::whole});
  const std::string path = ::testing::TempDir() + "picture_write_test.exr";
  std::ofstream(path, std::ios::binary) << exr_bytes(file, kDwab);
  Imf::MultiPartInputFile input(path.c_str());
  ASSERT_EQ(input.parts(), 2);
  Imf::InputPart data(input, 1);
  std::vector<float> position(kWidth * kHeight), depth(kWidth * kHeight);
  std::vector<unsigned> sum(kWidth * kHeight);
  Imf::FrameBuffer buffer;
  const Imath::Box2i window = data.header().dataWindow();
  buffer.insert("position.Y", Imf::Slice::Make(Imf::FLOAT, position.data(), window));
  buffer.insert("depth.Z", Imf::Slice::Make(Imf::FLOAT, depth.data(), window));
  buffer.insert("sum.0", Imf::Slice::Make(Imf::UINT, sum.data(), window));
  data.setFrameBuffer(buffer);
  data.readPixels(0, kHeight - 1);
  EXPECT_EQ(position, file.channels["position.Y"]);
  EXPECT_EQ(depth, file.channels["depth.Z"]);
  EXPECT_EQ(sum, numbers);
}

TEST(PictureWrite, SameBytesForTheSameInput) {
  for (const Storage& storage : {Storage{}, kHalf, kDwaa, kDwab})
    EXPECT_EQ(exr_bytes(sample(), storage), exr_bytes(sample(), storage));
}

TEST(PictureWrite, HalfFloatsAreReadAsFloats) {
  const std::string bytes = exr_bytes(sample(), kHalf);
  std::vector<float> alpha(kWidth * kHeight);
  parse_exr_words(
      bytes, "a.exr", kWidth, kHeight,
      {{"A", reinterpret_cast<unsigned char*>(alpha.data()), sizeof(float), WordChannel::real}});
  EXPECT_EQ(alpha, sample().picture.alpha);
}

}  // namespace
}  // namespace tdpt::picture_write_test
