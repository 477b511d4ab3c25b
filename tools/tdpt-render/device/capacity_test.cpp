#include "tools/tdpt-render/device/gpu_renderer.h"

#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "tools/tdpt-render/device/wavefront.h"
#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::capacity_test {

// Largest buffer: the least that Vulkan allows; memory, texels and buffers as in laptops.
gpu::Limits laptop() {
  gpu::Limits limits;
  limits.memory = uint64_t{2} << 30;
  limits.buffer = 1 << 27;
  limits.texels = uint64_t{1} << 31;
  limits.buffers = 35;
  limits.groups = 65535;
  return limits;
}

void expect_refused(const char* word, const gpu::Limits& limits, const DeviceNeeds& needs) {
  try {
    capacity_on("a device", limits, needs);
    FAIL() << word;
  } catch (const Error& e) {
    EXPECT_EQ(e.code, Exit::no_device);
    EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
  }
}

TEST(capacity, is_there_on_the_least_device_for_the_longest_paths) {
  const Capacity room = capacity_on("a device", laptop(), {0, 1 << 27, true, 35});
  EXPECT_GE(room.samples, kMostOfCache);
  EXPECT_GE(room.vertices, 2u * kMostOfCache * 1025);
  EXPECT_LE(room.vertices * sizeof(shader::PathVertex), laptop().buffer);
  EXPECT_LE(room.vertices, 64 * laptop().groups);
}

TEST(capacity, follows_each_limit) {
  gpu::Limits limits;
  limits.memory = uint64_t{1} << 38;
  limits.buffer = uint64_t{1} << 32;
  limits.texels = uint64_t{1} << 36;
  limits.buffers = 1 << 20;
  limits.groups = 1 << 31;
  EXPECT_EQ(capacity_on("a device", limits, {}).vertices, 1u << 24);
  limits.groups = 65535;
  EXPECT_EQ(capacity_on("a device", limits, {}).vertices, 64u * 65535);
  limits.buffer = 1 << 27;
  EXPECT_EQ(capacity_on("a device", limits, {}).vertices, (1u << 27) / 144);
  limits.buffer = uint64_t{1} << 32;
  limits.memory = uint64_t{4} << 30;
  const uint32_t plain = capacity_on("a device", limits, {}).vertices;
  EXPECT_LT(plain, 64u * 65535);
  EXPECT_LT(capacity_on("a device", limits, {0, 0, true, 0}).vertices, plain);
  // Scene and film are placed before samples.
  EXPECT_LT(capacity_on("a device", limits, {uint64_t{11} << 28, 0, false, 0}).vertices, plain);
}

TEST(capacity, that_is_too_little_is_refused) {
  gpu::Limits limits = laptop();
  capacity_on("a device", limits, {0, 0, false, 35});
  expect_refused("36 buffers", limits, {0, 0, false, 36});
  limits.texels = 1 << 28;
  expect_refused("the scene takes 268435457 bytes", limits, {(1 << 28) + 1, 0, false, 1});
  expect_refused("the film takes 268435456 bytes", limits, {0, 1 << 28, false, 1});
  limits.texels = uint64_t{1} << 31;
  expect_refused("1845427200 bytes of memory", limits, {uint64_t{12} << 27, 0, false, 1});
  limits.buffer = 1 << 26;
  expect_refused("525312 vertices", limits, {});
  // Words count no more than 2^32.
  EXPECT_THROW(FilmPlaces(uint64_t{1} << 32, {}, 0), Error);
}

TEST(capacity, is_asked_for_before_portals_are_turned_and_tables_follow) {
  const Scene scene = read_gltf(two_rooms_path());
  Vista vista(scene, scene.camera(""), 16, 12, {portal_in_the_hole()});
  RenderTables tables(vista);
  vista.openings = Openings(*vista.world, {});
  tables.follow(vista);
  EXPECT_TRUE(tables.portals.polygons.empty());
  const RenderTables anew(vista);
  EXPECT_EQ(tables.lights.words, anew.lights.words);
}

}  // namespace tdpt::capacity_test
