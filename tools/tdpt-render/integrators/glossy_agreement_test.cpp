// All integrators render the same picture of glossy, smooth, transparent and textured objects, lit
// by large lamps and by lamps without surface. The large lamps give every integrator a modest
// variance. Lamps without surface are not combined with mirrors or clear glass: only light walks
// find the light that they send to a matt surface by way of these, so nee would be darker; and pt
// never hits such lamps.
#include <gtest/gtest.h>

#include <bit>

#include "libcommon/scene/ies.h"
#include "libcommon/testing/files/temp_folder.h"
#include "libcommon/testing/rooms/glossy_rooms.h"
#include "tools/tdpt-render/testing/agreement.h"
#include "tools/tdpt-render/testing/faults.h"
#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::glossy_agreement_test {

using testing::GlossyRooms;
using Light = GlossyRooms::Light;

Scene scene_of(const GlossyRooms& what) {
  const testing::TempFolder folder;
  return read_gltf(folder.write("rooms.glb", testing::glossy_rooms(what)));
}

const Portal kWindow = rectangle({2.05, 0.5, -0.5}, {0, 0, 1}, {0, 1, 0});

Vista world_of(const Scene& scene, const std::vector<Portal>& portals = {kWindow}) {
  return Vista(scene, scene.camera(""), 32, 24, portals);
}

/// With and without portals, sample by sample (misplaced_portals_test.cpp): detects hundredths of a
/// per cent.
Verdict paired_verdict(const DepthRuns& runs, const DepthRuns& reference) {
  const Verdict verdict = judge(runs, reference, testing::compare_paired);
  std::printf("paired    least p %.1e; all depths %s\n", verdict.worst_p,
              testing::compare_paired(runs.of_depth[0], reference.of_depth[0]).text().c_str());
  return verdict;
}

/// Enough to detect 5 % of a portal's density or of a colour.
constexpr AgreementSettings kSettings{.runs = 32, .spp = 16};
/// Enough to detect a technique that counts twice.
constexpr AgreementSettings kGross{.runs = 32, .spp = 4};

struct Case {
  const char* name;
  GlossyRooms what;
  bool without_surface = false;  ///< its lamps, which pt never hits
};
void PrintTo(const Case& c, std::ostream* to) {
  *to << c.name;
}
const Case kCases[] = {
    {"rough_plastic_and_metal", {.plastic_floor = true, .metal_walls = true}},
    {"mirror_and_plastic", {.plastic_floor = true, .mirror = true}},
    {"clear_and_frosted_glass", {.glass = true}},
    {"smooth_shading", {.smooth = true}},
    {"textures_and_a_textured_lamp", {.textures = true, .light = Light::textured_lamp}},
    {"clear_coats_and_cloth", {.coats = true}},
    {"screen_with_holes", {.plastic_floor = true, .screen = true}},
    {"half_transparent_veil", {.metal_walls = true, .veil = true}},
    {"frosted_pane_of_no_thickness", {.smooth = true, .pane = true}},
    {"lamp_that_is_a_half_transparent_mirror",
     {.plastic_floor = true, .light = Light::mirror_lamp}},
    {"point_light", {.plastic_floor = true, .smooth = true, .light = Light::point}, true},
    {"spot_light", {.metal_walls = true, .textures = true, .light = Light::spot}, true},
    {"luminaire_with_a_profile", {.plastic_floor = true, .light = Light::luminaire}, true},
    {"sun", {.plastic_floor = true, .metal_walls = true, .light = Light::sun}, true}};

class glossy_agreement : public ::testing::TestWithParam<Case> {
 protected:
  const Scene scene_ = scene_of(GetParam().what);
  const Vista vista_ = world_of(scene_);
};
class long_glossy_agreement : public glossy_agreement {};

// All techniques between them; fewer samples of the one with light walks.
TEST_P(glossy_agreement, of) {
  for (const std::string& warning : scene_.warnings) ADD_FAILURE() << warning;
  expect_agreement(vista_, {&nee, &tdpt_org, &tdpt_guided}, kGross);
}
TEST_P(long_glossy_agreement, of) {
  std::vector<const Integrator*> all = integrators();
  if (GetParam().without_surface) all.erase(all.begin());
  expect_agreement(vista_, all, kSettings);
  const DepthRuns runs = render_runs(vista_, tdpt_ref, kSettings);
  const DepthRuns reference = render_runs(world_of(scene_, {}), tdpt_ref, kSettings);
  EXPECT_TRUE(holds(paired_verdict(runs, reference), "portals and none", runs, reference));
}
const auto name_of_case = [](const auto& info) { return std::string(info.param.name); };
INSTANTIATE_TEST_SUITE_P(, glossy_agreement, ::testing::ValuesIn(kCases), name_of_case);
INSTANTIATE_TEST_SUITE_P(, long_glossy_agreement, ::testing::ValuesIn(kCases), name_of_case);

// Twins: in the room of rough_plastic_and_metal.

TEST(glossy_agreement_twin, faults_are_caught_on_glossy_surfaces_too) {
  const Scene scene = scene_of({.plastic_floor = true, .metal_walls = true});
  const Vista vista = world_of(scene);
  const auto caught = [&](const char* what, const Vista& in, const Variant& faulty,
                          const AgreementSettings& settings) {
    const DepthRuns reference = render_runs(vista, bdpt, settings.of_reference());
    const Verdict verdict = judge(render_runs(in, faulty, settings), reference);
    std::printf("%-20s depths caught %d, least p %.1e\n", what, verdict.disagreements,
                verdict.worst_p);
    EXPECT_FALSE(verdict.holds()) << what;
  };
  caught("bi missing", vista,
         {tdpt_org.mixture.techniques,
          run_only<Technique::camera, Technique::direct, Technique::light, Technique::portal>},
         kGross);
  caught("light twice", vista, {bdpt.mixture.techniques, run_twice<Technique::light>}, kGross);
  // A BSDF with 5 % less colour than the reference.
  Scene darker = scene;
  for (Material& m : darker.materials)
    if (m.roughness < 0.35f) m.base_color *= 0.95f;
  caught("floor 5 % darker", world_of(darker), bdpt, kSettings);
}

// Sample by sample; short paths suffice.
TEST(glossy_agreement_twin, a_portal_off_by_5_percent_is_caught_on_glossy_surfaces_too) {
  constexpr AgreementSettings kShort{.max_depth = 3, .runs = 64, .spp = 13};
  const Scene scene = scene_of({.plastic_floor = true, .metal_walls = true});
  const DepthRuns without = render_runs(world_of(scene, {}), tdpt_ref, kShort);
  Vista vista = world_of(scene);
  const DepthRuns with = render_runs(vista, tdpt_ref, kShort);
  EXPECT_TRUE(holds(paired_verdict(with, without), "portals and none", with, without));
  vista.openings.portals = PortalSetFaults::scaled(vista.openings.portals, 1.05);
  EXPECT_FALSE(paired_verdict(render_runs(vista, tdpt_ref, kShort), without).holds());
}

// In the room of luminaire_with_a_profile: light walks are sampled correctly, with a wrong density.
TEST(glossy_agreement_twin, densities_of_a_profile_a_fifth_too_large_are_caught) {
  const Scene scene = scene_of({.plastic_floor = true, .light = Light::luminaire});
  const DepthRuns reference = render_runs(world_of(scene), nee, kSettings.of_reference());
  Scene faulty = scene;
  LightProfile profile = *scene.lights[0].profile;
  for (size_t r = 1; r < profile.words[0]; ++r) {
    uint32_t& word = profile.words[profile.words.size() - r];
    word = std::bit_cast<uint32_t>(std::bit_cast<float>(word) * 1.2f);
  }
  faulty.lights[0].profile = std::make_shared<LightProfile>(profile);
  const auto holds = [&](const Scene& of) {
    const Verdict verdict = judge(render_runs(world_of(of), bdpt, kSettings), reference);
    std::printf("depths caught %d, least p %.1e\n", verdict.disagreements, verdict.worst_p);
    return verdict.holds();
  };
  EXPECT_TRUE(holds(scene));
  EXPECT_FALSE(holds(faulty));
}

TEST(glossy_agreement_twin, a_scene_without_its_coats_or_its_cloth_is_caught) {
  constexpr AgreementSettings kShort{.max_depth = 3, .runs = 64, .spp = 18};
  const Scene scene = scene_of({.coats = true});
  const DepthRuns reference = render_runs(world_of(scene), bdpt, kShort.of_reference());
  const auto caught = [&](const Scene& faulty) {
    return !judge(render_runs(world_of(faulty), bdpt, kShort), reference).holds();
  };
  Scene bare = scene, dull = scene;
  for (Material& m : bare.materials) m.coat = 0;
  for (Material& m : dull.materials) m.sheen_color = {};
  EXPECT_TRUE(caught(bare));
  EXPECT_TRUE(caught(dull));
}

}  // namespace tdpt::glossy_agreement_test
