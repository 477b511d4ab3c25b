// Every sampler of light from the sky follows its density: directions, places on all lights, next
// events through windows, and the start of light walks; each with a twin.
#include <gtest/gtest.h>

#include <functional>

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
constexpr uint64_t kSamples = 60000;

/// Bins of latitude and longitude.
constexpr int kColumns = 32, kRows = 16;
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

std::vector<std::shared_ptr<const Sky>> skies() {
  return {one_colour_sky({1, 2, 3}), uneven_sky(),
          uneven_sky({sun_of({0.3, 1, 0.4}, 12 * kDegree, 4)})};
}

// `fault`: factor of the density of the upper half.
double directions(const Sky& sky, double fault) {
  const SkyDirections all(sky);
  const auto density = [&](const Vec3d& w) { return all.pdf_w(w) * (w.y > 0 ? fault : 1); };
  return chi_square_of_samples(kSamples, integral(density),
                               [&](uint64_t i) {
                                 Rng rng(51, 0, i);
                                 const double pick = rng.uniform();
                                 const double u = rng.uniform();
                                 const double v = rng.uniform();
                                 const Vec3d w = all.sample(pick, u, v);
                                 EXPECT_NEAR(length(w), 1, 1e-12);
                                 return bin_of(w);
                               })
      .p;
}
TEST(sky_samplers, directions_have_their_density) {
  for (const auto& sky : skies()) EXPECT_GT(directions(*sky, 1), kRight);
}
TEST(sky_samplers, twin_directions_of_one_half_a_tenth_off) {
  for (const auto& sky : skies()) EXPECT_LT(directions(*sky, 0.9), kWrong);
}

// Luminance over its integral, exactly.
TEST(sky_samplers, the_density_of_directions_is_their_luminance) {
  for (const auto& sky : skies()) {
    const SkyDirections all(*sky);
    for (uint64_t i = 0; i < 1000; ++i) {
      Rng rng(52, 0, i);
      const double y = 2 * rng.uniform() - 1, phi = 2 * pi * rng.uniform(),
                   r = std::sqrt(1 - y * y);
      const Vec3d w(r * std::cos(phi), y, r * std::sin(phi));
      EXPECT_NEAR(all.pdf_w(w) * all.total(), luminance(sky->radiance(w)), 1e-5);
    }
  }
}

// For small features: the mean of 1 / pdf of the samples there is the solid angle.
TEST(sky_samplers, suns_and_texels_of_any_size_are_drawn_as_they_are_weighed) {
  Sky::Map texel{512, 256, std::vector<Rgb>(512 * 256, Rgb(0.01f))};
  texel.texels[200 * 512 + 77] = Rgb(1e6f);
  for (const double half_angle : {1e-5, 0.25 * kDegree, 30 * kDegree}) {
    const Sky sky(texel, 1, {sun_of({0.1, 1, 0.2}, half_angle, 3)});
    const SkyDirections all(sky);
    double sun = 0, bright = 0;
    for (uint64_t i = 0; i < kSamples; ++i) {
      Rng rng(53, 0, i);
      const double pick = rng.uniform();
      const double u = rng.uniform();
      const double v = rng.uniform();
      const Vec3d w = all.sample(pick, u, v);
      const double y = luminance(sky.radiance(w)), pdf = all.pdf_w(w);
      EXPECT_GT(pdf, 0);
      if (y > 0.1e6 && w.y < 0) bright += 1 / pdf;
      if (length(w - sky.suns()[0].towards) < 2 * std::sin(half_angle / 2)) sun += 1 / pdf;
    }
    // Where the product of two weights, bilinear in the texel's neighbourhood, is above a tenth.
    const double share = 0.9 + 0.1 * std::log(0.1);
    const double of_texel =
        2 * share * (2 * pi / 512) * (std::cos(pi * 199.5 / 256) - std::cos(pi * 201.5 / 256));
    EXPECT_NEAR(bright / kSamples / of_texel, 1, 0.05) << half_angle;
    const double s = std::sin(half_angle / 2);
    EXPECT_NEAR(sun / kSamples / (4 * pi * s * s), 1, 0.05) << half_angle;
  }
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

const std::vector<Portal>& windows() {
  static const std::vector<Portal> all{
      rectangle({4.1, 0.1, -0.9}, {0, 0, 1.8}, {0, 1.8, 0}),
      rectangle({2.05, 0.875, -0.125}, {0, 0, 0.25}, {0, 0.25, 0}),
      {"triangle", {{2.5, 0.3, 0.2}, {3.5, 1.9, 0.3}, {2.6, 1.8, 0.3}}, {{0, 1, 2}}, {}, {}, true}};
  return all;
}

// Lights: emitters together, lamps by kind, the sky by direction.
double lights(const std::vector<Portal>& portals, double fault) {
  const Scene scene = room_with_lamps();
  Vista vista(scene, scene.camera(""), 4, 4, portals);
  const LightSelection& all = vista.openings.selection;
  const LightSource& sky = *all.lights().sky();
  std::vector<double> probability =
      integral([&](const Vec3d& w) { return all.pdf(sky, ~0u, -w, all.look(w)) * fault; });
  double emitters = 0;
  for (uint32_t t = 0; t < scene.triangles.size(); ++t)
    emitters += all.pdf_A(t) * shape_of(scene, t).area;
  probability.push_back(emitters);
  probability.push_back(0), probability.push_back(0);
  for (uint64_t i = 0; i < 5000; ++i) {
    Rng rng(54, 0, i);
    const Lights::Point p = all.sample(rng);
    if (!p.source->met()) probability[kBins + 1 + p.source->at_infinity()] = p.pdf;
  }
  EXPECT_GT(std::min(probability[kBins + 1], probability[kBins + 2]), 0);
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
TEST(sky_samplers, lights_beside_the_sky_are_chosen_with_their_density) {
  for (const auto& portals : {std::vector<Portal>{}, windows()})
    EXPECT_GT(lights(portals, 1), kRight);
}
TEST(sky_samplers, twin_a_sky_that_is_chosen_a_twentieth_more_often) {
  for (const auto& portals : {std::vector<Portal>{}, windows()})
    EXPECT_LT(lights(portals, 0.95), kWrong);
}

// Whatever the shares of the kinds, lights keep their shares within a kind.
TEST(sky_samplers, kinds_of_lights_are_chosen_as_often_as_was_asked) {
  const Scene scene = room_with_lamps();
  Vista vista(scene, scene.camera(""), 4, 4, windows());
  LightSelection& all = vista.openings.selection;
  const auto of_emitters = [&] {
    double sum = 0;
    for (uint32_t t = 0; t < scene.triangles.size(); ++t)
      sum += all.pdf_A(t) * shape_of(scene, t).area;
    return sum;
  };
  const Lights::KindProbabilities before = all.shares();
  EXPECT_NEAR(of_emitters(), before.surfaces, 1e-6);
  EXPECT_NEAR(before.surfaces + before.lamps + before.parallel + before.sky, 1, 1e-12);
  const Lights::KindProbabilities asked{0.1, 0.2, 0.3, 0.4};
  vista.openings = Openings(*vista.world, windows(), asked);
  EXPECT_NEAR(of_emitters(), 0.1, 1e-6);
  EXPECT_NEAR(all.sky_pdf_1(), 0.4, 1e-12);
  std::vector<uint64_t> counts(4);
  for (uint64_t i = 0; i < kSamples; ++i) {
    Rng rng(57, 0, i);
    const Lights::Point p = all.sample(rng);
    const Lights::InSky in_sky = p.source->is_sky() ? all.look(-p.position) : Lights::InSky{};
    EXPECT_NEAR(p.pdf / all.pdf(*p.source, p.triangle, p.position, in_sky), 1, 1e-9);
    ++counts[p.source->is_sky() ? 3 : p.source->is_surface() ? 0 : 1 + p.source->at_infinity()];
  }
  const auto chi_square_of = [&](std::vector<double> shares) {
    for (double& share : shares) share *= kSamples;
    return chi_square(counts, shares).p;
  };
  EXPECT_GT(chi_square_of({0.1, 0.2, 0.3, 0.4}), kRight);
  EXPECT_LT(chi_square_of({0.12, 0.2, 0.28, 0.4}), kWrong);  // twin
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
  std::vector<double> probability = integral(density, fault == 1 ? 72 : 24);
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
  constexpr int kSide = 4;
  constexpr size_t kPlaces = kSide * kSide;
  const auto quarter = [](const Vec3d& towards) {
    return static_cast<size_t>((towards.x > 0) + 2 * (towards.y > 0));
  };
  const auto cell = [](double x) { return std::clamp(static_cast<int>(x * kSide), 0, kSide - 1); };
  const auto place = [&](const Vec3d& p) {
    return static_cast<size_t>(cell(p.x + 0.5) * kSide + cell((p.z + 0.4) / 0.8));
  };
  std::vector<double> probability(4 * kPlaces);
  constexpr int kFine = 5, kAround = 192, kUp = 96;
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
             4 * kSamples, probability,
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
