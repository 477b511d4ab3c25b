#include "tools/tdpt-render/run/explain.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::explain_test {

struct Told {
  Scene scene = read_gltf(two_rooms_path());
  std::vector<Portal> portals;
  World world;
  RenderResult result;
  cli::Decisions decisions;

  Told(const std::string& integrator, std::vector<Portal> given, uint64_t spp = 16, int width = 48,
       double target_error = 0)
      : portals(std::move(given)), world(scene, scene.camera(""), width, 3 * width / 4, portals) {
    Arguments a;
    a.integrator = integrator;
    cli::Common common;
    common.quiet = true;
    RenderSettings settings;
    settings.spp = spp;
    settings.target_error = target_error;
    const Request request = request_of(a);
    const Choice choice = choose(request, settings, scene.camera(""), world, portals, common);
    CpuRenderer cpu(world);
    result = render(cpu, choice.candidates, settings, choice);
    decisions = decisions_of({world, portals, request, choice, settings, result});
  }

  size_t with(const std::string& chosen) const {
    return static_cast<size_t>(
        std::count_if(decisions.begin(), decisions.end(),
                      [&](const cli::Decision& d) { return d.chosen == chosen; }));
  }
  cli::Decision about(const std::string& what) const {
    for (const cli::Decision& d : decisions)
      if (d.what == what) return d;
    ADD_FAILURE() << "nothing is said of " << what;
    return {};
  }
};

TEST(explain, one_candidate_is_chosen_and_it_is_the_one_that_rendered) {
  const Told told("auto", {portal_in_the_hole()});
  EXPECT_EQ(told.with("chosen"), 1u);
  EXPECT_EQ(told.about(told.result.plan.label).chosen, "chosen");
  EXPECT_EQ(told.with("refused"), told.result.forecast.estimates.size() - 1);
  EXPECT_NE(told.about("pilot").price.find(" % of the rendering"), std::string::npos);
}

TEST(explain, a_named_integrator_weighs_nothing) {
  const Told told("bdpt", {});
  EXPECT_EQ(told.with("chosen"), 0u);
  EXPECT_EQ(told.about("pilot").chosen, "left out");
  EXPECT_EQ(told.about("portals").chosen, "left out");
  EXPECT_EQ(told.about("technique bi").chosen, "run");
  EXPECT_EQ(told.about("technique portal").chosen, "left out");
}

TEST(explain, a_portal_is_told_with_what_passed_it) {
  const Told told("tdpt-org", {portal_in_the_hole()});
  const cli::Decision d = told.about(told.portals[0].name);
  EXPECT_EQ(d.chosen, "used as drawn");
  EXPECT_NE(d.reason.find("the small picture's light says so"), std::string::npos);
}

// No light passes the wall beside the hole.
TEST(explain, a_portal_that_no_light_passes_is_left_out) {
  Portal beside = portal_in_the_hole();
  for (Vec3d& v : beside.vertices) v.z += 0.5;
  constexpr uint64_t kSpp = 64;  // enough for the exploration to decide
  const Told told("tdpt-org", {portal_in_the_hole(), beside}, kSpp);
  EXPECT_EQ(told.with("used as drawn"), 1u);
  EXPECT_EQ(told.with("left out"),
            Told("tdpt-org", {portal_in_the_hole()}, kSpp).with("left out") + 1);
}

TEST(explain, says_that_a_pilot_fixed_the_samples) {
  const Told told("bdpt", {}, 0, 16, 1e3);
  EXPECT_EQ(told.about("samples").reason, "the pilot fixed so many");
  EXPECT_NE(told.about("error pilot").reason.find("they tell that 1 take"), std::string::npos)
      << told.about("error pilot").reason;
  EXPECT_EQ(Told("bdpt", {}, 1, 16, 1e-3).about("samples").reason, "so many were asked for");
}

TEST(explain, samples_too_few_to_weigh_are_said_to_be) {
  const Told told("auto", {portal_in_the_hole()}, 1, 8);
  EXPECT_EQ(told.about("pilot").chosen, "left out");
  EXPECT_EQ(told.with("chosen"), 0u);
}

TEST(explain, says_what_of_an_unlimited_picture_is_left_out) {
  const Told told("nee", {});
  for (const char* what : {"layers", "frames", "alpha", "textures", "a sky"})
    EXPECT_EQ(told.about(what).chosen, "left out") << what;
  EXPECT_EQ(told.about("length of paths").chosen, "not limited");
  EXPECT_TRUE(told.about("samples").chosen.starts_with("16 a pixel"));
}

}  // namespace tdpt::explain_test
