// BSDFs in floats against the same text in doubles: values, weights, densities of sampled
// directions, and extremes.
//
// Floats hold a direction to 2^-24, and a microfacet's slope as well. The density of slopes D
// changes by 4/alpha of itself per unit of slope, so it is accurate to some 1e-6/alpha; near total
// reflection transmission changes faster still. D is the same in f and pdf_w, and cancels in their
// quotient.
#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "libcommon/testing/statistics/chi_square.h"
#include "tools/tdpt-render/path/bsdf/scatter.h"
#include "tools/tdpt-render/path/sample/walk.h"
#include "tools/tdpt-render/testing/bsdfs.h"
#include "tools/tdpt-render/testing/float_points.h"

namespace tdpt::float_bsdf_test {

using namespace test;

constexpr float kAlphas[] = {0, 2e-4f, 2e-3f, 0.02f, 0.1f, 0.3f, 0.6f, 1};

std::vector<NamedBsdf> all(float alpha) {
  std::vector<NamedBsdf> kinds = white(alpha);
  for (const NamedBsdf& k : coloured(alpha)) kinds.push_back(k);
  kinds.push_back({"almost matched", glass(alpha, 1.01f)});
  kinds.push_back({"infinite index", glass(alpha, 1e6f)});
  return kinds;
}

// With its own shading normal, and a coat with another.
Point bent_point(const Bsdf& b, Rng& rng) {
  const auto tilted = [&rng](const Vec3d& n, double most) {
    return Vec3d(Vec3f(normalize(n + uniform_direction(rng) * (most * rng.uniform()))));
  };
  Point p = whole::point(b);
  p.normal = Vec3d(Vec3f(uniform_direction(rng)));
  p.shading = tilted(p.normal, 0.5);
  p.bsdf.coat.normal = Vec3f(tilted({0, 0, 1}, 0.3));
  return p;
}

// A float's value and a double's.
struct Pair {
  double mine, exact;
  double error() const {
    return std::abs(mine - exact) / std::max({std::abs(mine), std::abs(exact), 1e-6});
  }
};
Pair pair(const Rgb& mine, const Rgb& exact) {
  return {max_component(mine), max_component(exact)};
}

// Directions in floats: `back` uniform, `to` uniform or sampled from the BSDF.
struct Ways {
  Vec3f back, to;
};
bool draw_ways(const Point& p, Rng& rng, bool turned, Ways& out) {
  out.back = Vec3f(uniform_direction(rng));
  out.to = Vec3f(uniform_direction(rng));
  if (!turned) return true;
  const double u = rng.uniform();
  const double v = rng.uniform();
  const double choice = rng.uniform();
  Turn t;
  if (!turn(p, From::camera, Incidence(p, Vec3d(out.back)), {u, v, choice}, t) || t.dirac)
    return false;
  out.to = Vec3f(t.w);
  return true;
}

// Errors of all BSDFs at one alpha, sorted. `faulty_alpha` is what the floats get in its place.
std::vector<double> errors(float alpha, bool bent, float faulty_alpha) {
  std::vector<double> found;
  for (const NamedBsdf& k : all(alpha))
    for (uint64_t i = 0; i < 1000; ++i) {
      Rng rng(3, bent ? 1 : 0, i);
      const Point p = bent ? bent_point(k.b, rng) : whole::point(k.b);
      shader::Point q = in_floats(p);
      if (q.bsdf.alpha == alpha) q.bsdf.alpha = faulty_alpha;
      Ways w;
      if (!draw_ways(p, rng, i % 2 == 1, w)) continue;
      const Vec3d back(w.back), to(w.to);
      // Skips directions whose side of a surface rounding may decide.
      if (std::min(std::abs(dot(p.shading, back)), std::abs(dot(p.shading, to))) < 1e-4) continue;
      const Pair f = pair(any_surface().bsdf_at(q, w.to, w.back), bsdf_at(p, to, back));
      const Pair pdf{any_surface().scatter_pdf_w(q, w.back, w.to, false),
                     scatter_pdf_w(p, Incidence(p, back), to, false)};
      found.push_back(f.error());
      found.push_back(pdf.error());
    }
  std::sort(found.begin(), found.end());
  return found;
}
double quantile(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<size_t>(share * static_cast<double>(sorted.size() - 1))];
}

TEST(float_bsdf, is_that_of_doubles) {
  for (const bool bent : {false, true})
    for (const float alpha : kAlphas) {
      const std::vector<double> e = errors(alpha, bent, alpha);
      const double rounding = 1e-5 + (alpha > 0 ? 5e-6 / alpha : 0);
      EXPECT_LT(quantile(e, 0.5), 0.2 * rounding) << alpha << bent;
      EXPECT_LT(quantile(e, 0.99), 2 * rounding) << alpha << bent;
      EXPECT_LT(quantile(e, 0.999), 10 * rounding) << alpha << bent;
      RecordProperty("worst_" + std::to_string(alpha) + (bent ? "_bent" : ""),
                     std::to_string(e.back()));
    }
}
TEST(float_bsdf, twin_an_alpha_half_a_percent_off) {
  for (const float alpha : {0.02f, 0.3f}) {
    const std::vector<double> e = errors(alpha, false, 1.005f * alpha);
    EXPECT_GT(quantile(e, 0.99), 1e-3) << alpha;
    EXPECT_GT(quantile(e, 0.9), 1e-4) << alpha;
  }
}

TEST(float_bsdf, albedo_and_odds_are_those_of_doubles) {
  for (const float alpha : kAlphas)
    for (const NamedBsdf& k : all(alpha))
      for (uint64_t i = 0; i < 200; ++i) {
        Rng rng(4, 0, i);
        const Point p = whole::point(k.b);
        const shader::Point q = in_floats(p);
        const Vec3f back(uniform_direction(rng));
        if (std::abs(back.z) < 1e-4f) continue;
        const double albedo =
            std::clamp<double>(max_component(albedo_of(p, Incidence(p, Vec3d(back)))), 0.05, 1);
        shader::Point met = q;
        met.triangle = 0;
        EXPECT_NEAR(any_surface().albedo_at(met, back), albedo, 5e-6) << k.name << back.z;
        const Odds exact = odds_at(p, Incidence(p, Vec3d(back)));
        const shader::Odds<float> mine = any_surface().odds_at(q, back);
        EXPECT_NEAR(mine.dirac, exact.dirac, 5e-6) << k.name << " " << alpha << " " << back.z;
        EXPECT_NEAR(mine.broad, exact.broad, 5e-6) << k.name << " " << alpha << " " << back.z;
      }
}

TEST(float_bsdf, off_surfaces_the_albedo_is_1_and_of_simple_ones_their_colour) {
  shader::Point p{};
  p.simple = true;
  p.triangle = shader::kNoTriangle;
  EXPECT_EQ(any_surface().albedo_at(p, {0, 0, 1}), 1);
  p.triangle = 0;
  EXPECT_EQ(any_surface().albedo_at(p, {0, 0, 1}), 0.05f);
  p.color = {0.2f, 0.7f, 0.1f};
  EXPECT_EQ(any_surface().albedo_at(p, {0, 0, 1}), 0.7f);
}

// The walk's weight in doubles, for the direction sampled in floats.
bool exact_weight(const Point& p, bool camera, const Vec3d& back, const shader::Turn<float>& t,
                  Vec3d& weight) {
  const shader::Surfaces& s = surfaces();
  return s.weigh(p, camera ? shader::FROM_CAMERA : shader::FROM_LIGHT,
                 s.scatter_context_at(p, back), s.seen_from(p, Vec3d(t.w)), t.dirac, weight);
}
// Errors of weights, sorted; twin: a density 1 % off.
std::vector<double> weight_errors(float alpha, bool bent, double off) {
  std::vector<double> found;
  for (const NamedBsdf& k : all(alpha))
    for (uint64_t i = 0; i < 600; ++i) {
      Rng rng(5, bent ? 1 : 0, i);
      const Point p = bent ? bent_point(k.b, rng) : whole::point(k.b);
      const bool camera = i % 2 == 0;
      const Vec3f back(uniform_direction(rng));
      const float u = rng.uniform_float();
      const float v = rng.uniform_float();
      const float choice = rng.uniform_float();
      shader::Turn<float> t;
      if (!any_surface().turn(in_floats(p), camera ? shader::FROM_CAMERA : shader::FROM_LIGHT, back,
                              u, v, choice, t))
        continue;
      EXPECT_NEAR(length(Vec3d(t.w)), 1, 1e-6);
      Vec3d exact;
      const Vec3d w(t.w);
      if (std::min(std::abs(dot(p.shading, Vec3d(back))), std::abs(dot(p.shading, w))) < 1e-3)
        continue;
      if (!exact_weight(p, camera, Vec3d(back), t, exact)) exact = {};
      found.push_back(pair(t.weight * static_cast<float>(off), Rgb(exact)).error());
    }
  std::sort(found.begin(), found.end());
  return found;
}
TEST(float_bsdf, weights_are_f_cos_by_density) {
  for (const bool bent : {false, true})
    for (const float alpha : kAlphas) {
      const std::vector<double> e = weight_errors(alpha, bent, 1);
      EXPECT_LT(quantile(e, 0.5), 1e-6) << alpha << bent;
      EXPECT_LT(quantile(e, 0.99), alpha > 0 ? 1e-4 + 2e-6 / alpha : 1e-4) << alpha << bent;
    }
}
TEST(float_bsdf, twin_a_density_half_a_percent_off) {
  EXPECT_GT(quantile(weight_errors(0.3f, false, 1 / 1.005), 0.5), 1e-3);
}

struct Judgement {
  double p, reflected_p, transmitted_p;
  double least() const { return std::min({p, reflected_p, transmitted_p}); }
};
Judgement judge(const Bsdf& b, const Vec3f& from, const SphereBins& bins, uint64_t stream,
                double off = 1) {
  constexpr uint64_t kSamples = 40000;
  const auto& surface = any_surface();
  const shader::Point p = in_floats(whole::point(b));
  uint64_t reflected = 0, transmitted = 0;
  const ChiSquare c =
      chi_square_of_samples(kSamples, bins.integrate([&](const Vec3d& to) {
        return off * double{surface.scatter_pdf_w(p, from, Vec3f(to), false)};
      }),
                            [&](uint64_t i) {
                              Rng rng(21, stream, i);
                              const float u = rng.uniform_float();
                              const float v = rng.uniform_float();
                              const float choice = rng.uniform_float();
                              shader::Turn<float> t;
                              if (!surface.turn(p, shader::FROM_CAMERA, from, u, v, choice, t))
                                return bins.size();
                              if (!t.dirac) return bins.bin(normalize(Vec3d(t.w)));
                              ++(from.z * t.w.z > 0 ? reflected : transmitted);
                              return bins.size();
                            });
  const auto probability = [&](const Vec3f& to) {
    const double n = index(b, Vec3d(to));
    return double{surface.scatter_pdf_w(p, from, to, true)} / (n * n * std::abs(to.z));
  };
  return {c.p, binomial_p(reflected, kSamples, probability({0, 0, from.z})),
          binomial_p(transmitted, kSamples, probability({0, 0, -from.z}))};
}
struct Case {
  std::string name;
  Bsdf b;
  Vec3f from;
  SphereBins bins;
};
void all_hold(const std::vector<Case>& cases) {
  const double least = sidak(1e-3, 3 * cases.size());
  for (size_t i = 0; i < cases.size(); ++i) {
    const Case& c = cases[i];
    const Judgement j = judge(c.b, c.from, c.bins, i);
    EXPECT_GT(j.least(), least) << c.name << " alpha " << c.b.alpha << " cos " << c.from.z << ": "
                                << j.p << " " << j.reflected_p << " " << j.transmitted_p;
  }
}
void expect_turns_to_follow_their_density(const std::vector<float>& rough,
                                          const std::vector<float>& narrow) {
  std::vector<Case> cases;
  for (const float alpha : rough)
    for (const NamedBsdf& k : coloured(alpha))
      for (const double z : {0.9, -0.3})
        cases.push_back({k.name, k.b, Vec3f(direction(z, 3.7 * z)), SphereBins(10, 10)});
  for (const float alpha : narrow)
    for (const Bsdf& b : {plastic(alpha), metal(alpha)})
      for (const double z : {1.0, 0.5, -0.1}) {
        const Vec3d from = direction(z, 1 + z), mirrored(-from.x, -from.y, from.z);
        cases.push_back({"narrow", b, Vec3f(from), SphereBins(mirrored, 2.0 * alpha, 24, 12)});
      }
  all_hold(cases);
}
TEST(float_bsdf, turns_follow_their_density) {
  expect_turns_to_follow_their_density({0.4f}, {1e-3f});
}
TEST(long_float_bsdf, turns_follow_their_density) {
  expect_turns_to_follow_their_density({0, 0.4f}, {1e-2f, 1e-3f});
}
TEST(float_bsdf, twin_a_density_5_percent_off_fails_the_chi_square) {
  for (const NamedBsdf& k : coloured(0.4f))
    EXPECT_LT(judge(k.b, Vec3f(direction(0.6, 1)), SphereBins(12, 12), 1, 1.05).p, 1e-6) << k.name;
}

void expect_extremes_hold(const shader::Point& p, const Vec3f& from, const Vec3f& to) {
  const auto& surface = any_surface();
  const shader::vec3 f = surface.bsdf_at(p, from, to);
  ASSERT_TRUE(is_finite(f) && f.y >= 0);
  for (const bool dirac : {false, true}) {
    const float pdf_w = surface.scatter_pdf_w(p, from, to, dirac);
    ASSERT_TRUE(std::isfinite(pdf_w) && pdf_w >= 0) << pdf_w;
  }
}
TEST(float_bsdf, extremes_stay_finite) {
  constexpr double cosines[] = {1, 1e-2, 1e-5, 1e-8, 1e-13, 1e-30, 1e-45, 0};
  constexpr float uniforms[] = {0, 6e-8f, 0.25f, 0.5f, 0.999f, 0.99999994f};
  for (const float alpha : {0.0f, 9.9e-5f, 1e-4f, 1.1e-4f, 1e-3f, 1e-2f, 1.0f}) {
    std::vector<NamedBsdf> kinds = all(alpha);
    kinds.push_back({"as good as matched", glass(alpha, 1.0002f)});
    for (const NamedBsdf& k : kinds) {
      SCOPED_TRACE(k.name + " alpha " + std::to_string(alpha));
      const shader::Point p = in_floats(whole::point(k.b));
      for (const double c : cosines)
        for (const double sign : {1.0, -1.0}) {
          const Vec3f from(direction(sign * c, 0.7));
          for (const float choice : uniforms)
            for (const float u : uniforms)
              for (const float v : uniforms) {
                shader::Turn<float> t;
                if (!any_surface().turn(p, shader::FROM_LIGHT, from, u, v, choice, t)) continue;
                ASSERT_NEAR(length(Vec3d(t.w)), 1, 1e-6);
                ASSERT_TRUE(is_finite(t.weight));
                ASSERT_TRUE(t.weight.y >= 0 && max_component(t.weight) < 100)
                    << t.weight.y << " from " << from.z << " to " << t.w.z;
                ASSERT_GT(any_surface().scatter_pdf_w(p, from, t.w, t.dirac), 0);
              }
          for (const double c_to : cosines)
            for (const double sign_to : {1.0, -1.0})
              for (const double azimuth : {0.7, 0.7 + std::numbers::pi, 2.0})
                expect_extremes_hold(p, from, Vec3f(direction(sign_to * c_to, azimuth)));
        }
    }
  }
}

}  // namespace tdpt::float_bsdf_test
