#include "libcommon/testing/houses/house_score.h"

#include <cmath>

#include <gtest/gtest.h>

#include "libcommon/testing/files/temp_folder.h"

namespace tdpt::testing::house_score_test {

// A wall across x = 0, 4 m wide and high, with a hole of 1 m in its middle.
Scene wall() {
  Scene scene;
  scene.materials.resize(1);
  const auto quad = [&](float y0, float y1, float z0, float z1) {
    const auto first = static_cast<uint32_t>(scene.positions.size());
    scene.positions.insert(scene.positions.end(),
                           {{0, y0, z0}, {0, y1, z0}, {0, y1, z1}, {0, y0, z1}});
    scene.triangles.push_back({{first, first + 1, first + 2}, 0});
    scene.triangles.push_back({{first, first + 2, first + 3}, 0});
  };
  quad(-2, -0.5f, -2, 2), quad(0.5f, 2, -2, 2), quad(-0.5f, 0.5f, -2, -0.5f),
      quad(-0.5f, 0.5f, 0.5f, 2);
  return scene;
}

// A square of side 1 about (x, y, 0), its normal turned by `turn` [rad] from +x about y.
Portal square(double x, double y, double turn = 0) {
  Portal p;
  const Vec3d across{-std::sin(turn), 0, std::cos(turn)};
  for (const auto& [a, b] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}})
    p.vertices.push_back(Vec3d{x, y, 0} + Vec3d{0, a, 0} + across * b);
  p.triangles = {{0, 1, 2}, {0, 2, 3}};
  return p;
}

// The list as a file has it, with a second hole that no light passes.
std::vector<HouseOpening> listed() {
  const TempFolder folder;
  return read_openings(
      folder.write("openings.json", R"([{"name": "window-1.1", "kind": "window", "state": "glass",
    "rooms": ["a", "b"], "polygon": [[0, -0.5, -0.5], [0, 0.5, -0.5], [0, 0.5, 0.5], [0, -0.5, 0.5]],
    "normal": [1, 0, 0], "wall": {"thickness": 0.2, "offset": 0}},
    {"name": "door-2", "kind": "door", "state": "closed", "rooms": ["a", "b"],
    "polygon": [[0, 3, 3], [0, 4, 3], [0, 4, 4]], "normal": [1, 0, 0]}])"));
}

// Nine of ten paths pass the hole towards +x, spread over it; one ends on its jamb.
LightPaths paths() {
  LightPaths all;
  for (int i = 0; i < 9; ++i) {
    const double y = -0.4 + 0.1 * i;
    all.paths.push_back({{-1, y, 0}, {1, y, 0.1}, {1.5, 0, 0}});
  }
  all.paths.push_back({{-1, 0.4, 0}, {0.05, 0.5, 0}, {1, 0, 0}});
  return all;
}

HouseScore scored(const std::vector<Portal>& portals) {
  const Scene scene = wall();
  const Tracer tracer(scene);
  return score_house(scene, tracer, listed(), paths(), portals);
}

TEST(HouseScore, APortalInTheOpeningIsRight) {
  const HouseScore s = scored({square(0, 0)});
  ASSERT_EQ(s.openings.size(), 1u);  // the closed door does not count
  EXPECT_NEAR(s.openings[0].light, 1, 1e-9);
  EXPECT_TRUE(s.openings[0].forward);
  EXPECT_EQ(s.openings[0].coverage, 1);
  EXPECT_TRUE(s.openings[0].right());
  EXPECT_NEAR(s.portals[0].light, 1, 1e-9);
  EXPECT_EQ(s.portals[0].openings, (std::vector<size_t>{0}));
}

TEST(HouseScore, OthersAreWrongEachInItsWay) {
  EXPECT_FALSE(scored({}).openings[0].right());
  const HouseScore beside = scored({square(0, 0.5)});  // covers half, half of it is wall
  EXPECT_LT(beside.openings[0].coverage, 0.8);
  EXPECT_LT(beside.openings[0].tightness, 0.7);
  const HouseScore tilted = scored({square(0, 0, 0.2)});
  EXPECT_NEAR(tilted.openings[0].angle, 0.2 * 57.3, 0.1);
  EXPECT_FALSE(tilted.openings[0].right());
  const HouseScore away = scored({square(3, 0)});
  EXPECT_TRUE(away.portals[0].openings.empty());
  EXPECT_EQ(away.openings[0].coverage, 0);
  Portal backwards = square(0, 0);
  for (auto& t : backwards.triangles) std::swap(t[1], t[2]);
  EXPECT_EQ(scored({backwards}).portals[0].light, 0);
}

// A leaf beside the hole's middle scatters half of the light that has passed the gap at x = -0.2
// towards a portal in the doorway.
TEST(HouseScore, LightThatALeafScattersIsCoveredByThePortalBehind) {
  const TempFolder folder;
  const std::string gap =
      R"([{"name": "door-1", "kind": "door", "state": "ajar", "rooms": ["a", "b"],
    "polygon": [[-0.2, -0.5, -0.5], [-0.2, 0.5, -0.5], [-0.2, 0.5, 0.5], [-0.2, -0.5, 0.5]],
    "normal": [1, 0, 0])";
  const std::string leaf = R"(, "leaf": {"doorway":
    [[0, -0.5, -0.5], [0, 0.5, -0.5], [0, 0.5, 0.5], [0, -0.5, 0.5]]}}])";
  const Scene scene = wall();
  const Tracer tracer(scene);
  LightPaths scattered;
  for (int i = 0; i < 10; ++i) {
    const Vec3d begin{-1, 0.01 * i, 0.1};
    if (i % 2 == 0)
      scattered.paths.push_back({begin, {-0.1, 0.1, 0.1}, {1, 0, 0}});
    else
      scattered.paths.push_back({begin, {1, 0, 0}});
  }
  const auto coverage = [&](const std::string& list) {
    const auto openings = read_openings(folder.write("list.json", list));
    return score_house(scene, tracer, openings, scattered, {square(0, 0)}).openings[0].coverage;
  };
  EXPECT_EQ(coverage(gap + leaf), 1);
  EXPECT_NEAR(coverage(gap + "}]"), 0.5, 1e-9);
}

TEST(LightPaths, AreReadAsTheyAreWritten) {
  const TempFolder folder;
  LightPaths all = paths();
  all.effective = 7;
  const LightPaths back = read_light_paths(folder.write("paths", text_of(all)));
  ASSERT_EQ(back.paths.size(), all.paths.size());
  EXPECT_EQ(back.effective, 7);
  EXPECT_NEAR(back.paths[3][1].y, all.paths[3][1].y, 1e-4);
}

}  // namespace tdpt::testing::house_score_test
