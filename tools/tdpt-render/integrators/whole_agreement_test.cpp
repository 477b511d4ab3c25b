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
                         {&nee, &tdpt_ref, &tdpt_guided});
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

// Weights may expect any number of connections, as long as those of all strategies agree.
TEST(whole_agreement_twin, connections_and_splats_that_count_for_others_are_caught) {
  const Scene scene = glossy_rooms();
  const Vista vista(scene, scene.camera(""), 32, 24,
                    {rectangle({2.05, 0.5, -0.5}, {0, 0, 1}, {0, 1, 0})});
  const DepthRuns reference = render_runs(vista, bdpt, kSettings.of_reference());
  const auto agrees = [&](const Variant& variant) {
    return judge(render_runs(vista, variant, kSettings), reference).holds();
  };
  const auto expecting_twice = [&](const Integrator& integrator) {
    Variant v = Variant::cached(vista, integrator, kMaxDepth);
    v.integrator.mixture.connected *= 2;
    v.integrator.mixture.connected_to_segments *= 2;
    return v;
  };
  Variant twice = expecting_twice(bdpt), segments = expecting_twice(tdpt_org);
  EXPECT_TRUE(agrees(twice));
  EXPECT_TRUE(agrees(segments));
  twice.besides = [](PathSampler& sampler) { sampler.run(Technique::bi); };
  EXPECT_FALSE(agrees(twice));
  segments.besides = [](PathSampler& sampler) { sampler.run(Technique::portal); };
  EXPECT_FALSE(agrees(segments));
  Variant splats = Variant::cached(vista, with_light_walks(bdpt, 0.25), kMaxDepth);
  splats.besides = [](PathSampler& sampler) { sampler.run(Technique::light); };
  EXPECT_FALSE(agrees(splats));
  Variant uncounted = Variant::cached(vista, with_light_walks(bdpt, 0.5), kMaxDepth);
  uncounted.counted_samples = 0.5;
  EXPECT_FALSE(agrees(uncounted));
  Variant without_bi = Variant::cached(vista, nee, kMaxDepth);
  without_bi.integrator.mixture = expecting_connections(vista, bdpt.mixture, kMaxDepth);
  without_bi.caches = false;
  without_bi.run = run_only<Technique::camera, Technique::direct, Technique::light>;
  EXPECT_FALSE(agrees(without_bi));
}

}  // namespace tdpt::whole_agreement_test
