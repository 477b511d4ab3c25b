// Reports about portals that are known to be good or bad.
#include "tools/tdpt-render/run/portal_report.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::portal_report_test {

// Upright, in a corner of the camera's room behind the camera: light passes, but does not matter.
Portal in_the_corner() {
  return rectangle({0.05, 0.02, -0.97}, {0, 0, 0.1}, {0, 0.1, 0});
}

RenderResult render_with(const std::vector<Portal>& portals) {
  const Scene scene = read_gltf(two_rooms_path());
  const World world(scene, scene.camera(""), 32, 24, portals);
  RenderSettings settings;
  settings.spp = 32;
  return render(world, tdpt_org, settings);
}

TEST(portals_report, a_portal_off_the_lights_way_is_called_useless_and_one_in_the_hole_is_not) {
  std::vector<Portal> portals{portal_in_the_hole(), in_the_corner()};
  portals[1].name = "corner";
  const RenderResult result = render_with(portals);
  EXPECT_EQ(useless_portals(portals, result),
            "next to no light came through corner: it was of no use");
  EXPECT_EQ(useless_portal(portals, 0, result), "");
  EXPECT_NE(useless_portal(portals, 1, result)
                .find("samples connected a lamp with the camera, they brought"),
            std::string::npos);
  // Each sample of the picture drew one segment; their light is the technique's share.
  ASSERT_EQ(result.tally.portals.size(), 2u);
  EXPECT_EQ(result.tally.portals[0].drawn + result.tally.portals[1].drawn, 32u * 24 * 32);
  EXPECT_NEAR(result.tally.portals[0].energy + result.tally.portals[1].energy,
              result.tally.energy[static_cast<size_t>(Technique::portal)], 1e-6);
  const auto json = portals_json(portals, result);
  EXPECT_FALSE(json[0].at("useless").get<bool>());
  EXPECT_TRUE(json[1].at("useless").get<bool>());
  EXPECT_NEAR(json[0].at("area").get<double>(), 0.0625, 1e-9);
  EXPECT_GT(json[0].at("lit").get<double>(), 10 * json[1].at("lit").get<double>());
}

TEST(portals_report, a_portal_that_faces_the_lamp_is_useless) {
  Portal back = portal_in_the_hole();
  for (auto& t : back.triangles) std::swap(t[1], t[2]);
  EXPECT_NE(useless_portals({back}, render_with({back})), "");
}

TEST(portals_report, every_portal_that_is_turned_is_told) {
  std::vector<Portal> portals(4, portal_in_the_hole());
  for (size_t i = 0; i < 4; ++i) portals[i].name = "portal." + std::to_string(i);
  portals[2].both_ways = portals[3].both_ways = true;
  using Strings = std::vector<std::string>;
  EXPECT_EQ(turnings(portals, {{0}, {1}, {2}, {3}}), Strings{});
  EXPECT_EQ(
      turnings(portals, {{0, PortalWay::back},
                         {1, PortalWay::both},
                         {2, PortalWay::front},
                         {3, PortalWay::back}}),
      (Strings{
          "portal.0: its front faces the light, not the camera: turned round",
          "portal.1: light passes it both ways, so it works both ways",
          "portal.2: is double-sided, light passes it from its back to its front: works that way "
          "alone",
          "portal.3: is double-sided, light passes it from its front to its back: works that way "
          "alone"}));
}

TEST(portals_report, few_samples_prove_nothing) {
  RenderResult result;
  result.tally.energy[0] = 1;
  result.tally.portals = {{kEnoughSamples - 1, 0, 0}};
  EXPECT_TRUE(useless_portals({portal_in_the_hole()}, result).empty());
  result.tally.portals[0].drawn = kEnoughSamples;
  EXPECT_NE(useless_portals({portal_in_the_hole()}, result), "");
  EXPECT_EQ(
      useless_portal({portal_in_the_hole()}, 0, result),
      "0 % of its 1000 samples connected a lamp with the camera, they brought 0 % of the light");
  // Much light from few of them is worth having.
  result.tally.portals[0].lit = 1;
  result.tally.portals[0].energy = 0.5;
  EXPECT_TRUE(useless_portals({portal_in_the_hole()}, result).empty());
}

TEST(portals_report, names_are_one_line) {
  EXPECT_EQ(names_of({"a"}), "a");
  EXPECT_EQ(names_of({"a", "b", "c", "d"}), "a, b, c, d");
  EXPECT_EQ(names_of({"a", "b", "c", "d", "e"}), "a, b, c and 2 more");
}

TEST(portals_report, one_that_no_light_passes_stays_in_the_statistics) {
  std::vector<Portal> portals(1, portal_in_the_hole());
  apply_ways({{0, PortalWay::left_out}}, portals);
  const auto json = portals_json(portals, {});
  EXPECT_NEAR(json[0].at("area").get<double>(), 0.0625, 1e-12);
  EXPECT_TRUE(json[0].at("useless").get<bool>());
}

TEST(portals_report, idle_portals_are_told_with_what_they_brought) {
  EXPECT_EQ(idleness(0.003), "paths that begin in the portals brought 0.3 % of the light");
}

}  // namespace tdpt::portal_report_test
