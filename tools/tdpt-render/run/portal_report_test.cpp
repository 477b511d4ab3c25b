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

// Figures that were measured; no word of what the picture would gain.
TEST(portals_report, light_through_portals_is_one_line_however_many_there_are) {
  Portal fitted = portal_in_the_hole();
  fitted.name = "portal.0";
  EXPECT_EQ(light_sentence({fitted}), "");
  fitted.figures = {{"area", 0.0625}, {"flux_share", 0.98}, {"conductance", 0.3}, {kLight, 0.734}};
  EXPECT_EQ(light_sentence({fitted}), "of the light that the camera sees 73 % passes portal.0");
  Portal fuller = fitted;
  fuller.name = "portal.1";
  fuller.figures[kLight] = 1;  // not 1e+02 %
  EXPECT_EQ(light_sentence({fitted, fuller}),
            "of the light that the camera sees 100 % passes portal.1, 73 % passes portal.0");
  EXPECT_EQ(light_sentence(std::vector<Portal>(20, fitted)),
            "of the light that the camera sees 73 % passes portal.0, 73 % passes portal.0, 73 % "
            "passes portal.0, at most 73 % each of 17 others");
  EXPECT_EQ(light_sentence({}), "");
  fitted.triangles.clear();
  EXPECT_EQ(light_sentence({fitted}), "");
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

TEST(portals_report, idle_portals_are_told_with_what_was_measured_of_them) {
  std::vector<Portal> portals(2, portal_in_the_hole());
  EXPECT_EQ(idleness(portals, 0.003),
            "the portals brought less than 1 % of the light: do they lie on its way?");
  portals[1].name = "hall";
  portals[0].figures["flux_share"] = 0.14;
  portals[1].figures["flux_share"] = 0.81;
  EXPECT_EQ(idleness(portals, 0.003),
            "paths through the portals brought 0.3 % of the light; says its file, 81 % of the "
            "camera's light passes hall");
  portals[0].figures[kLight] = 0.02;
  portals[1].figures[kLight] = 0.45;
  EXPECT_EQ(idleness(portals, 0.003),
            "paths through the portals brought 0.3 % of the light; of a small trial picture's "
            "light 45 % passed hall");
  portals[1].figures[kLight] = 0.999;
  EXPECT_NE(idleness(portals, 0.003).find(" light 100 % passed hall"), std::string::npos);
}

}  // namespace tdpt::portal_report_test
