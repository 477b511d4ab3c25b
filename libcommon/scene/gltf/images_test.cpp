// Damaged images, and images whose headers lie.
#include "libcommon/scene/gltf/textures.h"

#include <gtest/gtest.h>
#include <cstring>

namespace tdpt::gltf::images_test {

/// A grey JPEG with one bit per block; `data` follows the header of its only scan.
std::string jpeg(int width, int height, bool scan, const std::string& data) {
  std::string out = "\xff\xd8";
  const auto put = [&](std::initializer_list<int> bytes) {
    for (int b : bytes) out += static_cast<char>(b);
  };
  put({0xff, 0xdb, 0, 67, 0});
  out += std::string(64, 1);
  put({0xff, 0xc0, 0, 11, 8, height >> 8, height & 255, width >> 8, width & 255, 1, 1, 0x11, 0});
  for (int table : {0, 0x10}) {  // one code, of one bit, for "nothing"
    put({0xff, 0xc4, 0, 20, table, 1});
    out += std::string(16, 0);
  }
  if (scan) put({0xff, 0xda, 0, 8, 1, 1, 0, 0, 63, 0});
  return out + data + "\xff\xd9";
}

std::vector<uint8_t> texels_of(const std::string& image) {
  const std::optional<Image> out = decode_image(image);
  return out ? out->texels : std::vector<uint8_t>{};
}

/// Fills memory with `byte` and frees it.
void spoil_memory(int byte) {
  std::vector<void*> all;
  for (size_t size = 64; size < (1 << 18); size += size / 4) {
    all.push_back(std::malloc(size));
    std::memset(all.back(), byte, size);
    asm volatile("" : : "r"(all.back()) : "memory");
  }
  for (void* at : all) std::free(at);
}

TEST(Images, DamagedOnesAreTheSameEachTime) {
  ASSERT_EQ(texels_of(jpeg(64, 64, true, std::string(16, 0))).size(), 64u * 64 * 4);
  for (const bool scan : {false, true})
    for (const int size : {16, 48, 64, 200}) {
      const std::string image = jpeg(size, size, scan, "");
      spoil_memory(0xAB);
      const std::vector<uint8_t> once = texels_of(image);
      spoil_memory(0x55);
      EXPECT_EQ(texels_of(image), once) << size << " " << scan;
    }
}

TEST(Images, OfMoreTexelsThanTheirBytesCanHoldAreNone) {
  const std::string whole = jpeg(1024, 1024, true, std::string(4096, 0));
  EXPECT_EQ(texels_declared(whole), 1024 * 1024);
  EXPECT_EQ(texels_declared(jpeg(8192, 8192, true, std::string(4096, 0))), std::nullopt);
  EXPECT_EQ(texels_declared(jpeg(8192, 8192, false, "")), std::nullopt);
}

TEST(Images, OfThousandsOfScansAreNone) {
  const auto with_scans = [](int count) {
    std::string scans;
    for (int i = 0; i < count; ++i) scans += std::string("\xff\xda\0\x08\1\1\0\0\x3f\0\0", 11);
    return jpeg(8, 8, false, scans);
  };
  EXPECT_EQ(texels_declared(with_scans(500)), 64);
  EXPECT_EQ(texels_declared(with_scans(501)), std::nullopt);
}

/// A grey PNG of one texel, whose data chunk declares this length.
std::string png(uint32_t declared) {
  const std::string data("\x78\x01\x01\x02\x00\xfd\xff\x00\x80\x00\x82\x00\x81", 13);
  const auto word = [](uint32_t value) {
    std::string four;
    for (int shift : {24, 16, 8, 0}) four += static_cast<char>(value >> shift);
    return four;
  };
  return "\x89PNG\r\n\x1a\n" + word(13) + "IHDR" + word(1) + word(1) +
         std::string("\x08\x00\x00\x00\x00", 5) + word(0) + word(declared) + "IDAT" + data +
         word(0) + word(0) + "IEND" + word(0);
}

TEST(Images, ChunksAreAsLongAsTheySay) {
  EXPECT_EQ(texels_declared(png(13)), 1);
  EXPECT_EQ(texels_of(png(13)), (std::vector<uint8_t>{128, 128, 128, 255}));
  for (const uint32_t longer : {30u, 0x26000000u, 0xffffffffu})
    EXPECT_EQ(texels_declared(png(longer)), std::nullopt) << longer;
}

}  // namespace tdpt::gltf::images_test
