#include "libcommon/scene/sky_bins.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"

namespace tdpt::sky_bins_test {

constexpr double kAll = 4 * std::numbers::pi;

Vec3d direction(Rng& rng) {
  const double z = 1 - 2 * rng.uniform();
  const double phi = 2 * std::numbers::pi * rng.uniform();
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}

TEST(sky_bins, share_all_directions) {
  double sum = 0;
  for (uint32_t k = 0; k < kSkyBins; ++k) {
    const double sr = sky_bin_solid_angle(k);
    EXPECT_GT(sr, 0.14);
    EXPECT_LT(sr, 0.18);
    sum += sr;
    EXPECT_EQ(sky_bin(sky_bin_middle(k)), k);
    // Seen from within, counter-clockwise.
    const auto& c = sky_bin_corners(k);
    EXPECT_LT(dot(cross(c[1] - c[0], c[2] - c[0]), c[0]), 0);
  }
  EXPECT_NEAR(sum, kAll, 1e-9);
}

TEST(sky_bins, get_directions_by_solid_angle) {
  constexpr int kDirections = 100000;
  std::vector<double> count(kSkyBins, 0);
  Rng rng(3, 0, 0);
  for (int i = 0; i < kDirections; ++i) ++count[sky_bin(direction(rng))];
  // Largest deviation of the bins' counts, in standard deviations.
  const auto deviation = [&](double factor) {
    double worst = 0;
    for (uint32_t k = 0; k < kSkyBins; ++k) {
      const double expected = factor * kDirections * sky_bin_solid_angle(k) / kAll;
      worst = std::max(worst, std::abs(count[k] - expected) / std::sqrt(expected));
    }
    return worst;
  };
  EXPECT_LT(deviation(1), 4.5);
  EXPECT_GT(deviation(1.2), 4.5);  // twin
}

TEST(sky_bins, of_one_colour_shine_by_solid_angle) {
  Scene scene;
  scene.sky = std::make_shared<Sky>(Sky::Map{1, 1, {Rgb(2.0f)}}, 0.3);
  EXPECT_TRUE(lit_from_infinity(scene));
  const std::vector<double> light = sky_bin_light(scene);
  for (uint32_t k = 0; k < kSkyBins; ++k)
    EXPECT_NEAR(light[k], 2 * sky_bin_solid_angle(k), 0.03 * light[k]);
}

TEST(sky_bins, hold_suns_and_parallel_light) {
  Scene scene;
  EXPECT_FALSE(lit_from_infinity(scene));
  PunctualLight lamp;
  lamp.intensity = Rgb(3.0f);
  scene.lights = {lamp};
  EXPECT_FALSE(lit_from_infinity(scene));  // a point
  scene.lights[0].kind = PunctualLight::Kind::directional;
  scene.lights[0].direction = -sky_bin_middle(7);
  EXPECT_TRUE(lit_from_infinity(scene));
  const Sky::Sun sun{sky_bin_middle(40), 0.01, Rgb(1e6f)};
  scene.sky = std::make_shared<Sky>(Sky::Map{}, 0.0, std::vector<Sky::Sun>{sun});
  const std::vector<double> light = sky_bin_light(scene);
  EXPECT_NEAR(light[7], 3, 1e-5);
  EXPECT_NEAR(light[40], 1e6 * 2 * std::numbers::pi * (1 - std::cos(0.01)), 1);
  for (uint32_t k = 0; k < kSkyBins; ++k)
    if (k != 7 && k != 40) {
      EXPECT_EQ(light[k], 0);
    }
}

// A texel of a map, under any rotation.
TEST(sky_bins, hold_a_map_s_bright_texel_where_it_is) {
  Sky::Map map{64, 32, std::vector<Rgb>(64 * 32)};
  map.texels[5 * 64 + 11] = Rgb(1e6f);
  Scene scene;
  scene.sky = std::make_shared<Sky>(map, 1.1);
  const std::vector<double> light = sky_bin_light(scene);
  const uint32_t there = sky_bin(scene.sky->towards(11.5, 5.5));
  double all = 0;
  for (const double l : light) all += l;
  EXPECT_GT(light[there], 0.5 * all);
  const double sr = 2 * std::numbers::pi / 64 *
                    (std::cos(std::numbers::pi * 5 / 32) - std::cos(std::numbers::pi * 6 / 32));
  EXPECT_NEAR(all, 1e6 * sr, 1e-3 * all);
}

}  // namespace tdpt::sky_bins_test
