#include "tools/tdpt-render/portal_probe.h"

#include <gtest/gtest.h>

#include "libcommon/formats/portal_worth.h"
#include "tools/tdpt-render/test_rooms.h"

namespace tdpt {
namespace {

double conductance_in(const char* scene_name, const Portal& portal) {
  const Scene scene = read_gltf(std::string(TDPT_TESTDATA "/scenes/") + scene_name);
  return probed_conductance(World(scene, scene.camera(""), 8, 6, {portal}), portal);
}

Portal in_the_window() {
  return rectangle({2.05, 0.2, -0.8}, {0, 0, 1.6}, {0, 1.6, 0});
}

bool near(double measured, double expected) {
  return measured > 0.75 * expected && measured < 1.33 * expected;
}

// A room's surface is 24 m2, less the opening.
TEST(portal_probe, measures_the_opening_against_the_room) {
  const double window = 2.56 / 24;
  EXPECT_TRUE(near(conductance_in("window.glb", in_the_window()), window));
  // Twin: a portal over a quarter of the window is seen to be another.
  EXPECT_FALSE(
      near(conductance_in("window.glb", rectangle({2.05, 0.2, -0.8}, {0, 0, 0.8}, {0, 0.8, 0})),
           window));
  EXPECT_LT(conductance_in("two-rooms.glb", portal_in_the_hole()), 0.01);
}

TEST(portal_probe, a_wide_window_drawn_by_hand_is_useless_and_a_hole_is_useful) {
  const auto verdict = [](const char* name, const Portal& portal) {
    const Scene scene = read_gltf(std::string(TDPT_TESTDATA "/scenes/") + name);
    std::vector<Portal> portals{portal};
    probe(World(scene, scene.camera(""), 8, 6, portals), portals);
    return verdict_of(portals[0].figures);
  };
  const Verdict window = verdict("window.glb", in_the_window());
  EXPECT_EQ(window.worth, Worth::useless) << window.words;
  EXPECT_EQ(window.words.find("useless: a wide way, "), 0u);
  EXPECT_EQ(verdict("two-rooms.glb", portal_in_the_hole()).words, "useful");
  // Across the middle of a room: as wide as can be.
  EXPECT_EQ(verdict("two-rooms.glb", rectangle({1, 0.1, -0.9}, {0, 0, 1.8}, {0, 1.8, 0})).worth,
            Worth::useless);
}

TEST(portal_probe, leaves_figures_of_portalfit_alone) {
  const Scene scene = read_gltf(two_rooms_path());
  std::vector<Portal> portals(1, portal_in_the_hole());
  portals[0].figures["expected_gain"] = 17;
  probe(World(scene, scene.camera(""), 8, 6, portals), portals);
  EXPECT_EQ(portals[0].figures.size(), 1u);
}

}  // namespace
}  // namespace tdpt
