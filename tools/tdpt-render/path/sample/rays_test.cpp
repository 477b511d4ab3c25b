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
// Guided walks trace the same rays: a guided walk needs the crossing of each of its edges and
// already has it. It also needs edges from a lamp without surface. No segment ends there, so
// without guiding none of these is tested; with it a lamp's edges count as those of any other
// light: y_0 y_1, the (k-1) next events and y_0 x_l.
//
// A connection is not traced if a cosine or the film shows that it carries nothing. So the room is
// a ball of small facets that emit inwards, with a camera on its rim that sees nearly all of it: of
// many samples most make all connections, and none makes more. It is white, so that no walk ends
// early.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/variant.h"

namespace tdpt::rays_test {

// Lit by its walls, or by a lamp in it.
Scene ball(bool glowing) {
  constexpr int kAround = 48, kDown = 24;
  constexpr double kRadius = 0.9;
  Scene scene;
  Material glow;
  glow.base_color = Rgb(1);
  if (glowing) glow.emission = Rgb(1.0f);
  scene.materials.push_back(glow);
  if (!glowing) {
    PunctualLight lamp;
    lamp.position = {0.3, 0.11, 0.05};
    lamp.intensity = Rgb(1.0f);
    scene.lights.push_back(lamp);
  }
  for (int i = 0; i <= kDown; ++i)
    for (int j = 0; j < kAround; ++j) {
      const double t = std::numbers::pi * i / kDown, p = 2 * std::numbers::pi * j / kAround;
      const double s = i == 0 || i == kDown ? 0 : std::sin(t);
      scene.positions.push_back(
          Vec3f(Vec3d(s * std::cos(p), std::cos(t), s * std::sin(p)) * kRadius));
    }
  for (int i = 0; i < kDown; ++i)
    for (int j = 0; j < kAround; ++j) {
      const auto at = [&](int down, int around) {
        return static_cast<uint32_t>(down * kAround + around % kAround);
      };
      if (i > 0) scene.triangles.push_back({{at(i, j), at(i + 1, j), at(i, j + 1)}, 0});
      if (i < kDown - 1)
        scene.triangles.push_back({{at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)}, 0});
    }
  for (uint32_t t = 0; t < scene.triangles.size(); ++t) {  // fronts face inwards
    const TriangleShape shape = shape_of(scene, t);
    if (dot(shape.normal, shape.p0) > 0)
      std::swap(scene.triangles[t].vertex[1], scene.triangles[t].vertex[2]);
  }
  Camera camera;
  camera.position = {-0.85, 0.013, 0.007};
  camera.forward = {1, 0, 0};
  camera.up = {0, 1, 0};
  camera.right = {0, 0, 1};
  camera.yfov = 3.0;
  scene.cameras.push_back(camera);
  return scene;
}

struct Census {
  RayCounts most;       ///< largest numbers of any sample
  double complete = 0;  ///< share of samples that reach all three of `expected`
  uint64_t beyond = 0;  ///< samples that have more than expected of some kind
};

Census count(const Variant& variant, int k, const RayCounts& expected, bool glowing = true) {
  const Scene scene = ball(glowing);
  const Vista vista(scene, scene.camera(""), 16, 16,
                    {rectangle({0, -0.2, -0.2}, {0, 0, 0.4}, {0, 0.4, 0})});
  Film film(16, 16, 1);
  Census census;
  for (int i = 0; i < 512; ++i) {
    Tally tally;
    PathSampler sampler(vista, variant.settings(k, 3), film, tally);
    variant.sample(sampler, i % 16, i / 16 % 16, static_cast<uint64_t>(i));
    const RayCounts& r = tally.rays;
    census.most.closest = std::max(census.most.closest, r.closest);
    census.most.shadow = std::max(census.most.shadow, r.shadow);
    census.most.portal = std::max(census.most.portal, r.portal);
    census.most.connect = std::max(census.most.connect, r.connect);
    census.complete += (r.closest == expected.closest && r.shadow == expected.shadow &&
                        r.portal == expected.portal) /
                       512.0;
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
    EXPECT_EQ(table_1(tdpt_ref.mixture.techniques, k).portal, 3u * static_cast<uint64_t>(k) - 3 +
                                                                  (k == 3   ? 2
                                                                   : k == 4 ? 4
                                                                            : 5) +
                                                                  1);
    for (const Integrator* integrator : integrators()) {
      const RayCounts expected = table_1(integrator->mixture.techniques, k);
      const Census census = count(with_all_segments(*integrator), k, expected);
      EXPECT_EQ(census.most.closest, expected.closest) << integrator->name << " " << k;
      EXPECT_EQ(census.most.shadow, expected.shadow) << integrator->name << " " << k;
      EXPECT_EQ(census.most.portal, expected.portal) << integrator->name << " " << k;
      EXPECT_EQ(census.beyond, 0u) << integrator->name << " " << k;
      EXPECT_GT(census.complete, 0.5) << integrator->name << " " << k;
    }
  }
}

// Edges from a lamp without surface. For k <= 4, x_l is certainly connected with y_0.
uint64_t lamp_edges(TechniqueSet set, int depth) {
  const auto k = static_cast<uint64_t>(depth);
  if (!set.has(Technique::portal)) return 0;
  return (set.has(Technique::light) ? 1 : 0) + (set.has(Technique::direct) ? k - 1 : 0) + 1;
}

TEST(rays, of_directed_walks_are_tested_on_a_lamps_edges_too) {
  for (int k = 3; k <= 8; ++k)
    for (const Integrator* integrator : {&nee, &bdpt, &tdpt_org, &tdpt_ref, &tdpt_guided}) {
      RayCounts expected = table_1(integrator->mixture.techniques, k);
      const bool plain = integrator->mixture.guiding == Guiding{};
      if (plain) expected.portal -= lamp_edges(integrator->mixture.techniques, k);
      // If light begins only at y_0, a segment leaves room for one vertex less.
      if (integrator->mixture.has(Technique::portal)) {
        const auto n = static_cast<uint64_t>(k);
        expected.shadow -= few(3, n - 2) - few(3, n - 3);
        expected.portal -= few(3, n - 2) - few(3, n - 3);
      }
      const bool chosen = plain && k > 4 && integrator->mixture.has(Technique::portal);
      // One more edge if x_l is connected with others than y_0, which for short paths leaves the
      // camera's side one vertex less.
      if (chosen && k > 6) ++expected.portal;
      const Census census = count(with_all_segments(*integrator), k, expected, false);
      EXPECT_EQ(census.most.closest, expected.closest) << integrator->name << " " << k;
      EXPECT_EQ(census.most.shadow, expected.shadow) << integrator->name << " " << k;
      EXPECT_EQ(census.most.portal, expected.portal) << integrator->name << " " << k;
      EXPECT_EQ(census.beyond, 0u) << integrator->name << " " << k;
      EXPECT_GT(census.complete, chosen ? 0.0 : 0.4) << integrator->name << " " << k;
    }
}

// z_1 to z_6, each with y_1 to y_5 of a walk that is cached alone, even if some paths are too long;
// an end of a segment also with y_0, and the segment with z_1 to z_4.
TEST(rays, pairs_that_come_into_question_for_a_connect_are_counted) {
  EXPECT_EQ(count(nee, 6, {}).most.connect, 0u);
  EXPECT_EQ(count(bdpt, 6, {}).most.connect, 6u * 5);
  EXPECT_EQ(count(with_all_segments(tdpt_org), 6, {}).most.connect, 6u * 5 + 6 + 4);
}

TEST(rays, twin_a_directed_walk_beside_the_count_of_one_that_is_not) {
  const RayCounts expected = table_1(tdpt_org.mixture.techniques, 5);
  const RayCounts fewer{expected.closest, expected.shadow,
                        expected.portal - lamp_edges(tdpt_org.mixture.techniques, 5)};
  EXPECT_GT(count(with_all_segments(tdpt_guided), 5, fewer, false).beyond, 400u);
}

TEST(rays, twin_one_connection_more_or_one_technique_less_is_caught) {
  const RayCounts expected = table_1(tdpt_ref.mixture.techniques, 5);
  const Variant more{tdpt_ref.mixture.techniques, run_twice<Technique::direct>};
  EXPECT_GT(count(more, 5, expected).beyond, 400u);
  const Variant less{tdpt_ref.mixture.techniques,
                     run_only<Technique::camera, Technique::direct, Technique::portal>};
  EXPECT_EQ(count(less, 5, expected).complete, 0);
}

TEST(rays, twin_connections_with_all_are_not_those_with_few) {
  RayCounts expected = table_1(bdpt.mixture.techniques, 6);
  expected.shadow += 10 - 6;  // (k-1)(k-2)/2
  EXPECT_EQ(count(bdpt, 6, expected).complete, 0);
}

TEST(rays, twin_a_walk_of_one_edge_more_is_caught) {
  EXPECT_GT(count(tdpt_ref, 6, table_1(tdpt_ref.mixture.techniques, 5)).beyond, 500u);
}

}  // namespace tdpt::rays_test
