// Reports about portals that are known to be good or bad.
#include "tools/tdpt-render/run/report.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tools/tdpt-render/testing/rendering.h"
#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::report_test {

// Upright, in a corner of the camera's room behind the camera: light passes, but does not matter.
Portal in_the_corner() {
  return rectangle({0.05, 0.02, -0.97}, {0, 0, 0.1}, {0, 0.1, 0});
}

RenderResult render_with(const std::vector<Portal>& portals) {
  const Scene scene = read_gltf(two_rooms_path());
  const Vista vista(scene, scene.camera(""), 32, 24, portals);
  Job settings;
  settings.limits.spp = 32;
  return render(vista, tdpt_org, settings);
}

nlohmann::ordered_json portals_of(const std::vector<Portal>& portals, const RenderResult& result) {
  return stats_of({}, tdpt_org, portals, result)["portals"];
}

TEST(report, a_portal_off_the_lights_way_is_called_useless_and_one_in_the_hole_is_not) {
  std::vector<Portal> portals{portal_in_the_hole(), in_the_corner()};
  portals[1].name = "corner";
  const RenderResult result = render_with(portals);
  EXPECT_EQ(idleness_sentence(portals, result), "next to no light came through corner: of no use");
  // Each sample of the picture drew one segment; their light is the technique's share.
  ASSERT_EQ(result.tally.portals.size(), 2u);
  EXPECT_EQ(result.tally.portals[0].drawn + result.tally.portals[1].drawn, 32u * 24 * 32);
  EXPECT_NEAR(result.tally.portals[0].energy + result.tally.portals[1].energy,
              result.tally.energy[static_cast<size_t>(Technique::portal)], 1e-6);
  const auto json = portals_of(portals, result);
  EXPECT_FALSE(json[0].at("useless").get<bool>());
  EXPECT_TRUE(json[1].at("useless").get<bool>());
  EXPECT_NEAR(json[0].at("area").get<double>(), 0.0625, 1e-9);
  EXPECT_GT(json[0].at("lit").get<double>(), 10 * json[1].at("lit").get<double>());
}

TEST(report, a_portal_that_faces_the_lamp_is_useless) {
  Portal back = portal_in_the_hole();
  for (auto& t : back.triangles) std::swap(t[1], t[2]);
  EXPECT_NE(idleness_sentence({back}, render_with({back})), "");
}

TEST(report, a_portal_that_is_turned_is_told) {
  Portal portal = portal_in_the_hole();
  portal.name = "door";
  const auto says = [&](PortalWay way, const char* words) {
    return way_sentence(portal, way).find(words) != std::string::npos;
  };
  EXPECT_EQ(way_sentence(portal, PortalWay::as_drawn), "");
  EXPECT_EQ(way_sentence(portal, PortalWay::front), "");
  EXPECT_TRUE(says(PortalWay::back, "from its front to its back"));
  EXPECT_TRUE(says(PortalWay::both, "both ways"));
  EXPECT_TRUE(says(PortalWay::left_out, "left out"));
  portal.both_ways = true;
  EXPECT_EQ(way_sentence(portal, PortalWay::both), "");
  EXPECT_TRUE(says(PortalWay::front, "from its back to its front"));
  EXPECT_TRUE(says(PortalWay::back, "from its front to its back"));
}

RenderResult empty_result() {
  RenderResult result;
  result.progress = std::make_shared<Progress>(Film(1, 1, 1), Limits());
  return result;
}

TEST(report, few_samples_prove_nothing) {
  RenderResult result = empty_result();
  const auto useless = [&] {
    return portals_of({portal_in_the_hole()}, result)[0].at("useless").get<bool>();
  };
  result.tally.energy[0] = 1;
  result.tally.portals = {{kEnoughSamples - 1, 0, 0}};
  EXPECT_FALSE(useless());
  result.tally.portals[0].drawn = kEnoughSamples;
  EXPECT_TRUE(useless());
  // Much light from few of them is worth having.
  result.tally.portals[0].lit = 1;
  result.tally.portals[0].energy = 0.5;
  EXPECT_FALSE(useless());
}

TEST(report, one_that_no_light_passes_stays_in_the_statistics) {
  std::vector<Portal> portals(1, portal_in_the_hole());
  apply_ways({PortalWay::left_out}, portals);
  const auto json = portals_of(portals, empty_result());
  EXPECT_NEAR(json[0].at("area").get<double>(), 0.0625, 1e-12);
  EXPECT_TRUE(json[0].at("useless").get<bool>());
}

TEST(report, explain_has_what_the_statistics_have) {
  const std::vector<Portal> portals{portal_in_the_hole()};
  const RenderResult result = render_with(portals);
  Job job;
  job.automatic = true;
  const auto stats = stats_of(job, tdpt_org, portals, result);
  const cli::Decisions all = decisions_of(stats);
  for (const auto& [key, value] : stats.items())
    if (key != "portals" && key != "frames") {
      EXPECT_TRUE(std::any_of(all.begin(), all.end(), [&, &name = key](const cli::Decision& d) {
        return d.what == name;
      })) << key;
    }
  EXPECT_EQ(all.back().what, portals[0].name);
  EXPECT_NE(all.back().chosen.find("useless false"), std::string::npos);
}

}  // namespace tdpt::report_test
