// Survival of walks equals the albedo of the surface, which is estimated here by sampled weights.
#include "tools/tdpt-render/path/sample/walk.h"

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "tools/tdpt-render/testing/bsdfs.h"

namespace tdpt::roulette_test {

using test::NamedBsdf;

struct Estimate {
  double mean, error;  ///< standard error
};

// Mean weight of walks that come from `from`, largest component.
Estimate sampled_albedo(const Bsdf& b, const Vec3d& from) {
  constexpr int kSamples = 8000;
  Vec3d sum, squares;
  for (uint64_t i = 0; i < kSamples; ++i) {
    Rng rng(3, 1, i);
    const double choice = rng.uniform(), u = rng.uniform(), v = rng.uniform();
    test::whole::Scattered out;
    if (!test::whole::sample(b, from, choice, u, v, out)) continue;
    const double n = test::index(b, out.to);
    const Vec3d weight =
        out.dirac ? test::whole::dirac_reflectance(b, from, out.to) /
                        test::whole::dirac_probability(b, from, out.to)
                  : test::whole::f(b, from, out.to) *
                        (n * n * std::abs(out.to.z) / test::whole::pdf_w(b, from, out.to));
    sum += weight;
    squares += weight * weight;
  }
  Estimate largest{0, 0};
  for (const auto component : {&Vec3d::x, &Vec3d::y, &Vec3d::z}) {
    const double mean = sum.*component / kSamples;
    if (mean < largest.mean) continue;
    largest = {mean, std::sqrt(std::max(0.0, squares.*component / kSamples - mean * mean) /
                               (kSamples - 1))};
  }
  return largest;
}

// The same by quadrature over uniform directions, for broad lobes.
double integrated_albedo(const Bsdf& b, const Vec3d& from) {
  constexpr int kZ = 200, kAzimuth = 100;
  Vec3d sum;
  for (int i = 0; i < kZ; ++i)
    for (int j = 0; j < kAzimuth; ++j) {
      const double z = -1 + 2 * (i + 0.5) / kZ;
      const Vec3d to = test::direction(z, 2 * std::numbers::pi * (j + 0.5) / kAzimuth);
      const double n = test::index(b, to);
      sum += test::whole::f(b, from, to) * (n * n * std::abs(z));
    }
  return max_component(Vec3f(sum)) * 4 * std::numbers::pi / (kZ * kAzimuth);
}

double survival(const Bsdf& b, const Vec3d& from) {
  Material material;
  Point p = test::whole::point(b);
  p.material = &material;
  const Onb<double> onb(p.shading);
  return albedo_at(p, Incidence(p, onb.x * from.x + onb.y * from.y + onb.z * from.z));
}

std::vector<NamedBsdf> kinds(float alpha) {
  std::vector<NamedBsdf> all = test::white(alpha);
  for (const NamedBsdf& b : test::coloured(alpha)) all.push_back(b);
  return all;
}

// How much too often walks end (above) or survive (below); noise is subtracted.
struct Worst {
  double above = -1, below = -1;
  std::string at;
};
Worst worst_of(const std::vector<NamedBsdf>& all, double (*told)(const Bsdf&, const Vec3d&)) {
  Worst worst;
  for (const NamedBsdf& named : all)
    for (const double z : {1.0, 0.6, 0.2, -0.3, -0.9}) {
      if (z < 0 && !test::transmits(named.b)) continue;
      const Vec3d from = test::direction(z, 0.7);
      const Estimate albedo = sampled_albedo(named.b, from);
      const double lacks = std::clamp(albedo.mean, 0.05, 1.0) - told(named.b, from);
      worst.above = std::max(worst.above, -lacks - 4 * albedo.error);
      if (lacks - 4 * albedo.error <= worst.below) continue;
      worst.below = lacks - 4 * albedo.error;
      worst.at = named.name + " from z = " + std::to_string(z);
    }
  return worst;
}

TEST(roulette, walks_end_no_more_often_than_surfaces_absorb) {
  for (const float alpha : {0.0f, 0.05f, 0.3f, 1.0f}) {
    const Worst worst = worst_of(kinds(alpha), survival);
    EXPECT_LT(worst.below, 0.02) << worst.at << ", alpha " << alpha;
  }
}

TEST(roulette, nor_less_often_where_surfaces_are_opaque) {
  for (const float alpha : {0.0f, 0.05f, 0.3f, 1.0f}) {
    std::vector<NamedBsdf> opaque, layered;
    for (const NamedBsdf& b : kinds(alpha))
      if (!test::transmits(b.b))
        (test::has_sheen(b.b) || test::has_coat(b.b) || max_component(b.b.dip) > 0 ? layered
                                                                                   : opaque)
            .push_back(b);
    ASSERT_GT(opaque.size(), 6u);
    ASSERT_GT(layered.size(), 6u);
    EXPECT_LT(worst_of(opaque, survival).above, 0.02) << alpha;
    // No claim about what a sheen, or a rough coat over facets, counts twice, or about a
    // conductor's dip.
    EXPECT_LT(worst_of(layered, survival).above, 0.15) << alpha;
  }
}

TEST(roulette, sampled_weights_are_the_integral) {
  for (const NamedBsdf& named : kinds(0.7f))
    for (const double z : {0.9, 0.3}) {
      const Vec3d from = test::direction(z, 0.7);
      if (surfaces().odds_at(test::whole::point(named.b), from).dirac > 0)
        continue;  // no change of index
      const Estimate albedo = sampled_albedo(named.b, from);
      EXPECT_NEAR(integrated_albedo(named.b, from), albedo.mean, 5 * albedo.error + 2e-3)
          << named.name << " " << z;
    }
}

TEST(roulette, twin_walks_that_know_less_of_a_surface_are_caught) {
  const auto diffuse = [](const Bsdf& b, const Vec3d&) { return double{max_component(b.diffuse)}; };
  EXPECT_GT(worst_of(kinds(0.3f), diffuse).below, 0.3);
  const auto off_by_5_percent = [](const Bsdf& b, const Vec3d& from) {
    return 0.95 * survival(b, from);
  };
  for (const float alpha : {0.0f, 0.3f})
    EXPECT_GT(worst_of(kinds(alpha), off_by_5_percent).below, 0.03);
}

TEST(roulette, a_diffuse_surface_has_the_largest_component_of_its_colour) {
  Material material;
  Point p;
  EXPECT_EQ(albedo_at(p, Incidence(p, {0, 0, 1})), 1);  // off surfaces
  p.material = &material;
  p.normal = p.shading = {0, 0, 1};
  p.color = {0.2f, 0.7f, 0.1f};
  EXPECT_EQ(albedo_at(p, Incidence(p, {0, 0, 1})), double{0.7f});
  EXPECT_EQ(albedo_at(p, Incidence(p, {0, 0, -1})), double{0.7f});
  p.color = {};
  EXPECT_EQ(albedo_at(p, Incidence(p, {0, 0, 1})), 0.05);  // a black surface: lower limit
  p.color = Rgb(1);
  EXPECT_EQ(albedo_at(p, Incidence(p, {0, 0, 1})), 1);
}

// A pane stops rays as seldom as it reflects: those that it stops are all reflected.
TEST(roulette, walks_that_have_found_a_pane_go_on) {
  Material pane, sheet;
  pane.plain = sheet.plain = false;
  pane.specular = pane.transmission = 1;
  pane.roughness = 0;
  pane.base_color = Rgb(1);
  Point p;
  p.simple = false;
  p.normal = p.shading = {0, 0, 1};
  p.bsdf = test::make({}, test::normal_reflectance(1.5f), 1, {}, 0);
  for (const double z : {1.0, 0.6, -0.9}) {
    p.material = &pane;
    EXPECT_NEAR(albedo_at(p, Incidence(p, test::direction(z, 0.7))), 1, 0.01) << z;
    p.material = &sheet;  // twin: a sheet that all rays hit
    EXPECT_LT(albedo_at(p, Incidence(p, test::direction(z, 0.7))), 0.2) << z;
  }
}

TEST(roulette, the_first_vertices_always_go_on) {
  for (const int i : {0, 1}) EXPECT_TRUE(always_goes_on(i));
  for (const int i : {2, 3, 100}) EXPECT_FALSE(always_goes_on(i));
}

}  // namespace tdpt::roulette_test
