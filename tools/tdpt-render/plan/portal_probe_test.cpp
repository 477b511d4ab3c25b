#include "tools/tdpt-render/plan/portal_probe.h"

#include <gtest/gtest.h>

#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::portal_probe_test {

double conductance_in(const char* scene_name, const Portal& portal) {
  const Scene scene = read_gltf(std::string(TDPT_TESTDATA "/scenes/") + scene_name);
  return probed_conductance(World(scene, false), portal);
}

Portal in_the_window() {
  return rectangle({2.05, 0.2, -0.8}, {0, 0, 1.6}, {0, 1.6, 0});
}

bool near(double measured, double expected) {
  return measured > 0.75 * expected && measured < 1.33 * expected;
}

// The room's surface is 24 m2, less the opening.
TEST(portal_probe, measures_the_opening_against_the_room) {
  const double window = 2.56 / 24;
  EXPECT_TRUE(near(conductance_in("window.glb", in_the_window()), window));
  // Twin: a portal over a quarter of the window has another conductance.
  EXPECT_FALSE(
      near(conductance_in("window.glb", rectangle({2.05, 0.2, -0.8}, {0, 0, 0.8}, {0, 0.8, 0})),
           window));
  EXPECT_LT(conductance_in("two-rooms.glb", portal_in_the_hole()), 0.01);
}

}  // namespace tdpt::portal_probe_test
