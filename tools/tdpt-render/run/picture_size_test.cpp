#include "tools/tdpt-render/run/scene_cache.h"

#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/denoise/filter_picture.h"

namespace tdpt::picture_size_test {

void expect(const PictureSize& size, int width, int height) {
  EXPECT_EQ(size.width, width);
  EXPECT_EQ(size.height, height);
}

TEST(picture_size, follows_the_camera_where_nothing_is_given) {
  Camera camera;
  camera.aspect = 4.0 / 3;
  expect(picture_size(Scene(), camera, 0, 0), 640, 480);
  expect(picture_size(Scene(), camera, 100, 0), 100, 75);
  expect(picture_size(Scene(), camera, 0, 75), 100, 75);
  expect(picture_size(Scene(), camera, 100, 100), 100, 100);
  camera.aspect = 0;
  expect(picture_size(Scene(), camera, 0, 0), 640, 360);
}

TEST(picture_size, has_a_pixel_at_least_and_2_to_the_27_at_most) {
  Camera camera;
  camera.aspect = 1000;
  expect(picture_size(Scene(), camera, 8, 0), 8, 1);
  EXPECT_THROW(picture_size(Scene(), camera, 0, 100), UsageError);  // 100000 wide
  expect(picture_size(Scene(), camera, 16384, 8192), 16384, 8192);
  EXPECT_THROW(picture_size(Scene(), camera, 16384, 8193), UsageError);
}

TEST(film, is_limited_by_the_memory_of_all_its_sums) {
  RenderArguments a;
  const uint64_t machine = memory_limit();
  const auto expect_bytes = [&](uint64_t bytes) {
    limit_memory(6 * bytes);
    EXPECT_NO_THROW(expect_memory_of_film(a, {3, 2})) << bytes;
    limit_memory(6 * bytes - 1);
    EXPECT_THROW(expect_memory_of_film(a, {3, 2}), UsageError) << bytes;
    limit_memory(machine);
  };
  expect_bytes(48);
  a.alpha = true;
  expect_bytes(56);
  a.denoise = true;
  expect_bytes(104 + denoise::kBytesOfPixel);
  a.shard = "0/2";  // is filtered when it is merged
  expect_bytes(104);
  a.layers = true;
  expect_bytes(296);
  a.portals = {"door.glb"};
  expect_bytes(344);
  a.integrator = "nee";
  expect_bytes(200);
}

TEST(picture_size, is_that_of_the_scene_where_the_command_line_has_none) {
  Camera camera;
  camera.aspect = 4.0 / 3;
  Scene scene;
  scene.path = "room.glb";
  scene.defaults.place = "scenes[0].extras";
  expect(picture_size(scene, camera, 0, 0), 640, 480);
  scene.defaults.width = 320, scene.defaults.height = 200;
  expect(picture_size(scene, camera, 0, 0), 320, 200);
  expect(picture_size(scene, camera, 100, 0), 100, 75);
  expect(picture_size(scene, camera, 0, 75), 100, 75);
  scene.defaults.width = 0;
  expect(picture_size(scene, camera, 0, 0), 267, 200);
  scene.defaults.width = 65536, scene.defaults.height = 65536;
  try {
    picture_size(scene, camera, 0, 0);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_TRUE(std::string(e.what()).starts_with("room.glb:scenes[0].extras.tdpt_width:"));
  }
}

}  // namespace tdpt::picture_size_test
