#include "libcommon/draw/canvas.h"

#include <cmath>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "libcommon/draw/sheet.h"
#include "libcommon/testing/read_png.h"

namespace tdpt::draw {
namespace {

const Ink kWhite{1, 1, 1}, kBlack{0, 0, 0};

// How much of the canvas is inked [pixels].
double inked(const Canvas& c) {
  double sum = 0;
  for (int y = 0; y < c.height(); ++y)
    for (int x = 0; x < c.width(); ++x) sum += 1 - static_cast<double>(c.at(x, y).x);
  return sum;
}

TEST(canvas, shapes_cover_their_area) {
  Canvas disc(100, 100, kWhite), polygon(100, 100, kWhite), line(100, 100, kWhite),
      box(100, 100, kWhite);
  disc.disc({50.3, 49.6}, 20, kBlack);
  EXPECT_NEAR(inked(disc), std::numbers::pi * 400, 4);
  polygon.polygon({{10.2, 10}, {80, 20.5}, {60, 70}, {20, 50}}, kBlack);
  EXPECT_NEAR(inked(polygon), 2534.55, 5);
  line.line({10, 10}, {90, 70}, 5, kBlack);  // and half a disc at each end
  EXPECT_NEAR(inked(line), 100 * 5 + std::numbers::pi * 6.25, 5);
  box.fill({10.25, 20.5, 30.5, 10.25}, kBlack);
  EXPECT_NEAR(inked(box), 30.5 * 10.25, 1e-3);
  // Twin: a disc of another radius is not taken for this one.
  Canvas larger(100, 100, kWhite);
  larger.disc({50.3, 49.6}, 20.5, kBlack);
  EXPECT_GT(std::abs(inked(larger) - std::numbers::pi * 400), 4);
}

TEST(canvas, either_way_round_a_polygon_is_the_same) {
  Canvas a(40, 40, kWhite), b(40, 40, kWhite);
  a.polygon({{5, 5}, {30, 8}, {20, 33}}, kBlack);
  b.polygon({{20, 33}, {30, 8}, {5, 5}}, kBlack);
  EXPECT_EQ(a.png(), b.png());
}

TEST(canvas, half_opaque_ink_lies_half_way) {
  Canvas c(10, 10, kWhite);
  c.fill({0, 0, 10, 10}, kBlack, 0.5);
  EXPECT_FLOAT_EQ(c.at(5, 5).y, 0.5f);
}

TEST(canvas, nothing_is_drawn_outside_the_clip_or_the_canvas) {
  Canvas c(40, 40, kWhite);
  c.clip({10, 10, 20, 20});
  c.line({-1e5, -1e5}, {1e5, 1e5}, 3, kBlack);
  c.line({-500, 20}, {500, 22}, 3, kBlack);
  EXPECT_EQ(c.at(9, 9), kWhite);
  EXPECT_EQ(c.at(9, 20), kWhite);
  EXPECT_EQ(c.at(30, 30), kWhite);
  EXPECT_LT(c.at(20, 20).x, 0.01f);
  c.unclip();
  c.disc({NAN, 20}, 5, kBlack);
  c.line({20, 20}, {INFINITY, NAN}, 2, kBlack);
  c.polygon({{NAN, 0}, {5, 5}, {0, 5}}, kBlack);
  EXPECT_EQ(c.at(9, 9), kWhite);
}

TEST(canvas, becomes_a_png_of_its_pixels_to_a_step_of_63) {
  Canvas c(7, 5, ink(0x316599));
  c.blend(3, 2, ink(0xff8000));
  const testing::PngPixels p = testing::read_png(c.png());
  ASSERT_EQ(p.width, 7);
  ASSERT_EQ(p.height, 5);
  EXPECT_EQ(p.at(3, 2), (std::array<uint8_t, 3>{0xff, 0x82, 0}));
  EXPECT_EQ(p.at(2, 3), (std::array<uint8_t, 3>{0x31, 0x65, 0x9a}));
}

TEST(text, every_letter_leaves_its_own_trace_within_its_width) {
  std::set<std::string> traces;
  for (char letter = '!'; letter <= '~'; ++letter) {
    const std::string word(1, letter);
    Canvas c(60, 60, kWhite);
    text(c, {20, 40}, word, 20, kBlack);
    EXPECT_GT(inked(c), 5) << letter;
    EXPECT_TRUE(traces.insert(c.png()).second) << letter << " looks like another";
    const int end = static_cast<int>(std::ceil(20 + text_width(word, 20) + 3));
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 60; ++x)
        if (x < 17 || x > end || y > 50 || y < 12) {
          EXPECT_EQ(c.at(x, y), kWhite) << letter;
        }
  }
}

TEST(text, is_aligned_by_its_width) {
  const double width = text_width("portal.0", 12);
  Canvas left(200, 30, kWhite), right(200, 30, kWhite);
  text(left, {20, 20}, "portal.0", 12, kBlack);
  text(right, {20 + width, 20}, "portal.0", 12, kBlack, Align::right);
  EXPECT_EQ(left.png(), right.png());
}

TEST(sheet, numbers_are_grouped_and_words_are_fitted) {
  EXPECT_EQ(number(1234567), "1 234 567");
  EXPECT_EQ(number(-100000), "-100 000");
  EXPECT_EQ(number(999), "999");
  EXPECT_EQ(number(0.01234), "0.0123");
  EXPECT_EQ(base_name("a/b/room.glb"), "room.glb");
  EXPECT_EQ(base_name("-"), "(standard input)");
  EXPECT_EQ(fitted("short", 10, 1000), "short");
  const std::string cut = fitted("a very long sentence about light", 10, 100);
  EXPECT_TRUE(cut.ends_with("..."));
  EXPECT_LE(text_width(cut, 10), 100);
}

float lightness(const Ink& c) {
  return 0.3f * c.x + 0.6f * c.y + 0.1f * c.z;
}

TEST(colour, more_heat_is_darker) {
  for (int k = 0; k < 100; ++k)
    EXPECT_GT(lightness(heat(k / 100.0)), lightness(heat((k + 1) / 100.0))) << k;
}

TEST(colour, reach_and_regions_have_their_colours_at_the_ends) {
  EXPECT_EQ(reach(1, 0), kLight);
  EXPECT_EQ(reach(0, 1), kCamera);
  EXPECT_EQ(reach(1, 1), kBoth);
  EXPECT_EQ(reach(0, 0), kClay);
  EXPECT_EQ(region(0, 3), kLight);
  EXPECT_EQ(region(2, 3), kCamera);
  EXPECT_NE(region(1, 3), kLight);
  EXPECT_NE(region(1, 3), kCamera);
}

}  // namespace
}  // namespace tdpt::draw
