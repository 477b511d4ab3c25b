#include "libcommon/denoise/denoise.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "libcommon/denoise/test_picture.h"

namespace tdpt::denoise {
namespace denoise_test {
namespace {

// How many times the filter makes the squared error smaller.
double gain(const TestPicture& picture, const Input& input) {
  const double before = picture.error(TestPicture::noisy(input));
  return before / picture.error(denoise(input).picture);
}

TEST(Denoise, NoiseFalls) {
  const TestPicture picture;
  EXPECT_GT(gain(picture, picture.halves(0.5)), 20);
  EXPECT_GT(gain(picture, picture.halves(0.1)), 10);
}

TEST(Denoise, HalvesThatShareTheirNoiseAreNotFiltered) {
  const TestPicture picture;
  Input input = picture.halves(0.5);
  input.shot.b = input.shot.a;
  EXPECT_LT(gain(picture, input), 1.1);
}

// With kUntold of 1.5; noise that the filter took away would be 20 times as much.
TEST(Denoise, TheErrorThatIsLeftIsTold) {
  for (const double noise : {0.1, 0.3, 0.6}) {
    const TestPicture picture;
    const Input input = picture.halves(noise);
    const Result result = denoise(input);
    const double left = picture.error(result.picture);
    EXPECT_GT(result.relmse, 0.5 * left) << noise;
    EXPECT_LT(result.relmse, 2.5 * left) << noise;
  }
}

// Twin: halves that share half of their noise hide most of the error.
TEST(Denoise, TheErrorOfHalvesThatShareNoiseIsNotTold) {
  const TestPicture picture;
  Input input = picture.halves(0.6);
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < TestPicture::kSize.pixels(); ++i)
      input.shot.b[c][i] = 0.5f * (input.shot.a[c][i] + input.shot.b[c][i]);
  const Result result = denoise(input);
  EXPECT_LT(result.relmse, 0.5 * picture.error(result.picture));
}

TEST(Denoise, TheErrorIsToldWhereItIs) {
  TestPicture picture;
  const auto right = [](size_t i) { return i % 96 >= 48; };
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < picture.truth[c].size(); ++i)
      if (right(i)) picture.truth[c][i] *= mix64(i) % 2 == 0 ? 0.7f : 1.3f;
  double sums[2] = {};
  const Plane error = denoise(picture.halves(0.3)).error;
  for (size_t i = 0; i < error.size(); ++i) sums[right(i)] += static_cast<double>(error[i]);
  EXPECT_GT(sums[1], 2 * sums[0]);
}

TEST(Denoise, FeaturesOfAnotherPlaceBlurTheTexture) {
  const TestPicture picture;
  Input input = picture.halves(0.2);
  const double right = gain(picture, input);
  for (Plane& plane : input.shot.features)
    std::rotate(plane.begin(), plane.begin() + 5, plane.end());
  EXPECT_LT(gain(picture, input), right / 1.3);
}

// A lamp in a wall of the same colour, normal and depth: only its light tells it. Its edge, between
// two pixels, is noisy.
TEST(Denoise, ALampHasNoHalo) {
  const TestPicture picture;
  Input input = picture.halves(0.3);
  for (Plane& plane : input.shot.features) std::fill(plane.begin(), plane.end(), 0.5f);
  constexpr float kLamp = 40, kWall = 0.25f;
  const auto row = [](size_t i) { return i / 96; };
  Neighbour beside{input.shot, Plane(picture.truth[0].size(), 1.0f)};
  for (size_t i = 0; i < picture.truth[0].size(); ++i)
    for (Shot* shot : {&input.shot, &beside.shot})
      for (Colour* half : {&shot->a, &shot->b}) {
        const auto u = static_cast<float>(unit_double(mix64(2 * i + (half == &shot->a))));
        // What is beside shows the lamp a fraction of a pixel further down.
        const float edge = shot == &input.shot ? 0 : 0.05f;
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

TEST(Denoise, TheMeanStays) {
  const TestPicture picture;
  for (const double noise : {0.1, 0.5, 1.0}) {
    const Input input = picture.halves(noise);
    const double before = TestPicture::mean(TestPicture::noisy(input));
    EXPECT_NEAR(TestPicture::mean(denoise(input).picture) / before, 1, 1e-5) << noise;
  }
}

// A pattern that no feature shows.
Input hidden_pattern(TestPicture& picture, double noise) {
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < picture.truth[c].size(); ++i)
      picture.truth[c][i] *= mix64(i) % 2 == 0 ? 0.8f : 1.2f;
  return picture.halves(noise);
}

TEST(Denoise, TheNoisyPictureReturnsAsNoiseVanishes) {
  for (const double noise : {0.3, 0.1, 0.03, 0.01, 0.003, 0.001}) {
    TestPicture picture;
    const Input input = hidden_pattern(picture, noise);
    EXPECT_GT(gain(picture, input), 0.95) << noise;
  }
}

TEST(Denoise, AnOutlierIsSpreadAndItsEnergyKept) {
  const TestPicture picture;
  Input input = picture.halves(0.1);
  const size_t pixel = 20 * 96 + 50;
  for (Plane& plane : input.shot.a) plane[pixel] *= 400;
  const Result result = denoise(input);
  EXPECT_EQ(result.outliers, 1);
  EXPECT_GT(result.outlier_energy, 0.01);  // a filter that lost it would miss the mean below
  const double before = TestPicture::mean(TestPicture::noisy(input));
  EXPECT_NEAR(TestPicture::mean(result.picture) / before, 1, 1e-5);
  EXPECT_LT(result.picture[1][pixel], 2 * picture.truth[1][pixel]);
}

TEST(Denoise, AHighlightStays) {
  TestPicture picture;
  const size_t pixel = 20 * 96 + 50;
  for (Plane& plane : picture.truth) plane[pixel] *= 40;
  const Result result = denoise(picture.halves(0.1));
  EXPECT_EQ(result.outliers, 0);
  EXPECT_NEAR(result.picture[1][pixel] / picture.truth[1][pixel], 1, 0.3);
}

TEST(Denoise, BlocksAndThreadsDoNotShow) {
  const TestPicture picture;
  const Input input = picture.halves(0.5);
  const Result all = denoise(input), parts = denoise(input, 31);
  const Colour& whole = all.picture;
  EXPECT_EQ(parts.picture, whole);
  EXPECT_EQ(parts.error, all.error);
  EXPECT_EQ(parts.relmse, all.relmse);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(denoise(input).picture, whole);
}

TEST(Denoise, UnequalHalves) {
  const TestPicture picture;
  // As 3 samples: the second half has twice the variance.
  Input input = picture.halves(0.2);
  input.shot.b = picture.halves(0.2 * std::sqrt(2.0), 2).shot.b;
  input.shot.share_a = 2.0 / 3;
  Colour noisy = input.shot.a;
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < noisy[c].size(); ++i)
      noisy[c][i] = (2 * input.shot.a[c][i] + input.shot.b[c][i]) / 3;
  EXPECT_GT(picture.error(noisy) / picture.error(denoise(input).picture), 10);
}

Input with_neighbour(const TestPicture& picture, const Shot& neighbour) {
  Input input = picture.halves(0.5);
  input.neighbours.push_back({neighbour, Plane(TestPicture::kSize.pixels(), 1.0f)});
  return input;
}

TEST(Denoise, AnotherFrameHelpsAsFarAsItShowsTheSame) {
  const TestPicture picture;
  const double alone = gain(picture, picture.halves(0.5));
  const Shot before = picture.halves(0.5, 7).shot;
  EXPECT_GT(gain(picture, with_neighbour(picture, before)), 1.3 * alone);
  // A frame that is absent changes nothing.
  Input absent = with_neighbour(picture, before);
  absent.neighbours[0].present.assign(TestPicture::kSize.pixels(), 0);
  EXPECT_EQ(denoise(absent).picture, denoise(picture.halves(0.5)).picture);
  // A lamp was switched on between the frames: nothing but the light tells.
  TestPicture bright = picture;
  for (Plane& plane : bright.truth)
    for (float& v : plane) v *= 3;
  EXPECT_GT(gain(picture, with_neighbour(picture, bright.halves(0.5, 7).shot)), 0.7 * alone);
}

TEST(Denoise, BlocksDoNotShowWithFrames) {
  const TestPicture picture;
  Input input = with_neighbour(picture, picture.halves(0.5, 7).shot);
  Plane& present = input.neighbours[0].present;
  for (size_t i = 0; i < present.size(); ++i) present[i] = (i / 7 + i / 96 / 5) % 3 == 0 ? 0 : 1;
  const Result parts = denoise(input, 31), whole = denoise(input);
  EXPECT_EQ(parts.picture, whole.picture);
  EXPECT_EQ(parts.error, whole.error);
  EXPECT_EQ(parts.relmse, whole.relmse);
}

TEST(Denoise, UnitsOfLightDoNotMatter) {
  const TestPicture picture;
  const Input input = picture.halves(0.5);
  const Result plain = denoise(input);
  for (const int exponent : {-80, 60, 100}) {
    Input other = input;
    for (Colour* half : {&other.shot.a, &other.shot.b})
      for (Plane& plane : *half)
        for (float& v : plane) v = std::ldexp(v, exponent);
    const Result result = denoise(other);
    EXPECT_EQ(result.error, plain.error) << exponent;
    EXPECT_EQ(std::ldexp(result.picture[1][777], -exponent), plain.picture[1][777]) << exponent;
  }
}

TEST(Denoise, OneEnormousPixelLeavesNumbers) {
  const TestPicture picture;
  Input input = picture.halves(0.5);
  for (const size_t i : {2000, 2001, 2096, 2097})
    for (Colour* half : {&input.shot.a, &input.shot.b})
      for (Plane& plane : *half) plane[i] = 1e25f;
  const Result result = denoise(input);
  for (const Plane& plane : result.picture)
    for (const float v : plane) ASSERT_TRUE(std::isfinite(v));
  for (const float v : result.error) ASSERT_TRUE(std::isfinite(v));
}

TEST(Denoise, SmallAndBlackPictures) {
  Input input{{1, 1}, {}};
  for (size_t c = 0; c < 3; ++c) input.shot.a[c] = input.shot.b[c] = {0.0f};
  for (Plane& plane : input.shot.features) plane = {0.0f};
  EXPECT_EQ(denoise(input).picture[0][0], 0);
  input.shot.a[0][0] = input.shot.b[0][0] = 2;
  EXPECT_FLOAT_EQ(denoise(input).picture[0][0], 2);
}

}  // namespace
}  // namespace denoise_test
}  // namespace tdpt::denoise
