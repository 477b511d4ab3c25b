// Pictures rendered to a target error.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <nlohmann/json.hpp>

#include "tools/tdpt-render/plan/noise.h"
#include "tools/tdpt-render/testing/rendering.h"

namespace tdpt::target_test {

constexpr int kWidth = 16, kHeight = 12;

struct Window {
  Scene scene = read_gltf(TDPT_TESTDATA "/scenes/window.glb");
  Vista vista{scene, scene.camera(""), kWidth, kHeight, {}};
};
const Window& window() {
  static const Window window;
  return window;
}

Job to(double error) {
  Job settings;
  settings.limits.target_error = error;
  return settings;
}

// As exrdiff reports it.
double relmse(const Picture& picture, const Picture& reference) {
  double m = 0, sum = 0;
  const auto n = 3 * static_cast<double>(reference.pixels.size());
  for (const Rgb& r : reference.pixels)
    for (int c = 0; c < 3; ++c) m += static_cast<double>(r[c]) / n;
  for (size_t i = 0; i < reference.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      const auto r = static_cast<double>(reference.pixels[i][c]);
      const double d = static_cast<double>(picture.pixels[i][c]) - r;
      sum += d * d / (r * r + 0.01 * m * m) / n;
    }
  return sum;
}

Picture reference_of(const Vista& vista) {
  Job settings;
  settings.limits.spp = 2048;
  settings.seed = 77;
  return render(vista, nee, settings).picture;
}
const Picture& reference() {
  static const Picture reference = reference_of(window().vista);
  return reference;
}

// A pilot's estimate over the mean relMSE of pictures of as many samples. `one_round`: its parts
// share the random numbers of one round.
double told_over_true(bool one_round) {
  Film film(kWidth, kHeight, window().vista.world->lights.power());
  Tally tally(film.unit());
  ProgressBar progress("", "", 0, true);
  const DrawPart draw = [&](uint64_t part, const SampleRange& samples) {
    film.clear();
    CpuRenderer(window().vista)
        .render(nee, {}, one_round ? 3 : 3 + part, samples, film, tally, progress);
    return std::optional(film.sums());
  };
  const ErrorEstimate estimate = run_error_pilot(kWidth * kHeight, 1e6, 1, draw).estimate;
  double mean = 0;
  constexpr uint64_t kPictures = 12;
  for (uint64_t seed = 1; seed <= kPictures; ++seed) {
    Job settings;
    settings.limits.spp = estimate.samples;
    settings.seed = seed;
    mean += relmse(render(window().vista, nee, settings).picture, reference()) / kPictures;
  }
  return estimate.relmse / mean;
}

TEST(target, a_pilot_tells_the_error_of_pictures_like_its_parts) {
  EXPECT_NEAR(told_over_true(false), 1, 0.25);
  EXPECT_LT(told_over_true(true), 0.01);  // twin: parts share a scramble
}

TEST(target, the_picture_is_that_of_as_many_samples_on_any_number_of_threads) {
  Job settings = to(0.02);
  settings.layers = true;
  const RenderResult one = [&] {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 1);
    return render(window().vista, nee, settings);
  }();
  const RenderResult two = render(window().vista, nee, settings);
  EXPECT_EQ(one.picture.pixels, two.picture.pixels);
  ASSERT_TRUE(one.target);
  EXPECT_EQ(one.target->noise->relmse, two.target->noise->relmse);
  EXPECT_TRUE(one.target->reached());
  EXPECT_GT(one.spp(), 1u);
  EXPECT_LE(relmse(one.picture, reference()), 0.02);
  settings = Job();
  settings.limits.spp = one.spp();
  EXPECT_EQ(one.picture.pixels, render(window().vista, nee, settings).picture.pixels);
}

// The relMSE that is said of small pictures of few samples over the true one: a geometric mean.
// `naive`: it is that of four blocks of one sample each.
double said_of_few(bool naive) {
  constexpr uint64_t kPictures = 8;
  const Vista vista(window().scene, window().scene.camera(""), 8, 8, {});
  const Picture truth = reference_of(vista);
  double logarithm = 0;
  for (uint64_t seed = 1; seed <= kPictures; ++seed) {
    Job settings = to(0.2);
    settings.seed = seed;
    RenderResult r;
    if (!naive) r = render(vista, bdpt, settings);
    PictureParts blocks;
    std::vector<Vec3d> before(64);
    for (uint64_t spp = 1; naive && spp <= 4; ++spp) {
      settings.limits = {.spp = spp};
      r = render(vista, bdpt, settings);
      std::vector<Rgb>& block = blocks.emplace_back();
      for (size_t i = 0; i < before.size(); ++i) {
        const Vec3d sum = Vec3d(r.picture.pixels[i]) * static_cast<double>(spp);
        block.emplace_back(Vec3f(sum - before[i]));
        before[i] = sum;
      }
    }
    EXPECT_LE(r.spp(), 8u);
    const double error = relmse(r.picture, truth);
    const double said = naive ? estimate_error(blocks, 1).relmse / 4 : r.target->noise->relmse;
    EXPECT_TRUE(naive || r.target->reached() || error > 0.1) << error;
    logarithm += std::log(said / error) / kPictures;
  }
  return std::exp(logarithm);
}
TEST(target, the_error_said_of_few_samples_is_about_right) {
  const double said = said_of_few(false);
  EXPECT_GT(said, 0.37);
  EXPECT_LT(said, 2.7);
  EXPECT_GT(said_of_few(true), 4.5);  // twin
}

TEST(target, smaller_errors_take_more_samples) {
  uint64_t before = 0;
  for (const double error : {1e6, 0.1, 0.02}) {
    const RenderResult r = render(window().vista, nee, to(error));
    EXPECT_GT(r.spp(), before);
    EXPECT_EQ(r.spp(), r.target->fixed);
    EXPECT_EQ(r.target->stopped_by, "target");
    before = r.spp();
  }
  EXPECT_EQ(render(window().vista, nee, to(1e6)).spp(), 1u);
  // One pixel is a picture, too.
  const Vista pixel(window().scene, window().scene.camera(""), 1, 1, {});
  const RenderResult r = render(pixel, nee, to(1e-4));
  EXPECT_TRUE(r.target->reached());
  EXPECT_GT(r.spp(), 3u);
}

TEST(target, samples_and_time_are_limits) {
  Job settings = to(1e-7);
  settings.limits.spp = 5;
  const RenderResult few = render(window().vista, nee, settings);
  EXPECT_EQ(few.spp(), 5u);
  EXPECT_FALSE(few.target->reached());
  EXPECT_GT(few.target->fixed, 1000u);
  EXPECT_EQ(few.target->stopped_by, "spp");
  EXPECT_NE(target_sentence(*few.target, few.spp()).find("stopped by --spp"), std::string::npos);
  settings.limits.spp = 0;
  settings.limits.seconds = 0.3;
  const RenderResult late = render(window().vista, nee, settings);
  EXPECT_GT(late.spp(), 0u);
  EXPECT_FALSE(late.target->reached());
  EXPECT_EQ(late.target->stopped_by, "time");
  EXPECT_NE(target_sentence(*late.target, late.spp()).find("stopped by --time"), std::string::npos);
}

TEST(target, a_picture_without_light_ends) {
  const Scene scene = read_gltf(two_rooms_path());
  const Vista vista(scene, scene.camera(""), 8, 6, {});
  Job settings = to(0.01);
  settings.max_depth = 1;  // the lamp is out of sight
  const RenderResult unlit = render(vista, nee, settings);
  EXPECT_FALSE(unlit.target->reached());
  EXPECT_FALSE(unlit.target->noise);
  EXPECT_EQ(unlit.target->stopped_by, "no light");
  EXPECT_TRUE(target_json(*unlit.target, unlit.plan.error_pilot)["relmse"].is_null());
  EXPECT_NE(target_sentence(*unlit.target, unlit.spp()).find("too little light"),
            std::string::npos);

  Scene dark = read_gltf(two_rooms_path());
  for (Material& m : dark.materials) m.emission = Rgb(0);
  const Vista black(dark, dark.camera(""), 8, 6, {});
  ASSERT_TRUE(black.world->lights.empty());
  const RenderResult r = render(black, nee, to(0.01));
  EXPECT_EQ(r.spp(), 1u);
  EXPECT_TRUE(r.target->reached());
  EXPECT_EQ(target_json(*r.target, r.plan.error_pilot)["relmse"], 0);
}

TEST(target, a_miss_says_so) {
  TargetOutcome t;
  t.error = 0.01;
  t.fixed = 64;
  t.noise = {0.012, 0.011, 0.013};
  EXPECT_NE(target_sentence(t, 64).find("missed: it is about 0.012 [0.011, 0.013]"),
            std::string::npos);
  EXPECT_EQ(target_attributes(t).at("estimatedError"), "about 0.012 [0.011, 0.013]");
}

}  // namespace tdpt::target_test
