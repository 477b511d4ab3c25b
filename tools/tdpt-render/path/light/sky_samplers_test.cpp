// Every sampler of light from the sky follows its density: places on all lights, next events
// through windows, and the start of light walks; each with a twin. Directions:
// libcommon/scene/sky_test.
#include <gtest/gtest.h>

#include <functional>
#include <optional>

#include "libcommon/testing/statistics/chi_square.h"
#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/path/sample/walk.h"
#include "tools/tdpt-render/path/sample/world.h"
#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/sky.h"

namespace tdpt::sky_samplers_test {

using std::numbers::pi;

constexpr double kRight = 1e-4;  // a right sampler exceeds this in all but 1 seed of 10 000
constexpr double kWrong = 1e-9;  // a wrong one stays below
constexpr uint64_t kSamples = 30000;

/// Bins of latitude and longitude.
constexpr int kColumns = 16, kRows = 8;
constexpr size_t kBins = size_t{kColumns} * kRows;

size_t bin_of(const Vec3d& w) {
  const double u = std::atan2(w.x, -w.z) / (2 * pi) + 0.5;
  const double v = std::acos(std::clamp(w.y, -1.0, 1.0)) / pi;
  return static_cast<size_t>(std::min(static_cast<int>(v * kRows), kRows - 1) * kColumns +
                             std::min(static_cast<int>(u * kColumns), kColumns - 1));
}

/// Integral of a density [1/sr] over each bin, by the midpoints of fine cells: within a thousandth
/// at jumps.
std::vector<double> integral(const std::function<double(const Vec3d&)>& density, int fine = 24) {
  std::vector<double> sums(kBins);
  const int rows = kRows * fine, columns = kColumns * fine;
  for (int i = 0; i < rows; ++i) {
    const double theta = (i + 0.5) * pi / rows;
    const double sr = 2 * pi / columns * (std::cos(i * pi / rows) - std::cos((i + 1) * pi / rows));
    for (int j = 0; j < columns; ++j) {
      const double phi = ((j + 0.5) / columns - 0.5) * 2 * pi;
      const Vec3d w(std::sin(theta) * std::sin(phi), std::cos(theta),
                    -std::sin(theta) * std::cos(phi));
      sums[static_cast<size_t>(i / fine * kColumns + j / fine)] += density(w) * sr;
    }
  }
  return sums;
}

/// A room with an open end, and lamps of each kind besides the sky.
Scene room_with_lamps() {
  Scene scene = open_end(read_gltf(two_rooms_path()), 4.09);
  PunctualLight lamp;
  lamp.intensity = Rgb(0.5f);
  scene.lights.push_back(lamp);
  lamp.kind = PunctualLight::Kind::directional;
  scene.lights.push_back(lamp);
  return under(scene, uneven_sky({sun_of({0.3, 1, 0.4}, 12 * kDegree, 4)}));
}
/// In the open end, in the hole, and a triangle for both ways.
const std::vector<Portal>& windows() {
  static const std::vector<Portal> all{
      rectangle({4.1, 0.1, -0.9}, {0, 0, 1.8}, {0, 1.8, 0}),
      rectangle({2.05, 0.875, -0.125}, {0, 0, 0.25}, {0, 0.25, 0}),
      {"triangle", {{2.5, 0.3, 0.2}, {3.5, 1.9, 0.3}, {2.6, 1.8, 0.3}}, {{0, 1, 2}}, {}, {}, true}};
  return all;
}

using Shares = std::optional<Lights::KindProbabilities>;
const Shares kAsked = Lights::KindProbabilities{0.1, 0.2, 0.3, 0.4};

// Lights: emitters together, lamps by kind, the sky by direction. `asked`: shares of the kinds.
double lights(const std::vector<Portal>& portals, const Shares& asked, double fault) {
  const Scene scene = room_with_lamps();
  Vista vista(scene, scene.camera(""), 4, 4, portals);
  vista.openings = Openings(*vista.world, portals, asked);
  const LightSelection& all = vista.openings.selection;
  const LightSource& sky = *all.lights().sky();
  std::vector<double> probability =
      integral([&](const Vec3d& w) { return all.pdf(sky, ~0u, -w, all.look(w)) * fault; });
  double emitters = 0;
  for (uint32_t t = 0; t < scene.triangles.size(); ++t)
    emitters += all.pdf_A(t) * shape_of(scene, t).area;
  const Lights::KindProbabilities shares = all.shares();
  EXPECT_NEAR(shares.surfaces + shares.lamps + shares.parallel + shares.sky, 1, 1e-12);
  EXPECT_NEAR(emitters, shares.surfaces, 1e-6);
  EXPECT_NEAR(all.sky_pdf_1(), shares.sky, 1e-12);
  probability.insert(probability.end(), {emitters, shares.lamps, shares.parallel});
  return chi_square_of_samples(kSamples, probability,
                               [&](uint64_t i) {
                                 Rng rng(54, 1, i);
                                 const Lights::Point p = all.sample(rng);
                                 EXPECT_NEAR(p.pdf / all.pdf(*p.source, p.triangle, p.position,
                                                             all.look(-p.position)),
                                             1, 1e-9);
                                 if (p.source->is_sky()) return bin_of(-p.position);
                                 if (p.source->is_surface()) return kBins;
                                 return kBins + 1 + p.source->at_infinity();
                               })
      .p;
}
// Also with other shares of the kinds.
TEST(sky_samplers, lights_beside_the_sky_are_chosen_with_their_density) {
  for (const auto& portals : {std::vector<Portal>{}, windows()})
    EXPECT_GT(lights(portals, {}, 1), kRight);
  EXPECT_GT(lights(windows(), kAsked, 1), kRight);
}
TEST(sky_samplers, twin_a_sky_that_is_chosen_more_often_than_is_said) {
  for (const auto& portals : {std::vector<Portal>{}, windows()})
    EXPECT_LT(lights(portals, {}, 0.93), kWrong);
  EXPECT_LT(lights(windows(), kAsked, 0.93), kWrong);
}

// Next events at points of either room; `fault`: the density assumes this share of next events
// through windows.
struct Shaded {
  Vec3d place, normal;
  bool simple = true;
};
double next_events(const Shaded& shaded, double fault) {
  const Scene scene = room_with_lamps();
  Vista vista(scene, scene.camera(""), 4, 4, windows());
  Vertex v;
  v.position = scene.frame.to_canonical(shaded.place);
  v.normal = normalize(shaded.normal);
  v.material = &scene.materials[0];
  v.simple = shaded.simple;
  if (!v.simple) v.bsdf.through = Rgb(0.5f);  // both sides count
  vista.next_events().look_out(v.normal, v);
  EXPECT_GT(v.light_context.seen, 0);
  Vertex sky;
  double q = kThroughWindows;
  const auto density = [&](const Vec3d& w) {
    place_in_sky(vista.openings.selection, w, sky);
    return vista.next_events().pdf(v, sky).of(q);
  };
  q *= fault;
  std::vector<double> probability = integral(density, fault == 1 ? 96 : 24);
  q = kThroughWindows;
  return chi_square_of_samples(kSamples, probability,
                               [&](uint64_t i) {
                                 Rng rng(55, 0, i);
                                 const double pick = rng.uniform();
                                 const double a = rng.uniform();
                                 const double b = rng.uniform();
                                 const double side = rng.uniform();
                                 const Lights::Point p =
                                     vista.next_events().sample(v, q, pick, a, b, side);
                                 if (!p.source->is_sky()) return kBins;
                                 return bin_of(-p.position);
                               })
      .p;
}
const std::vector<Shaded> kShaded{{{3, 0, 0}, {0, 1, 0}},
                                  {{3.9, 1.2, -0.5}, {1, 0.2, 0}},
                                  {{0.3, 1, 0.1}, {1, 0, 0}},
                                  {{3, 0.3, -0.4}, {0, 0, 1}},
                                  {{3, 1.2, 0.6}, {0.3, 0, -1}, false}};
TEST(sky_samplers, next_events_have_their_density) {
  for (const Shaded& shaded : kShaded) EXPECT_GT(next_events(shaded, 1), kRight) << shaded.place.x;
}
TEST(sky_samplers, twin_next_events_that_look_through_windows_more_often_than_is_said) {
  for (const Shaded& shaded : kShaded) EXPECT_LT(next_events(shaded, 0.8), kWrong);
}

// Tables laid out for the portals before are reused if the windows are identical.
TEST(sky_samplers, windows_that_were_there_before_keep_their_tables) {
  const Scene scene = room_with_lamps();
  std::vector<Portal> portals = windows();
  const Tracer tracer(scene);
  const WindowSky one(scene.sky.get(), tracer, PortalSet(portals, scene.frame), {});
  const auto kept = [&](const Sky* sky) {
    const WindowSky other(sky, tracer, PortalSet(portals, scene.frame), one);
    size_t n = 0;
    for (const WindowSky::Window& a : other.windows())
      n += std::any_of(one.windows().begin(), one.windows().end(),
                       [&](const WindowSky::Window& b) { return a.frame == b.frame; });
    return std::pair(n, other.windows().size());
  };
  EXPECT_EQ(kept(scene.sky.get()), std::pair(size_t{4}, size_t{4}));
  EXPECT_EQ(kept(one_colour_sky(Rgb(1)).get()), std::pair(size_t{0}, size_t{4}));
  for (Portal& portal : portals) portal.both_ways = true;
  EXPECT_EQ(kept(scene.sky.get()), std::pair(size_t{4}, size_t{6}));
}

// Light walks over a floor: in which quarter of the sky they begin, and where they arrive.
double light_walks(const std::vector<Portal>& portals, const Integrator& integrator, bool fault) {
  Scene scene;
  scene.positions = {{-0.5f, 0, -0.4f}, {0.5f, 0, -0.4f}, {0.5f, 0, 0.4f}, {-0.5f, 0, 0.4f}};
  scene.triangles = {{{0, 1, 2}, 0}, {{0, 2, 3}, 0}};
  scene.materials.resize(1);
  scene.cameras.resize(1);
  scene.cameras[0] = {"", {0, 1, 0}, {1, 0, 0}, {0, 0, -1}, {0, -1, 0}};
  scene.sky = one_colour_sky(Rgb(1));
  const Vista vista(scene, scene.cameras[0], 4, 4, portals);
  const Guide guide(vista, integrator.mixture);
  constexpr int kSide = 3;
  constexpr size_t kPlaces = kSide * kSide;
  const auto quarter = [](const Vec3d& towards) {
    return static_cast<size_t>((towards.x > 0) + 2 * (towards.y > 0));
  };
  const auto cell = [](double x) { return std::clamp(static_cast<int>(x * kSide), 0, kSide - 1); };
  const auto place = [&](const Vec3d& p) {
    return static_cast<size_t>(cell(p.x + 0.5) * kSide + cell((p.z + 0.4) / 0.8));
  };
  std::vector<double> probability(4 * kPlaces);
  constexpr int kFine = 4, kAround = 96, kUp = 48;
  Vertex y0, y1;
  RayCounts rays;
  y1.normal = {0, 1, 0};
  y1.material = &scene.materials[0];
  for (int i = 0; i < kUp; ++i)
    for (int j = 0; j < kAround; ++j) {
      const double y = 1 - (2 * i + 1.0) / kUp, phi = 2 * pi * (j + 0.5) / kAround;
      const double r = std::sqrt(1 - y * y);
      place_in_sky(vista.openings.selection, {r * std::cos(phi), y, r * std::sin(phi)}, y0);
      if (guide.active()) guide.set_totals_at_light(y0);
      const double begins = vista.openings.selection.pdf(*y0.source, ~0u, y0.position, y0.in_sky);
      if (begins == 0) continue;
      for (int a = 0; a < kFine * kSide; ++a)
        for (int b = 0; b < kFine * kSide; ++b) {
          y1.position = {(a + 0.5) / (kFine * kSide) - 0.5, 0,
                         0.8 * ((b + 0.5) / (kFine * kSide) - 0.5)};
          const Edge e = between(y0, y1);
          const double plain = emission_pdf_A(y0, e, y1);
          const double arrives = guide.active() && !fault
                                     ? guide.pdf_A(From::light, y0, nullptr, e, y1, plain,
                                                   guide.crossing(y0, y1, rays.portal))
                                     : plain * (fault ? 1.1 : 1);
          probability[quarter(-y0.position) * kPlaces + place(y1.position)] +=
              begins * arrives * (4 * pi / (kUp * kAround)) *
              (0.8 / (kFine * kFine * kSide * kSide));
        }
    }
  return chi_square_of_samples(
             2 * kSamples, probability,
             [&](uint64_t i) {
               Walk walk;
               walk_from_light(vista, guide, 1, Sequence(56, 0, 0, i), walk, rays);
               if (walk.size < 2) return probability.size();
               return quarter(-walk[0].position) * kPlaces + place(walk[1].position);
             })
      .p;
}
const std::vector<Portal>& over_the_floor() {
  static const std::vector<Portal> all{rectangle({-0.3, 0.3, -0.3}, {0.6, 0, 0}, {0, 0, 0.5}),
                                       rectangle({0.1, 0.1, -0.2}, {0, 0, 0.4}, {0.2, 0.3, 0})};
  return all;
}
TEST(sky_samplers, light_walks_arrive_with_their_density) {
  EXPECT_GT(light_walks({}, bdpt, false), kRight);
  for (const Integrator* integrator : {&bdpt, &tdpt_guided})
    EXPECT_GT(light_walks(over_the_floor(), *integrator, false), kRight) << integrator->name;
}
TEST(sky_samplers, twin_light_walks_of_another_density) {
  for (const Integrator* integrator : {&bdpt, &tdpt_guided})
    EXPECT_LT(light_walks(over_the_floor(), *integrator, true), kWrong) << integrator->name;
}

}  // namespace tdpt::sky_samplers_test
