#include "tools/tdpt-render/picture_size.h"

#include <gtest/gtest.h>

#include "libcommon/base/error.h"

namespace tdpt {
namespace {

void expect(const PictureSize& size, int width, int height) {
  EXPECT_EQ(size.width, width);
  EXPECT_EQ(size.height, height);
}

TEST(picture_size, follows_the_camera_where_nothing_is_given) {
  Camera camera;
  camera.aspect = 4.0 / 3;
  expect(picture_size(camera, 0, 0), 640, 480);
  expect(picture_size(camera, 100, 0), 100, 75);
  expect(picture_size(camera, 0, 75), 100, 75);
  expect(picture_size(camera, 100, 100), 100, 100);
}

TEST(picture_size, is_16_by_9_for_a_camera_without_aspect) {
  Camera camera;
  camera.aspect = 0;
  expect(picture_size(camera, 0, 0), 640, 360);
}

TEST(picture_size, has_a_pixel_at_least_and_as_many_as_memory_is_meant_for_at_most) {
  Camera camera;
  camera.aspect = 1000;
  expect(picture_size(camera, 8, 0), 8, 1);
  EXPECT_THROW(picture_size(camera, 0, 100), UsageError);  // 100000 wide
  expect(picture_size(camera, 16384, 8192), 16384, 8192);
  EXPECT_THROW(picture_size(camera, 16384, 8193), UsageError);
}

}  // namespace
}  // namespace tdpt
