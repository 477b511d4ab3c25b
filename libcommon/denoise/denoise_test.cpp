#include "libcommon/denoise/denoise.h"

#include <algorithm>
#include <numbers>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "libcommon/testing/scenes/noisy_picture.h"

namespace tdpt::denoise {
namespace denoise_test {
namespace {

// How many times the filter makes the squared error smaller.
double gain(const TestPicture& picture, const Input& input) {
  const double before = picture.error(TestPicture::noisy(input));
  return before / picture.error(denoise(input).picture);
}

// Changes each number by its pixel.
template <class Change>
void change(Colour& colour, const Change& changed) {
  for (Plane& plane : colour)
    for (size_t i = 0; i < plane.size(); ++i) plane[i] = changed(i, plane[i]);
}

TEST(Denoise, NoiseFalls) {
  const TestPicture picture;
  EXPECT_GT(gain(picture, picture.halves(0.5)), 20);
  EXPECT_GT(gain(picture, picture.halves(0.1)), 10);
  Input input = picture.halves(0.5);
  input.halves.b = input.halves.a;
  EXPECT_LT(gain(picture, input), 1.1) << "twin: halves that share their noise";
}

// In nine of ten pictures. Noise that the filter took away would be 20 times as much.
TEST(Denoise, TheErrorThatIsLeftIsTold) {
  const TestPicture picture;
  int holds = 0;
  for (const double noise : {0.1, 0.3, 0.6})
    for (uint64_t seed = 1; seed <= 3; ++seed) {
      const Result result = denoise(picture.halves(noise, seed));
      ASSERT_TRUE(result.left) << noise;
      const double left = picture.error(result.picture);
      holds += left >= result.left->low && left <= result.left->high;
    }
  EXPECT_GE(holds, 7);
  // Twin: halves that share nine tenths of their noise hide most of the error.
  Input input = picture.halves(0.6);
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < TestPicture::kSize.pixels(); ++i)
      input.halves.b[c][i] = 0.9f * input.halves.a[c][i] + 0.1f * input.halves.b[c][i];
  const Result result = denoise(input);
  ASSERT_TRUE(result.left);
  EXPECT_LT(result.left->high, picture.error(result.picture));
}

// A tenth of the pixels are twenty times too bright, in either half: more light may be missing.
TEST(Denoise, TheErrorBesideManyOutliersIsNotKnown) {
  const TestPicture picture;
  Input input = picture.halves(0.3);
  for (size_t i = 0; i < TestPicture::kSize.pixels(); i += 10)
    for (Plane& plane : (i % 20 ? input.halves.a : input.halves.b)) plane[i] *= 20;
  const Result result = denoise(input);
  EXPECT_FALSE(result.left);
  EXPECT_TRUE(result.error.empty());
}

TEST(Denoise, TheErrorIsToldWhereItIs) {
  TestPicture picture;
  const auto right = [](size_t i) { return i % 96 >= 48; };
  change(picture.truth,
         [&](size_t i, float v) { return right(i) ? v * (mix64(i) % 2 == 0 ? 0.7f : 1.3f) : v; });
  double sums[2] = {};
  const Plane error = denoise(picture.halves(0.3)).error;
  for (size_t i = 0; i < error.size(); ++i) sums[right(i)] += static_cast<double>(error[i]);
  EXPECT_GT(sums[1], 2 * sums[0]);
}

TEST(Denoise, FeaturesOfAnotherPlaceBlurTheTexture) {
  const TestPicture picture;
  Input input = picture.halves(0.2);
  const double right = gain(picture, input);
  for (Plane& plane : input.halves.features)
    std::rotate(plane.begin(), plane.begin() + 5, plane.end());
  EXPECT_LT(gain(picture, input), right / 1.3);
}

// A lamp in a wall of the same colour, normal and depth: only its light tells it. Its edge, between
// two pixels, is noisy.
TEST(Denoise, ALampHasNoHalo) {
  const TestPicture picture;
  Input input = picture.halves(0.3);
  for (Plane& plane : input.halves.features) std::fill(plane.begin(), plane.end(), 0.5f);
  constexpr float kLamp = 40, kWall = 0.25f;
  const auto row = [](size_t i) { return i / 96; };
  Neighbour beside{input.halves, Plane(picture.truth[0].size(), 1.0f)};
  for (size_t i = 0; i < picture.truth[0].size(); ++i)
    for (NoisyHalves* halves : {&input.halves, &beside.halves})
      for (Colour* half : {&halves->a, &halves->b}) {
        const auto u = static_cast<float>(unit_double(mix64(2 * i + (half == &halves->a))));
        // What is beside shows the lamp a fraction of a pixel further down.
        const float edge = halves == &input.halves ? 0 : 0.05f;
        const float share = row(i) < 20    ? 1
                            : row(i) == 20 ? 0.4f + 0.2f * u
                            : row(i) == 21 ? edge
                                           : 0;
        for (Plane& plane : *half) plane[i] = kWall * (0.9f + 0.2f * u) + share * kLamp;
      }
  input.neighbours = {beside};
  const Result result = denoise(input);
  for (size_t i = 21 * 96; i < 26 * 96; ++i) EXPECT_LT(result.picture[1][i], 1.5f * kWall) << i;
}

// But for its own noise, about a hundredth of a pixel's.
TEST(Denoise, TheMeanStays) {
  const TestPicture picture;
  for (const double noise : {0.1, 1.0}) {
    const Input input = picture.halves(noise);
    const double before = TestPicture::mean(TestPicture::noisy(input));
    EXPECT_NEAR(TestPicture::mean(denoise(input).picture) / before, 1, 0.02 * noise) << noise;
  }
}

// Even with a pattern that no feature shows.
TEST(Denoise, TheNoisyPictureReturnsAsNoiseVanishes) {
  TestPicture picture;
  change(picture.truth, [](size_t i, float v) { return v * (mix64(i) % 2 == 0 ? 0.8f : 1.2f); });
  for (const double noise : {0.3, 0.03, 0.001})
    EXPECT_GT(gain(picture, picture.halves(noise)), 0.75) << noise;
}

// The light of one path, 7 % of all: nobody may see where it was.
TEST(Denoise, OnePathLeavesNoGlowAndIsTold) {
  const TestPicture picture;
  Input input = picture.halves(0.1);
  const Result without = denoise(input);
  constexpr size_t kX = 50, kY = 20;
  const double all =
      TestPicture::mean(picture.truth) * static_cast<double>(picture.truth[0].size());
  for (Plane& plane : input.halves.a) plane[kY * 96 + kX] += static_cast<float>(2 * 0.07 * all);
  const Result result = denoise(input);
  EXPECT_EQ(result.outliers, 1);
  EXPECT_NEAR(result.left_out, 0.07 / 1.07, 0.01);
  // Within so many pixels of it, from ring to ring; twin: the light spread over 20 pixels.
  Plane glow = without.picture[1];
  for (size_t i = 0; i < glow.size(); ++i) {
    const double x = static_cast<double>(i % 96) - kX, y = static_cast<double>(i / 96) - kY;
    glow[i] += static_cast<float>(0.07 * all * std::exp(-(x * x + y * y) / 800) /
                                  (800 * std::numbers::pi));
  }
  const auto brighter = [&](const Plane& picture_with, int outer) {
    double after = 0, before = 0;
    for (size_t i = 0; i < picture_with.size(); ++i) {
      const double away =
          std::hypot(static_cast<double>(i % 96) - kX, static_cast<double>(i / 96) - kY);
      if (away > outer || away <= outer / 2) continue;
      after += static_cast<double>(picture_with[i]);
      before += static_cast<double>(without.picture[1][i]);
    }
    return after / before - 1;
  };
  for (const int outer : {2, 4, 8, 16}) {
    EXPECT_NEAR(brighter(result.picture[1], outer), 0, 0.03) << outer;
    EXPECT_GT(brighter(glow, outer), 0.06) << outer;
  }
}

TEST(Denoise, AGuestIsTakenWhereItIsBetter) {
  const TestPicture picture;
  Input input = picture.halves(0.5);
  const double alone = picture.error(denoise(input).picture);
  // Good on the left, wrong on the right.
  Colour guest = picture.truth;
  change(guest, [](size_t i, float v) { return i % 96 >= 48 ? 1 : v; });
  EXPECT_GT(picture.error(guest), 10 * alone);
  input.guest = {guest, guest, guest};
  EXPECT_LT(picture.error(denoise(input).picture), 0.8 * alone);
}

TEST(Denoise, AHighlightStays) {
  TestPicture picture;
  const size_t pixel = 20 * 96 + 50;
  for (Plane& plane : picture.truth) plane[pixel] *= 40;
  const Result result = denoise(picture.halves(0.1));
  EXPECT_EQ(result.outliers, 0);
  EXPECT_NEAR(result.picture[1][pixel] / picture.truth[1][pixel], 1, 0.3);
}

TEST(Denoise, ThreadsDoNotShow) {
  const TestPicture picture;
  const Input input = picture.halves(0.5);
  const Colour whole = denoise(input).picture;
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(denoise(input).picture, whole);
}

TEST(Denoise, UnequalHalves) {
  const TestPicture picture;
  // As 3 samples: the second half has twice the variance.
  Input input = picture.halves(0.2);
  input.halves.b = picture.halves(0.2 * std::sqrt(2.0), 2).halves.b;
  input.halves.share_a = 2.0 / 3;
  Colour noisy = input.halves.a;
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < noisy[c].size(); ++i)
      noisy[c][i] = (2 * input.halves.a[c][i] + input.halves.b[c][i]) / 3;
  EXPECT_GT(picture.error(noisy) / picture.error(denoise(input).picture), 10);
}

Input with_neighbour(const TestPicture& picture, const NoisyHalves& neighbour) {
  Input input = picture.halves(0.5);
  input.neighbours.push_back({neighbour, Plane(TestPicture::kSize.pixels(), 1.0f)});
  return input;
}

TEST(Denoise, AnotherFrameHelpsAsFarAsItShowsTheSame) {
  const TestPicture picture;
  const Input input = picture.halves(0.5);
  const Colour plain = denoise(input).picture;
  const double alone = picture.error(TestPicture::noisy(input)) / picture.error(plain);
  const NoisyHalves before = picture.halves(0.5, 7).halves;
  EXPECT_GT(gain(picture, with_neighbour(picture, before)), 1.3 * alone);
  // A frame that is absent changes nothing.
  Input absent = with_neighbour(picture, before);
  absent.neighbours[0].present.assign(TestPicture::kSize.pixels(), 0);
  EXPECT_EQ(denoise(absent).picture, plain);
  // A lamp was switched on between the frames: nothing but the light tells.
  TestPicture bright = picture;
  change(bright.truth, [](size_t, float v) { return 3 * v; });
  EXPECT_GT(gain(picture, with_neighbour(picture, bright.halves(0.5, 7).halves)), 0.7 * alone);
}

TEST(Denoise, UnitsOfLightDoNotMatter) {
  const TestPicture picture;
  const Input input = picture.halves(0.5);
  const Result plain = denoise(input);
  for (const int exponent : {-80, 100}) {
    Input other = input;
    for (Colour* half : {&other.halves.a, &other.halves.b})
      change(*half, [&](size_t, float v) { return std::ldexp(v, exponent); });
    const Result result = denoise(other);
    EXPECT_EQ(result.error, plain.error) << exponent;
    EXPECT_EQ(std::ldexp(result.picture[1][777], -exponent), plain.picture[1][777]) << exponent;
  }
}

TEST(Denoise, EnormousPixelsAndSmallPicturesLeaveNumbers) {
  Input input = TestPicture().halves(0.5);
  for (const size_t i : {2000, 2001, 2096, 2097})
    for (Colour* half : {&input.halves.a, &input.halves.b})
      for (Plane& plane : *half) plane[i] = 1e25f;
  const Result result = denoise(input);
  for (const Plane& plane : result.picture)
    for (const float v : plane) ASSERT_TRUE(std::isfinite(v));
  for (const float v : result.error) ASSERT_TRUE(std::isfinite(v));
  Input one{{1, 1}, {}};
  for (size_t c = 0; c < 3; ++c) one.halves.a[c] = one.halves.b[c] = {0.0f};
  for (Plane& plane : one.halves.features) plane = {0.0f};
  EXPECT_EQ(denoise(one).picture[0][0], 0);
  one.halves.a[0][0] = one.halves.b[0][0] = 2;
  EXPECT_FLOAT_EQ(denoise(one).picture[0][0], 2);
}

}  // namespace
}  // namespace denoise_test
}  // namespace tdpt::denoise
