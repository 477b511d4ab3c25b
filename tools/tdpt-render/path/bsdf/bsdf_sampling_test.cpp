// Sampled directions follow their density, by chi-square over bins of the sphere; smooth lobes have
// their probability, by the binomial distribution.
#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "libcommon/testing/statistics/chi_square.h"
#include "tools/tdpt-render/testing/bsdfs.h"

namespace tdpt::bsdf_sampling_test {

using namespace test;

constexpr uint64_t kSamples = 20000;
constexpr double kLevel = 1e-3;  // a right program fails a whole TEST with this probability

struct Judgement {
  double p = 1, reflected_p = 1, transmitted_p = 1;
};

// sample(b, from, choice, u, v, out), pdf_w(b, from, to), probability(b, from, to) as in whole::.
template <class Sample, class Pdf, class Probability>
Judgement judge(const Bsdf& b, const Vec3d& from, const SphereBins& bins, uint64_t stream,
                Sample sample, Pdf pdf_w, Probability probability) {
  uint64_t reflected = 0, transmitted = 0;
  const double p =
      chi_square_of_samples(kSamples,
                            bins.integrate([&](const Vec3d& to) { return pdf_w(b, from, to); }),
                            [&](uint64_t i) {
                              Rng rng(21, stream, i);
                              const double choice = rng.uniform();
                              const double u = rng.uniform();
                              const double v = rng.uniform();
                              whole::Scattered s;
                              if (!sample(b, from, choice, u, v, s)) return bins.size();
                              if (!s.dirac) return bins.bin(s.to);
                              ++(from.z * s.to.z > 0 ? reflected : transmitted);
                              return bins.size();
                            })
          .p;
  const Vec3d same(0, 0, from.z);
  return {p, binomial_p(reflected, kSamples, probability(b, from, same)),
          binomial_p(transmitted, kSamples, probability(b, from, -same))};
}
Judgement judge(const Bsdf& b, const Vec3d& from, const SphereBins& bins, uint64_t stream) {
  return judge(b, from, bins, stream, whole::sample, whole::pdf_w, whole::dirac_probability);
}

struct Case {
  std::string name;
  Bsdf b;
  Vec3d from;
  SphereBins bins;
};

const SphereBins kWhole(8, 12);  // the whole sphere, evenly

void all_hold(const std::vector<Case>& cases) {
  const double least = sidak(kLevel, 3 * cases.size());
  for (size_t i = 0; i < cases.size(); ++i) {
    const Case& c = cases[i];
    const Judgement j = judge(c.b, c.from, c.bins, i);
    EXPECT_GT(std::min({j.p, j.reflected_p, j.transmitted_p}), least)
        << c.name << " alpha " << c.b.alpha << " cos " << c.from.z << ": " << j.p << " "
        << j.reflected_p << " " << j.transmitted_p;
  }
}

Vec3d reflection(const Vec3d& from) {
  return {-from.x, -from.y, from.z};
}
// Centre of the transmitted lobe, or of the reflected one if there is none.
Vec3d transmission(const Bsdf& b, const Vec3d& from) {
  Bsdf smooth = b;
  smooth.alpha = 0;
  smooth.diffuse = {};
  whole::Scattered s;
  return whole::sample(smooth, from, 1 - 1e-9, 0.5, 0.5, s) ? s.to : reflection(from);
}

// Every kind once and more at each roughness and from all sides.
TEST(bsdf_sampling, rough_lobes_follow_their_density) {
  std::vector<Case> cases;
  for (const auto& [alpha, z] : {std::pair{0.2f, 0.95}, {0.2f, -0.8}, {0.5f, 0.3}, {1.0f, 0.02}})
    for (const NamedBsdf& k : coloured(alpha))
      cases.push_back({k.name, k.b, direction(z, 3.7 * z), kWhole});
  for (const NamedBsdf& k : white(0.35f))
    for (double z : {0.7, -0.7}) cases.push_back({k.name, k.b, direction(z, 3.7 * z), kWhole});
  all_hold(cases);
}

TEST(bsdf_sampling, narrow_lobes_follow_their_density) {
  std::vector<Case> cases;
  for (const NamedBsdf& k : coloured(0.05f))
    for (double z : {0.9, -0.85}) {
      const Vec3d from = direction(z, 1 + z);
      cases.push_back({k.name, k.b, from, SphereBins(reflection(from), 0.1, 8, 6)});
      if (transmits(k.b))
        cases.push_back({k.name, k.b, from, SphereBins(transmission(k.b, from), 0.1, 8, 6)});
    }
  for (float alpha : {1e-2f, 1e-3f, 1.1e-4f})
    for (const Bsdf& b : {plastic(alpha), metal(alpha)})
      for (double z : {1.0, 0.5, -0.1}) {
        const Vec3d from = direction(z, 1 + z);
        cases.push_back({"narrow", b, from, SphereBins(reflection(from), 2.0 * alpha, 12, 8)});
      }
  all_hold(cases);
}

TEST(bsdf_sampling, smooth_lobes_are_taken_as_often_as_they_say) {
  std::vector<Case> cases;
  for (const NamedBsdf& k : coloured(0))
    for (double z : {0.95, 0.02, -0.2, -0.8})
      cases.push_back({k.name, k.b, direction(z, 3.7 * z), SphereBins(4, 6)});
  all_hold(cases);
}

// Twins.

template <class Pdf>
double p_of_density(const Bsdf& b, double z, Pdf pdf_w) {
  return judge(b, direction(z, 1), kWhole, 1, whole::sample, pdf_w, whole::dirac_probability).p;
}
template <class Sample>
Judgement of_sampler(const Bsdf& b, double z, Sample sample) {
  return judge(b, direction(z, 1), kWhole, 1, sample, whole::pdf_w, whole::dirac_probability);
}

TEST(bsdf_sampling, twin_other_densities_are_caught) {
  for (const NamedBsdf& k : coloured(0.4f))
    EXPECT_LT(p_of_density(k.b, 0.6,
                           [](const Bsdf& b, const Vec3d& from, const Vec3d& to) {
                             return 1.05 * whole::pdf_w(b, from, to);
                           }),
              1e-6)
        << k.name;
  const auto without_jacobian = [](const Bsdf& b, const Vec3d& from, const Vec3d& to) {
    return whole::pdf_w(b, from, to) * 4 * dot(from, normalize(from + to));
  };
  EXPECT_LT(p_of_density(metal(0.4f), 0.3, without_jacobian), 1e-6);
  const auto in_the_other_medium = [](const Bsdf& b, const Vec3d& from, const Vec3d& to) {
    const double n = index(b, from) / index(b, to);
    return whole::pdf_w(b, from, to) * n * n;
  };
  EXPECT_LT(p_of_density(glass(0.4f), 0.6, in_the_other_medium), 1e-6);
}

TEST(bsdf_sampling, twin_other_samplers_are_caught) {
  // Normals drawn whether they are visible or not.
  const auto blind = [](const Bsdf& b, const Vec3d& from, double, double u, double v,
                        whole::Scattered& out) {
    const double tangent = b.alpha * std::sqrt(v / (1 - v));
    const double c = 1 / std::sqrt(1 + tangent * tangent);
    const Vec3d h = direction(c, 2 * std::numbers::pi * u);
    out = {h * (2 * dot(from, h)) - from, false};
    return dot(from, h) > 0 && out.to.z > 0;
  };
  EXPECT_LT(of_sampler(metal(0.4f), 0.5, blind).p, 1e-6);
  const auto a_tenth_rougher = [](Bsdf b, const Vec3d& from, double choice, double u, double v,
                                  whole::Scattered& out) {
    b.alpha *= 1.1f;
    return whole::sample(b, from, choice, u, v, out);
  };
  for (const Bsdf& b : {metal(0.4f), glass(0.4f)})
    EXPECT_LT(of_sampler(b, 0.8, a_tenth_rougher).p, 1e-6);
  const auto other_odds = [](const Bsdf& b, const Vec3d& from, double choice, double u, double v,
                             whole::Scattered& out) {
    return whole::sample(b, from, std::pow(choice, 1.25), u, v, out);
  };
  EXPECT_LT(of_sampler(plastic(0.2f, Rgb(1), 0.5f), 0.6, other_odds).p, 1e-6);
  const Judgement smooth = of_sampler(glass(0), 0.6, other_odds);
  EXPECT_LT(smooth.reflected_p, 1e-4);
  EXPECT_LT(smooth.transmitted_p, 1e-4);
}

}  // namespace tdpt::bsdf_sampling_test
