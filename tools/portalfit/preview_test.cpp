#include "tools/portalfit/preview.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "libcommon/scene/scene.h"
#include "libcommon/testing/files/read_png.h"
#include "libcommon/testing/files/temp_folder.h"
#include "tools/portalfit/plane.h"
#include "tools/portalfit/portalfit.h"
#include "tools/portalfit/testing/openings.h"

namespace tdpt::preview_test {

// In the plane x = 2, light towards -x: y 0.5..1.5, z -0.2..0.6.
Portal door() {
  Portal p;
  p.vertices = {{2, 0.5, -0.2}, {2, 0.5, 0.6}, {2, 1.5, 0.6}, {2, 1.5, -0.2}};
  p.triangles = {{0, 1, 2}, {0, 2, 3}};
  p.figures = {{"area", 0.8}, {"flux_share", 0.9}};
  return p;
}

LightGrid lines_through_the_door() {
  return testing::grid_of(
      testing::lines_through({{{2, 1, 0.2}, {0, 0.5, 0}, {0, 0, 0.4}, {-1, 0, 0}}}, 500, {1}));
}

// Counts pixels of the portal's colour in the left panel (front) and in the right one (from above).
struct Green {
  int front = 0, above = 0;
};
Green green_of(const std::string& bytes) {
  const testing::PngPixels png = testing::read_png(bytes);
  Green green;
  const auto near = [](const std::array<uint8_t, 3>& c) {
    return std::abs(c[0] - 0x0f) < 3 && std::abs(c[1] - 0x8b) < 3 && std::abs(c[2] - 0x6d) < 3;
  };
  for (int y = 92; y < 600; ++y)
    for (int x = 0; x < png.width; ++x)
      if (near(png.at(x, y))) ++(x < png.width / 2 ? green.front : green.above);
  return green;
}

TEST(portal_preview, shows_the_outline_in_front_and_the_edge_from_above) {
  const LightGrid grid = lines_through_the_door();
  const Green with = green_of(
      draw::draw(portal_preview(grid, {door()}, {testing::all_of(grid).which}, "room.vdb", ""))
          .png());
  // An outline of four sides of some 300 pixels, 2 wide; an edge and an arrow.
  EXPECT_GT(with.front, 1000);
  EXPECT_GT(with.above, 500);
  // Twin: without a portal there is none of it.
  const Green without =
      green_of(draw::draw(portal_preview(grid, {}, {}, "room.vdb", "the opening is wide")).png());
  EXPECT_EQ(without.front + without.above, 0);
}

// A hole as deep as wide: many of its lines end within it, before the portal's plane or behind.
LightGrid lines_through_a_deep_hole() {
  LightGrid grid;
  grid.lines = testing::lines_of_tube(0.4, 0.4, 0.2, 4000);
  for (size_t i = 0; i < 4000; i += 4) {
    LightLine line = grid.lines[i];
    if (line.light.x > -0.2) continue;
    const Vec3d d = line.camera - line.light;
    line.camera = line.light + d * ((-0.05 - line.light.x) / d.x);
    grid.lines.push_back(line);
  }
  return testing::grid_of(grid.lines, 60);
}

TEST(portal_preview, shows_the_lines_that_the_fit_counts) {
  const LightGrid grid = lines_through_a_deep_hole();
  const FitResult fit = fit_portals(grid, {});
  ASSERT_EQ(fit.portals.size(), 1u);
  const auto counted = static_cast<size_t>(std::lround(fit.portals[0].figures.at("flux_share") *
                                                       static_cast<double>(grid.lines.size())));
  const auto seen = lines_to_show(grid, fit.lines, 0, frame_of(fit.portals[0]));
  const auto shown =
      std::count_if(seen.begin(), seen.end(), [](const SeenLine& l) { return l.way == Way::here; });
  EXPECT_EQ(static_cast<size_t>(shown), counted);
  // Twin: fewer lines cross the polygon.
  const PortalShape shape = shape_of(fit.portals[0]);
  const auto crossing_it = static_cast<size_t>(
      std::count_if(grid.lines.begin(), grid.lines.end(), [&](const LightLine& l) {
        const auto at = crossing(shape.plane, l);
        return at && contains(shape, *at);
      }));
  EXPECT_LT(crossing_it + 100, counted);
}

TEST(portal_debug_glb, has_the_corners_of_the_portal) {
  const testing::TempFolder folder;
  PortalFile file;
  file.portals = {door()};
  const Scene scene =
      read_gltf(folder.write("portal.glb", portal_debug_glb(lines_through_the_door(), file)));
  ASSERT_EQ(scene.triangles.size(), 2u);
  for (const Triangle& t : scene.triangles)
    for (const uint32_t k : t.vertex) {
      double nearest = INFINITY;
      for (const Vec3d& v : door().vertices)
        nearest = std::min(nearest, length(scene.frame.to_metres(Vec3d(scene.positions[k])) - v));
      EXPECT_LT(nearest, 1e-6);
    }
}

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

// Pixels above the legend that have exactly these colours; smooth edges may have one by chance.
struct Drawn {
  size_t portal = 0, refused = 0;
};
Drawn drawn(const FitResult& found) {
  const Scene& scene = two_rooms();
  const draw::Raster plan =
      draw::draw(plan_preview(scene, scene.camera(""), found, "none fits")).pixels();
  EXPECT_EQ(plan.width(), draw::kSheetWidth);
  Drawn n;
  for (int y = 0; y < plan.height() - 160; ++y)
    for (int x = 0; x < plan.width(); ++x) {
      n.portal += plan.at(x, y) == draw::kPortal;
      n.refused += plan.at(x, y) == draw::kRefused;
    }
  return n;
}

TEST(plan_preview, portals_are_green_and_what_was_refused_is_grey) {
  const Drawn portal = drawn(one_portal());
  EXPECT_GT(portal.portal, 100u);
  EXPECT_LT(portal.refused, 30u);
  FitResult found;
  found.refused.push_back({"it lies in the open", {one_portal().portals[0].vertices}});
  const Drawn refused = drawn(found);
  EXPECT_EQ(refused.portal, 0u);
  EXPECT_GT(refused.refused, 50u);
}

}  // namespace tdpt::preview_test
