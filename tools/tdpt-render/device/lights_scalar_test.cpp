// Lights in floats match those that the renderer computes in doubles, and a device's match its
// scalar build's to the last bit.
#include <cstddef>

#include "libcommon/gpu/kernel.h"
#include "libcommon/math/rng.h"
#include "libcommon/testing/statistics/chi_square.h"
#include "shaders/lights_test.h"
#include "shaders/shared/path/words_test.h"
#include "tools/tdpt-render/testing/lights.h"

namespace tdpt {
namespace shader {

struct TestedLights : ScalarLights {
  const Shaded* shaded_places;
  TestedLights(const LightTables& tables, const std::vector<Shaded>& places)
      : ScalarLights(tables), shaded_places(places.data()) {}

#include "shaders/shared/path/lights_test.h"
};

}  // namespace shader

namespace lights_scalar_test {

constexpr uint32_t kGroups = 64, kInvocations = 64 * kGroups;

// Places in both rooms and behind their walls; simple, bent, and lit from both sides.
std::vector<shader::Shaded> shaded_places(const Scene& scene) {
  std::vector<shader::Shaded> all;
  for (uint64_t i = 0; i < shader::kShadedPlaces; ++i) {
    Rng rng(71, 0, i);
    const auto next = [&] { return rng.uniform(); };
    const double x = next(), y = next(), z = next(), a = next(), b = next();
    shader::Shaded s{};
    s.position = Vec3f(scene.frame.to_canonical({4.2 * x - 0.1, 2.2 * y - 0.1, 2.2 * z - 1.1}));
    s.normal = Vec3f(cosine_hemisphere(Vec3d(0, 1, 0), a, b));
    s.shading = Vec3f(normalize(Vec3d(s.normal) + Vec3d(0.3, 0, 0.2)));
    s.simple = i % 3 != 0;
    s.through_windows = i % 5 == 0 ? 0 : 0.5f;
    if (i % 6 != 0) s.facing = i % 2 == 0 ? s.normal : -s.normal;
    all.push_back(s);
  }
  return all;
}

std::vector<uint32_t> device_words(const LightTables& t,
                                   const std::vector<shader::Shaded>& places) {
  using gpu::Buffer;
  gpu::Device device = gpu::Device::open();
  const Buffer words(device, uint64_t{4} * kInvocations * shader::kLightWords);
  const gpu::Kernel kernel(
      device, shader::lights_test_spv,
      {Buffer(device, std::vector{t.settings}), Buffer(device, t.words), Buffer(device, t.emitters),
       Buffer(device, t.lamps), Buffer(device, t.suns), Buffer(device, t.texels),
       Buffer(device, t.rect_lights), Buffer(device, t.windows), Buffer(device, t.frames),
       Buffer(device, places), words},
      sizeof(uint32_t));
  const uint32_t has = t.has_sky * shader::HAS_SKY + t.has_sky_map * shader::HAS_SKY_MAP +
                       t.has_lamps * shader::HAS_LAMPS +
                       t.has_rect_lights * shader::HAS_RECT_LIGHTS +
                       t.has_windows * shader::HAS_WINDOWS + t.prefers * shader::PREFERS;
  device.run([&](gpu::Commands& c) { c.dispatch(kernel, gpu::push(has), kGroups); });
  return words.download<uint32_t>(size_t{kInvocations} * shader::kLightWords);
}

struct Differences {
  size_t words = 0, no_numbers = 0;
};
// Compares `theirs` with the scalar build.
Differences compare_words(const std::vector<uint32_t>& theirs, const LightTables& tables,
                          const std::vector<shader::Shaded>& places) {
  const shader::TestedLights scalar(tables, places);
  Differences d;
  for (uint32_t i = 0; i < kInvocations; ++i) {
    const shader::LightWords mine = scalar.light_words_of(i);
    for (size_t k = 0; k < shader::kLightWords; ++k) {
      d.words += mine.words[k] != theirs[i * shader::kLightWords + k];
      d.no_numbers += !std::isfinite(std::bit_cast<float>(mine.words[k]));
    }
  }
  return d;
}

// Both tests in one run: compiling so many lights takes a device long.
TEST(lights_scalar, a_device_makes_the_same_words_of_all_lights_and_one_wrong_bit_is_seen) {
  const std::vector<std::string> named{"rectangular lights",
                                       "colour and windows",
                                       "uneven and windows",
                                       "fine",
                                       "rectangular lights and windows",
                                       "luminaires"};
  size_t lamps = 0;
  for (const auto& lit : lit_vistas(named)) {
    const std::vector<shader::Shaded> places = shaded_places(lit->scene);
    const std::vector<uint32_t> theirs = device_words(lit->tables, places);
    const Differences d = compare_words(theirs, lit->tables, places);
    EXPECT_EQ(d.words, 0u) << lit->name;
    EXPECT_EQ(d.no_numbers, 0u) << lit->name;
    if (!lit->tables.has_lamps) continue;
    ++lamps;
    LightTables wrong = lit->tables;
    float& x = wrong.lamps[0].position.x;
    x = std::bit_cast<float>(std::bit_cast<uint32_t>(x) ^ 1u);
    EXPECT_GT(compare_words(theirs, wrong, places).words, 0u) << lit->name;
  }
  EXPECT_GT(lamps, 0u);
}

// Index of the renderer's light: its kind, and which of the lamps.
uint32_t source_of(const LitVista& lit, const LightSource& source) {
  if (source.is_sky()) return shader::SOURCE_SKY;
  if (&source == &lit.vista.world->lights.surface(false)) return shader::SOURCE_FRONT;
  if (&source == &lit.vista.world->lights.surface(true)) return shader::SOURCE_BOTH;
  return shader::SOURCE_LAMPS +
         static_cast<uint32_t>(&source - lit.vista.world->lights.lamps().data());
}
const LightSource& source_at(const LitVista& lit, uint32_t source) {
  const Lights& lights = lit.vista.world->lights;
  if (source == shader::SOURCE_SKY) return *lights.sky();
  if (source < shader::SOURCE_SKY) return lights.surface(source == shader::SOURCE_BOTH);
  return lights.lamps()[source - shader::SOURCE_LAMPS];
}

double difference(const Vec3f& a, const Vec3d& b) {
  return length(Vec3d(a) - b);
}

// The same random numbers select the same point on surfaces and lamps, with the same density.
TEST(lights, are_chosen_as_the_renderer_chooses_them) {
  for (const auto& lit : lit_vistas()) {
    int others = 0;
    for (uint64_t i = 0; i < 20000; ++i) {
      const FourNumbers n(72, i);
      const shader::LightPlace p = lit->scalar.sample_light(n.pick, n.u, n.v, n.side);
      const Lights::Point q = lit->vista.openings.selection.sample(n.pick, n.u, n.v, n.side);
      if (p.source != source_of(*lit, *q.source) || p.triangle != q.triangle) {
        ++others;
        continue;
      }
      if (p.source == shader::SOURCE_SKY) continue;
      EXPECT_LT(difference(p.position, q.position), 1e-6) << lit->name;
      EXPECT_LT(difference(p.normal, q.normal), 1e-6);
      EXPECT_NEAR(p.pdf / q.pdf, 1, 1e-6) << lit->name;
      EXPECT_NEAR(p.b1, q.b1, 1e-6);
      EXPECT_NEAR(p.b2, q.b2, 1e-6);
    }
    EXPECT_LE(others, 1) << lit->name;  // at the border between two shares
  }
}

// For the same point: the ray that leaves, its radiance, the densities.
TEST(lights, shine_as_the_renderer_has_them) {
  for (const auto& lit : lit_vistas()) {
    for (uint64_t i = 0; i < 5000; ++i) {
      const FourNumbers n(73, i), m(74, i);
      const shader::LightPlace p = lit->scalar.sample_light(n.pick, n.u, n.v, n.side);
      const LightSource& source = source_at(*lit, p.source);
      Lights::Point q;
      q.source = &source;
      q.position = Vec3d(p.position);
      q.normal = Vec3d(p.normal);
      shader::vec3 origin, w;
      lit->scalar.leave_light(p, m.u, m.v, origin, w);
      const Lights::Ray ray = lit->vista.world->lights.leave(q, m.u, m.v);
      ASSERT_LT(difference(origin, ray.origin), 2e-6) << lit->name;
      ASSERT_LT(difference(w, ray.direction), 1e-6) << lit->name;
      EXPECT_EQ(lit->scalar.source_met(p.source), source.met());
      EXPECT_EQ(lit->scalar.source_at_infinity(p.source), source.at_infinity());
      EXPECT_NEAR(lit->scalar.cos_per_pdf_w(p.source, w) / source.cos_per_pdf_w(ray.direction), 1,
                  1e-6);
      EXPECT_EQ(difference(lit->scalar.source_facing(p.source, p.normal), source.facing(q.normal)),
                0);
      const Vec3f other =
          m.pick < 0.5f ? w : Vec3f(cosine_hemisphere(Vec3f(0, 1, 0), m.side, m.pick));
      EXPECT_NEAR(lit->scalar.emission_pdf_w(p.source, p.normal, other),
                  source.pdf_w(q.normal, Vec3d(other)),
                  2e-7 * (1 + source.pdf_w(q.normal, Vec3d(other))));
      if (p.source == shader::SOURCE_SKY) continue;
      const Rgb emission(1, 2, 3);
      const Rgb told(Vec3d(emission) * kUnit);
      const Rgb mine = lit->scalar.source_radiance(p.source, p.normal, emission, p.in_sky, other);
      const Rgb theirs = source.emitted(q.normal, told, Vec3d(other));
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(std::sqrt(mine[c] * kUnit), std::sqrt(theirs[c]), 2e-6) << lit->name;
    }
  }
}

// Over the area of emitters, each lamp, and a lattice of the sky.
double sum_of_densities(const LitVista& lit) {
  double sum = 0;
  for (uint32_t t = 0; t < lit.scene.triangles.size(); ++t)
    sum += lit.scalar.light_pdf(shader::SOURCE_FRONT, t, {}, {}) * shape_of(lit.scene, t).area;
  for (uint32_t i = 0; i < lit.tables.settings.lamps; ++i)
    sum += lit.scalar.light_pdf(shader::SOURCE_LAMPS + i, 0, {}, {});
  return sum + (lit.tables.has_sky ? lit.tables.settings.sky_pdf_1 : 0);
}
TEST(lights, have_densities_that_add_up_to_one) {
  for (const auto& lit : lit_vistas()) EXPECT_NEAR(sum_of_densities(*lit), 1, 1e-5) << lit->name;
}

// The pilot may change the probabilities of kinds: tables made then have them.
TEST(lights, are_chosen_by_the_shares_that_are_asked_for) {
  LitVista lit("uneven", open_room(uneven_sky()), {});
  const Lights::KindProbabilities asked{0.1, 0.2, 0.3, 0.4};
  lit.vista.openings = Openings(*lit.vista.world, {}, asked);
  const LightTables tables = make_light_tables(lit.vista, kUnit);
  const shader::ScalarLights scalar(tables);
  std::vector<uint64_t> counts(4);
  for (uint64_t i = 0; i < 60000; ++i) {
    const FourNumbers n(75, i);
    const uint32_t source = scalar.sample_light(n.pick, n.u, n.v, n.side).source;
    ++counts[source == shader::SOURCE_SKY  ? 3
             : source < shader::SOURCE_SKY ? 0
                                           : 1 + scalar.source_at_infinity(source)];
  }
  EXPECT_NEAR(tables.settings.sky_pdf_1, 0.4, 1e-6);
  EXPECT_GT(chi_square(counts, {6000, 12000, 18000, 24000}).p, 1e-4);
  EXPECT_LT(chi_square(counts, {7200, 12000, 16800, 24000}).p, 1e-9);  // twin
}

// Hundreds of emitters, the strongest a million times as strong as the faintest.
TEST(lights, of_many_strengths_are_chosen_with_their_density) {
  Scene scene = without_lamps(read_gltf(two_rooms_path()));
  for (int i = 0; i < 300; ++i)
    add_rect_light(scene, {0.1 + 0.006 * i, 1.9, 0}, {0.005, 0, 0}, {0, 0, 0.1},
                   Rgb(static_cast<float>(std::pow(10.0, -0.02 * (i % 300)))));
  const LitVista lit("many", scene, {});
  ASSERT_EQ(lit.tables.settings.emitters, 600u);
  std::vector<uint64_t> counts(scene.triangles.size());
  constexpr uint64_t kSamples = 200000;
  for (uint64_t i = 0; i < kSamples; ++i) {
    const FourNumbers n(78, i);
    const shader::LightPlace p = lit.scalar.sample_light(n.pick, n.u, n.v, n.side);
    ASSERT_LT(p.triangle, counts.size());
    EXPECT_EQ(p.pdf, lit.scalar.light_pdf(p.source, p.triangle, p.position, p.in_sky));
    ++counts[p.triangle];
  }
  std::vector<double> expected, wrong;
  for (uint32_t t = 0; t < counts.size(); ++t) {
    const double all = lit.scalar.light_pdf(shader::SOURCE_FRONT, t, {}, {}) * kSamples;
    expected.push_back(all * shape_of(scene, t).area);
    wrong.push_back(expected.back() * (t % 2 == 0 ? 1.1 : 0.9));
  }
  EXPECT_GT(chi_square(counts, expected).p, 1e-4);
  EXPECT_LT(chi_square(counts, wrong).p, 1e-9);  // twin
}

// The remainder of a random number that selected the sky fills 32 bits without gaps, so that
// entries of a few words get their share too.
TEST(lights, words_in_the_sky_are_even_to_the_last_bit) {
  const LitVista lit("colour", open_room(one_colour_sky({1, 2, 3})), {});
  ASSERT_LT(lit.tables.settings.sky_pdf_1, 0.99f);
  std::vector<uint64_t> high(256), middle(256), low(256);
  double n = 0;
  for (uint64_t i = 0; i < 100000; ++i) {
    const FourNumbers f(79, i);
    const uint32_t word = lit.scalar.pick_word(f.pick, f.side);
    if (!lit.scalar.is_sky_entry(lit.scalar.drawn_light(word))) continue;
    const uint32_t w = lit.scalar.word_in_sky(word, f.side);
    ++high[w >> 24], ++middle[w >> 8 & 255], ++low[w & 255], ++n;
  }
  for (const auto& counts : {high, middle, low})
    EXPECT_GT(chi_square(counts, std::vector<double>(256, n / 256)).p, 1e-4);
}

// Without emission there is nothing to sample.
TEST(lights, there_may_be_none) {
  const LitVista lit("dark", without_lamps(read_gltf(two_rooms_path())), {});
  EXPECT_EQ(lit.scalar.sample_light(0.5f, 0.5f, 0.5f, 0.5f).source, shader::SOURCE_NONE);
}

// A cone of a thousandth of a degree, and a lamp billions of times fainter than another.
TEST(lights, of_any_width_and_strength_are_found) {
  Scene scene = without_lamps(read_gltf(two_rooms_path()));
  PunctualLight lamp;
  lamp.kind = PunctualLight::Kind::spot;
  lamp.direction = normalize(Vec3d(1, -0.3, 0.2));
  lamp.cos_inner = lamp.cos_outer = std::cos(1e-3 * kDegree);
  lamp.intensity = Rgb(1e9f);
  scene.lights.push_back(lamp);
  lamp.kind = PunctualLight::Kind::point;
  lamp.intensity = Rgb(1e-20f);
  scene.lights.push_back(lamp);
  const LitVista lit("narrow", scene, {});
  int faint = 0, lit_ones = 0, spots = 0;
  for (uint64_t i = 0; i < 10000; ++i) {
    const FourNumbers n(76, i), m(77, i);
    const shader::LightPlace p = lit.scalar.sample_light(n.pick, n.u, n.v, n.side);
    shader::vec3 origin, w;
    lit.scalar.leave_light(p, m.u, m.v, origin, w);
    EXPECT_NEAR(length(Vec3d(w)), 1, 3e-7);
    faint += p.source == shader::SOURCE_LAMPS + 1;
    if (p.source != shader::SOURCE_LAMPS) continue;
    ++spots;
    lit_ones += lit.scalar.emission_pdf_w(p.source, {}, w) > 0;
  }
  EXPECT_NEAR(faint, 50, 30);
  // Directions are accurate to 1e-7, the cone is 1.7e-5 wide.
  EXPECT_GT(lit_ones, 0.98 * spots);
}

}  // namespace lights_scalar_test
}  // namespace tdpt
