#include "libcommon/draw/drawing.h"

#include <gtest/gtest.h>

namespace tdpt::draw::drawing_test {

constexpr Ink kRed = ink(0xff0000);

// Looks along -z at the rectangle x 0..4, y 0..3, 100 pixels per metre.
Panel flat_panel() {
  return {.view = Projection::flat({2, 1.5, 0}, {1, 0, 0}, {0, 1, 0}, 2, 1.5,
                                   {kMargin, kHeading, 400, 300}),
          .caption = "a panel"};
}
Panel camera_panel() {
  Camera camera;
  camera.position = {0, 0, 0};
  camera.forward = {0, 0, -1}, camera.right = {1, 0, 0}, camera.up = {0, 1, 0};
  camera.yfov = 0.8;
  return {.view = Projection::of_camera(camera, Frame{}, {kMargin, kHeading, 400, 300})};
}

class Drawn {
 public:
  Drawn(Panel panel, const std::vector<Shape>& shapes)
      : view_(panel.view),
        pixels_(
            draw({.title = "t", .sentence = "s", .panels = {std::move(panel)}, .shapes = shapes})
                .pixels()) {}
  Ink at(const Vec3d& place) const {
    const Pixel p = view_.project(place);
    return pixels_.at(static_cast<int>(p.x), static_cast<int>(p.y));
  }
  bool is(const Ink& c, const Vec3d& place) const { return length(at(place) - c) < 0.02f; }
  const Raster& pixels() const { return pixels_; }

 private:
  Projection view_;
  Raster pixels_;
};

TEST(projection, ray_and_project_are_inverse) {
  for (const Projection& p : {camera_panel().view, flat_panel().view})
    for (const Pixel at : {Pixel{37, 93}, Pixel{230, 200}, Pixel{400, 340.5}}) {
      Vec3d from, w;
      p.ray(at, from, w);
      const Pixel back = p.project(from + w * 0.7);
      EXPECT_NEAR(back.x, at.x, 1e-9);
      EXPECT_NEAR(back.y, at.y, 1e-9);
      EXPECT_NEAR(p.depth(from + w * 0.7), 0.7 * dot(w, p.forward), 1e-12);
    }
}

TEST(drawing, shapes_are_where_they_are) {
  Shape point{.kind = Shape::Kind::points, .size = 4}, line{.kind = Shape::Kind::lines, .size = 4},
      triangle{};
  point.point({1, 1, 0}, kRed);
  line.line({2, 0.5, 0}, {2, 2.5, 5}, kRed, ink(0x0000ff));
  triangle.triangle({3, 0.5, 0}, {3.5, 0.5, 0}, {3, 2.5, 0}, {kRed, 0.5f});
  const Drawn d(flat_panel(), {point, line, triangle});
  EXPECT_TRUE(d.is(kRed, {1, 1, 7}));
  EXPECT_TRUE(d.is(kPaper, {1.2, 1, 0}));
  EXPECT_TRUE(d.is(kRed, {2, 0.8, 0})) << "each half in the colour of its end";
  EXPECT_TRUE(d.is(ink(0x0000ff), {2, 2.2, 0}));
  EXPECT_TRUE(d.is(mix(kPaper, kRed, 0.5), {3.1, 1, 0}));
}

TEST(drawing, a_panel_shows_its_heights_only) {
  Shape line{.kind = Shape::Kind::lines, .size = 4};
  line.line({1, 0.2, 0}, {1, 2.8, 0}, kRed);
  Panel panel = flat_panel();
  panel.bottom = 1, panel.top = 2;
  const Drawn d(panel, {line});
  EXPECT_TRUE(d.is(kRed, {1, 1.5, 0}));
  for (const double y : {0.5, 2.5}) EXPECT_TRUE(d.is(kPaper, {1, y, 0}));
}

TEST(drawing, is_paler_behind_a_surface_and_absent_behind_the_camera) {
  Shape line{.kind = Shape::Kind::lines, .size = 4}, mark = line;
  line.line({-0.3, 0, -1}, {0.3, 0, -1}, kRed);
  mark.through = true;
  mark.line({-0.3, 0.1, -1}, {0.3, 0.1, -1}, kRed);
  Panel panel = camera_panel();
  panel.backdrop = Raster(400, 300, kPaper);
  panel.depth.assign(400 * 300, 0.5f);
  for (size_t k = 0; k < 300; ++k)  // a surface before its right half
    std::fill_n(panel.depth.begin() + static_cast<std::ptrdiff_t>(400 * k), 200, 2.0f);
  const Drawn d(panel, {line, mark});
  EXPECT_TRUE(d.is(kRed, {-0.2, 0, -1}));
  EXPECT_TRUE(d.is(mix(kPaper, kRed, 0.3), {0.2, 0, -1}));
  EXPECT_TRUE(d.is(kRed, {0.2, 0.1, -1}));
  Shape behind{.kind = Shape::Kind::lines, .size = 4};
  behind.line({-0.3, 0, 1}, {0.3, 0, 1}, kRed);
  const Raster with = Drawn(camera_panel(), {behind}).pixels(),
               without = Drawn(camera_panel(), {}).pixels();
  for (int y = 0; y < with.height(); ++y)
    for (int x = 0; x < with.width(); ++x) ASSERT_EQ(with.at(x, y), without.at(x, y));
}

TEST(drawing, labels_keys_and_notes_are_written_and_the_bytes_stay) {
  Drawing drawing{.title = "t", .sentence = "s", .panels = {flat_panel()}};
  const std::string bare = draw(drawing).png();
  drawing.labels = {{{1, 1, 0}, "portal.0"}};
  EXPECT_NE(draw(drawing).png(), bare);
  EXPECT_EQ(draw(drawing).png(), draw(drawing).png());
  drawing.labels[0].place.x = 9;
  EXPECT_EQ(draw(drawing).png(), bare) << "beside the panel";
  const int height = draw(drawing).height();
  drawing.key.assign(12, {{kRed}, "an entry of the key of the picture"});
  EXPECT_GT(draw(drawing).height(), height + 50) << "several rows";
  drawing.key.clear();
  drawing.notes = {"a note"};
  EXPECT_GT(draw(drawing).height(), height);
}

TEST(arranged, fills_the_sheet_without_overlap) {
  for (const std::vector<double>& aspects :
       {std::vector<double>{1.8}, {1.8, 0.7}, {1.8, 1, 1, 1}, {3, 3, 3}}) {
    const auto panels = arranged(aspects);
    ASSERT_EQ(panels.size(), aspects.size());
    for (size_t i = 0; i < panels.size(); ++i) {
      EXPECT_LE(panels[i].right(), kSheetWidth - kMargin);
      EXPECT_NEAR(panels[i].width / panels[i].height, aspects[i], 0.01);
      EXPECT_GT(panels[i].height, 240);
      for (size_t j = 0; j < i; ++j)
        EXPECT_TRUE(panels[j].right() < panels[i].x ||
                    panels[j].bottom() + kCaptionRoom <= panels[i].y);
    }
  }
  // Side by side they are 385 high, one above the other 470, with half of the sheet empty.
  EXPECT_EQ(arranged({1.78, 2.12})[0].y, arranged({1.78, 2.12})[1].y);
}

}  // namespace tdpt::draw::drawing_test
