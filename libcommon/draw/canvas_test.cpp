#include "libcommon/draw/canvas.h"

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "libcommon/base/file.h"
#include "libcommon/draw/palette.h"
#include "libcommon/testing/files/read_png.h"
#include "libcommon/testing/files/temp_folder.h"

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
  // Twin: a disc with another radius is distinguished.
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
  EXPECT_NEAR(c.pixels().at(5, 5).y, 0.5f, 1 / 255.0f);
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

// Every kind of shape; `tilt` moves a corner of the polygon.
Canvas all_shapes(double tilt) {
  Canvas c(160, 120, kPaper);
  Raster texels(40, 30);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x) texels.at(x, y) = heat(x / 40.0);
  c.raster({10, 10}, 2, texels);
  c.clip({0, 0, 140, 100});
  c.line({5, 5}, {150, 110}, 3, kPivot, 0.5);
  c.polygon({{60, 20}, {150 + tilt, 30}, {100, 90}}, kPortal, 0.4);
  c.unclip();
  c.disc({120, 90}, 12, kLamp);
  c.frame({100, 5, 50, 30}, 1, kInk);
  c.text({10, 112}, "portal 0", {10.5, kInk});
  return c;
}

// Mean difference over all channels, of 255, from another program's conversion of a file.
double off_our_png(const std::string& bytes, const std::string& convert, double tilt = 0) {
  const testing::TempFolder folder;
  folder.write("in", bytes);
  const std::string command = "cd '" + folder.path.string() + "' && " + convert;
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  const auto theirs = testing::read_png(read_file((folder.path / "out.png").string())),
             ours = testing::read_png(all_shapes(tilt).png());
  EXPECT_EQ(theirs.width, ours.width);
  EXPECT_EQ(theirs.height, ours.height);
  if (theirs.rgb.size() != ours.rgb.size()) return INFINITY;
  double sum = 0;
  for (size_t i = 0; i < ours.rgb.size(); ++i)
    for (size_t k = 0; k < 3; ++k) sum += std::abs(theirs.rgb[i][k] - ours.rgb[i][k]);
  return sum / static_cast<double>(3 * ours.rgb.size());
}

bool has(const char* program) {
  return std::system(("command -v " + std::string(program) + " >/dev/null").c_str()) == 0;
}

TEST(canvas, others_see_in_the_svg_what_the_png_shows) {
  if (!has("rsvg-convert")) GTEST_SKIP() << "rsvg-convert (librsvg2-bin) is missing";
  const std::string svg = all_shapes(0).svg();
  EXPECT_LT(off_our_png(svg, "rsvg-convert -o out.png in"), 1);
  EXPECT_GT(off_our_png(svg, "rsvg-convert -o out.png in", -20), 1.5) << "twin: another polygon";
}

TEST(canvas, others_see_in_the_pdf_what_the_png_shows) {
  if (!has("pdftoppm")) GTEST_SKIP() << "pdftoppm (poppler-utils) is missing";
  const std::string pdf = all_shapes(0).pdf(), convert = "pdftoppm -r 72 -png -singlefile in out";
  EXPECT_LT(off_our_png(pdf, convert), 2);
  EXPECT_GT(off_our_png(pdf, convert, -20), 2.5) << "twin: another polygon";
}

TEST(canvas, the_ending_of_the_name_gives_the_format) {
  const Canvas c = all_shapes(0);
  EXPECT_TRUE(c.file_named("a/b.svg").starts_with("<?xml"));
  EXPECT_TRUE(c.file_named("b.pdf").starts_with("%PDF-"));
  for (const char* name : {"b.png", "svg", "b.svg.png", "b"})
    EXPECT_EQ(c.file_named(name), c.png());
}

TEST(canvas, a_pdf_has_no_date) {
  EXPECT_EQ(all_shapes(0).pdf(), all_shapes(0).pdf());
  EXPECT_EQ(all_shapes(0).pdf().find("Date"), std::string::npos);
}

// The pixels that a letter inks: x0, y0 and, one further, x1, y1.
struct Extent {
  int x0 = 1000, y0 = 1000, x1 = 0, y1 = 0;
};
Raster letter_on_paper(const std::string& letter, Extent& extent) {
  Canvas c(100, 100, kWhite);
  c.text({30, 70}, letter, {30, kBlack});
  const Raster drawn = c.pixels();
  extent = {};
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 100; ++x)
      if (drawn.at(x, y) != kWhite) {
        extent.x0 = std::min(extent.x0, x), extent.x1 = std::max(extent.x1, x + 1);
        extent.y0 = std::min(extent.y0, y), extent.y1 = std::max(extent.y1, y + 1);
      }
  return drawn;
}

// Whether a letter is shown as the box for missing glyphs: ink all around.
bool is_boxed(const std::string& letter) {
  Extent e;
  const Raster drawn = letter_on_paper(letter, e);
  const auto round = [&](int inset) {
    for (int x = e.x0 + inset; x < e.x1 - inset; ++x)
      if (drawn.at(x, e.y0 + inset) == kWhite || drawn.at(x, e.y1 - 1 - inset) == kWhite)
        return false;
    for (int y = e.y0 + inset; y < e.y1 - inset; ++y)
      if (drawn.at(e.x0 + inset, y) == kWhite || drawn.at(e.x1 - 1 - inset, y) == kWhite)
        return false;
    return true;
  };
  return e.x1 - e.x0 > 12 && e.y1 - e.y0 > 20 && (round(0) || round(1));
}

TEST(text, every_letter_leaves_its_own_trace_within_its_width) {
  std::vector<std::string> letters;
  for (char letter = '!'; letter <= '~'; ++letter) letters.emplace_back(1, letter);
  letters.insert(letters.end(), {"é", "Ж", "Ω", "ß", "×", "²"});
  std::set<std::string> traces;
  for (const std::string& letter : letters) {
    EXPECT_FALSE(is_boxed(letter)) << letter;
    Canvas c(60, 60, kWhite);
    c.text({20, 40}, letter, {20, kBlack});
    EXPECT_GT(inked(c), 5) << letter;
    EXPECT_TRUE(traces.insert(c.png()).second) << letter << " looks like another";
    const int end = static_cast<int>(std::ceil(20 + text_width(letter, 20) + 3));
    const Raster drawn = c.pixels();
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 60; ++x)
        if (x < 17 || x > end || y > 50 || y < 12) {
          EXPECT_EQ(drawn.at(x, y), kWhite) << letter;
        }
  }
}

// Twin: a letter without a glyph is detected as a box.
TEST(text, a_letter_that_no_font_has_is_a_box) {
  EXPECT_TRUE(is_boxed("\xee\x80\x81"));  // U+E001, for private use
}

// DejaVu Sans has no Chinese letters.
TEST(text, a_letter_may_come_from_another_font) {
  if (std::system("fc-list ':charset=90e8' family | grep -q .") != 0)
    GTEST_SKIP() << "no font with U+90E8 (fonts-motoya-l-cedar) is installed";
  EXPECT_FALSE(is_boxed("部"));
  EXPECT_NEAR(text_width("a部b", 20), text_width("ab", 20) + text_width("部", 20), 2);
}

TEST(text, capitals_are_as_high_as_asked) {
  Extent e;
  letter_on_paper("H", e);
  EXPECT_NEAR(e.y1 - e.y0, 30, 1);
  EXPECT_NEAR(e.y1, 70, 1);
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

}  // namespace tdpt::draw::canvas_test
