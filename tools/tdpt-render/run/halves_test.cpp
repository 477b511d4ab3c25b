// The even and the odd samples of a picture are independent of each other, and tell its variance.
#include <array>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "tools/tdpt-render/testing/rendering.h"
#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/variant.h"

namespace tdpt::halves_test {

constexpr int kWidth = 12, kHeight = 9, kDepth = 4;
constexpr size_t kPixels = size_t{kWidth} * kHeight;

class halves : public ::testing::Test {
 protected:
  RenderResult rendered(const Integrator& integrator, uint64_t spp, uint64_t seed,
                        bool kept = true) const {
    Job settings;
    settings.limits.spp = spp;
    settings.seed = seed;
    settings.max_depth = kDepth;
    settings.halves = kept;
    return render(*renderer_, integrator, settings);
  }
  Film film(const Integrator& integrator, uint64_t spp, uint64_t seed) const {
    return std::move(rendered(integrator, spp, seed).progress->film);
  }
  /// A fault: both halves are of one sequence, its even and its odd samples. Those that it takes
  /// are 0, 2, 4, ..., a half that is stratified.
  Film film_of_one_sequence(const Integrator& integrator, uint64_t spp, uint64_t seed) const {
    Integrator expecting = integrator;
    expecting.mixture = expecting_connections(vista_, integrator.mixture, kDepth);
    ProgressBar progress("", "", 0, true);
    Film both = film_for(vista_, TechniqueSet(), false, true);
    for (const uint64_t half : {0, 1}) {
      Film film = film_for(vista_, TechniqueSet());
      Tally tally(film.unit());
      for (uint64_t s = half; s < spp; s += 2)
        renderer_->render(expecting, {.max_depth = kDepth, .seed = seed}, 0, {2 * s, 1}, film,
                          tally, progress);
      const std::vector<Vec3d> sums = film.sums();
      for (size_t i = 0; i < kPixels; ++i)
        both.add(static_cast<int>(i % kWidth), static_cast<int>(i / kWidth), sums[i], 0, half);
    }
    both.complete({0, spp});
    return both;
  }

  /// In the room with the lamp, where pictures have little noise.
  static Camera camera(const Scene& scene) {
    Camera camera = scene.camera("");
    camera.position += Vec3d(2.1 * scene.frame.scale, 0, 0);
    return camera;
  }
  const Scene scene_ = read_gltf(two_rooms_path());
  const Vista vista_{scene_, camera(scene_), kWidth, kHeight, {portal_in_the_hole()}};
  const std::shared_ptr<SampleRenderer> renderer_ = std::make_shared<CpuRenderer>(vista_);
};

TEST_F(halves, make_the_picture_and_do_not_change_it) {
  for (const Integrator* integrator : integrators()) {
    const RenderResult r = rendered(*integrator, 5, 1);
    EXPECT_EQ(r.picture.pixels, rendered(*integrator, 5, 1, false).picture.pixels)
        << integrator->name;
    const Picture even = r.progress->film.half(0), odd = r.progress->film.half(1);
    EXPECT_NE(even.pixels, odd.pixels);
    for (size_t i = 0; i < kPixels; ++i)
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR((3 * even.pixels[i][c] + 2 * odd.pixels[i][c]) / 5, r.picture.pixels[i][c],
                    1e-6 * r.picture.pixels[i][c])
            << integrator->name;
  }
}

TEST_F(halves, are_the_samples_of_even_and_of_odd_number) {
  const Film whole = film(bdpt, 3, 1);
  Film odd = film_for(vista_, TechniqueSet());
  Tally tally(odd.unit());
  ProgressBar progress("", "", 0, true);
  Integrator expecting = bdpt;
  expecting.mixture = expecting_connections(vista_, bdpt.mixture, kDepth);
  renderer_->render(expecting, {kDepth}, 0, {1, 1}, odd, tally, progress);
  EXPECT_EQ(whole.half(1).pixels, odd.picture().pixels);
  const Film one = film(nee, 1, 1);
  EXPECT_EQ(one.half(0).pixels, one.picture().pixels);
  EXPECT_EQ(one.half(1).pixels, std::vector<Rgb>(kPixels));
}

using Render = std::function<Film(uint64_t seed)>;

// Luminance by pixel.
std::vector<double> luminances(const Picture& picture) {
  std::vector<double> y;
  for (const Rgb& p : picture.pixels) y.push_back(static_cast<double>(luminance(p)));
  return y;
}

/// Mean correlation of a pixel's halves over pictures of several seeds.
struct Correlation {
  double mean = 0, error = 0;
};
Correlation correlation(const Render& render) {
  constexpr size_t kSeeds = 100;
  std::array<std::vector<std::vector<double>>, 2> all;
  for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Film film = render(seed);
    for (const uint64_t half : {0, 1}) all[half].push_back(luminances(film.half(half)));
  }
  // Of each seed, the mean over pixels of (A - its mean) (B - its mean) / their variance.
  std::vector<double> of_seed(kSeeds);
  for (size_t i = 0; i < kPixels; ++i) {
    std::array<double, 2> mean{}, square{};
    for (size_t h : {0, 1})
      for (const auto& y : all[h]) mean[h] += y[i] / kSeeds, square[h] += y[i] * y[i] / kSeeds;
    const double variance =
        std::sqrt((square[0] - mean[0] * mean[0]) * (square[1] - mean[1] * mean[1]));
    for (size_t s = 0; s < kSeeds; ++s)
      of_seed[s] += (all[0][s][i] - mean[0]) * (all[1][s][i] - mean[1]) / (variance * kPixels);
  }
  Correlation c;
  double square = 0;
  for (const double x : of_seed) c.mean += x / kSeeds, square += x * x / kSeeds;
  c.error = std::sqrt((square - c.mean * c.mean) / (kSeeds - 1));
  return c;
}
TEST_F(halves, are_independent) {
  for (const Integrator* integrator : {&nee, &tdpt_guided})
    for (const uint64_t spp : {2, 8}) {
      const Correlation c =
          correlation([&](uint64_t seed) { return film(*integrator, spp, seed); });
      EXPECT_LT(std::abs(c.mean), 4 * c.error) << integrator->name << " " << spp;
      EXPECT_LT(c.error, 0.02);
    }
}
TEST_F(halves, twin_those_of_one_sequence_are_not) {
  const Correlation c =
      correlation([&](uint64_t seed) { return film_of_one_sequence(nee, 2, seed); });
  EXPECT_LT(c.mean, -6 * c.error);
}

/// Variance that pictures tell of themselves / that seen among pictures of other seeds.
double told_over_seen(const Render& render) {
  constexpr size_t kSeeds = 100;
  std::vector<double> sum(kPixels), square(kPixels);
  double told = 0, seen = 0;
  for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Film film = render(seed);
    const std::vector<double> variance = film.variance(), y = luminances(film.picture());
    for (size_t i = 0; i < kPixels; ++i)
      sum[i] += y[i], square[i] += y[i] * y[i], told += variance[i] / kSeeds;
  }
  for (size_t i = 0; i < kPixels; ++i)
    seen += (square[i] - sum[i] * sum[i] / kSeeds) / (kSeeds - 1);
  return told / seen;
}
TEST_F(halves, tell_the_variance_of_pictures_of_other_seeds) {
  for (const uint64_t spp : {2, 7})
    EXPECT_NEAR(told_over_seen([&](uint64_t seed) { return film(nee, spp, seed); }), 1, 0.1) << spp;
  const double of_one_sequence =
      told_over_seen([&](uint64_t seed) { return film_of_one_sequence(nee, 2, seed); });
  EXPECT_GT(of_one_sequence, 1.1);  // twin
}

}  // namespace tdpt::halves_test
