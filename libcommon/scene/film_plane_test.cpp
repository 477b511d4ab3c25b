// The pinhole camera: pixels and directions are mutually inverse, and its density is that of
// uniform pixels.
#include "libcommon/scene/film_plane.h"

#include <gtest/gtest.h>
#include <cmath>
#include <numbers>

#include "libcommon/math/rng.h"

namespace tdpt::film_plane_test {

Camera camera() {
  Camera c;
  c.position = {0.3, -0.2, 0.1};
  c.forward = normalize(Vec3d(1, -0.5, 0.3));
  c.right = normalize(cross(c.forward, Vec3d(0, 1, 0)));
  c.up = cross(c.right, c.forward);
  c.yfov = 0.9;
  return c;
}

TEST(FilmPlane, DirectionAndRasterAreInverse) {
  const FilmPlane film(camera(), 64, 48);
  for (double x = 0.25; x < 64; x += 3.5)
    for (double y = 0.25; y < 48; y += 3.5) {
      double u, v;
      ASSERT_TRUE(film.raster(film.direction(x, y), u, v));
      EXPECT_NEAR(u, x, 1e-9);
      EXPECT_NEAR(v, y, 1e-9);
    }
  double u, v;
  EXPECT_FALSE(film.raster(-film.forward(), u, v));
  EXPECT_FALSE(film.raster(film.direction(-0.01, 5), u, v));
  EXPECT_FALSE(film.raster(film.direction(5, 48.01), u, v));
}

TEST(FilmPlane, TopLeftIsUpAndLeftAndYfovHolds) {
  const Camera c = camera();
  const FilmPlane film(c, 64, 48);
  const Vec3d corner = film.direction(0, 0);
  EXPECT_LT(dot(corner, c.right), 0);
  EXPECT_GT(dot(corner, c.up), 0);
  const double angle = std::acos(dot(film.direction(32, 0), film.direction(32, 48)));
  EXPECT_NEAR(angle, 0.9, 1e-12);
  EXPECT_NEAR(dot(film.direction(32, 24), c.forward), 1, 1e-12);
}

const FilmPlane kFilm(camera(), 64, 48);
const CameraBlur kLens({0.02, 0.5}, {});

// Where a point at a raster place and a distance along the view direction shows itself.
Vec3d at_distance(double x, double y, double distance) {
  const Vec3d w = kFilm.direction(x, y);
  return kFilm.position() + w * (distance / dot(w, kFilm.forward()));
}

TEST(Lens, ShowsItsPlaneOfFocusSharply) {
  for (uint64_t i = 0; i < 200; ++i) {
    Rng rng(1, 0, i);
    const double x = 64 * rng.uniform(), y = 48 * rng.uniform();
    const FilmPlane seen = kLens.draw(kFilm, rng.uniform(), rng.uniform(), 0);
    double u, v;
    ASSERT_TRUE(seen.raster(normalize(at_distance(x, y, 0.5) - seen.position()), u, v));
    EXPECT_NEAR(u, x, 1e-9);
    EXPECT_NEAR(v, y, 1e-9);
    const Vec3d w = seen.direction(x, y);
    ASSERT_TRUE(seen.raster(w, u, v));
    EXPECT_NEAR(u, x, 1e-9);
    EXPECT_NEAR(v, y, 1e-9);
    EXPECT_NEAR(dot(w, kFilm.forward()) * length(at_distance(x, y, 0.5) - seen.position()), 0.5,
                1e-12);
  }
}

// A point at distance d is a disc of radius R |1/f - 1/d| on a film at distance 1, filled evenly:
// the mean of the squared distance from its middle is half of its radius squared.
TEST(Lens, BlursOtherDistancesByAnEvenCircleOfConfusion) {
  const double pixels = 24 / kFilm.half_height();  // per unit on the film
  for (const double d : {0.25, 0.4, 1.0, 5.0}) {
    const Vec3d p = at_distance(32, 24, d);
    const double radius = 0.02 * std::abs(1 / 0.5 - 1 / d) * pixels;
    double largest = 0, squares = 0, across = 0;
    constexpr int kPoints = 10000;
    for (uint64_t i = 0; i < kPoints; ++i) {
      Rng rng(2, 0, i);
      const FilmPlane seen = kLens.draw(kFilm, rng.uniform(), rng.uniform(), 0);
      double u, v;
      ASSERT_TRUE(seen.raster(normalize(p - seen.position()), u, v));
      const double r2 = (u - 32) * (u - 32) + (v - 24) * (v - 24);
      largest = std::max(largest, r2);
      squares += r2 / kPoints;
      across += (u - 32) * (u - 32) / kPoints;
    }
    EXPECT_LE(std::sqrt(largest), radius * (1 + 1e-9)) << d;
    EXPECT_GE(std::sqrt(largest), radius * 0.99) << d;
    EXPECT_NEAR(squares, radius * radius / 2, 0.01 * radius * radius) << d;
    EXPECT_NEAR(across, radius * radius / 4, 0.01 * radius * radius) << d;
    EXPECT_GT(std::abs(squares - radius * radius / 3), 0.05 * radius * radius)
        << "a uniform radius";
  }
}

// Uniform raster places of a point of the lens have the density that its film claims.
TEST(Lens, DensityOfDirectionsIsThatOfUniformPixels) {
  const FilmPlane seen = kLens.draw(kFilm, 0.9, 0.3, 0);
  const Vec3d middle = seen.direction(57, 42);
  constexpr double kCos = 0.9995;  // a cone about the middle
  constexpr int kPlaces = 400000;
  double inside = 0, expected = 0;
  for (uint64_t i = 0; i < kPlaces; ++i) {
    Rng rng(3, 0, i);
    inside += dot(seen.direction(64 * rng.uniform(), 48 * rng.uniform()), middle) > kCos;
    const double z = 1 - (1 - kCos) * rng.uniform(), phi = 2 * std::numbers::pi * rng.uniform();
    const Vec3d side = normalize(cross(middle, Vec3d(0, 1, 0))), up = cross(side, middle);
    const double r = std::sqrt(1 - z * z);
    expected += seen.pdf_w(middle * z + side * (r * std::cos(phi)) + up * (r * std::sin(phi)));
  }
  expected *= 2 * std::numbers::pi * (1 - kCos);
  EXPECT_NEAR(inside, expected, 5 * std::sqrt(expected));
  EXPECT_GT(std::abs(inside - expected * dot(middle, seen.forward())), 5 * std::sqrt(expected));
}

TEST(Shutter, MovesEvenlyFromPoseToPose) {
  std::vector<Camera> poses;
  for (const double turn : {-0.2, 0.0, 0.1}) {
    Camera pose = camera();
    pose.position += pose.right * turn;
    pose.forward = normalize(camera().forward + camera().right * turn);
    pose.right = normalize(cross(pose.forward, camera().up));
    pose.up = cross(pose.right, pose.forward);
    poses.push_back(pose);
  }
  const CameraBlur shutter({}, poses);
  for (size_t i = 0; i < 3; ++i) {
    const FilmPlane film = shutter.draw(kFilm, 0, 0, 0.5 * static_cast<double>(i));
    EXPECT_LT(length(film.position() - poses[i].position), 1e-12);
    EXPECT_LT(length(film.forward() - poses[i].forward), 1e-12);
    EXPECT_LT(length(film.up() - poses[i].up), 1e-12);
  }
  for (double time = 0; time < 1; time += 0.1) {
    const FilmPlane film = shutter.draw(kFilm, 0.7, 0.2, time);
    const double moved = dot(film.position() - camera().position, camera().right);
    EXPECT_NEAR(moved, time < 0.5 ? -0.2 + 0.4 * time : 0.2 * (time - 0.5), 1e-12);
    EXPECT_NEAR(length(film.forward()), 1, 1e-12);
    EXPECT_NEAR(dot(film.forward(), film.up()), 0, 1e-12);
    EXPECT_LT(length(cross(film.right(), film.up()) + film.forward()), 1e-12);
    EXPECT_EQ(film.half_width(), kFilm.half_width());
  }
}

TEST(Blur, OfAPinholeAtAnInstantChangesNothing) {
  EXPECT_FALSE(CameraBlur().any());
  EXPECT_FALSE(CameraBlur({}, {camera()}).any());
  EXPECT_TRUE(kLens.any());
  const FilmPlane same = CameraBlur().draw(kFilm, 0.3, 0.4, 0.5);
  EXPECT_EQ(same.position(), kFilm.position());
  EXPECT_EQ(same.direction(7.1, 9.3), kFilm.direction(7.1, 9.3));
}

}  // namespace tdpt::film_plane_test
