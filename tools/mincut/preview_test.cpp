#include "tools/mincut/preview.h"

#include <set>

#include <gtest/gtest.h>

#include "libcommon/testing/files/read_png.h"

namespace tdpt::preview_test {

// Rooms x 0..2 and 2.1..4.1; the lamp hangs in the second, the camera stands in the first.
const Scene& two_rooms() {
  static const Scene scene = read_gltf(TDPT_TESTDATA "/scenes/two-rooms.glb");
  return scene;
}

// A patch for each face; those beyond x = 2.05 are in region `beyond`, the rest in `before`. One
// pivot pair, from the far room's end wall to the near one's.
CutFile cut_at_the_wall(uint64_t before, uint64_t beyond) {
  const Scene& scene = two_rooms();
  CutFile cut;
  cut.scene_hash = scene.hash;
  cut.grid = {{-100, -100, -100}, 1000};
  cut.bottleneck = true;
  cut.cuts = {{10, 0.01}};
  for (uint32_t face = 0; face < 2 * scene.triangles.size(); ++face) {
    const TriangleShape t = shape_of(scene, face / 2);
    Patch p;
    p.node = face + 3;
    p.samples = 1;
    p.centre = scene.frame.to_metres(t.p0 + (t.e1 + t.e2) / 3.0);
    p.normal = face % 2 == 0 ? t.normal : -t.normal;
    p.faces = {face};
    cut.sides.push_back(p.centre.x > 2.05 ? beyond : before);
    cut.patches.push_back(p);
  }
  Patch light = cut.patches[0], camera = cut.patches[0];
  light.centre = {4.1, 1, 0.05};
  camera.centre = {0, 1, 0.05};
  light.faces = camera.faces = {};
  cut.arcs = {{static_cast<uint32_t>(cut.patches.size()),
               static_cast<uint32_t>(cut.patches.size() + 1), 10}};
  cut.patches.push_back(light);
  cut.patches.push_back(camera);
  cut.sides.push_back(beyond);
  cut.sides.push_back(before);
  return cut;
}

draw::Drawing drawing_of(const CutFile& cut) {
  return cut_preview(two_rooms(), two_rooms().camera(""), cut, "room.max");
}
draw::Ink at(const draw::Panel& panel, const Vec3d& metres) {
  const draw::Pixel p = panel.view.project(metres);
  return panel.backdrop.at(static_cast<int>(p.x - panel.view.panel.x),
                           static_cast<int>(p.y - panel.view.panel.y));
}

// Shading keeps the ratio of a surface's colour components.
bool is_shade_of(const draw::Ink& pixel, const draw::Ink& colour) {
  const float shade = pixel.x / colour.x;
  return shade > 0.5f && shade < 1.01f && std::abs(pixel.y - shade * colour.y) < 0.02f &&
         std::abs(pixel.z - shade * colour.z) < 0.02f;
}

bool each_side_has_its_colour(const draw::Drawing& drawing) {
  const std::vector<draw::Panel>& panels = drawing.panels;  // camera, plan
  // Floors of both rooms in the plan; the near room's wall and, through the hole, the far one's.
  return is_shade_of(at(panels[1], {3.6, 0, 0.7}), draw::kLight) &&
         is_shade_of(at(panels[1], {0.5, 0, -0.7}), draw::kCamera) &&
         is_shade_of(at(panels[0], {2, 1.4, -0.6}), draw::kCamera) &&
         is_shade_of(at(panels[0], {2.1, 1.08, -0.06}), draw::kLight);
}

TEST(cut_preview, walls_have_the_colour_of_their_side_and_pivot_pairs_their_line) {
  const draw::Drawing drawing = drawing_of(cut_at_the_wall(1, 0));
  EXPECT_TRUE(each_side_has_its_colour(drawing));
  // Twin: with the sides exchanged the same pixels are wrong.
  EXPECT_FALSE(each_side_has_its_colour(drawing_of(cut_at_the_wall(0, 1))));
  const auto png = testing::read_png(draw::draw(drawing).png());
  EXPECT_EQ(png.width, draw::kSheetWidth);
  // On the way from the far room's end wall to the near one's.
  const draw::Pixel on_it = drawing.panels[1].view.project({1, 1, 0.05});
  const std::array<uint8_t, 3> pixel = png.at(static_cast<int>(on_it.x), static_cast<int>(on_it.y));
  for (size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(pixel[c], 255 * draw::kPivot[static_cast<int>(c)], 60) << c;
}

TEST(cuts_for, are_those_that_serve_the_camera) {
  FoundCuts found;
  found.file = cut_at_the_wall(0b001, 0b110);
  found.file.cuts = {{1, 0.1, 0}, {2, 0.2, 1}, {3, 0.3, 1}};
  found.file.arcs.push_back({found.file.arcs[0].to, found.file.arcs[0].from, 1});
  found.cameras.resize(3);
  const CutFile second = cuts_for(found, 1);
  ASSERT_EQ(second.cuts.size(), 2u);
  EXPECT_EQ(second.cuts[0].flow, 2);
  EXPECT_EQ(second.sides.front(), found.file.sides.front() == 1 ? 0u : 3u);
  EXPECT_EQ(second.arcs.size(), 1u) << "the other arc crosses the first camera's cut alone";
  found.cameras[2].reason = "there is none";
  const CutFile third = cuts_for(found, 2);
  EXPECT_FALSE(third.bottleneck);
  EXPECT_EQ(third.reason, "there is none");
  EXPECT_EQ(third.cuts.size(), 1u);
}

TEST(arcs_to_draw, takes_all_when_few_and_in_proportion_when_many) {
  CutFile cut;
  for (int i = 0; i < 10; ++i) cut.arcs.push_back({0, 1, 1.0});
  EXPECT_EQ(arcs_to_draw(cut, 10).size(), 10u);
  // Two openings: nine tenths of the light in the first 500 arcs, the rest in another 500.
  cut.arcs.clear();
  for (int i = 0; i < 1000; ++i) cut.arcs.push_back({0, 1, i < 500 ? 9.0 : 1.0});
  const std::vector<size_t> drawn = arcs_to_draw(cut, 100);
  EXPECT_EQ(drawn.size(), 100u);
  EXPECT_EQ(std::set<size_t>(drawn.begin(), drawn.end()).size(), drawn.size());
  EXPECT_NEAR(static_cast<double>(
                  std::count_if(drawn.begin(), drawn.end(), [](size_t i) { return i < 500; })),
              90, 1);
  for (CutArc& a : cut.arcs) a.capacity = 0;
  EXPECT_TRUE(arcs_to_draw(cut, 100).empty());
}

}  // namespace tdpt::preview_test
