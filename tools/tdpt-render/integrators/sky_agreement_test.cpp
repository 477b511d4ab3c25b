// All integrators render the same picture of rooms that a sky lights through windows, block by
// block and for every path length, wherever portals are: in the windows, beside them, in the room.
//
// The reference is bdpt without portals, since most of the sky's sampling depends on them.
#include <gtest/gtest.h>

#include "libcommon/testing/files/temp_folder.h"
#include "libcommon/testing/rooms/glossy_rooms.h"
#include "tools/tdpt-render/plan/candidates.h"
#include "tools/tdpt-render/testing/agreement.h"
#include "tools/tdpt-render/testing/faults.h"
#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/sheets.h"
#include "tools/tdpt-render/testing/sky.h"

namespace tdpt::sky_agreement_test {

using testing::GlossyRooms;
using Integrators = std::vector<const Integrator*>;

constexpr AgreementSettings kSettings{.max_depth = 6, .runs = 32, .spp = 8};
const Integrators kAll{&nee, &bdpt, &tdpt_org, &tdpt_ref, &tdpt_guided};
const Integrators kFew{&nee, &tdpt_ref, &tdpt_guided};

/// One room, x 0..2 m; the window at its end, y 0.5..1.5, z -0.5..0.5, x 2..2.1, is open.
Scene room(const GlossyRooms& what) {
  const testing::TempFolder folder;
  const Scene two = read_gltf(folder.write("rooms.glb", testing::glossy_rooms(what)));
  return without_lamps(open_end(two, 2.09));
}

/// Light going to -x; y and z extents.
Portal across(double y0, double y1, double z0, double z1, double x = 2.05) {
  return rectangle({x, y0, z0}, {0, 0, z1 - z0}, {0, y1 - y0, 0});
}
const Portal kWindow = across(0.5, 1.5, -0.5, 0.5);

std::vector<Portal> both_ways(std::vector<Portal> portals) {
  for (Portal& p : portals) p.both_ways = true;
  return portals;
}

class Room {
 public:
  explicit Room(Scene scene, std::shared_ptr<const Sky> sky,
                const AgreementSettings& settings = kSettings,
                const std::vector<Portal>& of_reference = {})
      : scene_(under(std::move(scene), std::move(sky))), settings_(settings) {
    const Vista vista(scene_, scene_.camera(""), 32, 24, of_reference);
    reference_ = render_runs(vista, bdpt, settings.of_reference());
    EXPECT_EQ(reference_.not_finite, 0u);
    EXPECT_GT(reference_.of_depth[0].mean(), 0);
  }

  bool agrees(const Vista& vista, const Variant& variant) const {
    const DepthRuns runs = render_runs(vista, variant, settings_);
    EXPECT_EQ(runs.not_finite, 0u);
    return judge(runs, reference_).holds();
  }
  void expect_agreement(const std::string& what, const std::vector<Portal>& portals,
                        const Integrators& all) const {
    const Vista vista(scene_, scene_.camera(""), 32, 24, portals);
    for (const Integrator* integrator : all) {
      const DepthRuns runs = render_runs(vista, *integrator, settings_);
      EXPECT_EQ(runs.not_finite, 0u);
      EXPECT_TRUE(holds(judge(runs, reference_), what + ", " + integrator->name, runs, reference_));
    }
  }
  /// Twin: segments that count twice.
  void expect_twice_to_be_caught(const std::vector<Portal>& portals) const {
    const Vista vista(scene_, scene_.camera(""), 32, 24, portals);
    EXPECT_FALSE(agrees(vista, Variant(tdpt_org, run_twice<Technique::portal>)));
  }
  const Scene& scene() const { return scene_; }

 private:
  Scene scene_;
  AgreementSettings settings_;
  DepthRuns reference_;
};

const Sky::Sun kSun = sun_of({1, 0.45, 0.2}, 0.25 * kDegree, 5);

TEST(sky_agreement, uneven_map) {
  const Room r(room({}), uneven_sky());
  r.expect_agreement("no portal", {}, {&pt});
  r.expect_agreement("in the window", both_ways({kWindow}), {&tdpt_org});
  r.expect_agreement("one behind another", {kWindow, across(0.2, 1.8, -0.9, 0.9, 1.2)},
                     {&nee, &tdpt_guided});
  r.expect_twice_to_be_caught({kWindow});
}

TEST(long_sky_agreement, sun_and_map_whatever_the_portals) {
  const Room r(room({}), uneven_sky({kSun}));
  for (const auto& [what, portals] : std::vector<std::pair<const char*, std::vector<Portal>>>{
           {"no portal", {}},
           {"in the window", {kWindow}},
           {"half of it", {across(0.5, 1.5, -0.5, 0)}},
           {"two halves", {across(0.5, 1.5, -0.5, 0), across(0.5, 1.5, 0, 0.5)}},
           {"larger than it", {across(0, 2, -0.9, 0.9)}},
           {"in the room", {rectangle({0.7, 0.3, -0.8}, {0.9, 0, 0.4}, {0, 1, 0})}},
           {"outside", {across(-1, 3, -2, 2, 2.6)}},
           {"tilted", {rectangle({1.8, 0.5, -0.5}, {0.2, 0, 1}, {0.25, 1, 0})}},
           {"both ways", both_ways({kWindow})}})
    r.expect_agreement(what, portals, kAll);
  const Vista vista(r.scene(), r.scene().camera(""), 32, 24, {kWindow});
  for (const Candidate& c : auto_candidates(vista)) EXPECT_TRUE(r.agrees(vista, c.integrator));
}

// The second is a triangle, half of the back wall, so its bounding rectangle is twice as large.
TEST(sky_agreement, two_windows) {
  const Scene scene =
      without(room({}), [](const Vec3d& p) { return p.z < -0.99 && p.y > p.x - 0.01; });
  const Portal triangle{"triangle", {{0, 0, -0.99}, {2, 2, -0.99}, {0, 2, -0.99}}, {{0, 1, 2}}, {}};
  const Room r(scene, uneven_sky({kSun}));
  r.expect_agreement("in both", {kWindow, triangle}, kFew);
  r.expect_twice_to_be_caught({kWindow, triangle});
}

// Sky and lamps together.
TEST(sky_agreement, lamps_and_sky) {
  Scene scene = room({});
  Material glow = scene.materials[0];
  glow.emission = Rgb(3);
  scene = with_sheet(scene, glow, {0.5, 1.98, -0.5}, {0.5, 0, 0}, {0, 0, 0.5});
  PunctualLight lamp;
  lamp.position = scene.frame.to_canonical({3, 1.5, 0.3});
  lamp.intensity = Rgb(0.5f);
  scene.lights.push_back(lamp);
  lamp.kind = PunctualLight::Kind::directional;
  lamp.direction = normalize(Vec3d(-1, -0.4, 0.3));
  lamp.intensity = Rgb(1);
  scene.lights.push_back(lamp);
  const Room r(scene, uneven_sky());
  r.expect_agreement("lamps and sky", {kWindow}, {&nee, &tdpt_guided});
  r.expect_twice_to_be_caught({kWindow});
}

TEST(sky_agreement, a_pane_in_the_window_and_a_veil_before_it) {
  Scene scene = with_sheet(room({}), clear_pane(), {2.05, 0.5, -0.5}, {0, 0, 1}, {0, 1, 0});
  scene = with_sheet(scene, veil(0.4f), {2.09, 0.5, -0.5}, {0, 0, 0.6}, {0, 1, 0});
  const Room r(scene, uneven_sky({kSun}));
  r.expect_agreement("on the pane", {kWindow}, {&nee, &tdpt_guided});
  r.expect_agreement("behind it", {across(0.5, 1.5, -0.5, 0.5, 2.02)}, {&tdpt_org});
  r.expect_twice_to_be_caught({kWindow});
}

// nee finds the bright patch by way of mirrors and glass only by chance.
TEST(sky_agreement, glossy_surfaces) {
  const Room r(room({.plastic_floor = true, .metal_walls = true, .smooth = true}), uneven_sky());
  r.expect_agreement("glossy", {kWindow}, {&nee, &tdpt_org});
}

// Walks that only Russian roulette ends, shared by samples, as in rendered pictures.
TEST(sky_agreement, whole_light) {
  AgreementSettings settings = kSettings;
  settings.max_depth = kMaxDepth;
  const Room r(room({}), uneven_sky({kSun}), settings);
  const Vista vista(r.scene(), r.scene().camera(""), 32, 24, {kWindow});
  for (const Integrator* integrator : kFew)
    EXPECT_TRUE(r.agrees(vista, Variant::cached(vista, *integrator, kMaxDepth)))
        << integrator->name;
  Variant twice = Variant::cached(vista, tdpt_org, kMaxDepth);
  twice.besides = [](PathSampler& sampler) { sampler.run(Technique::portal); };
  EXPECT_FALSE(r.agrees(vista, twice));
}

// Twins: densities that are 5 % too large.
TEST(sky_agreement_twin, a_sky_or_a_portal_off_by_5_percent_is_caught) {
  const AgreementSettings settings{.max_depth = 3, .runs = 64, .spp = 10};
  const std::vector<Portal> hole{across(0.75, 1.25, -0.25, 0.25)};
  const Room r(open_end(read_gltf(TDPT_TESTDATA "/scenes/half-metre-hole.glb"), 2.09),
               one_colour_sky(Rgb(1)), settings, hole);
  Vista vista(r.scene(), r.scene().camera(""), 32, 24, hole);
  for (const Integrator* integrator : {&nee, &tdpt_ref})
    EXPECT_TRUE(r.agrees(vista, *integrator)) << integrator->name;
  LightsFaults::scale_sky(vista.openings.selection, 1.05);
  for (const Integrator* integrator : {&nee, &bdpt})
    EXPECT_FALSE(r.agrees(vista, *integrator)) << integrator->name;
  LightsFaults::scale_sky(vista.openings.selection, 1 / 1.05);
  vista.openings.portals = PortalSetFaults::scaled(vista.openings.portals, 1.05);
  EXPECT_FALSE(r.agrees(vista, tdpt_ref));
}

}  // namespace tdpt::sky_agreement_test
