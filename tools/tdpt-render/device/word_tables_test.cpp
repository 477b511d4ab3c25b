// Kernels choose lights and parts of the sky by tables of whole numbers, exactly as often as their
// densities say.
#include <gtest/gtest.h>

#include "libcommon/testing/statistics/chi_square.h"
#include "tools/tdpt-render/testing/float_vistas.h"

namespace tdpt::word_tables_test {

constexpr double kRight = 1e-4, kWrong = 1e-9;

TEST(whole_shares, are_in_proportion_and_never_none) {
  const std::vector<double> weights{1, 0, 1e-12, 3, 0};
  const std::vector<uint64_t> begin = whole_shares(weights, 255);
  ASSERT_EQ(begin.size(), 6u);
  EXPECT_EQ(begin.front(), 0u);
  EXPECT_EQ(begin.back(), 255u);
  EXPECT_NEAR(static_cast<double>(begin[1]), 64, 1);
  EXPECT_EQ(begin[2], begin[1]);
  EXPECT_NEAR(static_cast<double>(begin[3] - begin[2]), 1.5, 0.5);
  EXPECT_EQ(begin[5], begin[4]);
  for (const uint64_t n : {1u, 16u, 255u}) {
    const std::vector<uint64_t> even = whole_shares(std::vector<double>(n, 0.3), 255);
    for (size_t i = 0; i < n; ++i) {
      EXPECT_GE(even[i + 1] - even[i], 255 / n);
      EXPECT_LE(even[i + 1] - even[i], 255 / n + 1);
    }
  }
}

// As in kernels: the two ends of a guide slot enclose the entry of each of its words.
TEST(word_table, guides_to_every_word) {
  std::vector<double> weights(1000, 1e-3);
  for (size_t i = 0; i < weights.size(); i += 7) weights[i] = 0;
  weights[300] = 1e6;
  weights[301] = 1e3;
  for (const std::vector<double>& some : {weights, {1.0}, {0, 0, 1.0, 0}, {1e-30, 1, 1e-30}}) {
    std::vector<uint32_t> words(5);
    const WordTable t = add_word_table(some, words);
    const uint64_t n = some.size();
    ASSERT_EQ(t.entries, n);
    uint64_t all = 0;
    for (uint32_t i = 0; i < n; ++i) {
      const uint64_t own = t.words_of(words, i);
      if (i + 1 < n) all += own;
      if (own == 0 || words[t.begin + i] == ~0u) continue;
      EXPECT_GT(some[i], 0);
      const uint64_t first = words[t.begin + i];
      for (const uint64_t word : {first, first + own - 1}) {
        if (word > 0xFFFFFFFE) continue;
        const uint64_t slot = word * n >> 32;
        EXPECT_LE(words[t.guide + slot], i);
        EXPECT_GE(words[t.guide + slot + 1], i);
      }
    }
    EXPECT_LE(all, uint64_t{1} << 32);
  }
}

// Hundreds of emitters, the strongest a million times as strong as the faintest.
TEST(lights_by_words, of_many_strengths_are_chosen_with_their_density) {
  Scene scene = without_lamps(read_gltf(two_rooms_path()));
  for (int i = 0; i < 300; ++i)
    add_rect_light(scene, {0.1 + 0.006 * i, 1.9, 0}, {0.005, 0, 0}, {0, 0, 0.1},
                   Rgb(static_cast<float>(std::pow(10.0, -0.02 * i))));
  const FloatVista vista("many", scene);
  std::vector<uint64_t> counts(scene.triangles.size());
  constexpr uint64_t kSamples = 100000;
  for (uint64_t i = 0; i < kSamples; ++i) {
    const FourNumbers n(78, i);
    ++counts[vista.floats.sample_light(n.pick, n.u, n.v, n.side).triangle];
  }
  std::vector<double> expected, wrong;
  for (uint32_t t = 0; t < counts.size(); ++t) {
    const double pdf = vista.floats.light_pdf(shader::SOURCE_FRONT, t, {}, {});
    expected.push_back(pdf * shape_of(scene, t).area * kSamples);
    wrong.push_back(expected.back() * (t % 2 == 0 ? 1.1 : 0.9));
  }
  EXPECT_GT(chi_square(counts, expected).p, kRight);
  EXPECT_LT(chi_square(counts, wrong).p, kWrong);
}

// The remainder of a random number that selected the sky fills 32 bits without gaps, so that
// entries of a few words get their share too.
TEST(lights_by_words, in_the_sky_they_are_even_to_the_last_bit) {
  const FloatVista vista("colour", open_room(one_colour_sky({1, 2, 3})));
  ASSERT_LT(vista.tables.lights.settings.sky_pdf_1, 0.99f);
  std::vector<uint64_t> high(256), middle(256), low(256);
  double n = 0;
  for (uint64_t i = 0; i < 30000; ++i) {
    const FourNumbers f(79, i);
    const uint32_t word = vista.floats.pick_word(f.pick, f.side);
    if (!vista.floats.is_sky_entry(vista.floats.drawn_light(word))) continue;
    const uint32_t w = vista.floats.word_in_sky(word, f.side);
    ++high[w >> 24], ++middle[w >> 8 & 255], ++low[w & 255], ++n;
  }
  for (const auto& counts : {high, middle, low})
    EXPECT_GT(chi_square(counts, std::vector<double>(256, n / 256)).p, kRight);
}

// Bins of latitude and longitude, and integrals over a lattice: texels are finer than what adaptive
// rules find.
constexpr int kColumns = 32, kRows = 16, kFine = 30;

size_t bin_of(const Vec3d& w) {
  const double u = std::atan2(w.x, -w.z) / (2 * std::numbers::pi) + 0.5;
  const double v = std::acos(std::clamp(w.y, -1.0, 1.0)) / std::numbers::pi;
  return static_cast<size_t>(std::min(static_cast<int>(v * kRows), kRows - 1) * kColumns +
                             std::min(static_cast<int>(u * kColumns), kColumns - 1));
}
std::vector<double> integrals(const std::function<double(const Vec3f&)>& density) {
  std::vector<double> sums(size_t{kColumns} * kRows);
  constexpr double kStep = std::numbers::pi / (kRows * kFine);
  constexpr double kAcross = 2 * std::numbers::pi / (kColumns * kFine);
  for (int i = 0; i < kRows * kFine; ++i)
    for (int j = 0; j < kColumns * kFine; ++j) {
      const double theta = (i + 0.5) * kStep, phi = (j + 0.5) * kAcross;
      const Vec3d w(std::sin(theta) * std::sin(phi), std::cos(theta),
                    -std::sin(theta) * std::cos(phi));
      const double sr = kAcross * (std::cos(i * kStep) - std::cos((i + 1) * kStep));
      sums[bin_of(w)] += density(Vec3f(w)) * sr;
    }
  return sums;
}

// Directions that walks begin in, and those by luminance alone.
void expect_directions_of_their_density(const FloatVista& vista, bool plain) {
  const shader::ScalarKernels& floats = vista.floats;
  const shader::LightSettings& settings = vista.tables.lights.settings;
  const std::vector<double> right = integrals([&](const Vec3f& w) {
    const shader::InSky in_sky = floats.look_at_sky(w);
    return plain ? in_sky.plain_w : in_sky.start_w;
  });
  const auto p = [&](const std::vector<double>& probability) {
    return chi_square_of_samples(30000, probability,
                                 [&](uint64_t i) {
                                   const FourNumbers n(83, i);
                                   const shader::SkyPlace drawn = floats.drawn_in_sky(
                                       plain ? settings.plain : settings.start,
                                       floats.pick_word(n.pick, n.side), n.u, n.v);
                                   return bin_of(Vec3d(drawn.towards));
                                 })
        .p;
  };
  EXPECT_GT(p(right), kRight) << vista.name << plain;
  std::vector<double> wrong = right;  // twin: a tenth off
  for (size_t k = 0; k < wrong.size(); ++k) wrong[k] *= k % 2 == 0 ? 1.1 : 0.9;
  EXPECT_LT(p(wrong), kWrong) << vista.name << plain;
}
TEST(sky_by_words, directions_have_their_density) {
  for (const auto& vista : lit_vistas()) {
    // Small suns are too fine for the lattice.
    if (!vista->tables.lights.has_sky ||
        (!vista->scene.sky->suns().empty() && vista->scene.sky->suns()[0].half_angle < 5 * kDegree))
      continue;
    expect_directions_of_their_density(*vista, true);
    if (vista->tables.lights.prefers) expect_directions_of_their_density(*vista, false);
  }
}

// However small, an entry is drawn with its reported probability, and the mean of 1 / pdf is its
// solid angle.
TEST(sky_by_words, suns_and_texels_of_any_size_are_drawn_as_they_are_weighed) {
  constexpr uint64_t kSamples = 30000;
  Sky::Map texel{512, 256, std::vector<Rgb>(512 * 256, Rgb(0.01f))};
  texel.texels[200 * 512 + 77] = Rgb(1e6f);
  for (const double half_angle : {6e-5, 0.25 * kDegree, 30 * kDegree}) {
    const auto sky =
        std::make_shared<Sky>(texel, 1, std::vector{sun_of({0.1, 1, 0.2}, half_angle, 3)});
    const FloatVista vista("sun", open_room(sky, false));
    double sun = 0, bright = 0;
    for (uint64_t i = 0; i < kSamples; ++i) {
      const FourNumbers n(85, i);
      const shader::SkyPlace p = vista.floats.drawn_in_sky(
          vista.tables.lights.settings.plain, vista.floats.pick_word(n.pick, n.side), n.u, n.v);
      const shader::InSky found = vista.floats.look_in_sky(p);
      ASSERT_GT(found.plain_w, 0);
      const double y = shader::luminance(found.radiance) * vista.tables.radiance_unit;
      if (y > 0.1e6 && p.towards.y < 0) bright += 1 / found.plain_w;
      if (length(Vec3d(p.towards) - sky->suns()[0].towards) < 2 * std::sin(half_angle / 2))
        sun += 1 / found.plain_w;
    }
    const double share = 0.9 + 0.1 * std::log(0.1), pi = std::numbers::pi;
    const double of_texel =
        2 * share * (2 * pi / 512) * (std::cos(pi * 199.5 / 256) - std::cos(pi * 201.5 / 256));
    EXPECT_NEAR(bright / kSamples / of_texel, 1, 0.05) << half_angle;
    const double s = std::sin(half_angle / 2);
    EXPECT_NEAR(sun / kSamples / (4 * pi * s * s), 1, 0.05) << half_angle;
  }
}

// Rows of 2e-4 degrees at the poles, the seam, columns narrower than rounding.
TEST(sky_by_words, places_are_found_again) {
  Sky::Map map{4096, 512, {}};
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x)
      map.texels.push_back(
          Rgb(1 + 0.5f * static_cast<float>(std::sin(0.01 * x) * std::cos(0.02 * y))));
  const FloatVista vista("large", open_room(std::make_shared<Sky>(map, 0.7), false));
  for (uint64_t i = 0; i < 5000; ++i) {
    const FourNumbers n(86, i);
    shader::SkyPlace p{};
    p.column = shader::below(static_cast<uint32_t>(n.pick * 0x1p32), 4096);
    p.row = i % 4 == 0   ? 0
            : i % 4 == 1 ? 512
                         : shader::below(static_cast<uint32_t>(n.side * 0x1p32), 513);
    p.across = n.u;
    p.down = n.v;
    p.towards = vista.floats.towards_place(p);
    const Sky::Cell cell{static_cast<int>(p.column), static_cast<int>(p.row), n.u, n.v};
    EXPECT_LT(length(Vec3d(p.towards) - vista.scene.sky->towards(cell)), 1e-6);
    const shader::SkyPlace q = vista.floats.place_in_sky(p.towards);
    const double rows = (p.row + double{p.down}) - (q.row + double{q.down});
    double columns = std::abs((p.column + double{p.across}) - (q.column + double{q.across}));
    columns = std::min(columns, 4096 - columns);
    ASSERT_LT(std::abs(rows), 2e-3) << p.row << ' ' << p.down;
    // Near a pole a column is narrower than the precision of directions.
    const double r = std::sqrt(1 - double{p.towards.y} * p.towards.y);
    ASSERT_LT(columns, 2e-4 + 3e-7 / std::max(r, 1e-9) * 4096) << p.row;
  }
}

}  // namespace tdpt::word_tables_test
