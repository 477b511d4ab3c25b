#include "tools/portalfit/plan_preview.h"

#include <gtest/gtest.h>

#include "libcommon/draw/sheet.h"

namespace tdpt::plan_preview_test {

// Rooms x 0..2 and 2.1..4.1; the hole between them y 0.875..1.125, z -0.125..0.125.
const Scene& two_rooms() {
  static const Scene scene = read_gltf(TDPT_TESTDATA "/scenes/two-rooms.glb");
  return scene;
}

FitResult one_portal() {
  Portal p;
  p.vertices = {
      {2.05, 0.875, -0.125}, {2.05, 1.125, -0.125}, {2.05, 1.125, 0.125}, {2.05, 0.875, 0.125}};
  p.triangles = {{0, 1, 2}, {0, 2, 3}};
  p.figures = {{"area", 0.0625}, {"flux_share", 0.9}};
  FitResult found;
  found.portals = {p};
  return found;
}

// Pixels above the legend that have exactly this colour; smooth edges may have it by chance.
size_t pixels_of(const draw::Ink& c, const FitResult& found) {
  const Scene& scene = two_rooms();
  const draw::Raster drawn = plan_preview(scene, scene.camera(""), found, "none fits").pixels();
  EXPECT_EQ(drawn.width(), draw::kSheetWidth);
  size_t n = 0;
  for (int y = 0; y < drawn.height() - 160; ++y)
    for (int x = 0; x < drawn.width(); ++x) n += drawn.at(x, y) == c;
  return n;
}

TEST(plan_preview, a_portal_is_green) {
  EXPECT_GT(pixels_of(draw::kPortal, one_portal()), 100u);
  EXPECT_LT(pixels_of(draw::kRefused, one_portal()), 30u);
}

TEST(plan_preview, what_was_refused_is_grey_and_nothing_is_drawn_where_nothing_was_found) {
  FitResult found;
  EXPECT_EQ(pixels_of(draw::kPortal, found), 0u);
  EXPECT_LT(pixels_of(draw::kRefused, found), 30u);
  found.refused.push_back(
      {"a candidate of 2 m2 lies in the open", "", {one_portal().portals[0].vertices}});
  EXPECT_GT(pixels_of(draw::kRefused, found), 50u);
}

}  // namespace tdpt::plan_preview_test
