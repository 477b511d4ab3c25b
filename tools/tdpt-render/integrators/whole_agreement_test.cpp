// All integrators render the same picture if only Russian roulette ends their walks and samples
// share their light walks, as in rendered pictures [passes.h]: for every length up to 8 and for all
// longer paths.
#include <gtest/gtest.h>

#include "libcommon/testing/files/temp_folder.h"
#include "libcommon/testing/rooms/glossy_rooms.h"
#include "tools/tdpt-render/testing/agreement.h"
#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::whole_agreement_test {

constexpr AgreementSettings kSettings{.max_depth = kMaxDepth, .runs = 32, .spp = 4};

// Bright, so that long paths carry a good part of the light.
Scene bright_rooms() {
  Scene scene = read_gltf(two_rooms_path());
  for (Material& m : scene.materials) m.base_color = Rgb(0.8f);
  return scene;
}

Scene glossy_rooms() {
  const testing::TempFolder folder;
  return read_gltf(folder.write(
      "rooms.glb",
      testing::glossy_rooms({.plastic_floor = true, .metal_walls = true, .smooth = true})));
}

Integrator with_light_walks(Integrator integrator, double share) {
  integrator.mixture.light_walks = share;
  return integrator;
}

void expect_whole_agreement(const Vista& vista, const std::vector<const Integrator*>& others) {
  std::vector<Variant> variants;
  for (const Integrator* integrator : others)
    variants.push_back(Variant::cached(vista, *integrator, kMaxDepth));
  // The reference connects only vertices of the same sample.
  const DepthRuns reference = render_runs(vista, bdpt, kSettings.of_reference());
  EXPECT_GT(reference.of_depth.back().mean(), 0.01 * reference.of_depth[0].mean());
  expect_agreement(vista, variants, reference, kSettings);
}

TEST(whole_agreement, two_rooms) {
  const Scene scene = bright_rooms();
  expect_whole_agreement(Vista(scene, scene.camera(""), 32, 24, {portal_in_the_hole()}),
                         {&nee, &bdpt, &tdpt_org, &tdpt_ref, &tdpt_guided});
}

TEST(whole_agreement, of_light_walks_in_any_share_of_the_samples) {
  const Scene scene = glossy_rooms();
  const Integrator quarter = with_light_walks(bdpt, 0.25), most = with_light_walks(bdpt, 0.7),
                   fewest = with_light_walks(tdpt_org, kFewestLightWalks),
                   all = with_light_walks(tdpt_guided, 1);
  expect_whole_agreement(
      Vista(scene, scene.camera(""), 32, 24, {rectangle({2.05, 0.5, -0.5}, {0, 0, 1}, {0, 1, 0})}),
      {&quarter, &most, &fewest, &all});
}

TEST(whole_agreement, glossy_rooms) {
  const Scene scene = glossy_rooms();
  expect_whole_agreement(
      Vista(scene, scene.camera(""), 32, 24, {rectangle({2.05, 0.5, -0.5}, {0, 0, 1}, {0, 1, 0})}),
      {&nee, &bdpt, &tdpt_org, &tdpt_ref, &tdpt_guided});
}

class whole_agreement_twin : public ::testing::Test {
 protected:
  static Variant expecting(const Integrator& integrator, const Vista& vista, double more) {
    Variant v = Variant::cached(vista, integrator, kMaxDepth);
    v.integrator.mixture.connected *= more;
    v.integrator.mixture.connected_to_segments *= more;
    return v;
  }
  Verdict verdict(const char* what, const Variant& variant) const {
    const Verdict v = judge(render_runs(vista_, variant, kSettings), reference_);
    std::printf("%-26s lengths caught %d, least p %.1e\n", what, v.disagreements, v.worst_p);
    return v;
  }

  const Scene scene_ = glossy_rooms();
  const Vista vista_{
      scene_, scene_.camera(""), 32, 24, {rectangle({2.05, 0.5, -0.5}, {0, 0, 1}, {0, 1, 0})}};
  const DepthRuns reference_ = render_runs(vista_, bdpt, kSettings.of_reference());
};

// Weights may expect any number of connections, as long as those of all strategies agree.
TEST_F(whole_agreement_twin, control_weights_that_expect_twice_as_many_connections) {
  EXPECT_TRUE(verdict("bdpt, connections expected twice", expecting(bdpt, vista_, 2)).holds());
  EXPECT_TRUE(verdict("tdpt-org, the same", expecting(tdpt_org, vista_, 2)).holds());
}

TEST_F(whole_agreement_twin, connections_that_are_made_twice_as_well_are_caught) {
  Variant twice = expecting(bdpt, vista_, 2);
  twice.besides = [](PathSampler& sampler) { sampler.run(Technique::bi); };
  EXPECT_FALSE(verdict("bi twice, expected twice", twice).holds());
  Variant segments = expecting(tdpt_org, vista_, 2);
  segments.besides = [](PathSampler& sampler) { sampler.run(Technique::portal); };
  EXPECT_FALSE(verdict("portal twice", segments).holds());
}

TEST_F(whole_agreement_twin, splats_of_few_light_walks_that_count_for_others_are_caught) {
  Variant twice = Variant::cached(vista_, with_light_walks(bdpt, 0.25), kMaxDepth);
  twice.besides = [](PathSampler& sampler) { sampler.run(Technique::light); };
  EXPECT_FALSE(verdict("light twice, in a quarter", twice).holds());
  Variant uncounted = Variant::cached(vista_, with_light_walks(bdpt, 0.5), kMaxDepth);
  uncounted.counted_samples = 0.5;
  EXPECT_FALSE(verdict("light walks counted as all", uncounted).holds());
}

TEST_F(whole_agreement_twin, a_technique_that_is_weighed_but_not_run_is_caught) {
  Variant without = Variant::cached(vista_, nee, kMaxDepth);
  without.integrator.mixture = expecting_connections(vista_, bdpt.mixture, kMaxDepth);
  without.caches = false;
  without.run = run_only<Technique::camera, Technique::direct, Technique::light>;
  EXPECT_FALSE(verdict("bi missing", without).holds());
}

}  // namespace tdpt::whole_agreement_test
