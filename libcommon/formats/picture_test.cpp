#include "libcommon/formats/picture.h"

#include <cmath>
#include <cstring>
#include <functional>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticities.h>
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

#include "libcommon/base/file.h"
#include "libcommon/formats/picture_bounds.h"
#include "libcommon/formats/png.h"
#include "libcommon/testing/files/refusal.h"
#include "libcommon/testing/files/temp_folder.h"

namespace tdpt::picture_test {

Picture gradient(int width, int height) {
  Picture p{width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      p.pixels.push_back(
          {static_cast<float>(x), static_cast<float>(y), 0.25f * static_cast<float>(x + y)});
  return p;
}

ExrFile read(std::string_view bytes) {
  return parse_exr(bytes, "a.exr");
}
Picture read_picture(std::string_view bytes) {
  return parse_exr_picture(bytes, "a.exr", 16, 8);
}

// The bytes of a file that the library itself writes, without our writer: of its header alone if
// there is nothing to write.
template <class Output = Imf::OutputFile>
std::string by_library(const Imf::Header& header,
                       const std::function<void(Output&)>& write = nullptr) {
  const testing::TempFolder folder;
  const std::string path = folder.path / "a.exr";
  {
    Output output(path.c_str(), header);
    if (write) write(output);
  }
  return read_file(path);
}
std::string of_rows(const Imf::Header& header, const Imf::FrameBuffer& buffer, int rows) {
  return by_library<Imf::OutputFile>(header, [&](Imf::OutputFile& output) {
    output.setFrameBuffer(buffer);
    output.writePixels(rows);
  });
}
// A picture of `pixels`, all with the channels' type.
template <class Number>
std::string of_rgb(Imf::Header header, Imf::PixelType type, const std::vector<Number>& grey) {
  Imf::FrameBuffer buffer;
  for (const char* c : {"R", "G", "B"}) {
    header.channels().insert(c, Imf::Channel(type));
    buffer.insert(c, Imf::Slice::Make(type, grey.data(), header.dataWindow()));
  }
  return of_rows(header, buffer, header.dataWindow().max.y - header.dataWindow().min.y + 1);
}

TEST(Picture, ComesBackAsItWasWritten) {
  ExrFile file;
  file.picture = gradient(37, 19);
  file.picture.pixels[5] = {1e-30f, -2.5f, 3e30f};
  file.layers["direct"] = gradient(37, 19);
  file.layers["portal.left"] = gradient(37, 19);
  file.attributes["integrator"] = "tdpt";
  set_provenance(file, {{"made by a 1: a", "from b c"}});
  const ExrFile back = read(exr_bytes(file));
  EXPECT_EQ(exr_bytes(file), exr_bytes(file));
  EXPECT_EQ(back.picture.width, 37);
  EXPECT_EQ(back.picture.height, 19);
  EXPECT_EQ(back.picture.pixels, file.picture.pixels);
  ASSERT_EQ(back.layers.size(), 2u);
  EXPECT_EQ(back.layers.at("portal.left").pixels, file.layers["portal.left"].pixels);
  EXPECT_EQ(back.attributes, file.attributes);
  EXPECT_EQ(provenance_of(back).lines, (std::vector<std::string>{"made by a 1: a", "from b c"}));
  EXPECT_EQ(back.pixels_without_data, 0);
  set_provenance(file, {});
  EXPECT_EQ(file.attributes.size(), 1u) << "an empty provenance takes none";
  EXPECT_TRUE(provenance_of(file).empty());
}

TEST(Picture, HalfWithAnOffsetDataWindow) {
  // Display window 4 x 3 at (10, 20); data 2 x 5 pixels from (11, 19): one row above and one below.
  Imf::Header header(Imath::Box2i({10, 20}, {13, 22}), Imath::Box2i({11, 19}, {12, 23}));
  std::vector<Imath::half> values(2 * 5);
  for (size_t i = 0; i < values.size(); ++i) values[i] = Imath::half(static_cast<float>(i + 1));
  values[7] = Imath::half(1e6f);  // infinite
  Imf::FrameBuffer buffer;
  for (const char* c : {"R", "G", "B", "A"}) {
    header.channels().insert(c, Imf::Channel(Imf::HALF));
    buffer.insert(c, Imf::Slice::Make(Imf::HALF, values.data(), header.dataWindow()));
  }
  const ExrFile back = read(of_rows(header, buffer, 5));
  ASSERT_EQ(back.picture.width, 4);
  ASSERT_EQ(back.picture.height, 3);
  for (int y = 0; y < 3; ++y) {
    const Rgb* row = &back.picture.pixels[static_cast<size_t>(4 * y)];
    EXPECT_EQ(row[0], Rgb(0));
    EXPECT_EQ(row[1], Rgb(static_cast<float>(2 * y + 3)));
    EXPECT_EQ(row[2], Rgb(y == 2 ? INFINITY : static_cast<float>(2 * y + 4)));
    EXPECT_EQ(row[3], Rgb(0));
    for (int x = 0; x < 4; ++x)  // what has no data covers nothing
      EXPECT_EQ(back.picture.alpha[static_cast<size_t>(4 * y + x)], row[x].x);
  }
  EXPECT_EQ(back.pixels_without_data, 6);
}

TEST(Picture, Tiles) {
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
  const std::string bytes =
      by_library<Imf::TiledOutputFile>(header, [&](Imf::TiledOutputFile& output) {
        output.setFrameBuffer(buffer);
        for (int level = 0; level < output.numLevels(); ++level)
          output.writeTiles(0, output.numXTiles(level) - 1, 0, output.numYTiles(level) - 1, level);
      });
  EXPECT_EQ(read(bytes).picture.pixels, p.pixels);
}

// A header of 8 x 8 pixels with these channels.
Imf::Header with_channels(std::initializer_list<const char*> names, int width = 8, int height = 8) {
  Imf::Header header(width, height);
  for (const char* c : names) header.channels().insert(c, Imf::Channel(Imf::FLOAT));
  return header;
}
std::string shown_in(const Imath::Box2i& window) {
  Imf::Header header(8, 8);
  header.displayWindow() = window;
  return of_rgb(header, Imf::FLOAT, std::vector<float>(64));
}

TEST(Picture, RefusesWhatItCannotShow) {
  const std::string grey = by_library(with_channels({"Y", "A"}));
  Imf::Header sparse = with_channels({"R", "G"}), deep = with_channels({"R", "G", "B"});
  sparse.channels().insert("B", Imf::Channel(Imf::FLOAT, 2, 2));
  deep.setType(Imf::DEEPSCANLINE);
  deep.compression() = Imf::ZIPS_COMPRESSION;
  testing::expect_refused(
      {{"", "", "is not an OpenEXR file"},
       {"glTF is something else", "", "is not an OpenEXR file"},
       {grey, "channels", "A Y, expected R, G and B"},
       {by_library(sparse), "channel B", "fewer samples than pixels"},
       {by_library<Imf::DeepScanLineOutputFile>(deep), "type", "deep pixels"},
       {shown_in({{100, 100}, {107, 107}}), "data window", "outside the display window"},
       {shown_in({{0, 0}, {69999, 7}}), "", "65536"},
       {shown_in({{0, 0}, {65535, 65535}}), "display window", "at most 17039360 in all"}},
      read);
  // A picture alone has no layers, and a bound; its header decides that, before there are pixels.
  ExrFile file, large;
  file.picture = file.layers["a"] = gradient(16, 8);
  large.picture = gradient(17, 8);
  EXPECT_EQ(read_picture(exr_bytes(file)).pixels, file.picture.pixels);
  testing::expect_refused(
      {{"glTF", "", "is not an OpenEXR file"},
       {exr_bytes(large).substr(0, 400), "header", "17 x 8 pixels, expected at most 16 x 8"},
       {shown_in({{0, 0}, {15, 7}}), "data window", "holds 64 pixels less"},
       {grey, "channels", "A Y, expected R, G and B"}},
      read_picture);
}

const Imf::Chromaticities kXyz({1, 0}, {0, 1}, {0, 0}, {1 / 3.0f, 1 / 3.0f});
const Imf::Chromaticities kAces({0.7347f, 0.2653f}, {0, 1}, {0.0001f, -0.077f},
                                {0.32168f, 0.33767f});

// A picture of one colour, with a layer of the same, that declares these primaries.
std::string with_primaries(const Imf::Chromaticities& primaries, const Rgb& colour) {
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
  return of_rows(header, buffer, 4);
}

void expect_near(const Rgb& a, const Rgb& b, double tolerance) {
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(static_cast<double>(a[c]), static_cast<double>(b[c]), tolerance) << c;
}

TEST(Picture, ColoursOfOtherPrimariesBecomeRec709) {
  // The colour 0.5 0.25 0.1 of Rec.709 in CIE XYZ, by the matrix of IEC 61966-2-1.
  const ExrFile xyz = read(with_primaries(kXyz, {0.313658f, 0.292353f, 0.134498f}));
  for (const Picture& p : {xyz.picture, xyz.layers.at("a")})
    for (const Rgb& pixel : p.pixels) expect_near(pixel, {0.5f, 0.25f, 0.1f}, 2e-4);
  // The white of ACES stays what it is: XYZ 0.95265 1 1.00883.
  expect_near(read(with_primaries(kAces, Rgb(1))).picture.pixels[3], {1.04696f, 0.99455f, 0.91562f},
              1e-3);
  // Red and blue of which each stands for the other.
  const Imf::Chromaticities own;
  const Imf::Chromaticities swapped(own.blue, own.green, own.red, own.white);
  expect_near(read(with_primaries(swapped, {1, 2, 3})).picture.pixels[0], {3, 2, 1}, 1e-5);
}

TEST(Picture, PrimariesOfRec709ChangeNoBit) {
  const Rgb colour(0.1f, 1e-20f, 7e9f);
  for (const float rounded : {0.0f, 1e-5f, -2e-5f}) {
    const Imf::Chromaticities own({0.64f, 0.33f}, {0.3f, 0.6f + rounded}, {0.15f, 0.06f},
                                  {0.3127f + rounded, 0.329f});
    EXPECT_EQ(read(with_primaries(own, colour)).picture.pixels[0], colour);
  }
}

TEST(Picture, PrimariesThatAreNoneAreRefused) {
  const Imf::Chromaticities own;
  for (const Imf::Chromaticities& bad :
       {Imf::Chromaticities({0, 0}, {0, 0}, {0, 0}, {0, 0}),
        Imf::Chromaticities(own.red, own.green, own.blue, {0.7f, 0.2f}),
        Imf::Chromaticities(own.red, own.red, own.blue, own.white),
        Imf::Chromaticities(own.red, own.green, {std::nanf(""), 0}, own.white),
        Imf::Chromaticities(own.red, own.green, own.blue, {0.3f, INFINITY})})
    testing::expect_refused({{with_primaries(bad, Rgb(1)), "chromaticities", "do not surround"}},
                            read);
}

// A green that no Rec.709 has.
TEST(Picture, LightOutsideTheGamutIsClippedToIt) {
  const std::string green = with_primaries(kXyz, {0, 1, 0});
  EXPECT_LT(read(green).picture.pixels[0].x, -1);
  const Rgb light = read_picture(green).pixels[0];
  expect_near(light, {0, 1.876f, 0}, 1e-3);
  EXPECT_EQ(light.x, 0);
  // What is negative in its own primaries stays so, to be refused.
  EXPECT_LT(read_picture(with_primaries(kXyz, Rgb(-1))).pixels[0].x, 0);
}

// A newer OpenEXR writes such files; they are not damaged.
TEST(Picture, WhatOpenExrHasGainedIsNamed) {
  ExrFile file;
  file.picture = gradient(8, 8);
  const std::string bytes = exr_bytes(file);
  using namespace std::string_view_literals;
  const auto compression = "compression\0compression\0\1\0\0\0"sv;
  const size_t at = bytes.find(compression) + compression.size();
  const auto with = [&](size_t place, int value) {
    return std::string(bytes).replace(place, 1, 1, static_cast<char>(value));
  };
  testing::expect_refused({{with(at, 10), "compression", "HTJ2K256"},
                           {with(at, 11), "compression", "HTJ2K32"},
                           {with(at, 13), "compression", "ZSTD"},
                           {with(at, 200), "compression", "number 200"},
                           {with(4, 3), "version", "3, expected 2"},
                           {with(5, 0x20), "version", "flags of features"}},
                          read);
}

// Another reader finds it there.
TEST(Picture, AlphaIsAChannelOfItsOwn) {
  const testing::TempFolder folder;
  ExrFile exr;
  exr.picture = gradient(5, 3);
  for (int i = 0; i < 15; ++i) exr.picture.alpha.push_back(static_cast<float>(i) / 14);
  Imf::InputFile input(folder.write("a.exr", exr_bytes(exr)).c_str());
  std::vector<float> alpha(15);
  Imf::FrameBuffer buffer;
  buffer.insert("A", Imf::Slice::Make(Imf::FLOAT, alpha.data(), input.header().dataWindow()));
  input.setFrameBuffer(buffer);
  input.readPixels(0, 2);
  EXPECT_EQ(alpha, exr.picture.alpha);
  const ExrFile back = read(exr_bytes(exr));
  EXPECT_EQ(back.picture.pixels, exr.picture.pixels);
  EXPECT_EQ(back.picture.alpha, exr.picture.alpha);
  exr.layers["a"] = gradient(5, 2);
  EXPECT_THROW(exr_bytes(exr), std::invalid_argument) << "of another size";
  exr.layers.clear();
  exr.picture.alpha.pop_back();
  EXPECT_THROW(exr_bytes(exr), std::invalid_argument);
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
  EXPECT_NO_THROW(read(with_size(note, 5)));
  testing::expect_refused(
      {{with_size(note, 0x60000005), "", "attribute note of 1610612741 bytes"},
       {with_size("lineOrder\0lineOrder\0"sv, 2), "", "of 2 bytes is no lineOrder"},
       {with_size("channels\0chlist\0"sv, 54), "", "of 54 bytes is no chlist"}},
      read);
}

// A header with `layers` of R, G and B and no pixels after it.
std::string header_of(int width, int height, int layers, Imf::Compression compression) {
  Imf::Header header = with_channels({"R", "G", "B"}, width, height);
  header.compression() = compression;
  for (int k = 1; k < layers; ++k)
    for (const char* c : {"R", "G", "B"})
      header.channels().insert(fmt::format("{}.{}", k, c), Imf::Channel(Imf::FLOAT));
  return by_library(header);
}

TEST(Picture, MorePixelsThanTheFileCanHoldAreRefusedBeforeTheyTakeMemory) {
  Imf::Header header = with_channels({"R", "G", "B"}, 12, 8);
  header.setTileDescription(Imf::TileDescription(8, 8));
  std::string tiles = by_library<Imf::TiledOutputFile>(header);
  const uint32_t rows = 4653064;
  tiles.replace(tiles.find("tiledesc") + 17, 4, reinterpret_cast<const char*>(&rows), 4);
  testing::expect_refused(
      {{tiles, "tiles", "8 x 4653064 pixels"},
       {header_of(65536, 256, 3, Imf::DWAB_COMPRESSION), "channels", "more than fits in memory"},
       {header_of(16384, 256, 20, Imf::ZIP_COMPRESSION), "data window", "are 960 MiB"}},
      read);
  for (const auto compression :
       {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::PIZ_COMPRESSION,
        Imf::PXR24_COMPRESSION, Imf::B44_COMPRESSION, Imf::DWAA_COMPRESSION})
    testing::expect_refused(
        {{header_of(2048, 4096, 60, compression), "data window", "GiB, expected at most"}}, read);
  // The most compressible pictures are within those bounds.
  const std::vector<float> black(size_t{1024} * 1024);
  for (int compression = 0; compression < Imf::NUM_COMPRESSION_METHODS; ++compression) {
    Imf::Header all(1024, 1024);
    all.compression() = static_cast<Imf::Compression>(compression);
    EXPECT_NO_THROW(read(of_rgb(all, Imf::FLOAT, black))) << compression;
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
  std::string missing = bytes;
  std::memset(missing.data() + exr::headers_of(bytes).end + 16, 0, 8);
  std::memset(bytes.data() + offset(1) + 4, 0, 4);
  testing::expect_refused(
      {{bytes, "", "chunk 1 of 3 is empty"}, {missing, "", "chunk 2 of 3 is missing"}}, read);
}

TEST(Picture, PngIsSrgbAndClipped) {
  const Picture p{2, 2, {Rgb(0.5f), Rgb(7.0f), Rgb(-1.0f), Rgb(NAN)}};
  const std::string png = png_bytes(p);
  EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(png, png_of_rgb8(2, 2, {188, 188, 188, 255, 255, 255, 0, 0, 0, 0, 0, 0}));
  // PNG stores colours without premultiplied alpha.
  const Picture half{2, 1, {Rgb(0.25f), Rgb(0.0f)}, {0.5f, 0}};
  EXPECT_EQ(png_bytes(half), png_of_rgb8(2, 1, {188, 188, 188, 128, 0, 0, 0, 0}));
}

}  // namespace tdpt::picture_test
