// A sample traces at most the rays of the paper's Table 1, for paths of up to k edges, except that
// a vertex is connected with only a few others [light_vertex_cache.h]:
//
//   light walk     (k-1) c_I + (k-1) c_V          edges; y_1..y_{k-1} are splatted (the paper's
//                                                  prose says up to y_{k-2}, which is k-2 of them)
//   camera walk     k c_I    + (k-1) c_V          edges; next events from z_1..z_{k-1}
//   bi-connections   B c_V                        z_j with a few of y_1..y_{k-1-j}: at most 2,
//                                                  and 1 from z_3 on
//   tri-connection  2 c_I    + (1+S+C) c_V        x_l, x_c; x_l to S of y_0..y_{k-3}, x_c to z_0
//                                                  and C of z_1..z_{k-2}; S <= 2, C <= 3
//
// instead of (k-1)(k-2)/2 and 2k-3. c_P, tests of an edge against the portals, for the whole
// sample:
//   (k-1) + (k-1) edges of both walks (the camera's own edge z_0 z_1 never counts),
//   (k-1) next-event edges, S edges of x_l, C edges of x_c.
// We test one more edge: the segment itself. It crosses the polygon it was drawn from, but its
// density is a sum over all that it crosses. With bi-connections their edges are tested as well.
//
// A connection is not traced if a cosine or the film shows that it carries nothing. So the room is
// convex and emits everywhere, with a camera near a wall that sees nearly all of it: of many
// samples some make all connections, and none makes more. It is white, so that no walk ends early.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/sheets.h"
#include "tools/tdpt-render/testing/variant.h"

namespace tdpt::rays_test {

Scene glowing_box() {
  Material glow;
  glow.base_color = Rgb(1);
  glow.emission = Rgb(1.0f);
  Scene scene;
  const Vec3d axes[] = {{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}, low(-1);
  for (size_t i = 0; i < 3; ++i) {  // fronts face inwards
    const Vec3d &u = axes[(i + 1) % 3], &v = axes[(i + 2) % 3];
    scene = with_sheet(scene, glow, low, u, v);
    scene = with_sheet(scene, glow, low + axes[i], v, u);
  }
  Camera camera;
  camera.position = {-0.98, 0.013, 0.007};
  camera.forward = {1, 0, 0};
  camera.up = {0, 1, 0};
  camera.right = {0, 0, 1};
  camera.yfov = 3.0;
  scene.cameras.push_back(camera);
  return scene;
}

constexpr int kSamples = 2048;

struct Census {
  RayCounts most;       ///< largest numbers of any sample
  double complete = 0;  ///< share of samples that reach all three of `expected`
  uint64_t beyond = 0;  ///< samples that have more than expected of some kind
};

Census count(const Variant& variant, int k, const RayCounts& expected) {
  static const Scene scene = glowing_box();
  const Vista vista(scene, scene.camera(""), 16, 16,
                    {rectangle({0, -0.2, -0.2}, {0, 0, 0.4}, {0, 0.4, 0})});
  Film film(16, 16, 1);
  Census census;
  for (int i = 0; i < kSamples; ++i) {
    Tally tally;
    PathSampler sampler(vista, variant.settings(k, 3), film, tally);
    variant.sample(sampler, i % 16, i / 16 % 16, static_cast<uint64_t>(i));
    const RayCounts& r = tally.rays;
    census.most.closest = std::max(census.most.closest, r.closest);
    census.most.shadow = std::max(census.most.shadow, r.shadow);
    census.most.portal = std::max(census.most.portal, r.portal);
    census.complete += (r.closest == expected.closest && r.shadow == expected.shadow &&
                        r.portal == expected.portal) /
                       double{kSamples};
    census.beyond +=
        r.closest > expected.closest || r.shadow > expected.shadow || r.portal > expected.portal;
  }
  return census;
}

/// Number of connections of z_j, or of an end of a segment, with `n` others.
uint64_t few(uint64_t most, uint64_t n) {
  return std::min(most, n);
}

/// An integrator that draws a segment in each sample.
Integrator with_all_segments(Integrator integrator) {
  integrator.mixture.segments = 1;
  return integrator;
}

/// Table 1 for one sample.
RayCounts table_1(TechniqueSet set, int depth) {
  const auto k = static_cast<uint64_t>(depth);
  const bool light = set.has(Technique::light), direct = set.has(Technique::direct);
  RayCounts r{k, direct ? k - 1 : 0, k - 1 + (direct ? k - 1 : 0)};
  if (light) r.closest += k - 1, r.shadow += k - 1, r.portal += k - 1;
  if (set.has(Technique::bi))
    for (uint64_t j = 1; j + 2 <= k; ++j) {
      const uint64_t connections = few(j < 3 ? 2 : 1, k - 1 - j);
      r.shadow += connections;
      r.portal += connections;
    }
  if (set.has(Technique::portal)) {
    r.closest += 2;
    r.shadow += 1 + few(2, k - 2) + few(3, k - 2);
    r.portal += few(2, k - 2) + few(3, k - 2) + 1;
  } else {
    r.portal = 0;  // integrators that have no use for portals do not test them
  }
  return r;
}

TEST(rays, are_those_of_table_1) {
  for (int k = 3; k <= 8; ++k) {
    for (const Integrator* integrator : integrators()) {
      const RayCounts expected = table_1(integrator->mixture.techniques, k);
      const Census census = count(with_all_segments(*integrator), k, expected);
      EXPECT_EQ(census.most.closest, expected.closest) << integrator->name << " " << k;
      EXPECT_EQ(census.most.shadow, expected.shadow) << integrator->name << " " << k;
      EXPECT_EQ(census.most.portal, expected.portal) << integrator->name << " " << k;
      EXPECT_EQ(census.beyond, 0u) << integrator->name << " " << k;
      EXPECT_GT(census.complete, 0) << integrator->name << " " << k;
    }
  }
}

TEST(rays, twins_are_caught) {
  const RayCounts expected = table_1(tdpt_ref.mixture.techniques, 5);
  const Variant more{tdpt_ref.mixture.techniques, run_twice<Technique::direct>};
  EXPECT_GT(count(more, 5, expected).beyond, 400u);
  const Variant less{tdpt_ref.mixture.techniques,
                     run_only<Technique::camera, Technique::direct, Technique::portal>};
  EXPECT_EQ(count(less, 5, expected).complete, 0);
  // Connections with all, (k-1)(k-2)/2.
  RayCounts with_all = table_1(bdpt.mixture.techniques, 6);
  with_all.shadow += 10 - 6;
  EXPECT_EQ(count(bdpt, 6, with_all).complete, 0);
  // Walks of one edge more.
  EXPECT_GT(count(tdpt_ref, 6, expected).beyond, 500u);
}

}  // namespace tdpt::rays_test
