// Lights: the density is that of the samples, and powers are summed correctly. Each statistical
// check has a twin with a planted fault.
#include "libcommon/scene/lights.h"

#include <gtest/gtest.h>
#include <cmath>
#include <numbers>

#include "libcommon/testing/statistics/chi_square.h"

namespace tdpt::lights_test {

Material material(const Rgb& emission, bool double_sided) {
  Material m;
  m.emission = emission;
  m.double_sided = double_sided;
  return m;
}

// Three emitting triangles of different power, one of them double-sided, and a dark one.
Scene lamps() {
  Scene s;
  s.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.25f, 0, 0}, {0, 0.5f, 0}};
  s.materials = {material(Rgb(1, 2, 3), false), material(Rgb(4), true), material(Rgb(), true)};
  s.triangles = {{{0, 1, 2}, 0}, {{0, 1, 2}, 2}, {{0, 3, 4}, 1}, {{0, 3, 2}, 0}};
  return s;
}

TEST(Lights, PowerAndDensityAddUp) {
  const Scene s = lamps();
  const Lights all(s);
  const LightSelection e(all);
  const double dim = luminance(Rgb(1, 2, 3)), both = luminance(Rgb(4));
  EXPECT_NEAR(all.power(), std::numbers::pi * (dim * 0.5 + 2 * both * 0.0625 + dim * 0.125), 1e-5);
  double total = 0;
  for (uint32_t t = 0; t < s.triangles.size(); ++t) total += e.pdf_A(t) * shape_of(s, t).area;
  EXPECT_NEAR(total, 1, 1e-6);
  EXPECT_EQ(e.pdf_A(1), 0);
  Scene dark = s;
  for (Material& m : dark.materials) m.emission = {};
  EXPECT_TRUE(Lights(dark).empty());
  EXPECT_EQ(Lights(dark).power(), 0);
}

TEST(Lights, SamplesFollowTheDensity) {
  const Scene s = lamps();
  const Lights all(s);
  const LightSelection e(all);
  // Bins: triangle x side x quarter of the triangle (by its middle points).
  std::vector<double> expected(4 * 2 * 4);
  for (uint32_t t : {0u, 2u, 3u})
    for (size_t side = 0; side < (t == 2 ? 2u : 1u); ++side)
      for (size_t k = 0; k < 4; ++k)
        expected[8 * t + 4 * side + k] =
            double{e.pdf_A(t)} * shape_of(s, t).area / 4 / (t == 2 ? 2 : 1);
  const auto bin = [&](uint64_t i) {
    Rng rng(3, 0, i);
    const Lights::Point x = e.sample(rng);
    EXPECT_EQ(x.pdf, e.pdf_A(x.triangle));
    const TriangleShape shape = shape_of(s, x.triangle);
    const Vec3d p = x.position - shape.p0;
    const double b1 = p.x / shape.e1.x, b2 = p.y / shape.e2.y;
    EXPECT_LE(b1 + b2, 1 + 1e-12);
    const size_t quarter = b1 > 0.5 ? 1 : b2 > 0.5 ? 2 : b1 + b2 < 0.5 ? 0 : 3;
    const size_t side = dot(x.normal, shape.normal) < 0;
    return 8 * x.triangle + 4 * side + quarter;
  };
  EXPECT_GT(chi_square_of_samples(20000, expected, bin).p, 1e-4);
  std::vector<double> wrong = expected;  // twin: a sixteenth of the light too often
  wrong[0] *= 1.25, wrong[1] *= 0.75;
  EXPECT_LT(chi_square_of_samples(20000, wrong, bin).p, 1e-9);
}

// Two of equal area, one of them billions of times fainter.
TEST(Lights, TheFaintAreChosenAHundredthAsOftenAsTheMean) {
  Scene s = lamps();
  s.materials[0].emission = Rgb(1e10f);
  s.materials[1].emission = Rgb(1e-10f);
  s.triangles = {{{0, 1, 2}, 0}, {{0, 1, 2}, 1}};
  const Lights lights(s);
  const LightSelection e(lights);
  EXPECT_NEAR(e.pdf_A(1) / e.pdf_A(0), 0.01 / 2, 1e-6);
  EXPECT_NEAR(e.shares().surfaces, 1, 1e-12);
  s.materials[1].emission = Rgb(1e9f);  // not faint: selected by power, which both sides have
  const Lights of_both(s);
  const LightSelection both(of_both);
  EXPECT_NEAR(both.pdf_A(1) / both.pdf_A(0), 2 * 0.1, 1e-6);
}

// The density integrates to 1 over all directions, for one side and for both.
TEST(Lights, DirectionsOfEmissionAddUp) {
  for (bool both : {false, true}) {
    const LightSource source = LightSource::surface(both);
    const auto at = [&](double cos) {
      return source.pdf_w({0, 0, 1}, {std::sqrt(1 - cos * cos), 0, cos});
    };
    double sum = 0;
    const int n = 2000;
    for (int i = 0; i < n; ++i) sum += at(-1 + (i + 0.5) * 2 / n) * 2 * std::numbers::pi * 2 / n;
    EXPECT_NEAR(sum, 1, 1e-6);
    EXPECT_EQ(at(-0.5) > 0, both);
  }
}

TEST(Lights, RadianceLeavesTheFrontOnlyUnlessDoubleSided) {
  const Rgb radiance(1, 2, 3);
  const Vec3d n(0, 0, 1);
  const LightSource front = LightSource::surface(false);
  EXPECT_EQ(front.emitted(n, radiance, {0, 0.6, 0.8}), radiance);
  EXPECT_EQ(front.emitted(n, radiance, {0, 0.6, -0.8}), Rgb());
  EXPECT_EQ(front.emitted(n, radiance, {1, 0, 0}), Rgb());
  EXPECT_EQ(LightSource::surface(true).emitted(n, radiance, {0, 0.6, -0.8}), radiance);
}

TEST(Lights, NarrowSpotsAreAsBrightInsideAsWideOnes) {
  PunctualLight spot;
  spot.kind = PunctualLight::Kind::spot;
  spot.intensity = Rgb(3);
  for (double inner : {0.4, 0.02, 1e-4}) {
    spot.cos_inner = std::cos(inner);
    spot.cos_outer = std::cos(1.5 * inner);
    const auto at = [&](double angle) {
      const Vec3d w(std::sin(angle), 0, -std::cos(angle));
      return LightSource::punctual(spot, 1).emitted({}, {}, w).x;
    };
    EXPECT_FLOAT_EQ(at(0), 3);
    EXPECT_NEAR(at(0.99 * inner), 3, 1e-3);
    EXPECT_GT(at(1.2 * inner), 0.1);
    EXPECT_LT(at(1.2 * inner), 2.9);
    EXPECT_EQ(at(1.51 * inner), 0);
  }
}

}  // namespace tdpt::lights_test
