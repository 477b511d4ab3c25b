// All integrators render the same picture of glossy, smooth, transparent and textured things, lit
// by lamps large and without extent. The lamps are large enough for every integrator to have a
// modest variance. Lights without extent are left out of rooms with mirrors or clear glass: what
// they send over such surfaces alone to a matt one, only light walks find, so that nee is darker
// there; and pt never meets these lights.
#include <gtest/gtest.h>

#include "libcommon/testing/files/temp_folder.h"
#include "libcommon/testing/rooms/glossy_rooms.h"
#include "tools/tdpt-render/testing/agreement.h"
#include "tools/tdpt-render/testing/faults.h"
#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt {
namespace {

using testing::GlossyRooms;
using Light = GlossyRooms::Light;

Scene scene_of(const GlossyRooms& what) {
  const testing::TempFolder folder;
  return read_gltf(folder.write("rooms.glb", testing::glossy_rooms(what)));
}

const Portal kWindow = rectangle({2.05, 0.5, -0.5}, {0, 0, 1}, {0, 1, 0});

World world_of(const Scene& scene, const std::vector<Portal>& portals = {kWindow}) {
  return World(scene, scene.camera(""), 32, 24, portals);
}

/// With portals and without, sample by sample (misplaced_portals_test.cpp): sees hundredths of a
/// per cent.
Verdict paired_verdict(const DepthRuns& runs, const DepthRuns& reference) {
  const Verdict verdict = judge(runs, reference, testing::compare_paired);
  std::printf("paired    least p %.1e; all depths %s\n", verdict.worst_p,
              testing::compare_paired(runs.of_depth[0], reference.of_depth[0]).text().c_str());
  return verdict;
}

void expect_agreement(const GlossyRooms& what, const std::vector<const Integrator*>& others,
                      const AgreementSettings& settings) {
  const Scene scene = scene_of(what);
  for (const std::string& warning : scene.warnings) ADD_FAILURE() << warning;
  const World world = world_of(scene);
  expect_agreement(world, others, settings);
  const DepthRuns runs = render_runs(world, tdpt_ref, settings);
  const DepthRuns reference = render_runs(world_of(scene, {}), tdpt_ref, settings);
  EXPECT_TRUE(holds(paired_verdict(runs, reference), "portals and none", runs, reference));
}

const std::vector<const Integrator*> kLamp{&pt, &nee, &tdpt_org, &tdpt_ref, &tdpt_guided};
const std::vector<const Integrator*> kPunctual{&nee, &tdpt_org, &tdpt_ref, &tdpt_guided};
constexpr AgreementSettings kSettings{.runs = 16, .spp = 32};

TEST(glossy_agreement, rough_plastic_and_metal) {
  expect_agreement({.plastic_floor = true, .metal_walls = true}, kLamp, kSettings);
}

TEST(glossy_agreement, mirror_and_plastic) {
  expect_agreement({.plastic_floor = true, .mirror = true}, kLamp, kSettings);
}

TEST(glossy_agreement, clear_and_frosted_glass) {
  expect_agreement({.glass = true}, kLamp, kSettings);
}

TEST(glossy_agreement, smooth_shading) {
  expect_agreement({.smooth = true}, kLamp, kSettings);
}

TEST(glossy_agreement, textures_and_a_textured_lamp) {
  expect_agreement({.textures = true, .light = Light::textured_lamp}, kLamp, kSettings);
}

TEST(glossy_agreement, clear_coats_and_cloth) {
  expect_agreement({.coats = true}, kLamp, kSettings);
}

TEST(glossy_agreement, screen_with_holes) {
  expect_agreement({.plastic_floor = true, .screen = true}, kLamp, kSettings);
}

TEST(glossy_agreement, half_transparent_veil) {
  expect_agreement({.metal_walls = true, .veil = true}, kLamp, kSettings);
}

TEST(glossy_agreement, frosted_pane_of_no_thickness) {
  expect_agreement({.smooth = true, .pane = true}, kLamp, kSettings);
}

TEST(glossy_agreement, lamp_that_is_a_half_transparent_mirror) {
  expect_agreement({.plastic_floor = true, .light = Light::mirror_lamp}, kLamp, kSettings);
}

TEST(glossy_agreement, point_light) {
  expect_agreement({.plastic_floor = true, .smooth = true, .light = Light::point}, kPunctual,
                   kSettings);
}

TEST(glossy_agreement, spot_light) {
  expect_agreement({.metal_walls = true, .textures = true, .light = Light::spot}, kPunctual,
                   kSettings);
}

TEST(glossy_agreement, sun) {
  expect_agreement({.plastic_floor = true, .metal_walls = true, .light = Light::sun}, kPunctual,
                   kSettings);
}

// Twins: room and samples are those of rough_plastic_and_metal.

TEST(glossy_agreement_twin, faults_are_caught_on_glossy_surfaces_too) {
  const Scene scene = scene_of({.plastic_floor = true, .metal_walls = true});
  const World world = world_of(scene);
  const DepthRuns reference = render_runs(world, bdpt, kSettings);
  const auto caught = [&](const char* what, const World& in, const Variant& faulty) {
    const Verdict verdict = judge(render_runs(in, faulty, kSettings), reference);
    std::printf("%-20s depths caught %d, least p %.1e\n", what, verdict.disagreements,
                verdict.worst_p);
    EXPECT_FALSE(verdict.holds()) << what;
  };
  caught("bi missing", world,
         {tdpt_org.mixture.techniques,
          run_only<Technique::camera, Technique::direct, Technique::light, Technique::portal>});
  caught("light twice", world, {bdpt.mixture.techniques, run_twice<Technique::light>});
  World spoilt(scene, scene.camera(""), 32, 24, {kWindow});
  spoilt.portals = PortalSetFaults::scaled(spoilt.portals, 1.05);
  EXPECT_FALSE(paired_verdict(render_runs(spoilt, tdpt_ref, kSettings),
                              render_runs(world_of(scene, {}), tdpt_ref, kSettings))
                   .holds());

  // A BSDF that differs by 5 % of its colour from the one the reference has.
  Scene darker = scene;
  for (Material& m : darker.materials)
    if (m.roughness < 0.35f) m.base_color *= 0.95f;
  caught("floor 5 % darker", world_of(darker), bdpt);
}

TEST(glossy_agreement_twin, a_scene_without_its_coats_or_its_cloth_is_caught) {
  const Scene scene = scene_of({.coats = true});
  const DepthRuns reference = render_runs(world_of(scene), bdpt, kSettings);
  const auto caught = [&](const Scene& faulty) {
    return !judge(render_runs(world_of(faulty), bdpt, kSettings), reference).holds();
  };
  Scene bare = scene, dull = scene;
  for (Material& m : bare.materials) m.coat = 0;
  for (Material& m : dull.materials) m.sheen_color = {};
  EXPECT_TRUE(caught(bare));
  EXPECT_TRUE(caught(dull));
}

}  // namespace
}  // namespace tdpt
