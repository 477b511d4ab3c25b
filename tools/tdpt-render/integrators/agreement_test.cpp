// All integrators render the same picture, block by block and for every path length 1..8. Twins: a
// technique that is wrong, or a density off by 5 %, is detected.
#include <gtest/gtest.h>

#include <map>

#include "tools/tdpt-render/testing/agreement.h"
#include "tools/tdpt-render/testing/faults.h"
#include "tools/tdpt-render/testing/rendering.h"
#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::agreement_test {

using Integrators = std::vector<const Integrator*>;

constexpr int kWidth = 32, kHeight = 24;

// Without pt, which finds a lamp only by chance: its variance is known only where that happens
// often.
const Integrators kButPt{&nee, &tdpt_org, &tdpt_ref, &tdpt_guided};

// Enough to detect a technique that counts twice.
constexpr AgreementSettings kGross{.runs = 32, .spp = 4};

// The furnace with only its ceiling emitting, and a portal across the room below it: every
// technique has a good part of the picture, and none is noisy.
class GlowingCeiling {
 public:
  Vista vista() const { return Vista(scene_, scene_.camera(""), kWidth, kHeight, {kPortal}); }

  /// Enough to detect 5 % of a portal's density.
  static constexpr AgreementSettings kSettings{.runs = 64, .spp = 7};

 private:
  const Portal kPortal = rectangle({-0.8, 0.9, -0.8}, {1.6, 0, 0}, {0, 0, 1.6});
  const Scene scene_ = below_a_glowing_ceiling();
};

TEST(agreement, glowing_ceiling) {
  const GlowingCeiling box;
  expect_agreement(box.vista(), {&pt, &tdpt_org, &tdpt_guided}, GlowingCeiling::kSettings);
}

TEST(agreement, glowing_ceiling_by_the_power_heuristic) {
  const GlowingCeiling box;
  expect_agreement(box.vista(), {&tdpt_ref, &tdpt_guided}, kGross, 2);
}

TEST(agreement, two_rooms_with_a_portal_in_the_hole) {
  const Scene scene = read_gltf(two_rooms_path());
  expect_agreement(Vista(scene, scene.camera(""), kWidth, kHeight, {portal_in_the_hole()}), kButPt,
                   kGross);
}

TEST(agreement, portals_that_cross_each_other) {
  const Scene scene = read_gltf(two_rooms_path());
  expect_agreement(Vista(scene, scene.camera(""), kWidth, kHeight, two_crossing_portals()),
                   {&tdpt_org, &tdpt_ref, &tdpt_guided}, kGross);
}

// nee finds too little light there to estimate its own error.
TEST(long_agreement, three_rooms_with_a_portal_in_each_hole) {
  const Scene scene = read_gltf(TDPT_TESTDATA "/scenes/three-rooms.glb");
  const auto hole = [](double x) { return rectangle({x, 0.75, -0.25}, {0, 0, 0.5}, {0, 0.5, 0}); };
  expect_agreement(Vista(scene, scene.camera(""), kWidth, kHeight, {hole(2.05), hole(4.15)}),
                   {&tdpt_org, &tdpt_ref, &tdpt_guided}, kGross);
}

TEST(long_agreement, lamp_behind_a_door_ajar) {
  const Scene scene = read_gltf(TDPT_TESTDATA "/scenes/door-ajar.glb");
  expect_agreement(Vista(scene, scene.camera(""), kWidth, kHeight,
                         {rectangle({2.05, 0.02, -0.4}, {0, 0, 0.8}, {0, 1.8, 0})}),
                   {&tdpt_org, &tdpt_ref, &tdpt_guided}, kGross);
}

// Lamps of different power, colour and albedo, some shining on both sides.
TEST(agreement, several_lamps) {
  Scene scene = read_gltf(TDPT_TESTDATA "/scenes/window.glb");
  Material strong = scene.materials[0], faint = scene.materials[0];
  strong.emission = {4, 2, 1};
  strong.double_sided = false;
  faint.emission = {0.02f, 0.05f, 0.1f};
  faint.double_sided = true;
  scene.materials.push_back(strong);
  scene.materials.push_back(faint);
  const auto materials = static_cast<uint32_t>(scene.materials.size());
  for (size_t i = 3; i < scene.triangles.size(); i += 5)
    scene.triangles[i].material = i % 2 ? materials - 1 : materials - 2;
  expect_agreement(Vista(scene, scene.camera(""), kWidth, kHeight,
                         {rectangle({2.05, 0.2, -0.8}, {0, 0, 1.6}, {0, 1.6, 0})}),
                   {&pt, &tdpt_ref, &tdpt_guided}, kGross);
}

// The lamp's power comes from a spot: splats are faint beside its radiance, and must be kept.
TEST(agreement, lamp_as_small_as_a_spot) {
  const Scene lamp = read_gltf(two_rooms_path());
  Scene spot = lamp;
  const double shrink = 1e-3;
  for (const Triangle& t : lamp.triangles) {
    if (max_component(lamp.materials[t.material].emission) <= 0) continue;
    for (uint32_t v : t.vertex) {
      const Vec3f middle(lamp.frame.to_canonical({3.1, 1.99, 0}));
      spot.positions[v] = middle + (lamp.positions[v] - middle) * static_cast<float>(shrink);
    }
  }
  for (Material& m : spot.materials) m.emission *= static_cast<float>(1 / (shrink * shrink));
  expect_agreement(Vista(spot, spot.camera(""), kWidth, kHeight, {portal_in_the_hole()}), kButPt,
                   kGross);
}

// What holds for each length in a run of depth 8 holds for every depth: connections are chosen
// among other vertices, but each length has the same light on average.
TEST(agreement, a_smaller_depth_has_the_same_light_of_its_lengths) {
  const GlowingCeiling box;
  const Vista vista = box.vista();
  const auto with_depth = [&](const Integrator& integrator, int depth) {
    AgreementSettings settings = kGross;
    settings.max_depth = depth;
    DepthRuns runs = render_runs(vista, Variant::cached(vista, integrator, depth), settings);
    runs.of_depth.resize(5);
    runs.of_depth.erase(runs.of_depth.begin());  // the sum of all is less light
    return runs;
  };
  for (const Integrator* integrator : {&bdpt, &tdpt_guided}) {
    const DepthRuns less = with_depth(*integrator, 4), more = with_depth(*integrator, 8);
    EXPECT_TRUE(holds(judge(less, more), integrator->name, less, more));
  }
  // Twin: the longest paths are taken for those of one depth more.
  DepthRuns less = with_depth(bdpt, 4), more = with_depth(bdpt, 8);
  less.of_depth.erase(less.of_depth.begin());
  more.of_depth.pop_back();
  EXPECT_FALSE(judge(less, more).holds());
}

// What holds for the observer's contributions and weights, of either exponent and any depth, holds
// for the rendered picture, whose samples share their light walks.
TEST(agreement, rendered_pictures_are_what_the_observer_sees) {
  const Scene scene = read_gltf(two_rooms_path());
  const Vista vista(scene, scene.camera(""), 40, 12, two_crossing_portals());
  const auto off = [&](const Variant& variant, int max_depth, double beta) {
    Tally tally;
    const auto by_depth =
        render_by_depth(vista, variant, {.max_depth = max_depth, .spp = 16}, 5, tally);
    Job settings;
    settings.limits.spp = 16;
    settings.max_depth = max_depth;
    settings.seed = 5;
    settings.beta = beta;
    const Picture picture =
        render(vista, *find_integrator(variant.integrator.name), settings).picture;
    double worst = 0, brightest = 0;
    for (size_t i = 0; i < picture.pixels.size(); ++i) {
      double sum = 0;
      for (const std::vector<double>& depth : by_depth) sum += depth[i];
      worst = std::max(worst, std::abs(luminance(picture.pixels[i]) - sum));
      brightest = std::max(brightest, sum);
    }
    return worst / std::max(brightest, 1e-30);
  };
  for (const Integrator* integrator : integrators())
    for (const int depth : {3, kMaxDepth}) {
      Variant power = Variant::cached(vista, *integrator, depth);
      power.beta.fill(2);
      EXPECT_LE(off(power, depth, 2), 2e-6) << integrator->name;
      if (integrator != &pt) {
        EXPECT_GT(off(power, depth, 1), 1e-4) << integrator->name;  // twin
      }
    }
}

// Twins: room, portal and samples as in glowing_ceiling.

class agreement_twin : public ::testing::Test {
 protected:
  void expect_caught(const char* what, const Variant& faulty,
                     const AgreementSettings& settings = kGross) {
    expect_caught(what, faulty, vista_, settings);
  }
  void expect_caught(const char* what, const Variant& faulty, const Vista& vista,
                     const AgreementSettings& settings) {
    EXPECT_FALSE(judge(render_runs(vista, faulty, settings), reference(settings)).holds()) << what;
  }
  const DepthRuns& reference(const AgreementSettings& settings) {
    DepthRuns& runs = references_[settings.spp];
    if (runs.of_depth.empty()) runs = render_runs(vista_, bdpt, settings.of_reference());
    return runs;
  }

  const GlowingCeiling box_;
  const Vista vista_ = box_.vista();

 private:
  std::map<uint64_t, DepthRuns> references_;
};

/// tdpt_org's techniques, each run so many times per twenty samples.
template <int Camera, int Direct, int Light, int Bi, int Portal>
void run(PathSampler& sample) {
  thread_local int count = 0;
  const int now = count++ % 20;
  const auto times = [&](int per_20) { return per_20 / 20 + (now < per_20 % 20 ? 1 : 0); };
  sample.walk_from_camera();
  sample.walk_from_light();
  for (int i = 0; i < times(Camera); ++i) sample.camera();
  for (int i = 0; i < times(Direct); ++i) sample.direct();
  for (int i = 0; i < times(Light); ++i) sample.light();
  for (int i = 0; i < times(Bi); ++i) sample.bi();
  for (int i = 0; i < times(Portal); ++i) sample.portal();
}

Variant as_org(void (*run)(PathSampler&)) {
  return {tdpt_org.mixture.techniques, run};
}
Variant as_ref(void (*run)(PathSampler&)) {
  return {tdpt_ref.mixture.techniques, run};
}

TEST_F(agreement_twin, what_is_run_or_weighed_otherwise) {
  const DepthRuns runs = render_runs(vista_, as_org(run<20, 20, 20, 20, 20>), kGross);
  EXPECT_TRUE(holds(judge(runs, reference(kGross)), "control", runs, reference(kGross)));
  expect_caught("camera missing", as_org(run<0, 20, 20, 20, 20>));
  expect_caught("direct missing", as_org(run<20, 0, 20, 20, 20>));
  expect_caught("light missing", as_org(run<20, 20, 0, 20, 20>));
  expect_caught("bi missing", as_org(run<20, 20, 20, 0, 20>));
  expect_caught("portal missing", as_org(run<20, 20, 20, 20, 0>));
  expect_caught("direct twice", as_org(run<20, 40, 20, 20, 20>));
  expect_caught("portal twice", as_org(run<20, 20, 20, 20, 40>));
  Variant light(tdpt_ref), camera(tdpt_guided);
  light.beta[static_cast<size_t>(Technique::light)] = 2;
  camera.beta[static_cast<size_t>(Technique::camera)] = 2;
  expect_caught("light with exponent 2", light);
  expect_caught("camera with exponent 2", camera);
}

TEST_F(agreement_twin, what_is_off_by_5_percent) {
  constexpr AgreementSettings kFine = GlowingCeiling::kSettings;
  expect_caught("direct 5 % too dark", as_ref(run<20, 19, 20, 0, 20>), kFine);
  expect_caught("light 5 % too dark", as_ref(run<20, 20, 19, 0, 20>), kFine);
  expect_caught("bi 5 % too dark", as_org(run<20, 20, 20, 19, 20>), kFine);
  // In a quarter of the samples.
  expect_caught("segments twice", {tdpt_guided, run_twice<Technique::portal>}, kFine);
  Vista vista = box_.vista();
  vista.openings.portals = PortalSetFaults::scaled(vista.openings.portals, 1.05);
  expect_caught("portal density x 1.05", tdpt_ref, vista, kFine);
}

}  // namespace tdpt::agreement_test
