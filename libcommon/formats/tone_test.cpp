#include "libcommon/formats/tone.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"

namespace tdpt::tone_test {
namespace {

using Tone = Vec3d (*)(const Vec3d&);

Vec3d clipped(const Vec3d& c) {
  return min(c, Vec3d(1));
}

// Rolls off each component by itself, as simple tone mappers do.
Vec3d by_component(const Vec3d& c) {
  return {toned(Vec3d(c.x)).x, toned(Vec3d(c.y)).x, toned(Vec3d(c.z)).x};
}

std::vector<Vec3d> random_colours() {
  Rng rng(7, 0, 0);
  std::vector<Vec3d> all;
  for (int i = 0; i < 2000; ++i) {
    const double brightness = std::exp2(20 * rng.uniform() - 10), r = rng.uniform();
    const double g = rng.uniform();
    all.push_back(brightness * Vec3d(r, g, rng.uniform()));
  }
  return all;
}

// Whether a colour that is a tenth brighter is shown brighter in every component.
bool rises(Tone tone) {
  for (const Vec3d& c : random_colours()) {
    const Vec3d more = tone(1.1 * c) - tone(c);
    if (!(std::min({more.x, more.y, more.z}) > 0)) return false;
  }
  return true;
}

// The place of the middle component between the others: the hue within a sixth of the circle.
double middle_of(const Vec3d& c) {
  const double low = std::min({c.x, c.y, c.z}), high = max_component(c);
  return (c.x + c.y + c.z - 2 * low - high) / (high - low);
}

bool keeps_hue(Tone tone) {
  for (const Vec3d& c : random_colours()) {
    const Vec3d t = tone(c);
    if ((c.x < c.y) != (t.x < t.y) || (c.y < c.z) != (t.y < t.z)) return false;
    if (std::abs(middle_of(t) - middle_of(c)) > 1e-6) return false;
  }
  return true;
}

TEST(Tone, ValuesUpToOneHalfStayAsTheyAre) {
  for (const Vec3d& c : {Vec3d(0), Vec3d(0.18), Vec3d(0.5, 0.2, 0.01), Vec3d(-1, 0.3, 0)})
    EXPECT_EQ(toned(c), c);
  EXPECT_NEAR(toned(Vec3d(0.5 + 1e-6)).x, 0.5 + 1e-6, 1e-11);  // without a bend
  EXPECT_DOUBLE_EQ(toned(Vec3d(1)).x, 0.75);
}

TEST(Tone, BrighterIsShownBrighterAndOfTheSameHue) {
  EXPECT_TRUE(rises(toned));
  EXPECT_TRUE(keeps_hue(toned));
  // Twins
  EXPECT_FALSE(rises(clipped));
  EXPECT_FALSE(keeps_hue(clipped));
  EXPECT_FALSE(keeps_hue(by_component));
}

TEST(Tone, NothingIsBeyondWhite) {
  for (const Vec3d& c : random_colours()) EXPECT_LT(max_component(toned(c)), 1);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const Vec3d& c : {Vec3d(1e30), Vec3d(infinity), Vec3d(infinity, 0, -infinity)})
    EXPECT_EQ(max_component(toned(c)), 1);
  EXPECT_EQ(toned({1, std::nan(""), 1}), Vec3d(0));
}

// Twice the radiance at one stop less is the same picture.
TEST(Tone, ExposureIsInStops) {
  const Picture picture{3, 1, {Rgb(0.1f, 0.2f, 0.3f), Rgb(2, 1, 0), Rgb(50)}};
  Picture twice = picture;
  for (Rgb& c : twice.pixels) c *= 2;
  EXPECT_EQ(preview_bytes(twice, -1), preview_bytes(picture, 0));
  EXPECT_NE(preview_bytes(twice, 0), preview_bytes(picture, 0));
}

// A half-covered pixel has the colour that it would have if it were covered.
TEST(Tone, AlphaAppliesAfterTheCurve) {
  const Picture covered{1, 1, {Rgb(4, 2, 1)}}, half{1, 1, {Rgb(2, 1, 0.5f)}, {0.5f}};
  const Rgb whole = toned(covered, 0).pixels[0];
  EXPECT_EQ(toned(half, 0).pixels[0], 0.5f * whole);
  const Picture none{1, 1, {Rgb(0)}, {0}};
  EXPECT_EQ(toned(none, 0).pixels[0], Rgb(0));
}

double shown_mean(const Picture& picture, double exposure) {
  double sum = 0;
  for (const Rgb& c : toned(picture, exposure).pixels) sum += static_cast<double>(luminance(c));
  return sum / static_cast<double>(picture.pixels.size());
}

Picture greys() {
  Picture p{100, 1, {}};
  for (int i = 1; i <= 100; ++i) p.pixels.push_back(Rgb(static_cast<float>(i * i)));
  return p;
}

TEST(Tone, AutomaticExposureShowsMiddleGreyOnAverage) {
  const Picture p = greys();
  const double stops = auto_exposure(p);
  EXPECT_NEAR(shown_mean(p, stops), 0.18, 0.002);
  EXPECT_EQ(stops, std::round(100 * stops) / 100);
  Picture brighter = p;
  for (Rgb& c : brighter.pixels) c *= 8;
  EXPECT_NEAR(auto_exposure(brighter), stops - 3, 0.011);
}

// A room with a window, or lamp, on some of its 200 x 100 pixels.
Picture room(double radiance, double window, double share) {
  Picture p{200, 100, {}};
  Rng rng(11, 0, 0);
  for (int i = 0; i < 20000; ++i) {
    const double surface = radiance * std::exp2(2 * rng.uniform() - 1);
    p.pixels.push_back(Rgb(static_cast<float>(i < share * 20000 ? window : surface)));
  }
  return p;
}

// As it is without its window: a hundred times as bright, or ten thousand.
TEST(Tone, ARoomIsSeenAsARoom) {
  const double alone = auto_exposure(room(0.1, 0, 0));
  EXPECT_NEAR(alone, std::log2(0.18 / 0.1), 0.2);
  for (const double share : {0.001, 0.05, 0.2, 0.4})
    for (const double window : {1.7, 10.0, 1000.0})
      EXPECT_NEAR(auto_exposure(room(0.1, window, share)), alone, 0.02) << share << " " << window;
}

TEST(Tone, BlackPixelsDoNotCountForAutomaticExposure) {
  Picture p = greys();
  const double stops = auto_exposure(p);
  p.height = 3;
  p.pixels.resize(200, Rgb(0));
  p.pixels.resize(300, Rgb(std::numeric_limits<float>::quiet_NaN()));
  EXPECT_EQ(auto_exposure(p), stops);
  EXPECT_EQ(auto_exposure({2, 1, {Rgb(0), Rgb(0)}}), 0);
  const float faintest = std::numeric_limits<float>::denorm_min();
  EXPECT_NEAR(auto_exposure({1, 1, {Rgb(faintest)}}), 149 + std::log2(0.18), 0.01);
}

}  // namespace
}  // namespace tdpt::tone_test
