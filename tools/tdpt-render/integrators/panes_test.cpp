// Window panes, which rays pass straight through, neither add nor take light wrongly, and portals
// work behind them.
#include <gtest/gtest.h>

#include "libcommon/testing/statistics/power.h"
#include "libcommon/testing/statistics/z_test.h"
#include "tools/tdpt-render/testing/rendering.h"
#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/sheets.h"
#include "tools/tdpt-render/testing/variant.h"

namespace tdpt::panes_test {

Scene furnace_with(const Material& pane, float albedo) {
  Scene scene = read_gltf(furnace_path());
  for (Material& m : scene.materials) m.base_color = Rgb(albedo);
  scene = with_sheet(scene, pane, {0, 0.3, -0.8}, {0.3, 0, 1.4}, {0.1, 1.4, 0});
  return with_sheet(scene, pane, {-0.8, 0.2, -0.9}, {0.9, 0, 0.1}, {0, 1.5, 0.2});
}

RenderResult rendered(const Scene& scene, const Integrator& integrator, int max_depth, uint64_t spp,
                      const std::vector<Portal>& portals = {}, uint64_t seed = 1) {
  const Vista vista(scene, scene.camera(""), 32, 24, portals);
  Job settings;
  settings.limits.spp = spp;
  settings.max_depth = max_depth;
  settings.seed = testing::fresh(seed);
  return render(vista, integrator, settings);
}

// Radiance is 1 in every direction, with or without panes: every sample is 1.
TEST(panes, cannot_be_seen_in_a_furnace) {
  const Picture picture = rendered(furnace_with(clear_pane(), 0), pt, 20, 4).picture;
  for (const Rgb& c : picture.pixels) EXPECT_NEAR(c.x, 1, 1e-4);
  Material smoked = clear_pane();  // twin: absorbs a tenth
  smoked.base_color = Rgb(0.9f);
  EXPECT_LT(rendered(furnace_with(smoked, 0), pt, 20, 4).mean().x, 0.99);
}

// Walls of albedo 1/2 that emit 1 give radiance 2, by every integrator. There is a pane on either
// side of the portal over the floor.
TEST(panes, keep_the_light_of_a_furnace_for_every_integrator) {
  const Scene scene = furnace_with(clear_pane(), 0.5f);
  for (const Integrator* integrator : integrators())
    EXPECT_NEAR(rendered(scene, *integrator, 20, 24, {portal_in_the_furnace()}).mean().x, 2, 0.012)
        << integrator->name;
}

Scene glazed_rooms(const Material& pane) {
  return with_sheet(read_gltf(two_rooms_path()), pane, {2.06, 0.875, -0.125}, {0, 0, 0.25},
                    {0, 0.25, 0});
}

TEST(panes, a_portal_works_behind_one) {
  const auto portal_share = [](const Scene& scene) {
    const RenderResult r = rendered(scene, tdpt_ref, 6, 32, {portal_in_the_hole()});
    double total = 0;
    for (double e : r.tally.energy) total += e;
    return r.tally.energy[static_cast<size_t>(Technique::portal)] / total;
  };
  EXPECT_GT(portal_share(glazed_rooms(clear_pane())), 0.1);
  Material tinted = clear_pane();  // twin: rays are stopped by coloured glass
  tinted.base_color = Rgb(1, 1, 0.999f);
  EXPECT_LT(portal_share(glazed_rooms(tinted)), 0.01);
}

// Short pictures, with independent random numbers or the same ones for two sheets.
constexpr uint64_t kPictures = 24;

// The light that the portal in the hole brings to each, with `sheet` at each of these x.
testing::BlockRuns brought_by_the_portal(const Material& sheet, std::initializer_list<double> at) {
  Scene scene = read_gltf(two_rooms_path());
  for (double x : at)
    scene = with_sheet(scene, sheet, {x, 0.875, -0.125}, {0, 0, 0.25}, {0, 0.25, 0});
  testing::BlockRuns all;
  for (uint64_t seed = 1; seed <= kPictures; ++seed) {
    const RenderResult r = rendered(scene, tdpt_ref, 4, 6, {portal_in_the_hole()}, seed);
    all.add({r.tally.energy[static_cast<size_t>(Technique::portal)]});
  }
  return all;
}

// Artists are likely to draw a portal on the glass itself.
TEST(panes, in_the_plane_of_a_portal_take_no_more_light_than_beside_it) {
  for (const Material& sheet : {clear_pane(), veil(0.3f)}) {
    const testing::BlockRuns beside = brought_by_the_portal(sheet, {2.06});
    const auto compared = [&](std::initializer_list<double> at) {
      const testing::Agreement a = compare_paired(brought_by_the_portal(sheet, at), beside);
      testing::tell_answer(a, kPictures);
      return a;
    };
    const testing::Agreement within = compared({2.05}), twice = compared({2.05, 2.06});
    EXPECT_TRUE(within.holds()) << within.text();
    EXPECT_FALSE(twice.holds()) << twice.text();  // twin: hit twice
  }
}

}  // namespace tdpt::panes_test
