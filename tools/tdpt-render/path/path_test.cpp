// Every path that any technique makes is held against the oracle: its MIS weight, and that its
// unweighted value is the measurement contribution divided by the density of its strategy.
#include <gtest/gtest.h>

#include <set>

#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/path/oracle.h"
#include "tools/tdpt-render/path/surface.h"
#include "tools/tdpt-render/test_rooms.h"
#include "tools/tdpt-render/test_variant.h"

namespace tdpt {
namespace {

using oracle::Fault;

struct Worst {
  double weight = 0;     ///< largest difference of the weights, balance heuristic
  double power = 0;      ///< of those of the power heuristic
  double power_1_9 = 0;  ///< twin: the oracle's exponent is 1.9 instead
  double ways = 0;       ///< between weights by products and by logarithms, both heuristics
  double ways_1_9 = 0;   ///< twin: 1.9 by logarithms, 2 by products
  double value = 0;      ///< largest relative difference of value * p and the contribution
  std::array<int, kTechniques> paths{};
  int dirac = 0, lamps = 0;  ///< paths that turn at a mirror, that begin at a lamp
  int all = 0, off = 0;      ///< paths, and those off by 1 % of their value or 0.001 of weight
};

Scene diffuse_rooms() {
  return read_gltf(two_rooms_path());
}

// The same rooms, every triangle of another make, with bent normals, and lamps of each kind beside
// the emitter, which shines on both sides and reflects as a mirror.
Scene glossy_rooms() {
  Scene scene = read_gltf(two_rooms_path());
  std::vector<Material> makes(8);
  for (Material& m : makes) m.plain = false;
  makes[0].plain = true;
  makes[1].specular = 1, makes[1].roughness = 0.5f;  // rough plastic
  makes[2].specular = 1, makes[2].roughness = 0;     // smooth plastic
  makes[3].metallic = 1, makes[3].roughness = 0.4f;  // rough metal
  makes[4].metallic = 1, makes[4].roughness = 0;     // mirror
  makes[5].transmission = 1, makes[5].solid = true, makes[5].specular = 1, makes[5].roughness = 0;
  makes[6] = makes[5], makes[6].roughness = 0.4f;                                  // rough glass
  makes[7].transmission = 0.5f, makes[7].specular = 1, makes[7].roughness = 0.3f;  // thin sheet
  const auto first = static_cast<uint32_t>(scene.materials.size());
  scene.materials.insert(scene.materials.end(), makes.begin(), makes.end());
  scene.smooth.assign(scene.triangles.size(), 1);
  scene.normals.resize(scene.positions.size());
  for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
    Triangle& triangle = scene.triangles[t];
    if (Material& m = scene.materials[triangle.material]; max_component(m.emission) > 0) {
      m.plain = false;
      m.double_sided = true;
      m.base_color = Rgb(0.3f), m.metallic = 1, m.roughness = 0;
      continue;
    }
    triangle.material = first + mix64(t) % 8;
    scene.smooth[t] = t % 2;
    for (uint32_t v : triangle.vertex)
      scene.normals[v] = Vec3f(normalize(shape_of(scene, t).normal + Vec3d(0.2, 0.1, -0.1)));
  }
  PunctualLight lamp;
  lamp.position = scene.frame.to_canonical({3, 1, 0.3});
  lamp.intensity = Rgb(0.05f);
  scene.lights.push_back(lamp);
  lamp.kind = PunctualLight::Kind::spot;
  lamp.direction = normalize(Vec3d(-1, -1, 0.5));
  lamp.cos_inner = 0.95, lamp.cos_outer = 0.7;
  scene.lights.push_back(lamp);
  lamp.kind = PunctualLight::Kind::directional;
  scene.lights.push_back(lamp);
  return scene;
}

/// NaN grows it to infinity.
void grow(double& largest, double difference) {
  if (!(std::abs(difference) <= largest))
    largest = std::isnan(difference) ? HUGE_VAL : std::abs(difference);
}

Worst compare(const Scene& scene, const Integrator& integrator, Fault fault, int max_depth = 6,
              uint64_t spp = 64, const std::vector<Portal>& portals = two_crossing_portals()) {
  const World world(scene, scene.camera(""), 16, 12, portals);
  Film film(16, 12, 1);
  Tally tally;
  Worst worst;
  const PathObserver observer = [&](const Path& path, Strategy strategy, const Rgb& value) {
    ++worst.paths[static_cast<size_t>(strategy.technique)];
    worst.lamps += !path.vertex(0).on_surface();
    bool dirac = false;
    for (int i = 1; i < path.k(); ++i) dirac |= path.dirac(i);
    worst.dirac += dirac;
    const auto p = oracle::densities(world, path, integrator.mixture, fault);
    const auto weight = [&](double beta) {
      return path.weight(integrator.mixture, strategy, beta);
    };
    const double weight_off = std::abs(weight(1) - oracle::weight(p, strategy, 1));
    grow(worst.weight, weight_off);
    grow(worst.power, weight(2) - oracle::weight(p, strategy, 2));
    grow(worst.power_1_9, weight(2) - oracle::weight(p, strategy, 1.9));
    if (path.k() >= 2) {
      const auto ways = [&](double products, double logarithms) {
        return path.weight_by_products(integrator.mixture, strategy, products).value() -
               path.weight_by_logarithms(integrator.mixture, strategy, logarithms);
      };
      grow(worst.ways, ways(1, 1));
      grow(worst.ways, ways(2, 2));
      grow(worst.ways_1_9, ways(2, 1.9));
    }
    for (const auto& d : p) {
      if (d.strategy.technique != strategy.technique || d.strategy.split != strategy.split)
        continue;
      const double expected = max_component(oracle::contribution(world, path));
      const double relative = max_component(value) * std::exp(d.log_p) / expected - 1;
      ++worst.all;
      worst.off += std::abs(relative) > 0.01 || weight_off > 1e-3;
      worst.value = std::max(worst.value, std::abs(relative));
    }
  };
  const Variant variant(integrator);
  PathSampler sampler(world, variant.settings(max_depth, 11), film, tally, &observer);
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 16; ++x)
      for (uint64_t s = 0; s < spp; ++s) variant.sample(sampler, x, y, s);
  return worst;
}

class paths : public testing::TestWithParam<const Integrator*> {};

TEST_P(paths, weights_and_values_are_the_oracles) {
  const Worst worst = compare(diffuse_rooms(), *GetParam(), Fault::none);
  EXPECT_LT(worst.weight, 1e-6);  // hit points lie beside the sampled rays by float rounding
  EXPECT_LT(worst.power, 2e-6);
  EXPECT_LT(worst.ways, 1e-12);
  EXPECT_LT(worst.value, 1e-4);  // values are floats
  if (GetParam() != &pt) {       // which has one technique, and its weights no exponent
    EXPECT_GT(worst.power_1_9, 2e-4);
    EXPECT_GT(worst.ways_1_9, 2e-4);
  }
  for (size_t i = 0; i < kTechniques; ++i) {
    if (GetParam()->mixture.has(static_cast<Technique>(i))) {
      EXPECT_GT(worst.paths[i], i == 0 ? 0 : 50) << kTechniqueNames[i];
    }
  }
}

TEST_P(paths, over_glossy_surfaces_too) {
  const Worst worst = compare(glossy_rooms(), *GetParam(), Fault::none);
  EXPECT_LT(worst.weight, 1e-4);
  EXPECT_LT(worst.power, 2e-4);
  EXPECT_LT(worst.ways, 1e-12);
  EXPECT_LE(worst.off, 2);  // edges so short that rounding turns them
  EXPECT_GT(worst.dirac, 10);
  if (GetParam() != &pt) {
    EXPECT_GT(worst.lamps, 100);
  }
}

TEST_P(paths, weights_of_all_strategies_sum_to_1) {
  const Scene scene = read_gltf(two_rooms_path());
  const World world(scene, scene.camera(""), 16, 12, two_crossing_portals());
  Film film(16, 12, 1);
  Tally tally;
  const Mixture& set = GetParam()->mixture;
  int crossing = 0;
  const PathObserver observer = [&](const Path& path, Strategy, const Rgb&) {
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
  PathSampler sampler(world, variant.settings(6, 5), film, tally, &observer);
  for (uint64_t s = 0; s < 2000; ++s) variant.sample(sampler, 8, 6, s);
  if (set.has(Technique::portal)) {
    EXPECT_GT(crossing, 0);  // some paths cross twice
  }
}

// The hole's is for one way; two across the camera's room make pairs either way.
TEST_P(paths, through_portals_for_both_ways_are_the_oracles) {
  std::vector<Portal> portals = two_crossing_portals();
  portals.push_back(rectangle({0.6, 0.2, -0.9}, {0, 0, 1.8}, {0, 1.6, 0}));
  portals[1].both_ways = portals[2].both_ways = true;
  const Scene scene = diffuse_rooms();
  ASSERT_EQ(PortalSet(portals, scene.frame).facets(), 5u);
  ASSERT_GT(PortalSet(portals, scene.frame).pairs(), 2u);
  const Worst worst = compare(scene, *GetParam(), Fault::none, 6, 32, portals);
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

// Probabilities other than the integrator's own. A ray that was aimed at a border of a portal may
// pass it by rounding: the walk knows that it was aimed there, the oracle does not.
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
        EXPECT_GT(worst.all, 5000);
        EXPECT_LE(worst.off, 3);
        EXPECT_GT(worst.paths[static_cast<size_t>(Technique::portal)], 100);
        const Mixture& m = integrator.mixture;
        combinations.insert(
            {m.guiding.chance[0], m.guiding.chance[1], m.segments, scene == &glossy});
      }
  EXPECT_EQ(combinations.size(), 3u * 2 * 2);
}

// Paths of walks that are directed one way or not at all, weighed as if they were directed another:
// how many differ from the oracle's weight. `told`: the mixture that is asked for.
int weighed_as_others(const Scene& scene, const Integrator& made, const Mixture& asked,
                      const Mixture& told) {
  const World world(scene, scene.camera(""), 16, 12, two_crossing_portals());
  Film film(16, 12, 1);
  Tally tally;
  const Guide guide = Guide::knowing_all(world, made.mixture);
  const Guide other = Guide::knowing_all(world, asked);
  int all = 0, off = 0;
  const PathObserver observer = [&](const Path& path, Strategy strategy, const Rgb&) {
    if (path.k() < 2 || !asked.has(strategy.technique)) return;
    const WalkDensities plain = path.plain_densities(world);
    const StrategySums sums =
        path.sums(asked, path.directed_densities(other, plain), plain, strategy);
    const double per_sample =
        asked.sample_weight(strategy.technique, path.k()) / asked.samples_of(strategy.technique);
    const double weight =
        oracle::weight(oracle::densities(world, path, told, Fault::none), strategy, 1);
    ++all;
    off += std::abs(sums.used * per_sample / sums.counted - weight) > 1e-4;
  };
  PathSampler sampler(world, {made.mixture, 6, 1, 5, made.stream}, guide, film, tally, &observer);
  for (uint64_t s = 0; s < 2000; ++s) sampler.sample(8, 6, s);
  EXPECT_GT(all, 50);
  return off;
}

TEST(paths_under_other_mixtures, weigh_as_the_oracle_says) {
  Mixture often = tdpt_guided.mixture, seldom = tdpt_guided.mixture;
  often.guiding = {{0.9, 0.8}};
  seldom.guiding = {{0.3, 0}};
  seldom.segments = 0.25;
  for (const Scene& scene : {diffuse_rooms(), glossy_rooms()})
    for (const Integrator* made : {&tdpt_org, &tdpt_guided})
      for (const Mixture& asked : {nee.mixture, bdpt.mixture, tdpt_org.mixture, often, seldom}) {
        // Edges so short that rounding turns them, as above.
        EXPECT_LE(weighed_as_others(scene, *made, asked, asked), 3) << made->name;
        // Twin: directed a little more often than was asked.
        Mixture told = asked;
        if (told.guiding == Guiding{}) continue;
        told.guiding.chance[0] += 0.05;
        EXPECT_GT(weighed_as_others(scene, *made, asked, told), 100) << made->name;
      }
}

TEST(path_twin, a_portal_density_off_is_caught_where_a_share_of_the_samples_draws_segments) {
  for (const Scene& scene : {diffuse_rooms(), glossy_rooms()}) {
    Integrator integrator = tdpt_guided;
    integrator.mixture.segments = 0.3;
    EXPECT_GT(compare(scene, integrator, Fault::portal_density_5_percent).weight, 1e-3);
  }
}

// Smooth plastic whose bent normals send what it mirrors into the surface at some z_1: a walk that
// tries the mirror there ends, directed or not. What walks carry from there through portals:
// directed ones against plain ones [standard errors]; `fault`: factor of the former.
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
  const World world(scene, scene.camera(""), 16, 12, two_crossing_portals());
  constexpr int kWalks = 800000;
  double mean[2] = {}, variance = 0;
  for (size_t directed : {0, 1}) {
    const Guide guide(world,
                      directed ? Mixture{kThreeWays, 1, 1, 1, {{0.9, 0.9}}} : tdpt_org.mixture);
    double sum = 0, squares = 0;
    Walk walk;
    RayCounts rays;
    for (int i = 0; i < kWalks; ++i) {
      Rng rng(3, directed, static_cast<uint64_t>(i));
      const double x = 16 * rng.uniform(), y = 12 * rng.uniform();
      walk_from_camera(world, guide, x, y, 2, Sequence(4, directed, static_cast<uint64_t>(i), 0),
                       walk, rays);
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

TEST(mixtures, weigh_next_events_and_count_the_share_of_segments) {
  const Mixture& less = kGuided[2].mixture;
  EXPECT_EQ(less.segments, 0.25);
  EXPECT_EQ(less.sample_weight(Technique::portal, 4), 0.25);
  EXPECT_EQ(less.sample_weight(Technique::direct, 2), 6);
  EXPECT_EQ(less.sample_weight(Technique::direct, 3), 2);
  EXPECT_EQ(less.sample_weight(Technique::bi, 3), 1);
  for (const Technique t : {Technique::direct, Technique::portal})
    EXPECT_EQ(tdpt_org.mixture.sample_weight(t, 2), 1);
}

TEST(path_twin, a_portal_density_off_by_5_percent_is_caught) {
  const Worst worst = compare(diffuse_rooms(), tdpt_ref, Fault::portal_density_5_percent);
  EXPECT_GT(worst.weight, 1e-3);
  EXPECT_GT(worst.value, 0.04);
}

TEST(path_twin, an_aim_off_by_5_percent_is_caught) {
  for (const Scene& scene : {diffuse_rooms(), glossy_rooms()}) {
    const Worst worst = compare(scene, tdpt_guided, Fault::aim_5_percent);
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

TEST(paths_deep, long_paths_keep_finite_weights) {
  const Worst worst = compare(diffuse_rooms(), tdpt_org, Fault::none, kMaxDepth, 1);
  EXPECT_LT(worst.weight, 1e-6);
  EXPECT_LT(worst.power, 2e-6);
  EXPECT_GT(worst.paths[3], 1000);
}

// Between two plates 1e-7 apart, by turns straight across and along: the densities of every
// strategy lie hundreds of orders of magnitude below those of the common factor.
TEST(paths_deep, weights_survive_products_that_no_double_holds) {
  const Scene scene = diffuse_rooms();
  const World world(scene, scene.camera(""), 16, 12, {});
  uint32_t lamp = 0;
  while (max_component(scene.material_of(lamp).emission) <= 0) ++lamp;
  Material grey;
  Walk y, z;
  const int k = 60;
  const Vec3d across = world.film.forward();  // the camera sees x_59 on its front
  const Vec3d along = normalize(cross(across, Vec3d(0, 1, 0)));
  const auto place = [&](int i, Vertex& v) {
    v.position = world.film.position() + across * (0.3 + 1e-7 * (i % 2)) +
                 along * (0.01 * (i / 2 - (k - 1) / 2));
    v.normal = across * (i % 2 ? -1 : 1);
    v.material = &grey;
  };
  y.size = 1;
  place(0, y.v[0]);
  y.v[0].material = &scene.material_of(lamp);
  y.v[0].triangle = lamp;
  y.v[0].source = &world.lights.surface(false);
  y.states[0].pdf_own_A = world.lights.pdf_A(lamp);
  z.size = k;
  z.v[0].position = world.film.position();
  for (int j = 1; j < k; ++j) place(k - j, z.v[static_cast<size_t>(j)]);
  const auto at = [&](int i) -> const Vertex& { return i == 0 ? y[0] : z[k - i]; };
  for (int i = 0; i < k; ++i) {
    const Vertex& v = at(i);
    const Edge from_camera = between(at(k), at(i));
    const double camera = i == k - 1 ? to_area(world.film.pdf_w(from_camera.w), from_camera, v)
                                     : scatter_pdf_A(at(i + 2), at(i + 1), v, false);
    const double light = i == 0   ? y.state(0).pdf_own_A
                         : i == 1 ? emission_pdf_A(at(0), v)
                                  : scatter_pdf_A(at(i - 2), at(i - 1), v, false);
    WalkState& state = z.states[static_cast<size_t>(k - i)];
    if (i > 0) state.pdf_own_A = camera, state.pdf_other_A = light;
  }
  RayCounts rays;
  const Guide guide(world, tdpt_org.mixture);
  const Path path(world, guide, y, 1, z, k, rays);
  const auto p = oracle::densities(world, path, bdpt.mixture);
  double largest = -1e300;
  for (const auto& d : p) largest = std::max(largest, d.log_p);
  for (const double beta : {1, 2}) {
    double sum = 0, off = 0, twin = 0;
    int told = 0;
    for (const auto& d : p) {
      EXPECT_FALSE(path.weight_by_products(bdpt.mixture, d.strategy, beta).has_value());
      const double w = path.weight(bdpt.mixture, d.strategy, beta);
      const double expected = oracle::weight(p, d.strategy, beta);
      EXPECT_NEAR(w, expected, 1e-9);
      if (expected > 1e-250) {
        grow(off, w / expected - 1);
        grow(twin, w / oracle::weight(p, d.strategy, beta * 1.05) - 1);
        ++told;
      }
      sum += w;
    }
    EXPECT_NEAR(sum, 1, 1e-9);
    EXPECT_LT(off, 1e-6);
    EXPECT_GT(twin, 0.1);  // an exponent off by 5 %
    EXPECT_GT(told, 10);
  }
  double common = 0;  // logarithm of what the product form divides by
  for (int i = 0; i < k; ++i)
    common += std::log(i == 0 ? y.state(0).pdf_own_A
                              : z.state(k - i).pdf_own_A + z.state(k - i).pdf_other_A);
  EXPECT_LT(largest - common, -750);  // beyond the smallest double, exp(-745)
}

// x_0 on a lamp, then x_1, x_2, x_3, and the camera. Neither x_1 nor x_3 can scatter towards x_2:
// only portal segments that end there, x_1 -> x_2 and x_2 -> x_3, have a density.
TEST(paths_skipped, a_vertex_that_no_walk_can_have_made_leaves_the_weights_of_segments) {
  const Scene scene = diffuse_rooms();
  const World plain(scene, scene.camera(""), 16, 12, {});
  const Vec3d forward = plain.film.forward();
  const Vec3d side = normalize(cross(forward, Vec3d(0, 1, 0)));
  const Vec3d x4 = plain.film.position(), x3 = x4 + forward * 0.3;
  const Vec3d x2 = x3 + forward * 0.2 + side * 0.05, x1 = x2 + side * 0.2;
  const Vec3d x0 = x1 + forward * 0.1 + side * 0.15;
  // A square about the middle of an edge, across it.
  const auto between_ends = [&](const Vec3d& from, const Vec3d& to, double size) {
    const Vec3d u = normalize(cross(to - from, Vec3d(0.1, 1, 0.2))) * size;
    const Vec3d v = normalize(cross(to - from, u)) * size;
    const Vec3d corner = (from + to) / 2 - u / 2 - v / 2;
    const auto metres = [&](const Vec3d& p) { return scene.frame.to_metres(p); };
    return rectangle(metres(corner), metres(corner + u) - metres(corner),
                     metres(corner + v) - metres(corner));
  };
  const World world(scene, scene.camera(""), 16, 12,
                    {between_ends(x1, x2, 0.04), between_ends(x2, x3, 0.05)});
  uint32_t lamp = 0;
  while (max_component(scene.material_of(lamp).emission) <= 0) ++lamp;
  Material grey;
  const auto vertex = [&](const Vec3d& position, const Vec3d& normal) {
    Vertex v;
    v.position = position;
    v.normal = normalize(normal);
    v.material = &grey;
    return v;
  };
  Walk y, z;
  y.size = 1;
  y.v[0] = vertex(x0, x1 - x0);
  y.v[0].material = &scene.material_of(lamp);
  y.v[0].triangle = lamp;
  y.v[0].source = &world.lights.surface(false);
  y.states[0].pdf_own_A = world.lights.pdf_A(lamp);
  z.size = 2;
  z.v[0].position = x4;
  z.v[1] = vertex(x3, -forward);  // x_2 is behind it
  const Edge film = between(z[0], z[1]);
  z.states[1].pdf_own_A = to_area(world.film.pdf_w(film.w), film, z[1]);
  const Vertex end_1 = vertex(x1, side);  // x_2 is behind it, x_0 in front
  const Vertex end_2 = vertex(x2, side - forward);
  RayCounts rays;
  const Guide guide(world, tdpt_org.mixture);
  const SegmentCrossings crossings{guide.crossing(end_1, end_2, rays.portal),
                                   guide.crossing(y[0], end_1, rays.portal),
                                   guide.crossing(end_2, z[1], rays.portal)};
  const Path path(world, guide, y, 1, end_1, end_2, crossings, z, 2, rays);
  for (const double beta : {1, 2}) {
    const auto p = oracle::densities(world, path, tdpt_org.mixture);
    double sum = 0;
    for (const auto& d : p) {
      const double w = path.weight(tdpt_org.mixture, d.strategy, beta);
      if (d.strategy.technique == Technique::portal && d.strategy.split > 0) {
        EXPECT_NEAR(w, oracle::weight(p, d.strategy, beta), 1e-9);
        EXPECT_GT(std::abs(w - oracle::weight(p, d.strategy, beta * 1.05)), 1e-3);  // twin
        sum += w;
      } else {
        EXPECT_EQ(d.log_p, -HUGE_VAL);
        EXPECT_TRUE(std::isnan(w)) << kTechniqueNames[static_cast<size_t>(d.strategy.technique)];
      }
    }
    EXPECT_NEAR(sum, 1, 1e-12);
  }
}

// Connections that the weights are not to know of: nothing of what they bring may vanish in
// silence.
TEST(paths_skipped, samples_of_a_strategy_without_density_are_counted) {
  const Scene scene = diffuse_rooms();
  const World world(scene, scene.camera(""), 16, 12, two_crossing_portals());
  const auto not_finite = [&](const Variant& variant) {
    Film film(16, 12, 1);
    Tally tally;
    PathSampler sampler(world, variant.settings(6, 5), film, tally);
    for (uint64_t s = 0; s < 1000; ++s) variant.sample(sampler, 8, 6, s);
    return tally.not_finite;
  };
  EXPECT_EQ(not_finite(tdpt_ref), 0u);
  EXPECT_EQ(not_finite(tdpt_org), 0u);
  EXPECT_GT(not_finite({tdpt_ref, run_twice<Technique::bi>}), 10u);
}

// G grows without bound in the corners of a box. Nothing is clamped: the weights keep it down.
TEST(connections, at_tiny_distances_are_bounded_by_their_weights) {
  const Scene scene = read_gltf(furnace_path());
  const World world(scene, scene.camera(""), 16, 12, {portal_in_the_furnace()});
  for (const Integrator* integrator : {&bdpt, &tdpt_org, &tdpt_ref}) {
    Film film(16, 12, 1);
    Tally tally;
    double weighted = 0, plain = 0;
    const PathObserver observer = [&](const Path& path, Strategy strategy, const Rgb& value) {
      const double w = path.weight(integrator->mixture, strategy, 1);
      plain = std::max(plain, double{value.x});
      // Splats are per film, not per pixel.
      if (strategy.split < path.k() && path.k() - strategy.split > 2)
        weighted = std::max(weighted, w * value.x);
    };
    const Variant variant(*integrator);
    PathSampler sampler(world, variant.settings(6, 3), film, tally, &observer);
    for (uint64_t s = 0; s < 100000; ++s)
      variant.sample(sampler, static_cast<int>(s % 16), static_cast<int>(s % 12), s);
    EXPECT_LT(weighted, 2) << integrator->name;  // the radiance in the box
    EXPECT_GT(plain, 100) << integrator->name;   // twin: without the weights
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

}  // namespace
}  // namespace tdpt
