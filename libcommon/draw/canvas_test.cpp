#include "libcommon/draw/canvas.h"

#include <cmath>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "libcommon/draw/palette.h"
#include "libcommon/testing/files/read_png.h"

namespace tdpt::draw::canvas_test {

const Ink kWhite{1, 1, 1}, kBlack{0, 0, 0};

// Area of the canvas that is inked [pixels].
double inked(const Canvas& c) {
  const Raster drawn = c.pixels();
  double sum = 0;
  for (int y = 0; y < drawn.height(); ++y)
    for (int x = 0; x < drawn.width(); ++x) sum += 1 - static_cast<double>(drawn.at(x, y).x);
  return sum;
}

TEST(canvas, shapes_cover_their_area) {
  Canvas disc(100, 100, kWhite), polygon(100, 100, kWhite), line(100, 100, kWhite),
      box(100, 100, kWhite), frame(100, 100, kWhite);
  disc.disc({50.3, 49.6}, 20, kBlack);
  EXPECT_NEAR(inked(disc), std::numbers::pi * 400, 4);
  polygon.polygon({{10.2, 10}, {80, 20.5}, {60, 70}, {20, 50}}, kBlack);
  EXPECT_NEAR(inked(polygon), 2534.55, 3);
  line.line({10, 10}, {90, 70}, 5, kBlack);  // plus half a disc at each end
  EXPECT_NEAR(inked(line), 100 * 5 + std::numbers::pi * 6.25, 2);
  box.fill({10.25, 20.5, 30.5, 10.25}, kBlack);
  EXPECT_NEAR(inked(box), 30.5 * 10.25, 0.5);
  frame.frame({10, 20, 30, 40}, 2, kBlack);
  EXPECT_NEAR(inked(frame), 30 * 40 - 26 * 36, 0.1);
  // Either way round; half opaque ink lies half way.
  Canvas turned(100, 100, kWhite), half(10, 10, kWhite);
  turned.polygon({{20, 50}, {60, 70}, {80, 20.5}, {10.2, 10}}, kBlack);
  EXPECT_EQ(turned.png(), polygon.png());
  half.fill({0, 0, 10, 10}, kBlack, 0.5);
  EXPECT_NEAR(half.pixels().at(5, 5).y, 0.5f, 1 / 255.0f);
  // Twin: a disc with another radius is distinguished.
  Canvas larger(100, 100, kWhite);
  larger.disc({50.3, 49.6}, 20.5, kBlack);
  EXPECT_GT(std::abs(inked(larger) - std::numbers::pi * 400), 4);
}

TEST(canvas, nothing_is_drawn_outside_the_clip_or_the_canvas) {
  Canvas c(40, 40, kWhite);
  c.clip({10, 10, 20, 20});
  c.line({-1e5, -1e5}, {1e5, 1e5}, 3, kBlack);
  c.line({-500, 20}, {500, 22}, 3, kBlack);
  EXPECT_EQ(c.pixels().at(9, 9), kWhite);
  EXPECT_EQ(c.pixels().at(9, 20), kWhite);
  EXPECT_EQ(c.pixels().at(30, 30), kWhite);
  EXPECT_LT(c.pixels().at(20, 20).x, 0.01f);
  c.unclip();
  const double before = inked(c);
  c.disc({NAN, 20}, 5, kBlack);
  c.line({20, 20}, {INFINITY, NAN}, 2, kBlack);
  c.line({20, 20}, {30, 1e9}, 2, kBlack);
  c.polygon({{NAN, 0}, {5, 5}, {0, 5}}, kBlack);
  EXPECT_EQ(inked(c), before);
  // A shape after one that was not drawn is intact.
  c.polygon({{1, 1}, {5, 1}, {5, 5}, {1, 5}}, kBlack);
  EXPECT_NEAR(inked(c), before + 16, 1e-9);
}

TEST(canvas, rasters_are_never_interpolated) {
  Raster texels(2, 1, kWhite);
  texels.at(1, 0) = ink(0xff8000);
  Canvas c(20, 10, kBlack);
  c.raster({4, 2}, 5, texels);
  const Raster drawn = c.pixels();
  EXPECT_EQ(drawn.at(4, 2), kWhite);
  EXPECT_EQ(drawn.at(8, 6), kWhite);
  EXPECT_EQ(drawn.at(9, 6), ink(0xff8000));
  EXPECT_EQ(drawn.at(13, 2), ink(0xff8000));
  for (const auto& [x, y] : {std::pair(3, 4), std::pair(14, 4), std::pair(8, 1), std::pair(8, 7)})
    EXPECT_EQ(drawn.at(x, y), kBlack);
}

TEST(canvas, becomes_a_png_of_its_pixels) {
  Canvas c(7, 5, ink(0x316599));
  c.fill({3, 2, 1, 1}, ink(0xff8000));
  const testing::PngPixels p = testing::read_png(c.png());
  ASSERT_EQ(p.width, 7);
  ASSERT_EQ(p.height, 5);
  EXPECT_EQ(p.at(3, 2), (std::array<uint8_t, 3>{0xff, 0x80, 0}));
  EXPECT_EQ(p.at(2, 3), (std::array<uint8_t, 3>{0x31, 0x65, 0x99}));
}

// The case previews-vector has other programs read them.
TEST(canvas, the_ending_of_the_name_gives_the_format) {
  Canvas c(160, 120, kPaper);
  c.disc({120, 90}, 12, kLamp);
  EXPECT_TRUE(c.file_named("a/b.svg").starts_with("<?xml"));
  EXPECT_TRUE(c.file_named("b.pdf").starts_with("%PDF-"));
  for (const char* name : {"b.png", "svg", "b.svg.png", "b"})
    EXPECT_EQ(c.file_named(name), c.png());
  EXPECT_EQ(c.pdf(), c.pdf());
  EXPECT_EQ(c.pdf().find("Date"), std::string::npos);
}

TEST(text, capitals_are_as_high_as_asked) {
  Canvas c(100, 100, kWhite);
  c.text({30, 70}, "H", {30, kBlack});
  const Raster drawn = c.pixels();
  int top = 100, bottom = 0;
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 100; ++x)
      if (drawn.at(x, y) != kWhite) top = std::min(top, y), bottom = y + 1;
  EXPECT_NEAR(bottom - top, 30, 1);
  EXPECT_NEAR(bottom, 70, 1);
}

TEST(text, letters_of_all_scripts_leave_traces_of_their_own) {
  std::set<std::string> traces;
  for (const char* letter : {"!", "a", "Z", "~", "é", "Ж", "Ω", "ß", "×", "²"}) {
    Canvas c(60, 60, kWhite);
    c.text({20, 40}, letter, {20, kBlack});
    EXPECT_GT(inked(c), 5) << letter;
    EXPECT_TRUE(traces.insert(c.png()).second) << letter << " looks like another";
  }
}

TEST(text, any_bytes_can_be_a_name) {
  ::testing::internal::CaptureStderr();
  EXPECT_GT(text_width("caf\xe9\xff", 10), text_width("caf", 10));
  EXPECT_NEAR(text_width("", 10), 0, 1e-9);
  Canvas c(100, 40, kWhite);
  c.text({10, 20}, "two\nlines\t\xc3", {10, kBlack});
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(text, is_aligned_by_its_width) {
  const double width = text_width("portal.0", 12);
  Canvas left(200, 30, kWhite), right(200, 30, kWhite), middle(200, 30, kWhite);
  left.text({20, 20}, "portal.0", {12, kBlack});
  right.text({20 + width, 20}, "portal.0", {12, kBlack, Align::right});
  middle.text({20 + 0.5 * width, 20}, "portal.0", {12, kBlack, Align::middle});
  EXPECT_EQ(left.png(), right.png());
  EXPECT_EQ(left.png(), middle.png());
}

TEST(text, ends_in_an_ellipsis_where_it_does_not_fit) {
  const std::string words = "a very long sentence about light";
  const auto drawn = [](const std::string& text, double room) {
    Canvas c(400, 30, kWhite);
    c.text({20, 20}, text, {.size = 10, .ink = kBlack, .room = room});
    return c;
  };
  EXPECT_EQ(drawn(words, 0).png(), drawn(words, 350).png());
  const Raster cut = drawn(words, 100).pixels(), whole = drawn(words, 0).pixels();
  bool beyond = false;
  for (int y = 0; y < 30; ++y)
    for (int x = 121; x < 400; ++x) {
      EXPECT_EQ(cut.at(x, y), kWhite);
      beyond |= whole.at(x, y) != kWhite;
    }
  EXPECT_TRUE(beyond) << "twin: uncut it is longer";
}

TEST(palette, numbers_are_grouped) {
  EXPECT_EQ(number(1234567), "1 234 567");
  EXPECT_EQ(number(-100000), "-100 000");
  EXPECT_EQ(number(999), "999");
  EXPECT_EQ(number(0.01234), "0.0123");
  EXPECT_EQ(base_name("a/b/room.glb"), "room.glb");
  EXPECT_EQ(base_name("-"), "(standard input)");
}

float lightness(const Ink& c) {
  return 0.3f * c.x + 0.6f * c.y + 0.1f * c.z;
}

TEST(colour, more_heat_is_darker) {
  for (int k = 0; k < 100; ++k)
    EXPECT_GT(lightness(heat(k / 100.0)), lightness(heat((k + 1) / 100.0))) << k;
}

}  // namespace tdpt::draw::canvas_test
