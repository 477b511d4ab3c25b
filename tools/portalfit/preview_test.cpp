#include "tools/portalfit/preview.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "libcommon/scene/scene.h"
#include "libcommon/testing/files/read_png.h"
#include "libcommon/testing/files/temp_folder.h"
#include "tools/portalfit/plane.h"
#include "tools/portalfit/portalfit.h"
#include "tools/portalfit/testing/bundle.h"
#include "tools/portalfit/testing/tube_lines.h"

namespace tdpt::preview_test {

// In the plane x = 2, light towards -x: y 0.5..1.5, z -0.2..0.6.
Portal door() {
  Portal p;
  p.vertices = {{2, 0.5, -0.2}, {2, 0.5, 0.6}, {2, 1.5, 0.6}, {2, 1.5, -0.2}};
  p.triangles = {{0, 1, 2}, {0, 2, 3}};
  p.figures = {{"area", 0.8}, {"flux_share", 0.9}};
  const Vec3d n = cross(p.vertices[1] - p.vertices[0], p.vertices[2] - p.vertices[0]);
  if (n.x > 0)
    for (auto& t : p.triangles) std::swap(t[1], t[2]);
  return p;
}

LightGrid lines_through_the_door() {
  LightGrid grid;
  grid.voxel = 0.25;
  grid.origin = {0, 0, -1};
  grid.dim = {16, 8, 8};
  grid.count.assign(16 * 8 * 8, 0);
  Rng rng(1, 2, 3);
  for (int i = 0; i < 500; ++i) {
    const double a = rng.uniform();
    const double b = rng.uniform();
    const double c = rng.uniform();
    const double d = rng.uniform();
    const Vec3d at{2, 0.5 + a, -0.2 + 0.8 * b}, w = cosine_hemisphere(c, d);
    const Vec3d way{-w.z, w.x, w.y};
    grid.lines.push_back({at - way, at + way, 0});
    walk_grid(grid, at - way, at + way, [&](size_t v, double) { ++grid.count[v]; });
  }
  return grid;
}

TEST(frame_of, stands_upright_in_the_plane_and_looks_along_the_light) {
  const PortalFrame f = frame_of(door());
  EXPECT_NEAR(length(f.o - Vec3d{2, 1, 0.2}), 0, 1e-12);
  EXPECT_NEAR(f.n.x, -1, 1e-12);
  EXPECT_NEAR(f.up.y, 1, 1e-12);
  // Seen from the camera's side, along +x, +z is to the right.
  EXPECT_NEAR(f.right.z, 1, 1e-12);
  Portal skylight = door();
  for (Vec3d& v : skylight.vertices) v = {v.z, 3, v.y};
  EXPECT_NEAR(frame_of(skylight).up.z, -1, 1e-12);
}

TEST(outline_of, leaves_the_diagonal_out) {
  const Portal p = door();
  const auto edges = outline_of(p);
  ASSERT_EQ(edges.size(), 4u);
  for (const auto& e : edges) EXPECT_LE(length(p.vertices[e[0]] - p.vertices[e[1]]), 1.0 + 1e-12);
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
  grid.voxel = 0.1;
  grid.origin = {-3, -3, -3};
  grid.dim = {60, 60, 60};
  grid.count.assign(60 * 60 * 60, 0);
  for (const LightLine& l : grid.lines)
    walk_grid(grid, l.light, l.camera, [&](size_t v, double) { ++grid.count[v]; });
  return grid;
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

TEST(lines_to_show, tells_own_lines_from_those_of_others_and_of_none) {
  const LightGrid grid = lines_through_the_door();
  const PortalFrame frame = frame_of(door());
  const auto ways = [&](size_t own) {
    std::vector<int> n(3, 0);
    for (const SeenLine& l : lines_to_show(grid, {{0, 1, 2}, {1, 7}}, own, frame))
      ++n[static_cast<size_t>(l.way)];
    return n;
  };
  EXPECT_EQ(ways(0), (std::vector<int>{3, 1, 496}));
  EXPECT_EQ(ways(1), (std::vector<int>{2, 2, 496}));
}

TEST(portal_preview, has_a_row_for_each_portal_but_six_at_most) {
  const LightGrid grid = lines_through_the_door();
  const auto height = [&](size_t n) {
    const std::vector<std::vector<uint32_t>> lines(n, testing::all_of(grid).which);
    return draw::draw(portal_preview(grid, std::vector<Portal>(n, door()), lines, "g", ""))
        .height();
  };
  EXPECT_GT(height(3), height(1));
  EXPECT_EQ(height(7), height(6));
}

TEST(portal_debug_glb, has_the_corners_of_the_portal) {
  const testing::TempFolder folder;
  PortalFile file;
  file.portals = {door()};
  const auto corners_missing = [&](const Portal& portal) {
    const Scene scene =
        read_gltf(folder.write("portal.glb", portal_debug_glb(lines_through_the_door(), file)));
    EXPECT_EQ(scene.triangles.size(), 2u);
    int missing = 0;
    for (const Vec3d& v : portal.vertices) {
      bool there = false;
      for (const Triangle& t : scene.triangles)
        for (const uint32_t k : t.vertex)
          there = there || length(scene.frame.to_metres(Vec3d(scene.positions[k])) - v) < 1e-6;
      missing += !there;
    }
    return missing;
  };
  EXPECT_EQ(corners_missing(door()), 0);
  Portal beside = door();
  for (Vec3d& v : beside.vertices) v.z += 0.01;
  EXPECT_EQ(corners_missing(beside), 4);
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

// Pixels above the legend that have exactly this colour; smooth edges may have it by chance.
size_t pixels_of(const draw::Ink& c, const FitResult& found) {
  const Scene& scene = two_rooms();
  const draw::Raster drawn =
      draw::draw(plan_preview(scene, scene.camera(""), found, "none fits")).pixels();
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

TEST(plan_preview, portals_and_refused_are_labelled) {
  FitResult found = one_portal();
  found.refused.push_back({"a candidate of 2 m2 lies in the open", {found.portals[0].vertices}});
  const draw::Drawing drawing = plan_preview(two_rooms(), two_rooms().camera(""), found, "");
  ASSERT_FALSE(drawing.labels.empty());
  EXPECT_EQ(drawing.labels.front().words, "A");
  EXPECT_EQ(drawing.labels.back().words, "portal.0");
  EXPECT_EQ(drawing.notes.at(0), "A: a candidate of 2 m2 lies in the open");
}

TEST(plan_preview, what_was_refused_is_grey_and_nothing_is_drawn_where_nothing_was_found) {
  FitResult found;
  EXPECT_EQ(pixels_of(draw::kPortal, found), 0u);
  EXPECT_LT(pixels_of(draw::kRefused, found), 30u);
  found.refused.push_back(
      {"a candidate of 2 m2 lies in the open", {one_portal().portals[0].vertices}});
  EXPECT_GT(pixels_of(draw::kRefused, found), 50u);
}

}  // namespace tdpt::preview_test
