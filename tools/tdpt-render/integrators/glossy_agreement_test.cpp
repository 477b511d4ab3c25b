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
    {"metal_textures_and_a_veil",
     {.plastic_floor = true,
      .metal_walls = true,
      .smooth = true,
      .textures = true,
      .veil = true,
      .light = Light::textured_lamp}},
    {"mirror_and_glass", {.mirror = true, .glass = true}},
    {"coats_a_screen_and_a_pane", {.screen = true, .pane = true, .coats = true}},
    {"lamp_that_is_a_half_transparent_mirror", {.light = Light::mirror_lamp}},
    {"luminaire_with_a_profile", {.plastic_floor = true, .light = Light::luminaire}, true},
    {"sun", {.plastic_floor = true, .metal_walls = true, .light = Light::sun}, true}};

class glossy_agreement : public ::testing::TestWithParam<Case> {
 protected:
  const Scene scene_ = scene_of(GetParam().what);
  const Vista vista_ = world_of(scene_);
};
class long_glossy_agreement : public glossy_agreement {};

// All techniques between them.
TEST_P(glossy_agreement, of) {
  for (const std::string& warning : scene_.warnings) ADD_FAILURE() << warning;
  expect_agreement(vista_, {&nee, &tdpt_guided}, kGross);
}
TEST_P(long_glossy_agreement, of) {
  std::vector<const Integrator*> all = integrators();
  if (GetParam().without_surface) all.erase(all.begin());
  expect_agreement(vista_, all, kSettings);
  const DepthRuns runs = render_runs(vista_, tdpt_ref, kSettings);
  const DepthRuns reference = render_runs(world_of(scene_, {}), tdpt_ref, kSettings);
  // Sample by sample, as in misplaced_portals_test.cpp: detects hundredths of a per cent.
  EXPECT_TRUE(
      holds(judge(runs, reference, testing::compare_paired), "portals and none", runs, reference));
}
const auto name_of_case = [](const auto& info) { return std::string(info.param.name); };
INSTANTIATE_TEST_SUITE_P(, glossy_agreement, ::testing::ValuesIn(kCases), name_of_case);
INSTANTIATE_TEST_SUITE_P(, long_glossy_agreement, ::testing::ValuesIn(kCases), name_of_case);

// Twins. Short paths suffice.
constexpr AgreementSettings kShort{.max_depth = 3, .runs = 32, .spp = 16};

// 5 % less colour than the reference; scenes without coats, and without cloth.
TEST(glossy_agreement_twin, other_surfaces_are_caught) {
  const Scene plain = scene_of({.plastic_floor = true, .metal_walls = true}),
              coated = scene_of({.coats = true});
  Scene darker = plain, bare = coated, dull = coated;
  for (Material& m : darker.materials)
    if (m.roughness < 0.35f) m.base_color *= 0.95f;
  for (Material& m : bare.materials) m.coat = 0;
  for (Material& m : dull.materials) m.sheen_color = {};
  const DepthRuns of_plain = render_runs(world_of(plain), bdpt, kShort.of_reference()),
                  of_coated = render_runs(world_of(coated), bdpt, kShort.of_reference());
  EXPECT_FALSE(judge(render_runs(world_of(darker), bdpt, kShort), of_plain).holds());
  EXPECT_FALSE(judge(render_runs(world_of(bare), bdpt, kShort), of_coated).holds());
  EXPECT_FALSE(judge(render_runs(world_of(dull), bdpt, kShort), of_coated).holds());
}

// Light walks from a luminaire are sampled correctly, with a wrong density.
TEST(glossy_agreement_twin, densities_of_a_profile_two_fifths_too_large_are_caught) {
  const Scene scene = scene_of({.plastic_floor = true, .light = Light::luminaire});
  Scene faulty = scene;
  LightProfile profile = *scene.lights[0].profile;
  for (size_t r = 1; r < profile.words[0]; ++r) {
    uint32_t& word = profile.words[profile.words.size() - r];
    word = std::bit_cast<uint32_t>(std::bit_cast<float>(word) * 1.4f);
  }
  faulty.lights[0].profile = std::make_shared<LightProfile>(profile);
  const DepthRuns reference = render_runs(world_of(scene), nee, kShort.of_reference());
  EXPECT_TRUE(judge(render_runs(world_of(scene), bdpt, kShort), reference).holds());
  EXPECT_FALSE(judge(render_runs(world_of(faulty), bdpt, kShort), reference).holds());
}

}  // namespace tdpt::glossy_agreement_test
