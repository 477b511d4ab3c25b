// Window panes, which rays pass straight through: they neither add light nor take any away that
// they should not, and portals work behind them.
#include <gtest/gtest.h>

#include "tools/tdpt-render/run/render.h"
#include "tools/tdpt-render/testing/renderer.h"
#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/sheets.h"
#include "tools/tdpt-render/testing/variant.h"

namespace tdpt {
namespace {

Scene furnace_with(const Material& pane, float albedo) {
  Scene scene = read_gltf(furnace_path());
  for (Material& m : scene.materials) m.base_color = Rgb(albedo);
  scene = with_sheet(scene, pane, {0, 0.3, -0.8}, {0.3, 0, 1.4}, {0.1, 1.4, 0});
  return with_sheet(scene, pane, {-0.8, 0.2, -0.9}, {0.9, 0, 0.1}, {0, 1.5, 0.2});
}

constexpr uint64_t kMany = kByTwin ? 512 : 1024;

RenderResult rendered(const Scene& scene, const Integrator& integrator, int max_depth, uint64_t spp,
                      const std::vector<Portal>& portals = {}) {
  const World world(scene, scene.camera(""), 32, 24, portals);
  RenderSettings settings;
  settings.spp = spp;
  settings.max_depth = max_depth;
  return render(*renderer_under_test(world), integrator, settings);
}

// Radiance is 1 in every direction, with or without panes: every single sample is 1.
TEST(panes, cannot_be_seen_in_a_furnace) {
  const Picture picture = rendered(furnace_with(clear_pane(), 0), pt, 20, 4).picture;
  for (const Rgb& c : picture.pixels) EXPECT_NEAR(c.x, 1, 1e-4);
  Material smoked = clear_pane();  // twin: one that swallows a tenth
  smoked.base_color = Rgb(0.9f);
  EXPECT_LT(rendered(furnace_with(smoked, 0), pt, 20, 4).mean().x, 0.99);
}

// Walls of albedo 1/2 that emit 1: radiance 2, by every integrator. The floor's portal has a pane
// on either side.
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
  Material tinted = clear_pane();  // twin: rays stop at coloured glass
  tinted.base_color = Rgb(1, 1, 0.999f);
  EXPECT_LT(portal_share(glazed_rooms(tinted)), 0.01);
}

// What the portal in the hole brings, with `sheet` at each of these x.
double brought_by_the_portal(const Material& sheet, std::initializer_list<double> at) {
  Scene scene = read_gltf(two_rooms_path());
  for (double x : at)
    scene = with_sheet(scene, sheet, {x, 0.875, -0.125}, {0, 0, 0.25}, {0, 0.25, 0});
  const RenderResult r = rendered(scene, tdpt_ref, 6, kMany, {portal_in_the_hole()});
  return r.tally.energy[static_cast<size_t>(Technique::portal)];
}

// A portal drawn on the glass is the likeliest that an artist draws.
TEST(panes, in_the_plane_of_a_portal_take_no_more_light_than_beside_it) {
  for (const Material& sheet : {clear_pane(), veil(0.3f)}) {
    const double beside = brought_by_the_portal(sheet, {2.06});
    EXPECT_NEAR(brought_by_the_portal(sheet, {2.05}) / beside, 1, 0.02);
    EXPECT_LT(brought_by_the_portal(sheet, {2.05, 2.06}) / beside, 0.97);  // twin: met twice
  }
}

// The same pane as a smooth lobe that walks take, which glass of another colour is: the slow way.
// Each passage is then an edge more; the picture of many edges is the same, but for Schlick's curve
// in the place of Fresnel's (less than 2 % here).
TEST(panes, agree_with_glass_that_walks_pass_by_a_lobe) {
  Material tinted = clear_pane();
  tinted.base_color = Rgb(1, 1, 0.999f);
  const double pane = rendered(glazed_rooms(clear_pane()), bdpt, 16, kMany).mean().x;
  const double lobe = rendered(glazed_rooms(tinted), bdpt, 18, kMany).mean().x;
  EXPECT_NEAR(pane / lobe, 1, 0.025);
  const double open = rendered(read_gltf(two_rooms_path()), bdpt, 16, kMany).mean().x;
  EXPECT_GT(open / lobe, 1.035);  // twin: without the pane
}

}  // namespace
}  // namespace tdpt
