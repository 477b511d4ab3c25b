// Surfaces: symmetry, conservation of energy and survival of walks, Fresnel's and Snell's laws.
//
// With basic radiance, energy E(from) = int f(from, to) n_to^2 |cos_to| dw_to + Dirac lobes is the
// share of a beam from `from` that is kept: a lossless surface conserves etendue n^2 |cos| dw.
#include <complex>

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "tools/tdpt-render/path/bsdf/scatter.h"
#include "tools/tdpt-render/testing/bsdfs.h"

namespace tdpt::bsdf_test {

using namespace test;

constexpr float kAlphas[] = {0, 2e-4f, 2e-3f, 0.02f, 0.1f, 0.3f, 0.6f, 1};

std::vector<NamedBsdf> all(float alpha) {
  std::vector<NamedBsdf> kinds = white(alpha);
  for (const NamedBsdf& k : coloured(alpha)) kinds.push_back(k);
  return kinds;
}
template <class Use>
void for_all(Use use) {
  for (float alpha : kAlphas)
    for (const NamedBsdf& k : all(alpha)) {
      SCOPED_TRACE(k.name + " alpha " + std::to_string(alpha));
      use(k);
    }
}

double difference(const Vec3d& a, const Vec3d& b) {
  return max_component(max(a - b, b - a));
}
bool symmetric(const Vec3d& ab, const Vec3d& ba) {
  return difference(ab, ba) <= 2e-4 * std::max(1e-6, max_component(max(ab, ba)));
}

// Uniform pairs, and pairs that sample() connects; asymmetric(b, from, to) = f.
template <class F>
int asymmetric_pairs(const Bsdf& b, F f) {
  int bad = 0;
  for (uint64_t i = 0; i < 400; ++i) {
    Rng rng(11, 0, i);
    const Vec3d from = uniform_direction(rng);
    Vec3d to = uniform_direction(rng);
    if (i % 2) {
      const double choice = rng.uniform();
      const double u = rng.uniform();
      const double v = rng.uniform();
      whole::Scattered s;
      if (!whole::sample(b, from, choice, u, v, s) || s.dirac) continue;
      to = s.to;
    }
    if (!symmetric(f(b, from, to), f(b, to, from))) ++bad;
  }
  return bad;
}
double apart(const Vec3d& mine, const Vec3d& of_books) {
  return difference(mine, of_books) /
         std::max({max_component(mine), max_component(of_books), 1e-9});
}
// Largest difference, over BSDFs of all kinds at such pairs, between the code and textbook formulas
// [oracle_bsdf.h]. Twin: `of_text` differs from alpha.
double most_apart(float alpha, float of_text) {
  double most = 0;
  for (const NamedBsdf& k : all(alpha))
    for (uint64_t i = 0; i < 100; ++i) {
      if (has_coat(k.b)) continue;  // two normals: oracle::CoatedSurface
      Bsdf b = k.b;
      if (b.alpha == alpha) b.alpha = of_text;
      Rng rng(13, 0, i);
      const Vec3d from = uniform_direction(rng);
      const double choice = rng.uniform();
      const double u = rng.uniform();
      const double v = rng.uniform();
      whole::Scattered s{uniform_direction(rng), false};
      if (i % 2 && !whole::sample(k.b, from, choice, u, v, s)) continue;
      namespace books = oracle::bsdf;
      const double of_dirac = books::dirac_probability(k.b, from, s.to);
      most =
          std::max({most, apart(whole::f(b, from, s.to), books::f(k.b, from, s.to)),
                    apart(Vec3d(whole::pdf_w(b, from, s.to)), Vec3d(books::pdf_w(k.b, from, s.to))),
                    apart(whole::albedo(b, from), books::albedo(k.b, from)),
                    apart(Vec3d(whole::dirac_probability(b, from, s.to)), Vec3d(of_dirac))});
      if (of_dirac > 0)
        most = std::max(most, apart(whole::dirac_reflectance(b, from, s.to),
                                    books::dirac_reflectance(k.b, from, s.to)));
    }
  return most;
}
TEST(bsdf, is_that_of_books) {
  for (const float alpha : kAlphas)
    EXPECT_LT(most_apart(alpha, alpha), 1e-7 + (alpha > 0 ? 1e-10 / alpha : 0)) << alpha;
}
TEST(bsdf, twin_an_alpha_half_a_percent_off_is_not_that_of_books) {
  for (const float alpha : {0.02f, 0.3f}) EXPECT_GT(most_apart(alpha, 1.005f * alpha), 1e-3);
}

TEST(bsdf, is_symmetric) {
  for_all([](const NamedBsdf& k) { EXPECT_EQ(asymmetric_pairs(k.b, whole::f), 0); });
}
TEST(bsdf, twin_the_bsdf_of_radiance_is_not_symmetric) {
  const auto radiance = [](const Bsdf& b, const Vec3d& from, const Vec3d& to) {
    const double n = index(b, from);
    return whole::f(b, from, to) * (n * n);
  };
  EXPECT_GT(asymmetric_pairs(glass(0.3f), radiance), 50);
  EXPECT_EQ(asymmetric_pairs(glass(0.3f, 1.5f, true), radiance), 0);
}

TEST(bsdf, smooth_lobes_are_symmetric) {
  for (const NamedBsdf& k : all(0))
    for (uint64_t i = 0; i < 100; ++i) {
      SCOPED_TRACE(k.name);
      Rng rng(12, 0, i);
      const Vec3d from = uniform_direction(rng);
      const double choice = rng.uniform();
      whole::Scattered s;
      if (!whole::sample(k.b, from, choice, 0.3, 0.6, s) || !s.dirac) continue;
      EXPECT_LT(difference(whole::dirac_reflectance(k.b, from, s.to),
                           whole::dirac_reflectance(k.b, s.to, from)),
                1e-5);
      EXPECT_GT(whole::dirac_probability(k.b, s.to, from), 0);
      // The way back is the way there: reflected, or bent by Snell's law.
      const bool reflects = from.z * s.to.z > 0;
      const double ratio = reflects ? 1 : index(k.b, s.to) / index(k.b, from);
      EXPECT_NEAR(length(s.to), 1, 1e-12);
      EXPECT_LT(length(Vec3d(s.to.x * ratio + from.x, s.to.y * ratio + from.y, 0)), 1e-12);
    }
}

// Energy kept of a beam from `from`, by `n` low-discrepancy samples (the R3 sequence).
struct Energy {
  Vec3d mean;
  double largest = 0;  // weight
};
Energy energy_by_sampling(const Bsdf& b, const Vec3d& from, int n = 2048) {
  Energy e;
  double x = 0.5, y = 0.5, z = 0.5;
  for (int i = 0; i < n; ++i) {
    x = std::fmod(x + 0.8191725133961645, 1);
    y = std::fmod(y + 0.6710436067037893, 1);
    z = std::fmod(z + 0.5497004779019703, 1);
    whole::Scattered s;
    if (!whole::sample(b, from, x, y, z, s)) continue;
    Vec3d w;
    if (s.dirac) {
      w = whole::dirac_reflectance(b, from, s.to) / whole::dirac_probability(b, from, s.to);
    } else {
      const double n_to = index(b, s.to);
      w = whole::f(b, from, s.to) * (n_to * n_to * std::abs(s.to.z) / whole::pdf_w(b, from, s.to));
    }
    EXPECT_TRUE(is_finite(w)) << from.z << " " << s.to.z;
    e.mean += w / n;
    e.largest = std::max(e.largest, max_component(w));
  }
  return e;
}
// The same over a grid of directions, for broad lobes.
template <class F>
double energy_by_quadrature(const Bsdf& b, const Vec3d& from, F f) {
  constexpr int kZ = 100, kAzimuth = 50;
  double sum = 0;
  for (int i = 0; i < kZ; ++i)
    for (int j = 0; j < kAzimuth; ++j) {
      const double z = -1 + 2 * (i + 0.5) / kZ;
      const Vec3d to = direction(z, 2 * std::numbers::pi * (j + 0.5) / kAzimuth);
      const double n = index(b, to);
      sum += f(b, from, to).y * n * n * std::abs(z);
    }
  return sum * 4 * std::numbers::pi / (kZ * kAzimuth) +
         whole::dirac_reflectance(b, from, {0, 0, from.z}).y +
         whole::dirac_reflectance(b, from, {0, 0, -from.z}).y;
}

TEST(bsdf, sampling_and_quadrature_agree_on_the_energy) {
  for (const NamedBsdf& k : all(0.7f))
    for (double z : {0.9, 0.3, -0.5}) {
      if (k.b.alpha > 0 && k.b.alpha < 0.3f) continue;  // narrow, whatever it is asked for
      const Vec3d from = direction(z, 0.3);
      EXPECT_NEAR(energy_by_sampling(k.b, from, 4096).mean.y,
                  energy_by_quadrature(k.b, from, whole::f), 6e-3)
          << k.name << " cos " << z;
    }
}
TEST(bsdf, twin_an_undarkened_diffuse_lobe_creates_energy) {
  const auto undarkened = [](const Bsdf& b, const Vec3d& from, const Vec3d& to) {
    Bsdf bare = b;
    bare.diffuse = {};
    return whole::f(bare, from, to) + whole::f(make(b.diffuse, {}, 0, {}, 1), from, to);
  };
  const Bsdf b = plastic(0.3f, Rgb(1));
  const Vec3d from = direction(0.4, 0.3);
  EXPECT_NEAR(energy_by_quadrature(b, from, whole::f), 1, 2e-3);
  EXPECT_GT(energy_by_quadrature(b, from, undarkened), 1.02);
}

// Survival of a walk that comes from `from`.
double survival(const Bsdf& b, const Vec3d& from) {
  Material material;
  Point p = whole::point(b);
  p.material = &material;
  return albedo_at(p, Incidence(p, from));
}

// How much too often walks end (`below`) or survive (`above`).
struct Lacks {
  double below = -1, above = -1, above_layers = -1;  // above: of opaque surfaces
};
// A surface reflects no more than it receives, and walks go on as often as it reflects.
template <class Told>
Lacks energy_and_survival(float alpha, Told told) {
  Lacks lacks;
  for (const NamedBsdf& k : all(alpha))
    for (double z : {1.0, 0.6, 0.2, 0.01, -0.01, -0.3, -0.9}) {
      const Vec3d from = direction(z, 0.7);
      const Energy e = energy_by_sampling(k.b, from);
      EXPECT_LE(max_component(e.mean), std::abs(z) > 0.05 && !has_sheen(k.b) ? 1.01 : 1.02)
          << k.name << " alpha " << alpha << " cos " << z;
      EXPECT_LT(e.largest, 8) << k.name << " alpha " << alpha << " cos " << z;
      if (std::abs(z) < 0.05 || (z < 0 && !transmits(k.b))) continue;
      const double lack = std::clamp(max_component(e.mean), 0.05, 1.0) - told(k.b, from);
      lacks.below = std::max(lacks.below, lack);
      if (transmits(k.b)) continue;
      const bool layers = has_sheen(k.b) || has_coat(k.b) || max_component(k.b.dip) > 0;
      double& above = layers ? lacks.above_layers : lacks.above;
      above = std::max(above, -lack);
    }
  return lacks;
}
TEST(bsdf, never_reflects_more_than_it_receives_and_walks_survive_as_often) {
  for (const float alpha : {0.0f, 0.05f, 0.3f, 1.0f}) {
    const Lacks lacks = energy_and_survival(alpha, survival);
    EXPECT_LT(lacks.below, 0.025) << alpha;
    EXPECT_LT(lacks.above, 0.025) << alpha;
    // No claim about what a sheen, or a rough coat over facets, counts twice, or about a
    // conductor's dip.
    EXPECT_LT(lacks.above_layers, 0.15) << alpha;
  }
}
TEST(bsdf, twin_walks_that_know_less_of_a_surface_are_caught) {
  const auto diffuse = [](const Bsdf& b, const Vec3d&) { return double{max_component(b.diffuse)}; };
  EXPECT_GT(energy_and_survival(0.3f, diffuse).below, 0.3);
  const auto off_by_5_percent = [](const Bsdf& b, const Vec3d& from) {
    return 0.95 * survival(b, from);
  };
  EXPECT_GT(energy_and_survival(0.3f, off_by_5_percent).below, 0.04);
}
// A pane stops rays as seldom as it reflects: those that it stops are all reflected.
TEST(bsdf, walks_that_have_found_a_pane_go_on) {
  Material pane, sheet;
  pane.plain = sheet.plain = false;
  pane.specular = pane.transmission = 1;
  pane.roughness = 0;
  pane.base_color = Rgb(1);
  Point p = whole::point(make({}, normal_reflectance(1.5f), 1, {}, 0));
  for (const double z : {1.0, 0.6, -0.9}) {
    p.material = &pane;
    EXPECT_NEAR(albedo_at(p, Incidence(p, direction(z, 0.7))), 1, 0.01) << z;
    p.material = &sheet;  // twin: a sheet that all rays hit
    EXPECT_LT(albedo_at(p, Incidence(p, direction(z, 0.7))), 0.2) << z;
  }
}

// Reflectance of the interface, by sampling it alone, plus what it leaves of a white diffuse lobe,
// by quadrature without the specular peak.
double white_energy(float alpha, float f0, double z) {
  const Bsdf coated = plastic(alpha, Rgb(1), f0), bare = plastic(alpha, {}, f0);
  const Vec3d from = direction(z, 2);
  double diffuse = 0;
  constexpr int kRings = 400;
  for (int i = 0; i < kRings; ++i) {
    const double mu = (i + 0.5) / kRings;
    const Vec3d to = direction(std::copysign(mu, z), 2);
    diffuse += 2 * std::numbers::pi * mu / kRings *
               (whole::f(coated, from, to).y - whole::f(bare, from, to).y);
  }
  return energy_by_sampling(bare, from, 16384).mean.y + diffuse;
}
TEST(bsdf, white_under_any_interface_stays_white) {
  for (float alpha : {0.0f, 2e-3f, 0.1f, 0.4f, 1.0f})
    for (float f0 : {0.0f, 0.04f, 0.5f})
      for (double z : {1.0, 0.4, 0.06, -0.5, 0.001})
        EXPECT_NEAR(white_energy(alpha, f0, z), 1, std::abs(z) > 0.05 ? 2e-3 : 5e-3)
            << "alpha " << alpha << " f0 " << f0 << " cos " << z;
}
TEST(bsdf, smooth_white_surfaces_lose_nothing_and_slightly_rough_ones_little) {
  for (double z : {1.0, 0.5, 0.07, -0.07, -0.5, -1.0}) {
    for (const NamedBsdf& k : white(0)) {
      if (k.name == "coated glass" && z < 0) continue;  // its coat reflects nothing inside
      // Cloth, and rough facets under a smooth coat.
      if (has_sheen(k.b) || k.name == "coated plastic" || k.name == "half coated metal") continue;
      EXPECT_NEAR(energy_by_sampling(k.b, direction(z, 1), 8192).mean.y, 1, 2.5e-3)
          << k.name << " " << z;
    }
    for (const NamedBsdf& k : white(0.1f))
      if (!has_sheen(k.b) && std::abs(z) > 0.1) {
        EXPECT_GT(energy_by_sampling(k.b, direction(z, 1)).mean.y, 0.95) << k.name << " " << z;
      }
  }
}

double reflected(const Bsdf& b, double z) {
  return whole::dirac_reflectance(b, direction(z, 0), direction(z, std::numbers::pi)).y;
}
TEST(bsdf, smooth_glass_obeys_fresnel_and_snell) {
  const Bsdf b = glass(0);
  EXPECT_NEAR(reflected(b, 1), 0.04, 1e-7);
  EXPECT_NEAR(reflected(b, -1), 0.04, 1e-7);
  EXPECT_NEAR(reflected(b, 0.5), 0.089186, 1e-5);  // 60 degrees, from the sine and tangent laws
  const double brewster = std::cos(std::atan(1.5)), transmitted = std::sin(std::atan(1.5));
  const double s = std::pow(std::sin(std::acos(brewster) - std::acos(transmitted)), 2);
  EXPECT_NEAR(reflected(b, brewster), 0.5 * s, 1e-6);  // the parallel half vanishes
  EXPECT_EQ(reflected(b, -0.74), 1);                   // total beyond cos = sqrt(5)/3 = 0.745
  EXPECT_LT(reflected(b, -0.75), 0.7);
  EXPECT_EQ(whole::dirac_probability(b, direction(-0.74, 0), {0, 0, -1}), 1);
  EXPECT_EQ(whole::dirac_probability(b, direction(-0.74, 0), {0, 0, 1}), 0);
  whole::Scattered out;
  ASSERT_TRUE(whole::sample(b, direction(0.6, 0), 0.999, 0.5, 0.5, out));
  EXPECT_TRUE(out.dirac);
  EXPECT_NEAR(out.to.x, -0.8 / 1.5, 1e-12);
  EXPECT_LT(out.to.z, 0);
  EXPECT_EQ(index(b, out.to), 1.5);
}
TEST(bsdf, a_pane_and_matched_glass_let_light_straight_through) {
  for (const Bsdf& b : {glass(0, 1.5f, true), make({}, Rgb(0), 1, Rgb(1), 0.5f, 1)}) {
    const Vec3d from = direction(0.6, 0.4);
    whole::Scattered out;
    ASSERT_TRUE(whole::sample(b, from, 0.999, 0.3, 0.4, out));
    EXPECT_TRUE(out.dirac);
    EXPECT_LT(length(out.to + from), 1e-12);
    EXPECT_EQ(index(b, out.to), 1);
    EXPECT_FALSE(whole::connectible(b));
  }
}

// Unpolarised, by complex numbers.
double fresnel(double c, std::complex<double> n) {
  const std::complex<double> q = std::sqrt(n * n - (1 - c * c));
  return 0.5 * (std::norm((c - q) / (c + q)) + std::norm((n * n * c - q) / (n * n * c + q)));
}
TEST(bsdf, metals_follow_their_complex_index) {
  const auto most_off = [](const Bsdf& b, std::complex<double> n) {
    double most = 0;
    for (double c = 0.0005; c < 1; c += 0.001)
      most = std::max(most, std::abs(reflected(b, c) - fresnel(c, n)));
    return most;
  };
  // Gold, copper, aluminium, iron and tungsten, near 530 nm.
  for (const std::complex<double> n :
       {std::complex(0.375, 2.386), std::complex(0.924, 2.452), std::complex(0.88, 6.269),
        std::complex(2.95, 2.93), std::complex(3.29, 2.75)}) {
    Bsdf b = test::conductor(0, Vec3d(n.real()), Vec3d(n.imag()));
    EXPECT_NEAR(reflected(b, 1), fresnel(1, n), 1e-6);
    EXPECT_NEAR(reflected(b, 1.0 / 7), fresnel(1.0 / 7, n), 1e-6);
    EXPECT_LT(most_off(b, n), 0.055);
    b.dip = {};  // twin: by Schlick's curve alone
    if (n.real() > 2) {
      EXPECT_GT(most_off(b, n), 0.1);
    }
  }
}

// Directions in or nearly in the surface, the roughest and nearly smooth surfaces: every number is
// finite, samples have a density, and weights are bounded.
TEST(bsdf, extremes_stay_finite) {
  constexpr double cosines[] = {1, 1e-2, 1e-5, 1e-13, 5e-324, 0};
  constexpr double uniforms[] = {0, 1e-12, 0.5, 1 - 0x1p-53};
  for (float alpha : {0.0f, 9.9e-5f, 1.1e-4f, 1e-2f, 1.0f}) {
    std::vector<NamedBsdf> kinds = all(alpha);
    kinds.push_back({"infinite index", glass(alpha, 1e6f)});
    kinds.push_back({"almost matched", glass(alpha, 1.0002f)});
    for (const NamedBsdf& k : kinds) {
      SCOPED_TRACE(k.name + " alpha " + std::to_string(alpha));
      for (double c : cosines)
        for (double sign : {1.0, -1.0}) {
          const Vec3d from = direction(sign * c, 0.7);
          for (double choice : uniforms)
            for (double u : uniforms)
              for (double v : uniforms) {
                whole::Scattered s;
                if (!whole::sample(k.b, from, choice, u, v, s)) continue;
                ASSERT_NE(s.to.z, 0);
                ASSERT_NEAR(length(s.to), 1, 1e-9);
                if (s.dirac) {
                  ASSERT_GT(whole::dirac_probability(k.b, from, s.to), 0);
                  continue;
                }
                const double pdf = whole::pdf_w(k.b, from, s.to), n = index(k.b, s.to);
                const double weight =
                    max_component(whole::f(k.b, from, s.to)) * n * n * std::abs(s.to.z) / pdf;
                ASSERT_TRUE(pdf > 0 && std::isfinite(pdf)) << pdf << " from " << from.z;
                ASSERT_TRUE(weight >= 0 && weight < 100) << weight << " from " << from.z;
              }
          for (double c_to : cosines)
            for (double sign_to : {1.0, -1.0})
              for (double azimuth : {0.7, 0.7 + std::numbers::pi, 2.0}) {
                const Vec3d to = direction(sign_to * c_to, azimuth);
                ASSERT_TRUE(is_finite(whole::f(k.b, from, to)));
                ASSERT_GE(whole::f(k.b, from, to).y, 0);
                ASSERT_TRUE(std::isfinite(whole::pdf_w(k.b, from, to)));
                ASSERT_TRUE(is_finite(whole::dirac_reflectance(k.b, from, to)));
                ASSERT_TRUE(std::isfinite(whole::dirac_probability(k.b, from, to)));
              }
        }
    }
  }
}

}  // namespace tdpt::bsdf_test
