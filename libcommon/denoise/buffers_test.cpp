#include "libcommon/denoise/buffers.h"

#include <cmath>

#include <gtest/gtest.h>

#include "libcommon/testing/scenes/noisy_picture.h"

namespace tdpt::denoise {
namespace buffers_test {
namespace {

constexpr Size kSize = TestPicture::kSize;
constexpr double kWall = 2;  // depth [m]

Camera facing() {
  Camera camera;
  camera.right = {1, 0, 0}, camera.up = {0, 1, 0}, camera.forward = {0, 0, -1};
  camera.yfov = 1;
  return camera;
}
// Of a camera that has moved by so many pixels at the depth of the wall.
View view(double pixels, double depth = kWall) {
  Camera camera = facing();
  const double pixel = 2 * std::tan(0.5 * camera.yfov) * kWall / kSize.height;
  camera.position = {pixels * pixel, 0, 0};
  return {FilmPlane(camera, kSize.width, kSize.height),
          Plane(kSize.pixels(), static_cast<float>(depth))};
}

// Numbers that tell the pixel.
NoisyHalves numbered(float more) {
  NoisyHalves halves;
  halves.share_a = 0.75;
  Plane plane;
  for (size_t i = 0; i < kSize.pixels(); ++i) plane.push_back(more + static_cast<float>(i));
  halves.a.fill(plane);
  halves.b.fill(plane);
  halves.features.fill(plane);
  return halves;
}

TEST(Reproject, ACameraThatStaysSeesTheSame) {
  const Neighbour all = reproject(numbered(0.5f), view(0), numbered(0), view(0));
  EXPECT_EQ(all.present, Plane(kSize.pixels(), 1.0f));
  EXPECT_EQ(all.halves.a, numbered(0.5f).a);
  EXPECT_EQ(all.halves.b, numbered(0.5f).b);
  EXPECT_EQ(all.halves.features[5], numbered(0.5f).features[5]);
  EXPECT_EQ(all.halves.features[6], numbered(0).features[6]);  // the depth from here
  EXPECT_EQ(all.halves.share_a, 0.75);
}

TEST(Reproject, PlacesAreFoundWhereTheyWereSeen) {
  const NoisyHalves here = numbered(0), there = numbered(0.5f);
  for (const int moved : {7, -5}) {
    const Neighbour all = reproject(there, view(moved), here, view(0));
    for (int x = 0; x < kSize.width; ++x) {
      const size_t i = 20 * 96 + static_cast<size_t>(x);
      const bool seen = x >= moved && x < kSize.width + moved;
      EXPECT_EQ(all.present[i], seen ? 1 : 0) << x;
      const size_t j = i - static_cast<size_t>(seen ? moved : 0);
      EXPECT_EQ(all.halves.a[1][i], seen ? there.a[1][j] : here.a[1][i]) << x;
    }
  }
}

TEST(Reproject, BetweenPixelsIsWhatLinearInterpolationSays) {
  const NoisyHalves here = numbered(0), there = numbered(0);
  const Neighbour all = reproject(there, view(2.25), here, view(0));
  for (int x = 3; x < kSize.width; ++x) {
    const size_t i = 20 * 96 + static_cast<size_t>(x);
    EXPECT_NEAR(all.halves.b[0][i], there.b[0][i] - 2.25f, 1e-3f);
    EXPECT_NEAR(all.halves.features[0][i], there.features[0][i] - 2.25f, 1e-3f);
  }
  // Only from those that show the same: here every second column is another surface.
  View striped = view(2.25);
  for (size_t i = 1; i < kSize.pixels(); i += 2) striped.depth[i] = 1.1f * striped.depth[i];
  const Neighbour half = reproject(there, striped, here, view(0));
  for (int x = 4; x < kSize.width; ++x) {
    const size_t i = 20 * 96 + static_cast<size_t>(x), j = i - 2;  // the nearest
    EXPECT_EQ(half.present[i], 1);
    EXPECT_EQ(half.halves.a[0][i], there.a[0][j % 2 == 0 ? j : j - 1]);
  }
}

// Between a lamp and a wall, of the same depth, is neither, unless no pixel lies between them.
TEST(Reproject, NothingIsTakenFromTheEdgeOfALamp) {
  NoisyHalves there = numbered(0);
  Plane plane(kSize.pixels());
  for (size_t i = 0; i < plane.size(); ++i) plane[i] = i % 96 < 40 ? 40.0f : 0.25f;
  plane[20 * 96 + 60] = 1000;  // noise is no edge
  there.a.fill(plane);
  for (size_t i = 0; i < plane.size(); ++i)
    if (i % 96 >= 70) plane[i] = 40;  // nor is what one half alone says
  there.b.fill(plane);
  for (const double moved : {0.5, 0.0}) {
    const Neighbour all = reproject(there, view(moved), numbered(0), view(0));
    for (size_t x = 1; x < 95; ++x) {
      const bool edge = moved > 0 && x == 40;
      EXPECT_EQ(all.present[20 * 96 + x], edge ? 0 : 1) << moved << ' ' << x;
    }
  }
}

TEST(Reproject, WhatIsHiddenThereOrNothingIsNotTaken) {
  const auto share = [](double here, double there) {
    const Plane present =
        reproject(numbered(1), view(3, there), numbered(0), view(0, here)).present;
    double sum = 0;
    for (const float p : present) sum += static_cast<double>(p);
    return sum / static_cast<double>(kSize.pixels());
  };
  EXPECT_GT(share(kWall, 1.01 * kWall), 0.9);
  EXPECT_EQ(share(kWall, 1.1 * kWall), 0);
  EXPECT_EQ(share(kWall, 0.9 * kWall), 0);
  EXPECT_EQ(share(kWall, 1e10), 0);
  EXPECT_EQ(share(1e10, kWall), 0);
  EXPECT_EQ(share(1e10, 1e10), 1);
  View beyond_the_wall = view(0);
  Camera camera = facing();
  camera.position = {0, 0, -2 * kWall};
  beyond_the_wall.film = FilmPlane(camera, kSize.width, kSize.height);
  EXPECT_EQ(reproject(numbered(1), beyond_the_wall, numbered(0), view(0)).present,
            Plane(kSize.pixels()));
}

}  // namespace
}  // namespace buffers_test
}  // namespace tdpt::denoise
