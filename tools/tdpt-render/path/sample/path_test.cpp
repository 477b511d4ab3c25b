// Compares every path of every technique with the oracle: its MIS weight, and that its unweighted
// value is the measurement contribution divided by the density of its strategy.
#include <gtest/gtest.h>

#include <set>

#include "tools/tdpt-render/testing/blur.h"
#include "tools/tdpt-render/testing/known_paths.h"

namespace tdpt::path_test {

using oracle::Fault;

class paths : public testing::TestWithParam<const Integrator*> {};

TEST_P(paths, weights_and_values_are_the_oracles) {
  const Worst worst = compare(diffuse_rooms(), *GetParam(), Fault::none);
  EXPECT_LT(worst.weight, 1e-6);  // rounding to floats moves hit points off the sampled rays
  EXPECT_LT(worst.power, 2e-6);
  EXPECT_LT(worst.value, 1e-4);  // values are floats
  if (GetParam() != &pt) {       // it has one technique, so its weights have no exponent
    EXPECT_GT(worst.power_1_9, 2e-4);
  }
  for (size_t i = 0; i < kTechniques; ++i) {
    if (GetParam()->mixture.has(static_cast<Technique>(i))) {
      EXPECT_GT(worst.paths[i], i == 0 ? 0 : 50) << kTechniqueNames[i];
    }
  }
}

TEST_P(paths, over_glossy_surfaces_too) {
  const Worst worst = compare(glossy_rooms(), *GetParam(), Fault::none, 6, 96);
  EXPECT_LT(worst.weight, 1e-4);
  EXPECT_LT(worst.power, 2e-4);
  EXPECT_LE(worst.off, 2);
  EXPECT_LE(worst.short_ones, 5);
  EXPECT_GT(worst.dirac, 10);
  if (GetParam() != &pt) {
    EXPECT_GT(worst.lamps, 100);
  }
}

TEST_P(paths, over_coats_that_lean_too) {
  const Worst worst = compare(coated_rooms(), *GetParam(), Fault::none, 6, 96);
  EXPECT_LE(worst.off, 5);  // cosines of 0.001, which rounding of positions changes
  EXPECT_GT(worst.all, GetParam() == &pt ? 30 : 3000);
  EXPECT_GT(worst.dirac, 10);
}

TEST_P(paths, of_a_wide_lens_that_moves_too) {
  const Scene scene = diffuse_rooms();
  const auto compared = [&](Fault fault) {
    return compare(scene, *GetParam(), fault, 6, 64, two_crossing_portals(),
                   strong_blur(scene.camera("")));
  };
  const Worst worst = compared(Fault::none);
  EXPECT_LT(worst.weight, 1e-6);
  EXPECT_LT(worst.power, 2e-6);
  EXPECT_LT(worst.value, 1e-4);
  if (GetParam()->mixture.has(Technique::light)) {
    EXPECT_GT(worst.paths[static_cast<size_t>(Technique::light)], 50);
    EXPECT_GT(compared(Fault::film_of_the_middle).off, worst.all / 100);
  }
}

TEST_P(paths, weights_of_all_strategies_sum_to_1) {
  const Scene scene = read_gltf(two_rooms_path());
  const Vista vista(scene, scene.camera(""), 16, 12, two_crossing_portals());
  Film film(16, 12, 1);
  Tally tally;
  const Mixture& set = GetParam()->mixture;
  int crossing = 0;
  const PathObserver observer = [&](const Contribution& found) {
    const Path& path = found.path;
    const auto weight = [&](Technique technique, int split) {
      const double w = path.weight(set, {technique, split}, 1);
      return std::isnan(w) ? 0 : w;  // no density
    };
    double sum = weight(Technique::camera, 0);
    if (path.k() >= 2) {
      sum += weight(Technique::direct, 1);
      sum += weight(Technique::light, path.k());
      for (int s = 2; s < path.k(); ++s) sum += weight(Technique::bi, s);
      int portals = 0;
      for (int a = 0; a <= path.k() - 2; ++a) {
        const double w = weight(Technique::portal, a);
        portals += w > 0;
        sum += w;
      }
      crossing += portals > 1;
    }
    EXPECT_NEAR(sum, 1, 1e-12);
  };
  const Variant variant(*GetParam());
  PathSampler sampler(vista, variant.settings(6, 5), film, tally, &observer);
  for (uint64_t s = 0; s < 2000; ++s) variant.sample(sampler, 8, 6, s);
  if (set.has(Technique::portal)) {
    EXPECT_GT(crossing, 0);  // some paths cross twice
  }
}

// The hole's portal is one-way; two across the camera's room make pairs in both directions.
TEST_P(paths, through_portals_for_both_ways_are_the_oracles) {
  std::vector<Portal> portals = two_crossing_portals();
  portals.push_back(rectangle({0.6, 0.2, -0.9}, {0, 0, 1.8}, {0, 1.6, 0}));
  portals[1].both_ways = portals[2].both_ways = true;
  const Scene scene = diffuse_rooms();
  ASSERT_EQ(PortalSet(portals, scene.frame).facets(), 5u);
  ASSERT_GT(PortalSet(portals, scene.frame).pairs(), 2u);
  const Worst worst = compare(scene, *GetParam(), Fault::none, 6, 96, portals);
  EXPECT_LT(worst.weight, 1e-6);
  EXPECT_LT(worst.value, 1e-4);
  if (GetParam()->mixture.has(Technique::portal)) {
    EXPECT_GT(worst.paths[static_cast<size_t>(Technique::portal)], 300);
    const Worst faulty = compare(scene, *GetParam(), Fault::one_way_5_percent, 6, 4, portals);
    EXPECT_GT(faulty.weight, 1e-3);
    EXPECT_GT(faulty.value, 0.04);
  }
}

INSTANTIATE_TEST_SUITE_P(integrators, paths, testing::ValuesIn(integrators()),
                         [](const auto& integrator) {
                           std::string name = integrator.param->name;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// Guiding probabilities other than the integrator's. A ray aimed at a portal's border may miss it
// by rounding: the walk knows that it aimed there, the oracle does not.
TEST(paths_guided, of_any_probability_are_the_oracles) {
  std::set<std::tuple<double, double, double, bool>> combinations;
  const Scene diffuse = diffuse_rooms(), glossy = glossy_rooms();
  for (const Guiding& guiding : {Guiding{{0.9, 0.9}}, Guiding{{0.2, 0}}, Guiding{{0, 0.7}}})
    for (const double segments : {1.0, 0.3})
      for (const Scene* scene : {&diffuse, &glossy}) {
        Integrator integrator = tdpt_guided;
        integrator.mixture.guiding = guiding;
        integrator.mixture.segments = segments;
        const Worst worst = compare(*scene, integrator, Fault::none);
        EXPECT_GT(worst.all, 3000);
        EXPECT_LE(worst.off, 3);
        EXPECT_GT(worst.paths[static_cast<size_t>(Technique::portal)], 100);
        const Mixture& m = integrator.mixture;
        combinations.insert(
            {m.guiding.chance[0], m.guiding.chance[1], m.segments, scene == &glossy});
      }
  EXPECT_EQ(combinations.size(), 3u * 2 * 2);
}

TEST(paths_under_other_mixtures, weigh_as_the_oracle_says) {
  Mixture often = tdpt_guided.mixture, seldom = tdpt_guided.mixture, connected = tdpt_org.mixture;
  often.guiding = {{0.9, 0.8}};
  seldom.guiding = {{0.3, 0}};
  seldom.segments = 0.25;
  connected.connected = often.connected = 2.5;
  connected.connected_to_segments = often.connected_to_segments = 1.7;
  connected.segments_connected = often.segments_connected = 16;
  seldom.light_walks = 0.125;
  for (const Scene& scene : {diffuse_rooms(), glossy_rooms()})
    for (const Integrator* made : {&tdpt_org, &tdpt_guided})
      for (const Mixture& asked :
           {nee.mixture, bdpt.mixture, tdpt_org.mixture, connected, often, seldom}) {
        // Edges so short that rounding turns them, as above.
        EXPECT_LE(weighed_as_others(scene, *made, asked, asked), 3) << made->name;
        // Twin: guided a little more often than asked.
        Mixture told = asked;
        if (told.guiding == Guiding{}) continue;
        told.guiding.chance[0] += 0.05;
        EXPECT_GT(weighed_as_others(scene, *made, asked, told), 100) << made->name;
      }
  // Twins: connected a little more often than asked.
  Mixture told = connected;
  told.connected *= 1.05;
  EXPECT_GT(weighed_as_others(diffuse_rooms(), tdpt_org, connected, told), 100);
  told = connected;
  told.connected_to_segments *= 1.05;
  EXPECT_GT(weighed_as_others(diffuse_rooms(), tdpt_org, connected, told), 100);
  told = connected;
  told.segments_connected *= 1.05;
  EXPECT_GT(weighed_as_others(diffuse_rooms(), tdpt_org, connected, told), 100);
  told = connected;
  told.light_walks = 0.95;
  EXPECT_GT(weighed_as_others(diffuse_rooms(), tdpt_org, connected, told), 100);
}

TEST(path_twin, a_portal_density_off_is_caught_where_a_share_of_the_samples_draws_segments) {
  for (const Scene& scene : {diffuse_rooms(), glossy_rooms()}) {
    Integrator integrator = tdpt_guided;
    integrator.mixture.segments = 0.3;
    EXPECT_GT(compare(scene, integrator, Fault::portal_density_5_percent).weight, 1e-3);
  }
}

// Smooth plastic whose bent normals reflect into the surface at some z_1: a walk that chooses the
// mirror lobe there ends, guided or not. Compares what guided and plain walks carry from there
// through portals [standard errors]; `fault`: factor of the former.
double carried_by_directed_walks(double fault) {
  Scene scene = diffuse_rooms();
  Material plastic;
  plastic.plain = false;
  plastic.specular = 1, plastic.specular_color = Rgb(12), plastic.roughness = 0;
  scene.materials.push_back(plastic);
  scene.smooth.assign(scene.triangles.size(), 1);
  scene.normals.resize(scene.positions.size());
  for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
    scene.triangles[t].material = static_cast<uint32_t>(scene.materials.size() - 1);
    for (uint32_t v : scene.triangles[t].vertex)
      scene.normals[v] = Vec3f(normalize(shape_of(scene, t).normal + Vec3d(0.7, 0.35, -0.35)));
  }
  const Vista vista(scene, scene.camera(""), 16, 12, two_crossing_portals());
  constexpr int kWalks = 800000;
  double mean[2] = {}, variance = 0;
  for (size_t directed : {0, 1}) {
    const Guide guide(vista,
                      directed ? Mixture{kThreeWays, 1, 1, 1, {{0.9, 0.9}}} : tdpt_org.mixture);
    double sum = 0, squares = 0;
    Walk walk;
    RayCounts rays;
    for (int i = 0; i < kWalks; ++i) {
      Rng rng(3, directed, static_cast<uint64_t>(i));
      const double x = 16 * rng.uniform(), y = 12 * rng.uniform();
      walk_from_camera(vista, guide, vista.view.film, x, y, 2,
                       Sequence(4, directed, static_cast<uint64_t>(i), 0), walk, rays);
      if (walk.size < 3 || !(walk.state(2).crossing.density > 0)) continue;
      const Vertex& z1 = walk[1];
      const Vec3d back = between(z1, walk[0]).w;
      const Vec3d mirrored = z1.shading * (2 * dot(z1.shading, back)) - back;
      if (same_side(z1, mirrored, back)) continue;
      const double carried = luminance(walk.state(2).throughput) * (directed ? fault : 1);
      sum += carried;
      squares += carried * carried;
    }
    mean[directed] = sum / kWalks;
    variance += (squares / kWalks - mean[directed] * mean[directed]) / kWalks;
  }
  return std::abs(mean[1] - mean[0]) / std::sqrt(variance);
}
TEST(paths_guided, carry_no_more_where_a_mirrored_direction_lies_in_the_surface) {
  EXPECT_LT(carried_by_directed_walks(1), 4);
}
TEST(path_twin, directed_walks_that_carry_twice_as_much_are_caught) {
  EXPECT_GT(carried_by_directed_walks(2), 8);
}

TEST(mixtures, weigh_next_events_and_count_connections_and_the_share_of_segments) {
  Mixture less = tdpt_guided.mixture;
  EXPECT_EQ(less.segments, 0.25);
  EXPECT_EQ(less.sample_weight(Technique::portal, 2, 4), 0.25);
  EXPECT_EQ(less.sample_weight(Technique::direct, 1, 2), 6);
  EXPECT_EQ(less.sample_weight(Technique::direct, 1, 3), 2);
  EXPECT_EQ(less.sample_weight(Technique::bi, 2, 3), 1);
  EXPECT_EQ(tdpt_org.mixture.sample_weight(Technique::direct, 1, 2), 1);
  EXPECT_EQ(tdpt_org.mixture.sample_weight(Technique::portal, 0, 2), 1);
  less.connected = 2.5, less.connected_to_segments = 1.5;
  EXPECT_EQ(less.sample_weight(Technique::bi, 2, 3), 2.5);
  EXPECT_EQ(less.sample_weight(Technique::light, 3, 3), 0.25);
  EXPECT_EQ(bdpt.mixture.sample_weight(Technique::light, 3, 3), 1);
  EXPECT_EQ(less.sample_weight(Technique::camera, 0, 3), 1);
  EXPECT_EQ(less.sample_weight(Technique::portal, 0, 4), 0.25);  // light that begins at x_l
  EXPECT_EQ(less.sample_weight(Technique::portal, 1, 4), 0.375);
  less.segments_connected = 3;
  EXPECT_EQ(less.sample_weight(Technique::portal, 0, 4), 0.75);
  EXPECT_EQ(less.sample_weight(Technique::portal, 1, 4), 1.125);
  EXPECT_EQ(less.sample_weight(Technique::portal, 2, 4), 0.375);  // the camera sees x_c
  EXPECT_EQ(less.sample_weight(Technique::portal, 0, 2), 0.25);
}

TEST(path_twin, a_portal_density_off_by_5_percent_is_caught) {
  const Worst worst = compare(diffuse_rooms(), tdpt_ref, Fault::portal_density_5_percent);
  EXPECT_GT(worst.weight, 1e-3);
  EXPECT_GT(worst.value, 0.04);
}

TEST(path_twin, a_portal_whose_surround_is_forgotten_is_caught) {
  const Worst worst = compare(diffuse_rooms(), tdpt_ref, Fault::no_surround);
  EXPECT_GT(worst.weight, 0.03);
  EXPECT_GT(worst.value, 0.02);
}

TEST(path_twin, an_aim_off_by_5_percent_is_caught) {
  for (const Scene& scene : {diffuse_rooms(), glossy_rooms(), coated_rooms()}) {
    const Worst worst = compare(scene, tdpt_guided, Fault::guide_5_percent);
    EXPECT_GT(worst.weight, 1e-3);
    EXPECT_GT(worst.value, 0.04);
  }
}

TEST(path_twin, a_dropped_cosine_is_caught) {
  const Worst worst = compare(diffuse_rooms(), bdpt, Fault::missing_cosine);
  EXPECT_GT(worst.weight, 1e-3);
  EXPECT_GT(worst.value, 0.04);
}

TEST(path_twin, a_connection_weighed_at_a_mirror_is_caught) {
  EXPECT_GT(compare(glossy_rooms(), bdpt, Fault::connection_at_a_mirror).weight, 1e-2);
}

Scene bright(Scene scene) {
  for (Material& m : scene.materials) m.base_color = Rgb(0.8f);
  return scene;
}

// Of any length that Russian roulette allows.
TEST(paths_deep, of_walks_without_limit_are_the_oracles) {
  const Scene scene = bright(diffuse_rooms());
  for (const Integrator* integrator : integrators()) {
    const Worst worst = compare(scene, *integrator, Fault::none, kMaxDepth, 32);
    if (integrator == &tdpt_guided) {
      EXPECT_LE(worst.off, 4);  // rays that miss a portal's border, as above
    } else {
      EXPECT_LT(worst.weight, 1e-6) << integrator->name;
      EXPECT_LT(worst.power, 2e-6) << integrator->name;
      EXPECT_LT(worst.value, 1e-3) << integrator->name;  // a float's rounding at every vertex
    }
    if (integrator == &pt) continue;
    EXPECT_GT(worst.deep, 100) << integrator->name;
    EXPECT_GT(worst.longest, 20) << integrator->name;
  }
}

TEST(paths_deep, over_glossy_surfaces_too) {
  for (const Integrator* integrator : {&bdpt, &tdpt_guided}) {
    const Worst worst = compare(bright(glossy_rooms()), *integrator, Fault::none, kMaxDepth, 32);
    EXPECT_LE(worst.off, 3) << integrator->name;
    EXPECT_GT(worst.deep, 20) << integrator->name;
  }
}

TEST(path_twin, walks_that_are_thought_immortal_are_caught) {
  for (const Scene& scene : {diffuse_rooms(), bright(diffuse_rooms()), glossy_rooms()})
    for (const Integrator* integrator : {&nee, &bdpt, &tdpt_ref, &tdpt_guided}) {
      const Worst worst = compare(scene, *integrator, Fault::immortal, 12, 16);
      EXPECT_GT(worst.weight, 0.003) << integrator->name;
      EXPECT_GT(worst.value, 0.1) << integrator->name;
    }
}

// Cached vertices are connected more or less often than once for each of a walk.
TEST(paths_connected, any_number_of_times_are_the_oracles) {
  for (const Integrator* row : {&bdpt, &tdpt_org, &tdpt_ref, &tdpt_guided})
    for (const auto& [connected, to_segments] : {std::pair{2.5, 1.7}, {0.6, 0.4}})
      for (const int depth : {6, kMaxDepth}) {
        Integrator integrator = *row;
        integrator.mixture.connected = connected;
        integrator.mixture.connected_to_segments = to_segments;
        integrator.mixture.segments_connected = 6 * connected;
        const Worst worst = compare(diffuse_rooms(), integrator, Fault::none, depth);
        EXPECT_LT(worst.weight, 1e-6) << integrator.name;
        EXPECT_LT(worst.power, 2e-6) << integrator.name;
        EXPECT_LT(worst.value, 1e-4) << integrator.name;
      }
}

// Connections that the weights do not know of: their light must not vanish silently.
TEST(paths_skipped, samples_of_a_strategy_without_density_are_counted) {
  const Scene scene = diffuse_rooms();
  const Vista vista(scene, scene.camera(""), 16, 12, two_crossing_portals());
  const auto not_finite = [&](const Variant& variant) {
    Film film(16, 12, 1);
    Tally tally;
    PathSampler sampler(vista, variant.settings(6, 5), film, tally);
    for (uint64_t s = 0; s < 1000; ++s) variant.sample(sampler, 8, 6, s);
    return tally.not_finite;
  };
  EXPECT_EQ(not_finite(tdpt_ref), 0u);
  EXPECT_EQ(not_finite(tdpt_org), 0u);
  EXPECT_GT(not_finite({tdpt_ref, run_twice<Technique::bi>}), 10u);
}

// G is unbounded in the corners of a box. Nothing is clamped: the weights keep it down.
TEST(connections, at_tiny_distances_are_bounded_by_their_weights) {
  const Scene scene = read_gltf(furnace_path());
  const Vista vista(scene, scene.camera(""), 16, 12, {portal_in_the_furnace()});
  for (const Integrator* integrator : {&bdpt, &tdpt_org, &tdpt_ref}) {
    Film film(16, 12, 1);
    Tally tally;
    double weighted = 0, plain = 0;
    const Variant variant = Variant::cached(vista, *integrator, 6);
    const PathObserver observer = [&](const Contribution& found) {
      const auto& [path, strategy, value, times] = found;
      const double w = path.weight(variant.integrator.mixture, strategy, 1);
      plain = std::max(plain, double{value.x});
      // Splats are per film, not per pixel.
      if (strategy.split < path.k() && path.k() - strategy.split > 2)
        weighted = std::max(weighted, w * value.x);
    };
    PathSampler sampler(vista, variant.settings(6, 3), film, tally, &observer);
    variant.picture(sampler, 16, 12, 512, [](int, int) {});
    EXPECT_LT(weighted, 2) << integrator->name;  // the radiance in the box
    EXPECT_GT(plain, 20) << integrator->name;    // twin: without the weights
    EXPECT_EQ(tally.not_finite, 0u);
  }
}

TEST(transmittance, inside_a_solid_is_that_of_its_length_and_1_towards_the_sun) {
  Material glass;
  glass.solid = true;
  glass.absorption = Rgb(0.5f, 1, 2);
  Vertex a, b, sun;
  a.material = b.material = &glass;
  a.normal = {0, 0, -1};  // the inside is above a
  b.position = {0, 0, 3};
  b.normal = {0, 0, 1};
  EXPECT_NEAR(transmittance(a, b, {0, 0, 1}, 3).x, std::exp(-1.5f), 1e-6f);
  EXPECT_NEAR(transmittance(a, b, {0, 0, 1}, 3).z, std::exp(-6.0f), 1e-6f);
  EXPECT_EQ(transmittance(a, b, {0, 0, -1}, 3).x, 1);  // outside
  PunctualLight parallel;
  parallel.kind = PunctualLight::Kind::directional;
  const LightSource source = LightSource::punctual(parallel, 1);
  sun.source = &source;
  EXPECT_EQ(transmittance(a, sun, {0, 0, 1}, 1).x, 1);
}

}  // namespace tdpt::path_test
