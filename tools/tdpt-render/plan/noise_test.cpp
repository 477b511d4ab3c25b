#include "tools/tdpt-render/plan/noise.h"

#include <cmath>

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "tools/tdpt-render/run/render.h"
#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::noise_test {

constexpr int kWidth = 200, kHeight = 150;

// A picture whose pixels have known means; a sample is uniform from 0 to twice that.
double mean_of(size_t pixel) {
  return 0.1 + static_cast<double>(pixel % 17);
}

// `again`: every block of four samples repeats the random numbers of the first.
void add_samples(Film& film, uint64_t n, uint64_t seed, bool again) {
  const uint64_t first = film.samples();
  for (uint64_t s = first; s < first + n; ++s)
    for (size_t i = 0; i < kWidth * kHeight; ++i) {
      Rng rng(seed, i, again ? s % 4 : s);
      const double x = 2 * rng.uniform() * mean_of(i);
      film.add(static_cast<int>(i % kWidth), static_cast<int>(i / kWidth), {x, x, x}, mix64(s + i),
               s);
    }
  film.complete({first, n});
}

double true_relmse(const Film& film) {
  const auto n = static_cast<double>(film.samples());
  const std::vector<Vec3d> sums = film.sums();
  double all = 0, sum = 0;
  for (size_t i = 0; i < sums.size(); ++i) all += mean_of(i) / static_cast<double>(sums.size());
  for (size_t i = 0; i < sums.size(); ++i) {
    const double off = sums[i].x / n - mean_of(i);
    sum += off * off / (mean_of(i) * mean_of(i) + 0.01 * all * all);
  }
  return sum / static_cast<double>(sums.size());
}

// Estimated noise of a picture of `samples`, over the truth; `before`: samples rendered before the
// watch began.
double told_over_truth(uint64_t samples, uint64_t before = 0, bool again = false) {
  Film film(kWidth, kHeight, 1);
  if (before > 0) add_samples(film, before, 3, again);
  NoiseWatch watch(film);
  while (film.samples() < samples) {
    add_samples(film, std::min(samples, watch.next()) - film.samples(), 3, again);
    if (film.samples() == watch.next()) watch.look(film);
  }
  const std::optional<Noise> noise = watch.noise(film);
  EXPECT_TRUE(noise.has_value());
  return noise ? noise->relmse / true_relmse(film) : 0;
}

TEST(noise, is_said_with_what_a_clean_picture_takes) {
  EXPECT_EQ(noise_sentence({0.004, 0.003, 0.005, true}, 2), "clean (relMSE 0.004, 0.003 to 0.005)");
  EXPECT_EQ(noise_sentence({0.45, 0.3, 0.6, true}, 2),
            "still noisy (relMSE 0.45, 0.3 to 0.6); for a clean picture: about 64 times as many "
            "samples (2.1 minutes here), or --target-error 0.01");
  EXPECT_EQ(noise_sentence({0.05, 0.025, 0.1, false}, 2),
            "still noisy (relMSE above 0.025); for a clean picture: at least 4 times as many "
            "samples (8 s here), or --target-error 0.01");
  EXPECT_EQ(noise_sentence({0.02, 0.008, 0.1, false}, 2),
            "noise not known yet (relMSE above 0.008)");
  EXPECT_EQ(noise_sentence({3, 1, 9, false}, 200),
            "very noisy (relMSE above 0.5); for a clean picture: at least 64 times as many "
            "samples (3.6 hours here), or --target-error 0.01");
}

TEST(noise, is_that_of_the_picture) {
  for (const uint64_t samples : {16, 37, 64}) {
    const double told = told_over_truth(samples);
    EXPECT_GT(told, 0.95) << samples;
    EXPECT_LT(told, 1.2) << samples;
  }
  const double gone_on = told_over_truth(37, 21);
  EXPECT_GT(gone_on, 0.95);
  EXPECT_LT(gone_on, 1.25);
}

TEST(noise, twin_blocks_that_share_their_random_numbers) {
  EXPECT_LT(told_over_truth(16, 0, true), 0.1);
}

TEST(noise, is_not_told_from_three_samples_or_of_the_dark) {
  Film lit(kWidth, kHeight, 1);
  NoiseWatch watch_of_lit(lit);
  for (uint64_t s = 0; s < 3; ++s) {
    EXPECT_FALSE(watch_of_lit.noise(lit));
    add_samples(lit, 1, 3, false);
    watch_of_lit.look(lit);
  }
  EXPECT_FALSE(watch_of_lit.noise(lit));
  Film film(2, 2, 1);
  NoiseWatch watch(film);
  for (uint64_t s = 0; s < 4; ++s) {
    EXPECT_FALSE(watch.noise(film));
    film.complete({s, 1});
    watch.look(film);
  }
  EXPECT_FALSE(watch.noise(film));
}

// The watched pixels cover every column, whatever the width.
TEST(noise, is_told_where_light_falls_into_one_column_alone) {
  for (const int width : {1024, 1000, 640, 777}) {
    Film film(width, 1024, 1);
    NoiseWatch watch(film);
    for (uint64_t s = 0; s < 4; ++s) {
      for (int y = 0; y < 1024; ++y) film.add(7, y, {1, 1, 1}, 0, 0);
      film.complete({s, 1});
      watch.look(film);
    }
    EXPECT_TRUE(watch.noise(film)) << width;
  }
}

TEST(noise, of_a_rendering_is_told_and_changes_no_pixel) {
  const Scene scene = read_gltf(two_rooms_path());
  const World world(scene, scene.camera(""), 32, 24, {portal_in_the_hole()});
  RenderSettings settings;
  settings.spp = 37;
  const RenderResult r = render(world, bdpt, settings);
  ASSERT_TRUE(r.noise);
  EXPECT_GT(r.noise->relmse, 0);
  EXPECT_LT(r.noise->low, r.noise->high);
  Film film = film_for(world, TechniqueSet());
  Tally tally(film.unit());
  Progress progress("", "", 0, true);
  render_samples(world, r.plan.integrator, {}, 0, {0, 37}, film, tally, progress);
  EXPECT_EQ(film.picture().pixels, r.picture.pixels);
}

}  // namespace tdpt::noise_test
