#include "libcommon/options/shot_options.h"

#include <gtest/gtest.h>

#include "libcommon/testing/files/refusal.h"

namespace tdpt::shot_options_test {
namespace {

using testing::refusal;

TEST(Frames, AreARangeOrOne) {
  EXPECT_EQ(frame_range({"1-48", 24}).first, 1);
  EXPECT_EQ(frame_range({"1-48", 24}).last, 48);
  EXPECT_EQ(frame_range({"0-0", 24}).count(), 1);
  EXPECT_EQ(frame_range({"7", 24}).last, 7);
  for (const char* wrong : {"a", "1-", "-3", "1-2-3", "1,4", "1-b", "", " 1", "1-99999999", "1--2"})
    EXPECT_THROW(frame_range({wrong, 24}), UsageError) << wrong;
  EXPECT_NE(refusal([] { frame_range({"48-1", 24}); }).find("meant 1-48?"), std::string::npos);
}

TEST(Frames, NumberTheLastHashesOfAName) {
  EXPECT_EQ(name_of_frame("-o", "a/shot.####.exr", 12), "a/shot.0012.exr");
  EXPECT_EQ(name_of_frame("-o", "a/shot.##.exr", 1234), "a/shot.1234.exr");
  EXPECT_EQ(name_of_frame("-o", "###", 7), "007");
  EXPECT_EQ(name_of_frame("-o", "take #2/x#.exr", 3), "take #2/x3.exr");
  EXPECT_EQ(name_of_frame("-o", "####.0-of-4.exr", 3), "0003.0-of-4.exr");
  for (const char* wrong : {"shot.exr", "#/shot.exr", "-"})
    EXPECT_THROW(name_of_frame("-o", wrong, 1), UsageError) << wrong;
}

TEST(Frames, AreNamesOfACamerasPoses) {
  const std::string name = camera_at_frame("walk, frame 1", 12);
  EXPECT_EQ(name, "walk, frame 1, frame 12");
  EXPECT_EQ(frame_of_camera(name, "walk, frame 1"), 12);
  EXPECT_EQ(frame_of_camera(name, "walk"), std::nullopt);
  EXPECT_EQ(frame_of_camera("walk", "walk"), std::nullopt);
  EXPECT_EQ(frame_of_camera("walk, frame 7", "walk"), 7);
  EXPECT_EQ(frame_of_camera("walk, frame ", "walk"), std::nullopt);
}

}  // namespace
}  // namespace tdpt::shot_options_test
