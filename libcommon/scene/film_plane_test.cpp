// The pinhole camera: pixels and directions are mutually inverse, and its density is that of
// uniform pixels.
#include "libcommon/scene/film_plane.h"

#include <gtest/gtest.h>
#include <numbers>

#include "libcommon/math/rng.h"

namespace tdpt::film_plane_test {

Camera camera() {
  Camera c;
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

TEST(FilmPlane, DensityIntegratesToOneOverTheSphere) {
  const FilmPlane film(camera(), 64, 48);
  const int n = 200000;
  double sum = 0, squares = 0, faulty = 0;
  for (uint64_t i = 0; i < n; ++i) {
    Rng rng(4, 0, i);
    const double z = 2 * rng.uniform() - 1, phi = 2 * std::numbers::pi * rng.uniform();
    const double r = std::sqrt(1 - z * z);
    const Vec3d w(r * std::cos(phi), r * std::sin(phi), z);
    double x, y;
    if (!film.raster(w, x, y)) continue;
    const double f = 4 * std::numbers::pi * film.pdf_w(w);
    sum += f, squares += f * f;
    faulty += f * dot(w, film.forward());  // one cosine too few in the denominator
  }
  const double mean = sum / n, error = std::sqrt((squares / n - mean * mean) / n);
  EXPECT_NEAR(mean, 1, 4 * error);
  EXPECT_GT(std::abs(faulty / n - 1), 4 * error);
}

}  // namespace tdpt::film_plane_test
