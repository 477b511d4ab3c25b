#include "tools/tdpt-render/plan/noise.h"

#include <cmath>

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "tools/tdpt-render/testing/rendering.h"
#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::noise_test {

constexpr int kWidth = 48, kHeight = 36;

// A picture of known means: a gradient, a checkered floor and a lamp.
double mean_of(int x, int y) {
  if (x < 4 && y < 4) return 8;
  return (0.1 + 0.02 * x) * (y > 24 && (x / 3 + y / 3) % 2 == 0 ? 4 : 1);
}

// Of mean 1.
using Sample = double (*)(Rng&);
double light_tailed(Rng& rng) {
  return 2 * rng.uniform();
}
// Most are black, and few of the others hold most of the light.
double heavy_tailed(Rng& rng) {
  if (rng.uniform() > 0.25) return 0;
  const double u = rng.uniform();
  return 4 * 1.4 / 2.4 * std::pow(1 - u, -1 / 2.4);  // Pareto
}

/// What is wrong with the samples, for twins.
enum class Fault { none, repeated, hidden };

// `repeated`: from the ninth on, samples are those before. `hidden`: a third of the light
// comes from samples that are met too seldom.
void add_sample(Film& film, uint64_t s, uint64_t seed, Sample sample, Fault fault) {
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const auto pixel = static_cast<uint64_t>(y * kWidth + x);
      Rng rng(seed, pixel, fault == Fault::repeated ? s % 8 : s);
      double v = sample(rng) * mean_of(x, y);
      if (fault == Fault::hidden) v *= 2.0 / 3;
      film.add(x, y, {v, v, v}, mix64(s + pixel), s);
    }
  film.complete({s, 1});
}

double true_relmse(const Film& film) {
  double all = 0, sum = 0;
  const std::vector<Vec3d> sums = film.sums();
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) all += mean_of(x, y) / (kWidth * kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const double mean = mean_of(x, y);
      const double off =
          sums[static_cast<size_t>(y * kWidth + x)].x / static_cast<double>(film.samples()) - mean;
      sum += off * off / (mean * mean + 0.01 * all * all) / (kWidth * kHeight);
    }
  return sum;
}

struct Coverage {
  int told = 0, held = 0;  // of all pictures; of those told
  double off = 0;          // mean log of told over true
};

Coverage coverage(uint64_t samples, Sample sample, Fault fault = Fault::none) {
  constexpr uint64_t kPictures = 40;
  Coverage c;
  for (uint64_t seed = 1; seed <= kPictures; ++seed) {
    Film film(kWidth, kHeight, 1);
    PictureBlocks blocks;
    for (uint64_t s = 0; s < samples; ++s) {
      add_sample(film, s, seed, sample, fault);
      if (film.samples() == blocks.next()) blocks.add(film.sums(watched_step(film)));
    }
    const std::optional<Noise> noise = noise_of(film, blocks);
    if (!noise) continue;
    const double truth = true_relmse(film);
    ++c.told;
    c.held += noise->low <= truth && truth <= noise->high;
    c.off += std::log(noise->relmse / truth);
  }
  c.off /= std::max(c.told, 1);
  return c;
}

TEST(noise, holds_in_nine_of_ten_pictures) {
  for (const uint64_t samples : {4, 7, 37}) {
    for (const Sample sample : {light_tailed, heavy_tailed}) {
      const Coverage c = coverage(samples, sample);
      std::printf("%2d samples, %s-tailed: told %d, held %d, told over true %.2f\n",
                  static_cast<int>(samples), sample == heavy_tailed ? "heavy" : "light", c.told,
                  c.held, std::exp(c.off));
      EXPECT_GE(c.held, 0.9 * c.told) << samples;
      EXPECT_GE(c.told, 36) << samples;
    }
  }
}

TEST(noise, twin_samples_that_repeat_each_other_and_light_that_none_met) {
  EXPECT_LT(coverage(16, light_tailed, Fault::repeated).held, 10);
  EXPECT_LT(coverage(37, light_tailed, Fault::hidden).held, 10);
}

TEST(noise, is_said_with_what_a_clean_picture_takes) {
  const auto says = [](const std::optional<Noise>& noise, const char* words) {
    return noise_sentence(noise, 2).find(words) != std::string::npos;
  };
  EXPECT_EQ(noise_sentence(Noise{0.004, 0.003, 0.005}, 2), "clean (relMSE 0.004, 0.003 to 0.005)");
  EXPECT_TRUE(says(Noise{0.45, 0.4, 0.6}, "64 times as many samples (2.1 minutes here)"));
  EXPECT_TRUE(says(Noise{0.012, 0.009, 0.015}, "still noisy (relMSE 0.012, 0.009 to 0.015)"));
  EXPECT_TRUE(says(Noise{0.012, 0.009, 0.015}, "2 times as many samples (4 s here)"));
  EXPECT_TRUE(says({}, "cannot be told"));
}

TEST(noise, is_not_told_from_three_samples_nor_where_few_pixels_hold_most_of_it_nor_of_the_dark) {
  Film film(kWidth, kHeight, 1), dark(2, 2, 1);
  PictureBlocks blocks, blocks_of_dark;
  for (uint64_t s = 0; s < 8; ++s) {
    add_sample(film, s, 3, light_tailed, Fault::none);
    if (s == 5) film.add(20, 10, {100, 100, 100}, 0, s);  // half of the error
    if (film.samples() == blocks.next()) blocks.add(film.sums(1));
    if (s < 4) {
      EXPECT_EQ(noise_of(film, blocks).has_value(), s == 3);
    }
    dark.complete({s, 1});
    if (dark.samples() == blocks_of_dark.next()) blocks_of_dark.add(dark.sums(1));
  }
  EXPECT_FALSE(noise_of(film, blocks));
  EXPECT_FALSE(noise_of(dark, blocks_of_dark));
}

// The watched pixels cover every column, whatever the width.
TEST(noise, is_told_where_light_falls_into_one_column_alone) {
  for (const int width : {1024, 777}) {
    Film film(width, 1024, 1);
    PictureBlocks blocks;
    for (uint64_t s = 0; s < 4; ++s) {
      for (int y = 0; y < 1024; ++y) film.add(7, y, {1, 1, 1}, 0, 0);
      film.complete({s, 1});
      blocks.add(film.sums(watched_step(film)));
    }
    EXPECT_TRUE(noise_of(film, blocks)) << width;
  }
}

TEST(noise, of_a_rendering_is_told_and_changes_no_pixel) {
  const Scene scene = read_gltf(two_rooms_path());
  const Vista vista(scene, scene.camera(""), 32, 24, {portal_in_the_hole()});
  Job settings;
  settings.limits.spp = 37;
  const RenderResult r = render(vista, bdpt, settings);
  ASSERT_TRUE(r.noise);
  EXPECT_GT(r.noise->relmse, 0);
  EXPECT_LT(r.noise->low, r.noise->high);
  Film film = film_for(vista, TechniqueSet());
  Tally tally(film.unit());
  ProgressBar progress("", "", 0, true);
  CpuRenderer(vista).render(r.plan.integrator, {}, 0, {0, 37}, film, tally, progress);
  EXPECT_EQ(film.picture().pixels, r.picture.pixels);
}

}  // namespace tdpt::noise_test
