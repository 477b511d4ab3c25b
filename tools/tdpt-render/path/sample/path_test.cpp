// Compares every path of every technique with the oracle: the weights of all strategies that could
// have made it, and that its unweighted value is the measurement contribution divided by the
// density of its own. Under a sky x_0 is a direction, P>(x_0) and P<(x_0) are per solid angle, and
// so is the light's end of a portal segment.
#include <gtest/gtest.h>

#include <numeric>
#include <optional>

#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/testing/blur.h"
#include "tools/tdpt-render/testing/oracle.h"
#include "tools/tdpt-render/testing/rect_lights.h"
#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/sky.h"
#include "tools/tdpt-render/testing/variant.h"

namespace tdpt::path_test {

using oracle::Fault;

struct Room {
  std::string name;
  Scene scene;
  std::vector<Portal> portals;
  bool exact = true;  ///< diffuse, so that only rounding of positions is between path and oracle
  int max_depth = 6;
  bool blurred = false;  ///< by a wide lens that moves
};

const Sky::Sun kSun = sun_of({1, 0.12, 0.05}, 0.25 * kDegree, 4);
const Sky::Sun kHaze = sun_of({1, 0.3, -0.2}, 10 * kDegree, 2);

/// The far room without its end wall.
Scene open(const Scene& scene) {
  return open_end(scene, 4.09);
}
Scene bright(Scene scene) {
  for (Material& m : scene.materials) m.base_color = Rgb(0.8f);
  return scene;
}

/// The hole's, the tilted one in the camera's room, and one in the open end.
std::vector<Portal> three_portals(bool both_ways = false) {
  std::vector<Portal> portals = two_crossing_portals();
  portals.push_back(rectangle({4.1, 0.1, -0.9}, {0, 0, 1.8}, {0, 1.8, 0}));
  for (Portal& portal : portals) portal.both_ways = both_ways;
  return portals;
}
/// The hole's is one-way; two across the camera's room make pairs in both directions.
std::vector<Portal> pairs_both_ways() {
  std::vector<Portal> portals = two_crossing_portals();
  portals.push_back(rectangle({0.6, 0.2, -0.9}, {0, 0, 1.8}, {0, 1.6, 0}));
  portals[1].both_ways = portals[2].both_ways = true;
  return portals;
}

const std::vector<Room>& rooms() {
  static const std::vector<Room> all = [] {
    const Scene diffuse = diffuse_rooms(), glossy = glossy_rooms();
    const Scene skylit = under(open(diffuse), uneven_sky({kHaze}));  // and lamps
    const auto two = two_crossing_portals(), three = three_portals();
    return std::vector<Room>{
        {"diffuse", diffuse, two},
        {"glossy", glossy, two, false},
        {"coated", coated_rooms(), two, false},
        {"blurred", diffuse, two, true, 6, true},
        {"both ways", diffuse, pairs_both_ways()},
        {"bright", bright(diffuse), two, true, kMaxDepth},
        {"bright glossy", bright(glossy), two, false, kMaxDepth},
        {"sky", under(without_lamps(open(diffuse)), uneven_sky({kSun, kHaze})), three},
        {"sky and lamps", skylit, three},
        {"sky both ways", skylit, three_portals(true)},
        {"sky bright", bright(skylit), three, true, kMaxDepth},
        {"sky glossy", under(without_lamps(open(glossy)), uneven_sky({kSun, kHaze})), three, false},
        {"even sky glossy", under(open(glossy), one_colour_sky({2, 3, 4})), three, false},
        {"rectangular lights", with_rect_lights(diffuse), two},
        {"rectangular lights glossy", with_rect_lights(glossy), two, false},
        {"rectangular lights and sky", under(open(with_rect_lights(diffuse)), uneven_sky()),
         three}};
  }();
  return all;
}
const Room& room(const std::string& name) {
  return *std::find_if(rooms().begin(), rooms().end(),
                       [&](const Room& r) { return r.name == name; });
}

/// The rows of the table, and what the pilot makes of them.
std::vector<Integrator> mixtures() {
  std::vector<Integrator> all(kIntegrators.begin(), kIntegrators.end());
  const auto other = [&](const char* name, const Integrator& row) -> Mixture& {
    all.push_back(row);
    all.back().name = name;
    return all.back().mixture;
  };
  other("guided_often", tdpt_guided).guiding = {{0.9, 0.9}};
  Mixture& light = other("guided_from_the_light", tdpt_guided);
  light.guiding = {{0.2, 0}}, light.segments = 1;
  other("nee_guided_to_windows", nee).guiding = {{0, 0.4}};
  Mixture& anywhere = other("bdpt_that_looks_everywhere", bdpt);
  anywhere.through_windows = 0, anywhere.light_walks = 0.25;
  // Cached vertices are connected more or less often than once for each of a walk.
  Mixture& often = other("connected_often", tdpt_org);
  often.connected = 2.5, often.connected_to_segments = 1.7, often.segments_connected = 15;
  Mixture& seldom = other("connected_seldom", tdpt_ref);
  seldom.connected_to_segments = 0.4, seldom.segments_connected = 3.6;
  return all;
}

struct Worst {
  double weight = 0;     ///< largest difference of the weights, balance heuristic
  double power = 0;      ///< the same for the power heuristic
  double power_1_9 = 0;  ///< twin: the oracle's exponent is 1.9 instead
  double value = 0;      ///< largest relative error of value * times * p against the contribution
  double sum = 0;        ///< largest difference of the sum of all weights from 1
  std::array<int, kTechniques> paths{}, sky{};  ///< number by technique; of those, paths that begin
                                                ///< in the sky
  int dirac = 0, lamps = 0;  ///< paths with a Dirac lobe; paths that begin at a lamp
  int all = 0, off = 0;      ///< paths, and those off by 1 % of their value or 0.001 in weight
  int left_out = 0;  ///< not compared: rounding may turn an edge, or which portals it crosses
  int deep = 0;      ///< paths of 12 edges or more

  void add_counts(const Worst& w) {
    for (size_t i = 0; i < kTechniques; ++i) paths[i] += w.paths[i], sky[i] += w.sky[i];
    dirac += w.dirac, lamps += w.lamps, all += w.all, deep += w.deep;
  }
};

/// NaN makes it infinite.
void grow(double& largest, double difference) {
  if (!(std::abs(difference) <= largest))
    largest = std::isnan(difference) ? HUGE_VAL : std::abs(difference);
}

bool has_short_edge(const Path& path) {
  double least = 1;
  for (int i = 0; i < path.k(); ++i)
    least = std::min(least, between(path.vertex(i), path.vertex(i + 1)).d2);
  return least < 1e-10;  // canonical
}

// Whether a vertex, on the rim of a hole, is so near a portal's plane that its edges do not count
// as crossing it [PortalSet::kPortalMargin], which the oracle ignores.
bool touches_a_portals_plane(const Vista& vista, const Path& path) {
  for (int i = 0; i <= path.k(); ++i) {
    if (path.vertex(i).at_infinity()) continue;
    for (size_t q = 0; q < vista.openings.portals.size(); ++q) {
      const PortalSet::Polygon& polygon = vista.openings.portals.polygon(static_cast<int>(q));
      const double height = dot(polygon.normal, path.vertex(i).position - polygon.p0);
      if (std::abs(height) < 2 * PortalSet::kPortalMargin) return true;
    }
  }
  return false;
}

Worst compare(const Room& room, const Integrator& integrator, uint64_t spp = 8,
              Fault fault = Fault::none) {
  Vista vista(room.scene, room.scene.camera(""), 16, 12, room.portals);
  if (room.blurred) vista.view.blur = strong_blur(room.scene.camera(""));
  Film film(16, 12, 1);
  Tally tally;
  Worst worst;
  std::optional<oracle::SkyLight> sky;
  if (room.scene.sky) sky.emplace(vista);
  const Mixture& mixture = integrator.mixture;
  const PathObserver observer = [&](const Contribution& found) {
    const auto& [path, strategy, value, times] = found;
    if (has_short_edge(path) || touches_a_portals_plane(vista, path)) {
      ++worst.left_out;
      return;
    }
    const auto technique = static_cast<size_t>(strategy.technique);
    ++worst.all;
    ++worst.paths[technique];
    worst.deep += path.k() >= 12;
    worst.lamps += !path.vertex(0).on_surface();
    worst.sky[technique] += path.vertex(0).at_infinity() && path.vertex(0).met();
    bool dirac = false;
    for (int i = 1; i < path.k(); ++i) dirac |= path.dirac(i);
    worst.dirac += dirac;
    const auto p = oracle::densities(vista, path, mixture, fault, sky ? &*sky : nullptr);
    const auto weight = [&](double beta) { return path.weight(mixture, strategy, beta); };
    const double weight_off = std::abs(weight(1) - oracle::weight(p, strategy, 1));
    grow(worst.weight, weight_off);
    grow(worst.power, weight(2) - oracle::weight(p, strategy, 2));
    grow(worst.power_1_9, weight(2) - oracle::weight(p, strategy, 1.9));
    double sum = 0, value_off = HUGE_VAL;
    for (const auto& d : p) {
      const double w = path.weight(mixture, d.strategy, 1);
      sum += std::isnan(w) ? 0 : w;  // no density
      if (d.strategy != strategy) continue;
      const double expected = max_component(oracle::contribution(path));
      // For one sample of the strategy.
      const double p_s =
          std::exp(d.log_p) / mixture.samples_of(strategy.technique, strategy.split, path.k());
      const double told = max_component(value) * times * p_s;
      value_off = expected > 0 ? std::abs(told / expected - 1) : told;
    }
    grow(worst.sum, sum - 1);
    grow(worst.value, value_off);
    worst.off += !(value_off < 0.01 && weight_off < 1e-3);
  };
  const Variant variant(integrator);
  PathSampler sampler(vista, variant.settings(room.max_depth, 11), film, tally, &observer);
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 16; ++x)
      for (uint64_t s = 0; s < spp; ++s) variant.sample(sampler, x, y, s);
  EXPECT_LE(worst.left_out, 5 + worst.all / 100);
  return worst;
}

/// A ray aimed at a portal's border may miss it by rounding, which the oracle does not know; bent
/// normals make cosines of 0.001, which rounding of positions changes.
constexpr int kMostOff = 3;

class paths : public testing::TestWithParam<Integrator> {};

TEST_P(paths, are_the_oracles) {
  const Mixture& mixture = GetParam().mixture;
  Worst all;
  for (const Room& room : rooms()) {
    SCOPED_TRACE(room.name);
    const Worst worst = compare(room, GetParam());
    all.add_counts(worst);
    grow(all.power_1_9, worst.power_1_9);
    EXPECT_LE(worst.off, kMostOff);
    if (!room.exact || mixture.guiding != Guiding{}) continue;
    EXPECT_LT(worst.weight, 1e-5);
    EXPECT_LT(worst.power, 2e-5);
    EXPECT_LT(worst.value, 1e-3);  // a float's rounding at every vertex
    EXPECT_LT(worst.sum, 1e-9);
  }
  for (size_t i = 0; i < kTechniques; ++i) {
    if (!mixture.has(static_cast<Technique>(i))) continue;
    EXPECT_GT(all.paths[i], 100) << kTechniqueNames[i];
    EXPECT_GT(all.sky[i], 10) << kTechniqueNames[i];
  }
  EXPECT_GT(all.dirac, 10);
  if (mixture.techniques == pt.mixture.techniques) return;  // its weights have no exponent
  EXPECT_GT(all.power_1_9, 2e-4);
  EXPECT_GT(all.lamps, 100);
  EXPECT_GT(all.deep, 20);
}

INSTANTIATE_TEST_SUITE_P(integrators, paths, testing::ValuesIn(mixtures()),
                         [](const auto& integrator) {
                           std::string name = integrator.param.name;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// Each fault of the oracle's is far from what the same paths are with it.
TEST(path_twin, every_planted_fault_is_caught) {
  struct Planted {
    Fault fault;
    std::vector<std::string> rooms;
    std::vector<Integrator> by;
  };
  const std::vector<Integrator> directly{nee, bdpt, tdpt_ref, tdpt_guided},
      through_portals{tdpt_org, tdpt_ref, tdpt_guided};
  for (const auto& [fault, names, by] : std::vector<Planted>{
           {Fault::portal_density_5_percent,
            {"diffuse", "glossy", "sky", "even sky glossy"},
            through_portals},
           {Fault::no_surround, {"diffuse"}, {tdpt_ref}},
           {Fault::one_way_5_percent, {"both ways"}, through_portals},
           {Fault::guide_5_percent,
            {"diffuse", "glossy", "coated", "sky", "even sky glossy"},
            {tdpt_guided}},
           {Fault::missing_cosine, {"diffuse"}, {bdpt}},
           {Fault::connection_at_a_mirror, {"glossy"}, {bdpt}},
           {Fault::immortal, {"diffuse", "bright", "glossy"}, directly},
           {Fault::film_of_the_middle, {"blurred"}, {bdpt, tdpt_ref}},
           {Fault::sky_5_percent, {"sky", "sky and lamps", "even sky glossy"}, directly},
           {Fault::sky_segment_distance, {"sky", "even sky glossy"}, through_portals},
           {Fault::sky_segment_cosine, {"sky", "even sky glossy"}, through_portals},
           {Fault::window_5_percent, {"sky", "even sky glossy"}, directly},
           {Fault::rect_light_5_percent,
            {"rectangular lights", "rectangular lights and sky"},
            directly}})
    for (const std::string& name : names)
      for (const Integrator& integrator : by)
        EXPECT_GT(compare(room(name), integrator, 4, fault).off, 3 * kMostOff)
            << static_cast<int>(fault) << " " << name << " " << integrator.name;
}

// Random cases: portals of all places, sizes and directions, overlapping; maps of any size with
// black texels; any suns; any mixtures.
struct Case {
  explicit Case(uint64_t seed) {
    Rng rng(61, 0, seed);
    const auto in = [&](double a, double b) { return a + (b - a) * rng.uniform(); };
    const auto often = [&](double share) { return rng.uniform() < share; };
    std::vector<Portal>& portals = room.portals;
    for (double n = in(1, 6); n > 1; --n) {
      if (often(0.5)) {
        const double x = in(2, 4.2), y = in(0, 0.5), z = in(-0.9, 0), depth = in(0.2, 1);
        portals.push_back(rectangle({x, y, z}, {0, 0, depth}, {0, in(0.2, 1.5), 0}));
      } else {
        const double x = in(0, 4.3), y = in(0, 1.5), z = in(-1, 0.5), a = in(-1, 1), b = in(-1, 1);
        portals.push_back(rectangle({x, y, z}, {a, b, 0.5}, {b, 0.7, -a}));
      }
      if (often(0.2)) portals.back().triangles.pop_back();
      portals.back().both_ways = often(0.4);
      if (often(0.1)) portals.push_back(portals.back());
    }
    Sky::Map map{static_cast<int>(in(1, 40)), static_cast<int>(in(1, 20)), {}};
    if (often(0.2)) map.width = map.height = 1;
    for (int i = 0; i < map.width * map.height; ++i)
      map.texels.push_back(Rgb(often(0.3) ? 0 : static_cast<float>(std::pow(10, in(-2, 3)))));
    std::vector<Sky::Sun> suns;
    const double y = in(-0.3, 0.5), half_angle = std::pow(10, in(-4, -0.3));
    if (often(0.5)) suns.push_back(sun_of({1, y, 0.2}, half_angle, 3));
    if (often(0.2)) map = {};
    room.scene = open(diffuse_rooms());
    if (often(0.5)) room.scene = without_lamps(room.scene);
    room.scene.sky = std::make_shared<Sky>(map, in(0, 6), suns);
    integrator = kIntegrators[static_cast<size_t>(in(1, 6))];
    if (often(0.5)) integrator.mixture.guiding.chance = {0.7 * in(0, 1), 0.4};
    integrator.mixture.through_windows = often(0.3) ? 0 : in(0, 0.95);
  }
  Room room;
  Integrator integrator;
};
TEST(paths_at_random, are_the_oracles) {
  Worst all;
  for (uint64_t seed = 0; seed < 25; ++seed) {
    const Case c(seed);
    const Worst worst = compare(c.room, c.integrator);
    EXPECT_LE(worst.off, kMostOff) << seed;
    all.add_counts(worst);
  }
  EXPECT_GT(all.all, 1000);
  EXPECT_GT(std::accumulate(all.sky.begin(), all.sky.end(), 0), 500);
}

// Paths of walks with one guiding, or none, weighed for another one, as the pilot does: number of
// weights that differ from the oracle's. `told`: the mixture that the oracle is asked for.
int weighed_as_others(const Room& room, const Integrator& made, const Mixture& asked,
                      const Mixture& told) {
  const Vista vista(room.scene, room.scene.camera(""), 16, 12, room.portals);
  Film film(16, 12, 1);
  Tally tally;
  const Guide guide = Guide::knowing_all(vista, made.mixture);
  const Guide other = Guide::knowing_all(vista, asked);
  int all = 0, off = 0;
  WalkDensities plain, directed;
  std::optional<oracle::SkyLight> sky;
  if (room.scene.sky) sky.emplace(vista);
  const PathObserver observer = [&](const Contribution& found) {
    const auto& [path, strategy, value, times] = found;
    if (path.k() < 2 || !asked.has(strategy.technique)) return;
    path.plain_densities(vista, plain);
    path.directed_densities(other, plain, directed);
    const StrategySums sums = path.sums(asked, directed, plain, strategy);
    const auto [technique, split] = strategy;
    const double per_sample = asked.sample_weight(technique, split, path.k()) /
                              asked.samples_of(technique, split, path.k());
    const auto p = oracle::densities(vista, path, told, Fault::none, sky ? &*sky : nullptr);
    ++all;
    off +=
        !(std::abs(sums.used * per_sample / sums.counted - oracle::weight(p, strategy, 1)) <= 1e-4);
  };
  PathSampler sampler(vista, {made.mixture, 6, 1, 5, made.stream}, guide, film, tally, &observer);
  for (uint64_t s = 0; s < 2000; ++s) sampler.sample(8, 6, s);
  EXPECT_GT(all, 8);
  return off;
}

TEST(paths_under_other_mixtures, weigh_as_the_oracle_says) {
  Mixture often = tdpt_guided.mixture, seldom = tdpt_guided.mixture, anywhere = bdpt.mixture,
          connected = tdpt_org.mixture, aiming = nee.mixture;
  often.guiding = {{0.9, 0.8}};
  seldom.guiding = {{0.3, 0}}, seldom.segments = 0.25, seldom.light_walks = 0.125;
  anywhere.through_windows = 0;
  aiming.guiding = {{0, 0.1}};  // less than bright surfaces allow
  connected.connected = often.connected = 2.5;
  connected.connected_to_segments = often.connected_to_segments = 1.7;
  connected.segments_connected = often.segments_connected = 16;
  for (const char* name : {"diffuse", "glossy", "sky and lamps"})
    for (const Integrator* made : {&tdpt_org, &tdpt_guided})
      for (const Mixture& asked : {nee.mixture, anywhere, connected, aiming, often, seldom}) {
        EXPECT_LE(weighed_as_others(room(name), *made, asked, asked), kMostOff) << made->name;
        // Twin: guided a little more often than asked.
        Mixture told = asked;
        if (told.guiding == Guiding{}) continue;
        for (double& chance : told.guiding.chance) chance += 0.05;
        EXPECT_GT(weighed_as_others(room(name), *made, asked, told), 2 * kMostOff) << made->name;
      }
  // Twins: connected and splatted a little more often than asked, and looking out.
  for (double Mixture::*const factor :
       {&Mixture::connected, &Mixture::connected_to_segments, &Mixture::segments_connected,
        &Mixture::light_walks, &Mixture::through_windows}) {
    Mixture told = connected;
    told.*factor *= 0.95;
    EXPECT_GT(weighed_as_others(room("sky and lamps"), tdpt_org, connected, told), 5 * kMostOff);
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
    variant.picture(sampler, 16, 12, 64, [](int, int) {});
    EXPECT_LT(weighted, 2) << integrator->name;  // the radiance in the box
    EXPECT_GT(plain, 10) << integrator->name;    // twin: without the weights
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
