#include "libcommon/formats/picture.h"

#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <limits>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticities.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineOutputFile.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <half.h>
#include <unistd.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/formats/picture_bounds.h"
#include "libcommon/formats/png.h"
#include "libcommon/math/rng.h"

namespace tdpt::picture_test {

Picture gradient(int width, int height) {
  Picture p{width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      p.pixels.push_back(
          {static_cast<float>(x), static_cast<float>(y), 0.25f * static_cast<float>(x + y)});
  return p;
}

// The InputError for these bytes; "" if they are accepted.
std::string complaint(std::string_view bytes) {
  try {
    parse_exr(bytes, "a.exr");
    return "";
  } catch (const InputError& e) {
    return e.what();
  }
}

// A file written directly with the library, without our writer.
class TemporaryFile {
 public:
  TemporaryFile()
      : path_(::testing::TempDir() + "picture_test_" + std::to_string(::getpid()) + ".exr") {}
  ~TemporaryFile() { std::remove(path_.c_str()); }
  const char* name() const { return path_.c_str(); }
  std::string bytes() const { return read_file(path_); }

 private:
  std::string path_;
};

TEST(Picture, ComesBackAsItWasWritten) {
  ExrFile file;
  file.picture = gradient(37, 19);
  file.picture.pixels[5] = {1e-30f, -2.5f, 3e30f};
  file.layers["direct"] = gradient(37, 19);
  file.layers["portal.left"] = gradient(37, 19);
  file.attributes["integrator"] = "tdpt";
  set_provenance(file, {{"made by a 1: a", "from b c"}});
  const ExrFile back = parse_exr(exr_bytes(file), "a.exr");
  EXPECT_EQ(back.picture.width, 37);
  EXPECT_EQ(back.picture.height, 19);
  EXPECT_EQ(back.picture.pixels, file.picture.pixels);
  ASSERT_EQ(back.layers.size(), 2u);
  EXPECT_EQ(back.layers.at("portal.left").pixels, file.layers["portal.left"].pixels);
  EXPECT_EQ(back.attributes, file.attributes);
  EXPECT_EQ(provenance_of(back).lines, (std::vector<std::string>{"made by a 1: a", "from b c"}));
  EXPECT_EQ(back.pixels_without_data, 0);
}

TEST(Picture, SameInputSameBytes) {
  ExrFile file;
  file.picture = gradient(200, 100);
  EXPECT_EQ(exr_bytes(file), exr_bytes(file));
}

TEST(Picture, EmptyProvenanceTakesNoAttribute) {
  ExrFile file;
  set_provenance(file, {});
  EXPECT_TRUE(file.attributes.empty());
  EXPECT_TRUE(provenance_of(file).empty());
}

TEST(Picture, HalfWithAnOffsetDataWindow) {
  const TemporaryFile file;
  // Display window 4 x 3 at (10, 20); data 2 x 5 pixels from (11, 19): one row above and one below.
  Imf::Header header(Imath::Box2i({10, 20}, {13, 22}), Imath::Box2i({11, 19}, {12, 23}));
  std::vector<Imath::half> values(2 * 5);
  for (size_t i = 0; i < values.size(); ++i) values[i] = Imath::half(static_cast<float>(i + 1));
  Imf::FrameBuffer buffer;
  for (const char* c : {"R", "G", "B", "A"}) {
    header.channels().insert(c, Imf::Channel(Imf::HALF));
    buffer.insert(c, Imf::Slice::Make(Imf::HALF, values.data(), header.dataWindow()));
  }
  {
    Imf::OutputFile output(file.name(), header);
    output.setFrameBuffer(buffer);
    output.writePixels(5);
  }
  const ExrFile back = read_exr(file.name());
  ASSERT_EQ(back.picture.width, 4);
  ASSERT_EQ(back.picture.height, 3);
  for (int y = 0; y < 3; ++y) {
    const Rgb* row = &back.picture.pixels[static_cast<size_t>(4 * y)];
    EXPECT_EQ(row[0], Rgb(0));
    EXPECT_EQ(row[1], Rgb(static_cast<float>(2 * y + 3)));
    EXPECT_EQ(row[2], Rgb(static_cast<float>(2 * y + 4)));
    EXPECT_EQ(row[3], Rgb(0));
    for (int x = 0; x < 4; ++x)  // what has no data covers nothing
      EXPECT_EQ(back.picture.alpha[static_cast<size_t>(4 * y + x)], row[x].x);
  }
  EXPECT_EQ(back.pixels_without_data, 6);
}

TEST(Picture, Tiles) {
  const TemporaryFile file;
  Picture p = gradient(50, 30);
  Imf::Header header(50, 30);
  header.setTileDescription(Imf::TileDescription(16, 8, Imf::MIPMAP_LEVELS));
  Imf::FrameBuffer buffer;
  float* first[] = {&p.pixels[0].x, &p.pixels[0].y, &p.pixels[0].z};
  for (int c = 0; c < 3; ++c) {
    const std::string name(1, "RGB"[c]);
    header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    buffer.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(first[c]), sizeof(Rgb),
                                   sizeof(Rgb) * 50));
  }
  {
    Imf::TiledOutputFile output(file.name(), header);
    output.setFrameBuffer(buffer);
    for (int level = 0; level < output.numLevels(); ++level)
      output.writeTiles(0, output.numXTiles(level) - 1, 0, output.numYTiles(level) - 1, level);
  }
  EXPECT_EQ(read_exr(file.name()).picture.pixels, p.pixels);
}

// A file with one grey channel, to be modified.
std::string with_header(const std::function<void(Imf::Header&)>& change) {
  const TemporaryFile file;
  Imf::Header header(8, 8);
  std::vector<float> values(64);
  change(header);
  Imf::FrameBuffer buffer;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
    const auto n = c.channel().xSampling;
    buffer.insert(c.name(),
                  Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), 4, 32, n, n));
  }
  {
    Imf::OutputFile output(file.name(), header);
    output.setFrameBuffer(buffer);
    output.writePixels(8);
  }
  return file.bytes();
}

TEST(Picture, RefusesWhatItCannotShow) {
  EXPECT_EQ(complaint(""), "a.exr: is not an OpenEXR file");
  EXPECT_EQ(complaint("glTF is something else"), "a.exr: is not an OpenEXR file");
  EXPECT_EQ(complaint(with_header([](Imf::Header& h) {
              h.channels().insert("Y", Imf::Channel(Imf::FLOAT));
              h.channels().insert("A", Imf::Channel(Imf::FLOAT));
            })),
            "a.exr:channels: A Y, expected R, G and B");
  EXPECT_EQ(complaint(with_header([](Imf::Header& h) {
              for (const char* c : {"R", "G", "B"})
                h.channels().insert(c,
                                    Imf::Channel(Imf::FLOAT, *c == 'B' ? 2 : 1, *c == 'B' ? 2 : 1));
            })),
            "a.exr:channel B: has fewer samples than pixels, expected one a pixel");
  EXPECT_EQ(complaint(with_header([](Imf::Header& h) {
              for (const char* c : {"R", "G", "B"})
                h.channels().insert(c, Imf::Channel(Imf::FLOAT));
              h.displayWindow() = Imath::Box2i({100, 100}, {107, 107});
            })),
            "a.exr:data window: lies outside the display window, expected an overlap");
  const std::string huge = complaint(with_header([](Imf::Header& h) {
    for (const char* c : {"R", "G", "B"}) h.channels().insert(c, Imf::Channel(Imf::FLOAT));
    h.displayWindow() = Imath::Box2i({0, 0}, {69999, 7});
  }));
  EXPECT_NE(huge.find("a.exr"), std::string::npos);
  EXPECT_NE(huge.find("65536"), std::string::npos) << huge;
  const std::string many = complaint(with_header([](Imf::Header& h) {
    for (const char* c : {"R", "G", "B"}) h.channels().insert(c, Imf::Channel(Imf::FLOAT));
    h.displayWindow() = Imath::Box2i({0, 0}, {65535, 65535});
  }));
  EXPECT_EQ(many,
            "a.exr:display window: 65536 x 65536 pixels around 8 x 8 that have data, expected at "
            "most 17039360 in all");
}

// The error of parse_exr_picture for a file of at most 16 x 8 pixels.
std::string complaint_of_picture(std::string_view bytes) {
  try {
    parse_exr_picture(bytes, "a.exr", 16, 8);
    return "";
  } catch (const InputError& e) {
    return e.what();
  }
}

TEST(Picture, AloneItHasNoLayersAndABound) {
  ExrFile file;
  file.picture = gradient(16, 8);
  file.layers["a"] = gradient(16, 8);
  EXPECT_EQ(parse_exr_picture(exr_bytes(file), "a.exr", 16, 8).pixels, file.picture.pixels);
  EXPECT_EQ(complaint_of_picture("glTF"), "a.exr: is not an OpenEXR file");
  // The header alone decides: the file has no pixels.
  ExrFile large;
  large.picture = gradient(17, 8);
  EXPECT_EQ(complaint_of_picture(exr_bytes(large).substr(0, 400)),
            "a.exr:header: 17 x 8 pixels, expected at most 16 x 8");
  EXPECT_EQ(complaint_of_picture(with_header([](Imf::Header& h) {
              for (const char* c : {"R", "G", "B"})
                h.channels().insert(c, Imf::Channel(Imf::FLOAT));
              h.displayWindow() = Imath::Box2i({0, 0}, {15, 7});
            })),
            "a.exr:data window: holds 64 pixels less than the display window, expected all");
  EXPECT_EQ(complaint_of_picture(with_header(
                [](Imf::Header& h) { h.channels().insert("Y", Imf::Channel(Imf::FLOAT)); })),
            "a.exr:channels: Y, expected R, G and B");
}

const Imf::Chromaticities kXyz({1, 0}, {0, 1}, {0, 0}, {1 / 3.0f, 1 / 3.0f});
const Imf::Chromaticities kAces({0.7347f, 0.2653f}, {0, 1}, {0.0001f, -0.077f},
                                {0.32168f, 0.33767f});

// A picture of one colour, with a layer of the same, that declares these primaries.
std::string with_primaries(const Imf::Chromaticities& primaries, const Rgb& colour) {
  const TemporaryFile file;
  std::vector<Rgb> pixels(32, colour);
  Imf::Header header(8, 4);
  Imf::addChromaticities(header, primaries);
  Imf::FrameBuffer buffer;
  for (const char* layer : {"", "a."})
    for (int c = 0; c < 3; ++c) {
      const std::string name = std::string(layer) + "RGB"[c];
      header.channels().insert(name, Imf::Channel(Imf::FLOAT));
      buffer.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(&pixels[0][c]),
                                     sizeof(Rgb), 8 * sizeof(Rgb)));
    }
  {
    Imf::OutputFile output(file.name(), header);
    output.setFrameBuffer(buffer);
    output.writePixels(4);
  }
  return file.bytes();
}

void expect_near(const Rgb& a, const Rgb& b, double tolerance) {
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(static_cast<double>(a[c]), static_cast<double>(b[c]), tolerance) << c;
}

TEST(Picture, ColoursOfOtherPrimariesBecomeRec709) {
  // The colour 0.5 0.25 0.1 of Rec.709 in CIE XYZ, by the matrix of IEC 61966-2-1.
  const ExrFile xyz = parse_exr(with_primaries(kXyz, {0.313658f, 0.292353f, 0.134498f}), "a.exr");
  for (const Picture& p : {xyz.picture, xyz.layers.at("a")})
    for (const Rgb& pixel : p.pixels) expect_near(pixel, {0.5f, 0.25f, 0.1f}, 2e-4);
  // The white of ACES stays what it is: XYZ 0.95265 1 1.00883.
  expect_near(parse_exr(with_primaries(kAces, Rgb(1)), "a.exr").picture.pixels[3],
              {1.04696f, 0.99455f, 0.91562f}, 1e-3);
  // Red and blue of which each stands for the other.
  const Imf::Chromaticities own;
  const Imf::Chromaticities swapped(own.blue, own.green, own.red, own.white);
  expect_near(parse_exr(with_primaries(swapped, {1, 2, 3}), "a.exr").picture.pixels[0], {3, 2, 1},
              1e-5);
}

TEST(Picture, PrimariesOfRec709ChangeNoBit) {
  const Rgb colour(0.1f, 1e-20f, 7e9f);
  for (const float rounded : {0.0f, 1e-5f, -2e-5f}) {
    const Imf::Chromaticities own({0.64f, 0.33f}, {0.3f, 0.6f + rounded}, {0.15f, 0.06f},
                                  {0.3127f + rounded, 0.329f});
    EXPECT_EQ(parse_exr(with_primaries(own, colour), "a.exr").picture.pixels[0], colour);
  }
}

TEST(Picture, PrimariesThatAreNoneAreRefused) {
  const Imf::Chromaticities own;
  EXPECT_EQ(complaint(with_primaries({{0, 0}, {0, 0}, {0, 0}, {0, 0}}, Rgb(1))),
            "a.exr:chromaticities: 0 0 0 0 0 0 0 0: primaries that do not surround their white");
  for (const Imf::Chromaticities& bad :
       {Imf::Chromaticities(own.red, own.green, own.blue, {0.7f, 0.2f}),
        Imf::Chromaticities(own.red, own.red, own.blue, own.white),
        Imf::Chromaticities(own.red, own.green, {std::nanf(""), 0}, own.white),
        Imf::Chromaticities(own.red, own.green, own.blue, {0.3f, INFINITY})})
    EXPECT_NE(complaint(with_primaries(bad, Rgb(1))).find("do not surround"), std::string::npos);
}

// A green that no Rec.709 has.
TEST(Picture, LightOutsideTheGamutIsClippedToIt) {
  const std::string green = with_primaries(kXyz, {0, 1, 0});
  EXPECT_LT(parse_exr(green, "a.exr").picture.pixels[0].x, -1);
  const Rgb light = parse_exr_picture(green, "a.exr", 16, 8).pixels[0];
  expect_near(light, {0, 1.876f, 0}, 1e-3);
  EXPECT_EQ(light.x, 0);
  // What is negative in its own primaries stays so, to be refused.
  EXPECT_LT(parse_exr_picture(with_primaries(kXyz, Rgb(-1)), "a.exr", 16, 8).pixels[0].x, 0);
}

// A newer OpenEXR writes such files; they are not damaged.
TEST(Picture, WhatOpenExrHasGainedIsNamed) {
  ExrFile file;
  file.picture = gradient(8, 8);
  std::string bytes = exr_bytes(file);
  using namespace std::string_view_literals;
  const auto compression = "compression\0compression\0\1\0\0\0"sv;
  const size_t at = bytes.find(compression) + compression.size();
  const auto with = [&](size_t place, int value) {
    std::string other = bytes;
    other[place] = static_cast<char>(value);
    return complaint(other);
  };
  for (const auto& [value, name] : {std::pair(10, "HTJ2K256"), std::pair(11, "HTJ2K32"),
                                    std::pair(13, "ZSTD"), std::pair(200, "number 200")})
    EXPECT_EQ(with(at, value),
              fmt::format("a.exr:compression: {}, which this program does not support, expected "
                          "none, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA or DWAB",
                          name));
  EXPECT_EQ(with(4, 3), "a.exr:version: 3, expected 2");
  EXPECT_EQ(with(5, 0x20), "a.exr:version: has flags of features that this program does not know");
}

TEST(Picture, HalvesOfInfinityAreInfinite) {
  const TemporaryFile file;
  Imf::Header header(8, 4);
  std::vector<Imath::half> values(32, Imath::half(1.0f));
  values[9] = Imath::half(1e6f);
  Imf::FrameBuffer buffer;
  for (const char* c : {"R", "G", "B"}) {
    header.channels().insert(c, Imf::Channel(Imf::HALF));
    buffer.insert(c, Imf::Slice::Make(Imf::HALF, values.data(), header.dataWindow()));
  }
  {
    Imf::OutputFile output(file.name(), header);
    output.setFrameBuffer(buffer);
    output.writePixels(4);
  }
  const Picture p = parse_exr_picture(file.bytes(), "a.exr", 16, 8);
  EXPECT_EQ(p.pixels[8], Rgb(1));
  EXPECT_TRUE(std::isinf(p.pixels[9].x));
}

TEST(Picture, DeepPixelsAreRefused) {
  const TemporaryFile file;
  Imf::Header header(2, 2);
  header.setType(Imf::DEEPSCANLINE);
  header.compression() = Imf::ZIPS_COMPRESSION;
  std::vector<unsigned> counts(4, 1);
  std::vector<float> values(4, 1.0f);
  std::vector<float*> pointers;
  for (float& v : values) pointers.push_back(&v);
  Imf::DeepFrameBuffer buffer;
  buffer.insertSampleCountSlice(
      Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts.data()), 4, 8));
  for (const char* c : {"R", "G", "B"}) {
    header.channels().insert(c, Imf::Channel(Imf::FLOAT));
    buffer.insert(c, Imf::DeepSlice(Imf::FLOAT, reinterpret_cast<char*>(pointers.data()),
                                    sizeof(float*), 2 * sizeof(float*), sizeof(float)));
  }
  {
    Imf::DeepScanLineOutputFile output(file.name(), header);
    output.setFrameBuffer(buffer);
    output.writePixels(2);
  }
  EXPECT_EQ(complaint(file.bytes()),
            "a.exr:type: deep pixels, expected one sample of R, G and B a pixel");
}

TEST(Picture, AlphaIsAChannelOfItsOwn) {
  const TemporaryFile file;
  ExrFile exr;
  exr.picture = gradient(5, 3);
  for (int i = 0; i < 15; ++i) exr.picture.alpha.push_back(static_cast<float>(i) / 14);
  std::ofstream(file.name(), std::ios::binary) << exr_bytes(exr);
  Imf::InputFile input(file.name());
  std::vector<float> alpha(15);
  Imf::FrameBuffer buffer;
  buffer.insert("A", Imf::Slice::Make(Imf::FLOAT, alpha.data(), input.header().dataWindow()));
  input.setFrameBuffer(buffer);
  input.readPixels(0, 2);
  EXPECT_EQ(alpha, exr.picture.alpha);
  const ExrFile back = parse_exr(exr_bytes(exr), "a.exr");
  EXPECT_EQ(back.picture.pixels, exr.picture.pixels);
  EXPECT_EQ(back.picture.alpha, exr.picture.alpha);
  exr.picture.alpha.pop_back();
  EXPECT_THROW(exr_bytes(exr), std::invalid_argument);
}

TEST(Picture, FilesCutShortAreRefusedInOneLine) {
  ExrFile file;
  file.picture = gradient(40, 40);
  const std::string bytes = exr_bytes(file);
  for (size_t size = 0; size < bytes.size(); size += size < 700 ? 1 : 37) {
    const std::string text = complaint(std::string_view(bytes).substr(0, size));
    EXPECT_TRUE(text.starts_with("a.exr: is ")) << size << ": " << text;
    EXPECT_EQ(text.find('\n'), std::string::npos);
  }
}

// The library would allocate any declared size and read past the end of the values.
TEST(Picture, AttributesAreAsLongAsTheySay) {
  ExrFile file;
  file.picture = gradient(4, 4);
  file.attributes["note"] = "seven";
  const std::string good = exr_bytes(file);
  const auto with_size = [&](std::string_view before, uint32_t size) {
    std::string bad = good;
    const size_t at = bad.find(before) + before.size();
    return bad.replace(at, 4, reinterpret_cast<const char*>(&size), 4);
  };
  using namespace std::string_view_literals;
  const auto note = "note\0string\0"sv;
  EXPECT_EQ(complaint(with_size(note, 5)), "");
  const size_t left = good.size() - good.find(note) - note.size() - 4;
  EXPECT_EQ(complaint(with_size(note, 0x60000005)),
            fmt::format("a.exr: is damaged: attribute note of 1610612741 bytes in a file with {} "
                        "more",
                        left));
  EXPECT_EQ(complaint(with_size("lineOrder\0lineOrder\0"sv, 2)),
            "a.exr: is damaged: attribute lineOrder of 2 bytes is no lineOrder");
  EXPECT_EQ(complaint(with_size("channels\0chlist\0"sv, 54)),
            "a.exr: is damaged: attribute channels of 54 bytes is no chlist");
}

TEST(Picture, RefusesAnotherVersion) {
  ExrFile file;
  file.picture = gradient(4, 4);
  std::string bytes = exr_bytes(file);
  using namespace std::string_view_literals;
  const auto version = "tdptFormat\0string\0\1\0\0\0"sv;
  const size_t at = bytes.find(version);
  ASSERT_NE(at, std::string::npos);
  EXPECT_EQ(complaint(std::string(bytes).replace(at, 10, "tdptFormal")), "");
  bytes[at + version.size()] = '2';
  const std::string expected =
      "a.exr:tdptFormat: this file has version 2 of the format; this program reads version 1";
  EXPECT_EQ(complaint(bytes), expected);
  try {
    parse_exr_picture(bytes, "a.exr", 8, 8);
    ADD_FAILURE();
  } catch (const InputError& e) {
    EXPECT_EQ(e.what(), expected);
  }
}

// A header with `layers` of R, G and B and no pixels after it.
std::string header_of(int width, int height, int layers, Imf::Compression compression) {
  const TemporaryFile file;
  Imf::Header header(width, height);
  header.compression() = compression;
  for (int k = 0; k < layers; ++k)
    for (const char* c : {"R", "G", "B"})
      header.channels().insert(k == 0 ? c : fmt::format("{}.{}", k, c), Imf::Channel(Imf::FLOAT));
  { const Imf::OutputFile output(file.name(), header); }
  return file.bytes();
}

TEST(Picture, TilesOfAnySizeAreNotAllocatedOnTheHeadersWord) {
  EXPECT_EQ(complaint(header_of(65536, 256, 3, Imf::DWAB_COMPRESSION)),
            "a.exr:channels: 9 channels of 65536 x 256 pixels, more than fits in memory");
  const TemporaryFile file;
  Imf::Header header(12, 8);
  for (const char* c : {"R", "G", "B"}) header.channels().insert(c, Imf::Channel(Imf::FLOAT));
  header.setTileDescription(Imf::TileDescription(8, 8));
  { const Imf::TiledOutputFile output(file.name(), header); }
  std::string bytes = file.bytes();
  const uint32_t rows = 4653064;
  bytes.replace(bytes.find("tiledesc") + 17, 4, reinterpret_cast<const char*>(&rows), 4);
  EXPECT_EQ(complaint(bytes), "a.exr:tiles: tiles of 8 x 4653064 pixels, more than fits in memory");
}

TEST(Picture, MorePixelsThanTheFileCanHoldAreRefusedBeforeTheyTakeMemory) {
  EXPECT_EQ(complaint(header_of(16384, 256, 20, Imf::ZIP_COMPRESSION)),
            "a.exr:data window: 16384 x 256 pixels of 60 channels are 960 MiB, expected at most "
            "5.59 MiB in a file of 1.57 KiB");
  for (const auto compression :
       {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::PIZ_COMPRESSION,
        Imf::PXR24_COMPRESSION, Imf::B44_COMPRESSION, Imf::DWAA_COMPRESSION}) {
    const std::string text = complaint(header_of(2048, 4096, 60, compression));
    EXPECT_NE(text.find("GiB, expected at most"), std::string::npos) << compression << text;
  }
}

// The most compressible pictures are within those bounds.
TEST(Picture, BlackPicturesOfAllCompressionsAreRead) {
  constexpr int side = 1024;
  const std::vector<float> black(size_t{side} * side);
  for (int compression = 0; compression < Imf::NUM_COMPRESSION_METHODS; ++compression) {
    const TemporaryFile file;
    Imf::Header header(side, side);
    header.compression() = static_cast<Imf::Compression>(compression);
    Imf::FrameBuffer buffer;
    for (const char* c : {"R", "G", "B"}) {
      header.channels().insert(c, Imf::Channel(Imf::FLOAT));
      buffer.insert(c, Imf::Slice::Make(Imf::FLOAT, black.data(), header.dataWindow()));
    }
    {
      Imf::OutputFile output(file.name(), header);
      output.setFrameBuffer(buffer);
      output.writePixels(side);
    }
    EXPECT_EQ(complaint(file.bytes()), "") << compression;
  }
}

// The library leaves the pixels of an empty chunk uninitialised.
TEST(Picture, ChunksHaveBytes) {
  ExrFile file;
  file.picture = gradient(8, 40);
  std::string bytes = exr_bytes(file);
  const auto offset = [&](size_t chunk) {  // of the three chunks of 16 rows after the header
    uint64_t at = 0;
    std::memcpy(&at, bytes.data() + exr::headers_of(bytes).end + 8 * chunk, sizeof at);
    return at;
  };
  EXPECT_EQ(complaint(bytes), "");
  const std::string good = bytes;
  std::memset(bytes.data() + offset(1) + 4, 0, 4);
  EXPECT_EQ(complaint(bytes), "a.exr: is damaged: chunk 1 of 3 is empty");
  bytes = good;
  std::memset(bytes.data() + exr::headers_of(bytes).end + 16, 0, 8);
  EXPECT_EQ(complaint(bytes), "a.exr: is damaged: chunk 2 of 3 is missing");
}

TEST(Picture, TakesNoMoreThanTheLimitOfMemory) {
  ExrFile file;
  file.picture = gradient(100, 100);
  file.layers["a"] = gradient(100, 100);
  const uint64_t machine = memory_limit();
  limit_memory(400'000);
  EXPECT_EQ(complaint(exr_bytes(file)),
            "a.exr:display window: 100 x 100 pixels of 2 layers take 544 KiB of memory, expected "
            "at most the 391 KiB of --max-memory");
  limit_memory(machine);
  EXPECT_EQ(complaint(exr_bytes(file)), "");
}

// Whatever the bytes, the outcome is a picture or an InputError: no crash, no other exception.
TEST(Picture, DamagedBytesNeverDoWorseThanAnInputError) {
  ExrFile file;
  file.picture = gradient(40, 40);
  file.layers["a"] = gradient(40, 40);
  const std::string good = exr_bytes(file);
  int refused = 0;
  for (uint32_t i = 0; i < 1500; ++i) {
    Rng rng(1, 2, i);
    std::string bytes = good;
    for (int n = 0; n < 1 + static_cast<int>(3 * rng.uniform()); ++n) {
      const double size = rng.uniform() < 0.5 ? 400 : static_cast<double>(bytes.size());
      const auto at = static_cast<size_t>(rng.uniform() * size);
      bytes[at] = static_cast<char>(256 * rng.uniform());
    }
    refused += !complaint(bytes).empty();
  }
  EXPECT_GT(refused, 500);
}

TEST(Picture, RefusesToWriteLayersOfAnotherSize) {
  ExrFile file;
  file.picture = gradient(4, 4);
  file.layers["a"] = gradient(4, 3);
  EXPECT_THROW(exr_bytes(file), std::invalid_argument);
}

TEST(Picture, PngIsSrgbAndClipped) {
  const Picture p{
      2, 2, {Rgb(0.5f), Rgb(7.0f), Rgb(-1.0f), Rgb(std::numeric_limits<float>::quiet_NaN())}};
  const std::string png = png_bytes(p);
  EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(png, png_of_rgb8(2, 2, {188, 188, 188, 255, 255, 255, 0, 0, 0, 0, 0, 0}));
}

// PNG stores colours without premultiplied alpha.
TEST(Picture, PngWithAlpha) {
  Picture p{2, 1, {Rgb(0.25f), Rgb(0.0f)}, {0.5f, 0}};
  const std::string png = png_bytes(p);
  EXPECT_EQ(png[25], 6);  // RGB and alpha
  const std::string straight = png_of_rgb8(2, 1, {188, 188, 188, 128, 0, 0, 0, 0});
  EXPECT_EQ(png, straight);
}

}  // namespace tdpt::picture_test
