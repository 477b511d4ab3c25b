#include "libcommon/formats/viewpoint.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace tdpt::viewpoint_test {

Viewpoint eye() {
  return {{1.25, -2, 0.1}, {0.6, 0, -0.8}, {0, 1, 0}, 0.9, 1.5, true, "the eye"};
}

TEST(Viewpoint, IsReadAsItWasWritten) {
  const std::string text = viewpoint_text(eye());
  EXPECT_EQ(text, "1.25 -2 0.1 0.6 0 -0.8 0 1 0 0.9 1.5 fronts the eye");
  const auto read = parse_viewpoint(text);
  ASSERT_TRUE(read);
  EXPECT_EQ(viewpoint_text(*read), text);
  EXPECT_EQ(words_of_difference(eye(), *read, 1), "");
  Viewpoint nameless = eye();
  nameless.name = "", nameless.culls = false;
  EXPECT_EQ(viewpoint_text(*parse_viewpoint(viewpoint_text(nameless))), viewpoint_text(nameless));
}

TEST(Viewpoint, OfACameraIsInMetresAndBack) {
  const Frame frame{{10, 20, 30}, 0.25};
  Camera camera = camera_of(frame, eye());
  EXPECT_NEAR(length(camera.right - Vec3d{0.8, 0, 0.6}), 0, 1e-15);
  EXPECT_NEAR(length(camera.position - frame.to_canonical({1.25, -2, 0.1})), 0, 1e-15);
  EXPECT_EQ(words_of_difference(viewpoint_of(frame, camera), eye(), 1), "");
  camera.name = " a\nname\t";
  EXPECT_EQ(viewpoint_of(frame, camera).name, "a name") << "of one line";
}

TEST(Viewpoint, WhatIsNoneIsNotRead) {
  for (const char* line :
       {"", "1 2 3", "1 2 3 0 0 -1 0 1 0 0.9 1.5", "1 2 3 0 0 -1 0 1 0 0.9 1.5 some eye",
        "1 2 3 0 0 -2 0 1 0 0.9 1.5 all", "1 2 3 0 0 -1 0 0 1 0.9 1.5 all",
        "1 2 3 0 0 -1 0 1 0 0 1.5 all", "1 2 3 0 0 -1 0 1 0 4 1.5 all",
        "1 2 3 0 0 -1 0 1 0 0.9 -1 all", "1 2 nan 0 0 -1 0 1 0 0.9 1 all",
        "1 2 inf 0 0 -1 0 1 0 0.9 1 all", "1 2 3x 0 0 -1 0 1 0 0.9 1 all"})
    EXPECT_FALSE(parse_viewpoint(line)) << line;
}

TEST(Viewpoint, DifferencesAreToldWhereTheyMatter) {
  const auto told = [](const auto& change, double size = 4) {
    Viewpoint other = eye();
    change(other);
    return words_of_difference(eye(), other, size);
  };
  EXPECT_EQ(told([](Viewpoint& v) { v.name = "another", v.aspect = 1; }), "");
  EXPECT_EQ(told([](Viewpoint& v) { v.position.x += 0.003; }), "");
  EXPECT_EQ(told([](Viewpoint& v) { v.position.x += 0.003; }, 2), "0.003 m away");
  EXPECT_EQ(told([](Viewpoint& v) { v.forward = {0, 0, -1}; }), "turned by 37 degrees");
  EXPECT_EQ(told([](Viewpoint& v) { v.up = -v.up; }), "turned by 180 degrees");
  EXPECT_EQ(told([](Viewpoint& v) { v.yfov = 0.5; }), "of 28.6 in the place of 51.6 degrees");
  EXPECT_EQ(told([](Viewpoint& v) { v.position.y = 0, v.culls = false; }),
            "2 m away and not passing backs (--cull)");
}

TEST(Viewpoint, InWords) {
  Viewpoint v = eye();
  v.position = {1.5, -0.0, 1e-7}, v.forward = {0, 0, -1}, v.up = {0, 1, 0};
  v.yfov = std::numbers::pi / 4, v.aspect = 1.5, v.culls = true, v.name = "hall";
  const std::string words = words_of(v);
  for (const char* part : {"hall: eye 1.5 0 1e-07 m", "45 degrees", "aspect 1.5", "--cull"})
    EXPECT_NE(words.find(part), std::string::npos) << words;
  v.aspect = 0, v.culls = false, v.name = "";
  EXPECT_EQ(words_of(v).find("eye 1.5 0 1e-07 m"), 0u);
}

}  // namespace tdpt::viewpoint_test
