#include "libcommon/options/shot_options.h"

#include <functional>

#include <gtest/gtest.h>

#include "libcommon/base/error.h"

namespace tdpt::testing::shot_options_test {
namespace {

std::string refusal(const std::function<void()>& call) {
  try {
    call();
    return "";
  } catch (const UsageError& e) {
    return e.what();
  }
}

TEST(Frames, AreARangeOrOne) {
  EXPECT_EQ(frame_range({"1-48", 24}).first, 1);
  EXPECT_EQ(frame_range({"1-48", 24}).last, 48);
  EXPECT_EQ(frame_range({"0-0", 24}).count(), 1);
  EXPECT_EQ(frame_range({"7", 24}).last, 7);
  for (const char* wrong : {"a", "1-", "-3", "1-2-3", "1,4", "1-b", "", " 1", "1-99999999", "1--2"})
    EXPECT_NE(refusal([&] {
                frame_range({wrong, 24});
              }).find("expected A-B, as 1-48"),
              std::string::npos)
        << wrong;
  EXPECT_EQ(refusal([] {
              frame_range({"48-1", 24});
            }),
            "--frames 48-1: runs backwards; meant 1-48?");
}

TEST(Frames, SayTheTimeThemselves) {
  EXPECT_EQ(refusal([] {
              check_shot({"1-4", 24}, {1.5, {}});
            }),
            "--at: the frames of --frames say which time they show");
  check_shot({"", 24}, {1.5, {}});
}

TEST(Frames, NumberTheLastHashesOfAName) {
  EXPECT_EQ(name_of_frame("-o", "a/shot.####.exr", 12), "a/shot.0012.exr");
  EXPECT_EQ(name_of_frame("-o", "a/shot.##.exr", 1234), "a/shot.1234.exr");
  EXPECT_EQ(name_of_frame("-o", "###", 7), "007");
  EXPECT_EQ(name_of_frame("-o", "take #2/x#.exr", 3), "take #2/x3.exr");
  EXPECT_EQ(name_of_frame("-o", "####.0-of-4.exr", 3), "0003.0-of-4.exr");
  for (const char* wrong : {"shot.exr", "#/shot.exr", "-"})
    EXPECT_NE(refusal([&] { name_of_frame("-o", wrong, 1); }).find("write #### where"),
              std::string::npos)
        << wrong;
}

TEST(Frames, MakeAShot) {
  EXPECT_EQ(name_of_shot("a/shot.####.exr"), "a/shot.exr");
  EXPECT_EQ(name_of_shot("a.b/shot_##.x.exr"), "a.b/shot.x.exr");
  EXPECT_EQ(name_of_shot("take #2/####.exr"), "take #2/frames.exr");
  EXPECT_EQ(name_of_shot("#.exr"), "frames.exr");
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
}  // namespace tdpt::testing::shot_options_test
