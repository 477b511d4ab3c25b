// The sky: orientation of its map, interpolation, and samples with the claimed density, each with a
// twin.
#include "libcommon/scene/sky.h"

#include <gtest/gtest.h>
#include <cmath>
#include <numbers>

#include "libcommon/math/rng.h"
#include "libcommon/testing/statistics/chi_square.h"

namespace tdpt::sky_test {

using std::numbers::pi;

constexpr double kRight = 1e-4;  // a correct sampler is below this for 1 seed in 10 000
constexpr double kWrong = 1e-9;  // a faulty one is below this
constexpr uint64_t kSamples = 20000;

Sky::Map one_colour(const Rgb& colour) {
  return {1, 1, {colour}};
}

template <class Radiance>
Sky::Map map_of(int width, int height, Radiance radiance) {
  Sky::Map map{width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) map.texels.push_back(radiance(x, y));
  return map;
}
// Smoothly varying, different in every texel.
Sky::Map gradient(int width = 24, int height = 12) {
  return map_of(width, height, [&](int x, int y) {
    const float u = static_cast<float>(x) / static_cast<float>(width);
    const float v = static_cast<float>(y) / static_cast<float>(height);
    return Rgb(1 + u, 0.2f + 2 * v, 0.5f + u * v);
  });
}
// 1e6 in one texel, 1 in all others.
Sky::Map hot(int x, int y, int width = 32, int height = 16) {
  return map_of(width, height, [=](int i, int j) { return Rgb(i == x && j == y ? 1e6f : 1.0f); });
}

Vec3d direction(double azimuth, double y) {
  const double s = std::sqrt((1 - y) * (1 + y));
  return {s * std::sin(azimuth), y, -s * std::cos(azimuth)};
}

void expect_near(const Vec3d& a, const Vec3d& b, double tolerance = 1e-12) {
  EXPECT_LT(length(a - b), tolerance) << a.x << ' ' << a.y << ' ' << a.z;
}
void expect_near(const Rgb& a, const Rgb& b, float tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance);
}

// The convention of latitude-longitude maps, as documented.
TEST(Sky, CentreOfTheMapIsAheadAndThreeQuartersAreToTheRight) {
  const Sky sky(gradient(64, 32), 0);
  expect_near(sky.towards(32, 16), {0, 0, -1});
  expect_near(sky.towards(48, 16), {1, 0, 0});
  expect_near(sky.towards(16, 16), {-1, 0, 0});
  expect_near(sky.towards(0, 16), {0, 0, 1});
  expect_near(sky.towards(17, 0), {0, 1, 0});
  expect_near(sky.towards(17, 32), {0, -1, 0});
  double x, y;
  sky.raster({1, 0, 0}, x, y);
  EXPECT_NEAR(x, 48, 1e-9);
  EXPECT_NEAR(y, 16, 1e-9);
  sky.raster({0, 1, 0}, x, y);
  EXPECT_NEAR(y, 0, 1e-9);
}

TEST(Sky, RotationTurnsItCounterClockwiseSeenFromAbove) {
  const Sky::Map map = gradient(64, 32);
  const Sky sky(map, 0), turned(map, 0.5 * pi);
  // What was ahead (-z) is then to the left (-x).
  expect_near(turned.radiance({-1, 0, 0}), sky.radiance({0, 0, -1}), 1e-6f);
  expect_near(turned.towards(32, 16), {-1, 0, 0});
  const Sky a_little(map, 0.3);
  for (const Vec3d& w : {direction(1, 0.2), direction(-2, -0.9), direction(3.1, 0.95)}) {
    const Vec3d before{std::cos(0.3) * w.x - std::sin(0.3) * w.z, w.y,
                       std::sin(0.3) * w.x + std::cos(0.3) * w.z};
    expect_near(a_little.radiance(w), sky.radiance(before), 1e-5f);
  }
}

TEST(Sky, RasterAndTowardsAreInverse) {
  const Sky sky(gradient(), 1.2);
  Rng rng(1, 0, 0);
  for (int i = 0; i < 1000; ++i) {
    const double x = 24 * rng.uniform();
    const double y = 12 * rng.uniform();
    double back_x, back_y;
    sky.raster(sky.towards(x, y), back_x, back_y);
    EXPECT_NEAR(back_x, x, 1e-9);
    EXPECT_NEAR(back_y, y, 1e-7);
    const Sky::Cell cell = sky.cell(sky.towards(x, y));
    expect_near(sky.towards(cell), sky.towards(x, y), 1e-9);
  }
}

TEST(Sky, TexelsAreSeenAtTheirCentres) {
  const Sky::Map map = gradient();
  for (const double rotation : {0.0, 2.0}) {
    const Sky sky(map, rotation);
    for (int y = 0; y < map.height; ++y)
      for (int x = 0; x < map.width; ++x)
        expect_near(sky.radiance(sky.towards(x + 0.5, y + 0.5)),
                    map.texels[static_cast<size_t>(y * map.width + x)], 1e-5f);
  }
}

TEST(Sky, BetweenTexelsItIsBilinearRoundTheSeamAndHeldAtThePoles) {
  const Sky::Map map = hot(31, 3);
  const Sky sky(map, 0);
  const float half = 0.5f * (1e6f + 1);
  expect_near(sky.radiance(sky.towards(31, 3.5)), Rgb(half), 1);
  expect_near(sky.radiance(sky.towards(32, 3.5)), Rgb(half), 1);  // the seam
  expect_near(sky.radiance(sky.towards(0, 3.5)), Rgb(half), 1);
  expect_near(sky.radiance(sky.towards(0.5, 3.5)), Rgb(1), 1);
  const double y = 0.5 * (std::cos(pi * 3.5 / 16) + std::cos(pi * 4.5 / 16));
  expect_near(sky.radiance(direction(pi * (31.5 / 16 - 1), y)), Rgb(half), 1);
  const Sky top(hot(7, 0), 0);
  for (const double at : {0.5, 0.3, 1e-3})
    expect_near(top.radiance(top.towards(7.5, at)), Rgb(1e6f), 10);
}

TEST(Sky, ColumnsBeyondRoundingAreColumns) {
  const Sky sky(hot(0, 8, 8192, 17), 1e-3);
  for (const double x : {0.0, 1e-16, 8192 - 1e-12, 8191.5, 0.5})
    for (const double y : {0.0, 1e-9, 8.5, 17 - 1e-9, 17.0}) {
      const Sky::Cell c = sky.cell(sky.towards(x, y));
      EXPECT_TRUE(c.column >= 0 && c.column < 8192 && c.row >= 0 && c.row <= 17);
      EXPECT_TRUE(c.across >= 0 && c.across <= 1 && c.down >= 0 && c.down <= 1);
    }
}

// Nobody should ask, but it must not read outside of memory.
TEST(Sky, NoDirectionIsSeenAsNoNumber) {
  const Sky sky(gradient(), 0);
  const SkyDirections plain(sky), weighted(sky, [](const Vec3d&) { return 1.0; });
  const Vec3d none(NAN, NAN, NAN);
  EXPECT_TRUE(std::isnan(sky.radiance(none).x));
  EXPECT_TRUE(std::isnan(plain.pdf_w(none)));
  EXPECT_TRUE(std::isnan(weighted.pdf_w(none)));
}

TEST(Sky, SunsAddToTheMap) {
  const Sky sky(one_colour(Rgb(2)), 0, {{direction(1, 0.5), 0.1, Rgb(7, 8, 9)}});
  expect_near(sky.radiance(direction(1, 0.5)), Rgb(9, 10, 11), 0);
  expect_near(sky.radiance(direction(1.2, 0.5)), Rgb(2), 0);
  const Sky dark({}, 0, {{direction(1, 0.5), 0.1, Rgb(7, 8, 9)}});
  expect_near(dark.radiance(direction(1, 0.5)), Rgb(7, 8, 9), 0);
  expect_near(dark.radiance(direction(2, 0.5)), Rgb(0), 0);
  EXPECT_TRUE(SkyDirections(Sky({}, 0)).empty());
  EXPECT_TRUE(SkyDirections(Sky(one_colour(Rgb(0)), 0)).empty());
}

using Draw = std::function<Vec3d(double pick, double u, double v)>;
using Density = std::function<double(const Vec3d&)>;

// Bins of a part of the map; everything outside is one bin.
struct Window {
  const Sky& sky;
  double x0, x1, y0, y1;  ///< as raster(); x may wrap round the seam
  int n = 16;

  size_t bin(const Vec3d& w) const {
    double x, y;
    sky.raster(w, x, y);
    x = x0 + std::fmod(x - x0 + sky.map().width, sky.map().width);
    const double i = (x - x0) / (x1 - x0) * n, j = (y - y0) / (y1 - y0) * n;
    if (i < 0 || j < 0 || i >= n || j >= n) return static_cast<size_t>(n * n);
    return static_cast<size_t>(j) * static_cast<size_t>(n) + static_cast<size_t>(i);
  }
  std::vector<double> integrate(const std::function<double(const Vec3d&)>& density) const {
    constexpr int k = 16;  // midpoints per bin, both ways
    const double dx = (x1 - x0) / (n * k), dy = (y1 - y0) / (n * k);
    const double area = dx * 2 * pi / sky.map().width * dy * pi / sky.map().height;
    std::vector<double> bins(static_cast<size_t>(n * n));
    for (int j = 0; j < n * k; ++j)
      for (int i = 0; i < n * k; ++i) {
        const double y = y0 + (j + 0.5) * dy;
        bins[static_cast<size_t>(j / k * n + i / k)] +=
            density(sky.towards(x0 + (i + 0.5) * dx, y)) * std::sin(pi * y / sky.map().height) *
            area;
      }
    return bins;
  }
};
Window whole(const Sky& sky) {
  return {sky, 0, static_cast<double>(sky.map().width), 0, static_cast<double>(sky.map().height)};
}

// Bins of equal solid angle on a sun's disc.
struct Disc {
  static constexpr int kRings = 12, kSectors = 8;
  Vec3d axis;
  double half_angle;

  double height() const {  // 1 - cos
    const double s = std::sin(0.5 * half_angle);
    return 2 * s * s;
  }
  size_t bin(const Vec3d& w) const {
    const Vec3d to_axis = w - axis, local = Onb<double>(axis).to_local(w);
    const double ring = 0.5 * dot(to_axis, to_axis) / height() * kRings;
    const double sector = (std::atan2(local.y, local.x) / (2 * pi) + 0.5) * kSectors;
    if (ring >= kRings) return size_t{kRings} * kSectors;
    return static_cast<size_t>(ring) * kSectors +
           std::min(static_cast<size_t>(sector), size_t{kSectors - 1});
  }
  std::vector<double> integrate(const Density& density) const {
    constexpr int k = 16;  // midpoints per bin, both ways
    std::vector<double> bins(size_t{kRings} * kSectors);
    for (int i = 0; i < kRings * k; ++i)
      for (int j = 0; j < kSectors * k; ++j) {
        const double h = (i + 0.5) / (kRings * k) * height(), r = std::sqrt(h * (2 - h));
        const double phi = ((j + 0.5) / (kSectors * k) - 0.5) * 2 * pi;
        const Vec3d w = Onb<double>(axis).to_world({r * std::cos(phi), r * std::sin(phi), 1 - h});
        bins[static_cast<size_t>(i / k * kSectors + j / k)] +=
            density(w) * 2 * pi * height() / (kRings * k * kSectors * k);
      }
    return bins;
  }
};

Draw draw_of(const SkyDirections& d) {
  return [&d](double pick, double u, double v) { return d.sample(pick, u, v); };
}
Density density_of(const SkyDirections& d) {
  return [&d](const Vec3d& w) { return d.pdf_w(w); };
}

template <class Bins>
double p_of(const Bins& bins, const Density& density, const Draw& draw) {
  return chi_square_of_samples(kSamples, bins.integrate(density),
                               [&](uint64_t i) {
                                 Rng rng(41, 0, i);
                                 const double pick = rng.uniform();
                                 const double u = rng.uniform();
                                 const double v = rng.uniform();
                                 return bins.bin(draw(pick, u, v));
                               })
      .p;
}

using Weight = std::function<double(const Vec3d&)>;

// Samples have the density, which is that of luminance, or near that of luminance and weight.
template <class Bins>
void expect_follows(const Sky& sky, const SkyDirections& d, const std::vector<Bins>& all,
                    const Weight& weight = {}) {
  for (const Bins& bins : all) EXPECT_GT(p_of(bins, density_of(d), draw_of(d)), kRight);
  constexpr int kDraws = 2000;
  double total = 0;
  for (uint64_t i = 0; i < kDraws; ++i) {
    Rng rng(42, 0, i);
    const double pick = rng.uniform();
    const double u = rng.uniform();
    const double v = rng.uniform();
    const Vec3d w = d.sample(pick, u, v);
    EXPECT_NEAR(length(w), 1, 1e-14);
    const double light = luminance(sky.radiance(w));
    ASSERT_GT(light, 0);
    total += light * (weight ? weight(w) : 1) / d.pdf_w(w) / kDraws;
    if (!weight) {
      EXPECT_NEAR(d.pdf_w(w) / light * d.total(), 1, 1e-5);
    }
  }
  EXPECT_NEAR(total / d.total(), 1, 0.03);
}

TEST(SkyDirections, OneColour) {
  const Sky sky(one_colour(Rgb(3)), 0.7);
  const SkyDirections d(sky);
  EXPECT_NEAR(d.total(), 4 * pi * 3, 1e-5);
  EXPECT_NEAR(d.pdf_w({0, 1, 0}), 0.25 / pi, 1e-7);
  expect_follows<SphereBins>(sky, d, {SphereBins(16, 16)});
  const Draw even_in_angle = [&](double, double u, double v) { return sky.towards(u, v); };
  EXPECT_LT(p_of(SphereBins(16, 16), density_of(d), even_in_angle), kWrong);  // twin
}

TEST(SkyDirections, Gradient) {
  const Sky sky(gradient(), 1.0), other(gradient(), 1.0 + pi);
  const SkyDirections d(sky), turned(other);
  expect_follows<Window>(sky, d, {whole(sky)});
  expect_follows<SphereBins>(sky, d, {SphereBins(16, 16)});
  EXPECT_LT(p_of(whole(sky), density_of(d), draw_of(turned)), kWrong);  // twin
}
// Twin: the density of cells, constant within each.
TEST(SkyDirections, TwinOfAGradientInSteps) {
  const Sky sky(gradient(4, 2), 0);
  const SkyDirections d(sky);
  const Density of_texel = [&](const Vec3d& w) {
    double x, y;
    sky.raster(w, x, y);
    return d.pdf_w(sky.towards(std::floor(x) + 0.5, std::floor(y) + 0.5));
  };
  EXPECT_LT(p_of(whole(sky), of_texel, draw_of(d)), kWrong);
}

// On a side of the seam and at both poles.
TEST(SkyDirections, OneHotTexel) {
  for (const auto& [column, row] : {std::pair(31, 5), {7, 0}, {20, 15}}) {
    const Sky sky(hot(column, row), 0), off(hot(column, row), -pi / 32);
    const SkyDirections d(sky), half_a_texel_off(off);
    const double x = column + 0.5, y = row + 0.5;
    const Window lit{sky, x - 1, x + 1, std::max(y - 1, 0.0), std::min(y + 1, 16.0)};
    expect_follows<Window>(sky, d, {lit});
    EXPECT_LT(p_of(lit, density_of(d), draw_of(half_a_texel_off)), kWrong) << "twin";
    // Twin: uniform in the polar angle instead of its cosine.
    const Draw by_angle = [&](double pick, double u, double v) {
      double at_x, at_y;
      sky.raster(d.sample(pick, u, v), at_x, at_y);
      return at_y < 0.5 ? sky.towards(at_x, 0.5 * v) : sky.towards(at_x, at_y);
    };
    if (row == 0) {
      EXPECT_LT(p_of(lit, density_of(d), by_angle), kWrong);
    }
  }
}

TEST(SkyDirections, NothingThatShinesHasDensityZero) {
  const Sky sky(hot(5, 5), 0.3, {{direction(2, 0.3), 1e-3, Rgb(1e5f)}});
  const SkyDirections d(sky);
  Rng rng(43, 0, 0);
  for (int i = 0; i < 5000; ++i) {
    const double u = rng.uniform();
    const double v = rng.uniform();
    const Vec3d w = direction(2 * pi * u, 2 * v - 1);
    EXPECT_GE(d.pdf_w(w) * d.total(), 0.999);
  }
}

std::vector<Sky::Sun> two_suns() {
  return {{direction(1, 0.8), 0.05, Rgb(900)}, {direction(-2, 0.1), 0.2, Rgb(50, 30, 10)}};
}

TEST(SkyDirections, SunsOverAMap) {
  const Sky sky(gradient(), 0.4, two_suns());
  const SkyDirections d(sky);
  const auto disc = [&](size_t k) { return Disc{two_suns()[k].towards, two_suns()[k].half_angle}; };
  expect_follows<Disc>(sky, d, {disc(0), disc(1)});
  std::vector<Sky::Sun> suns = two_suns();
  suns[0].half_angle *= 0.95;
  const Sky other(gradient(), 0.4, suns);
  const SkyDirections smaller(other);
  EXPECT_LT(p_of(disc(0), density_of(d), draw_of(smaller)), kWrong);  // twin
}
TEST(SkyDirections, SunsOfManySizes) {
  for (const double half_angle : {1e-4, 0.7}) {
    const Sky sky({}, 0, {{direction(1, 0.2), half_angle, Rgb(1)}});
    const SkyDirections d(sky);
    EXPECT_NEAR(d.total() / (2 * pi * (1 - std::cos(half_angle))), 1, 1e-6);
    expect_follows<Disc>(sky, d, {Disc{sky.suns()[0].towards, half_angle}});
  }
}

// A window to the east, and little of everything else.
double eastwards(const Vec3d& w) {
  return w.x > 0.3 ? 1 : 0.1;
}

TEST(SkyDirections, Weighted) {
  for (const Sky::Map& map : {one_colour(Rgb(1)), gradient(256, 128)}) {
    const Sky sky(map, 0.5, two_suns());
    const SkyDirections d(sky, eastwards);
    const SphereBins east({1, 0, 0}, 1.0, 16, 16);
    expect_follows<SphereBins>(sky, d, {SphereBins(16, 16), east}, eastwards);
    const SkyDirections other(sky, [](const Vec3d& w) { return w.x > 0.3 ? 0.7 : 0.1; });
    EXPECT_LT(p_of(east, density_of(d), draw_of(other)), kWrong);  // twin
  }
}
// A uniform sky is cut into 128 wedges, each with the weight of its middle. The wedge of a
// direction is first found approximately, and corrected near a border.
TEST(SkyDirections, WeightsOfOneColourChangeAtTheBordersOfTheirWedges) {
  constexpr int kWedges = 128;
  const auto weight = [](const Vec3d& w) { return 2 + std::sin(3 * std::atan2(w.x, -w.z)); };
  const Sky sky(one_colour({1, 2, 3}), 0.7);
  const SkyDirections all(sky, weight);
  const auto towards = [](double wedge) { return direction(2 * pi * wedge / kWedges - 0.7, 0.4); };
  for (int k = 0; k < kWedges; ++k) {
    const double before = all.pdf_w(towards(k - 0.5)), after = all.pdf_w(towards(k + 0.5));
    EXPECT_NE(before, after) << k;
    EXPECT_NEAR(after / before / (weight(towards(k + 0.5)) / weight(towards(k - 0.5))), 1, 1e-6);
    for (const double off : {1e-9, 1e-6, 1e-5, 1e-4, 1e-3, 3e-3, 0.3}) {
      EXPECT_EQ(all.pdf_w(towards(k - off)), before) << k << ' ' << off;
      EXPECT_EQ(all.pdf_w(towards(k + off)), after) << k << ' ' << off;
    }
  }
}

TEST(Sky, RoughPlacesAreNearTheRightOnes) {
  const Sky sky(gradient(), 0.7);
  double largest = 0;
  for (uint64_t i = 0; i < kSamples; ++i) {
    Rng rng(15, 0, i);
    const double azimuth = 2 * pi * rng.uniform();
    const Vec3d w = direction(azimuth, 2 * rng.uniform() - 1);
    const Sky::Cell right = sky.cell(w), rough = sky.rough_place(w).cell;
    EXPECT_EQ(rough.row, right.row);
    EXPECT_EQ(rough.down, right.down);
    const double off = rough.column + rough.across - right.column - right.across;
    largest = std::max(largest, std::abs(std::remainder(off, 24)));
  }
  EXPECT_LT(largest, 2e-5 / (2 * pi) * 24);
  EXPECT_GT(largest, 0);
}

TEST(SkyDirections, WhatHasNoWeightIsNeverDrawn) {
  const Sky sky(gradient(), 0.5, two_suns());
  const auto upwards = [](const Vec3d& w) { return w.y > 0.5 ? 1.0 : 0.0; };
  const SkyDirections d(sky, upwards);
  for (uint64_t i = 0; i < 5000; ++i) {
    Rng rng(44, 0, i);
    const double pick = rng.uniform();
    const double u = rng.uniform();
    const double v = rng.uniform();
    const Vec3d w = d.sample(pick, u, v);
    EXPECT_GT(w.y, 0.45);
    EXPECT_GT(d.pdf_w(w), 0);
  }
  EXPECT_EQ(d.pdf_w({0, -1, 0}), 0);
  EXPECT_TRUE(SkyDirections(sky, [](const Vec3d&) { return 0.0; }).empty());
}

// Maps whose table has blocks of cells that do not divide the map evenly, with one texel of 1e9.
TEST(SkyDirections, LargeMapsAreDrawnFromExactlyAsWell) {
  constexpr int kWidth = 2050, kHeight = 1107;
  Sky::Map map = gradient(kWidth, kHeight);
  map.texels[size_t{700} * kWidth + 2049] = Rgb(1e9f);
  const Sky sky(map, 0.2);
  const SkyDirections d(sky), weighted(sky, eastwards);
  const Window at_hot{sky, 2048.5, 2050.5, 699.5, 701.5, 12};
  const double luminous = luminance(Rgb(1e9f)) * sky.solid_angle(700);
  EXPECT_NEAR(d.total() / luminous, 1, 1e-2);
  expect_follows<Window>(sky, d, {at_hot});
  expect_follows<Window>(sky, weighted, {at_hot}, eastwards);
  const Sky even(gradient(kWidth, kHeight), 0.2);
  expect_follows<SphereBins>(even, SkyDirections(even), {SphereBins(12, 12)});
}

}  // namespace tdpt::sky_test
