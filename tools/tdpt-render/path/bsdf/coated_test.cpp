// Clear coat and sheen against the formulas of their glTF extensions, and coats whose normal
// differs from that of the base.
#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "libcommon/testing/statistics/chi_square.h"
#include "tools/tdpt-render/path/bsdf/scatter.h"
#include "tools/tdpt-render/testing/bsdfs.h"

namespace tdpt::coated_test {

using namespace test;

// KHR_materials_clearcoat: V D F of GGX with the coat's roughness and index 1.5, V = G2 / (4 cos
// cos) written as in the format.
double coat_of_the_format(double roughness, const Vec3d& l, const Vec3d& v) {
  const double a = roughness * roughness, nl = l.z, nv = v.z;
  const Vec3d h = normalize(l + v);
  const double nh = h.z, vh = dot(v, h);
  const double d = a * a / (std::numbers::pi * std::pow(nh * nh * (a * a - 1) + 1, 2));
  const double vis = 0.5 / (nl * std::sqrt(nv * nv * (1 - a * a) + a * a) +
                            nv * std::sqrt(nl * nl * (1 - a * a) + a * a));
  return (0.04 + 0.96 * std::pow(1 - vh, 5)) * d * vis;
}

// KHR_materials_sheen: Charlie's distribution and its fitted masking.
double sheen_of_the_format(double roughness, const Vec3d& l, const Vec3d& v) {
  const double a = roughness * roughness;
  const auto fit = [&](double x) {
    const double t = (1 - a) * (1 - a);
    const auto mix = [t](double p, double q) { return (1 - t) * p + t * q; };
    return mix(21.5473, 25.3245) /
               (1 + mix(3.82987, 3.32435) * std::pow(x, mix(0.19823, 0.16801))) +
           mix(-1.97760, -1.27393) * x + mix(-4.32054, -4.85967);
  };
  const auto masking = [&](double c) {
    return c < 0.5 ? std::exp(fit(c)) : std::exp(2 * fit(0.5) - fit(1 - c));
  };
  const Vec3d h = normalize(l + v);
  const double sine = std::sqrt(1 - h.z * h.z);
  const double d = (2 + 1 / a) * std::pow(sine, 1 / a) / (2 * std::numbers::pi);
  return d / ((1 + masking(v.z) + masking(l.z)) * 4 * v.z * l.z);
}

template <class Use>
void for_pairs(uint64_t stream, Use use) {
  for (uint64_t i = 0; i < 500; ++i) {
    Rng rng(31, stream, i);
    Vec3d a = uniform_direction(rng), b = uniform_direction(rng);
    a.z = std::abs(a.z), b.z = std::abs(b.z);
    use(a, b);
  }
}

TEST(coated, the_coat_is_that_of_the_format) {
  for (const double roughness : {0.1, 0.3, 0.6, 1.0})
    for_pairs(1, [&](const Vec3d& l, const Vec3d& v) {
      const shader::Coat coat{{0, 0, 1}, 1, {}, static_cast<float>(roughness * roughness)};
      const double expected = coat_of_the_format(std::sqrt(double{coat.alpha}), l, v);
      EXPECT_NEAR(surfaces().coat_f(coat, l, v), expected, 1e-5 * expected);
    });
}

TEST(coated, the_sheen_is_that_of_the_format_where_that_loses_no_light) {
  for (const double roughness : {0.3, 0.5, 0.8, 1.0})
    for_pairs(2, [&](const Vec3d& l, const Vec3d& v) {
      const double expected = sheen_of_the_format(roughness, l, v);
      EXPECT_NEAR(surfaces().sheen_f(l, v, roughness * roughness), expected, 1e-9 * expected);
    });
}
TEST(coated, a_fine_sheen_is_scaled_to_what_it_receives) {
  const Vec3d grazing = direction(0.01, 0);
  const SphereBins bins(32, 16);
  const auto received = [&](auto f) {
    double sum = 0;
    for (const double x :
         bins.integrate([&](const Vec3d& w) { return w.z > 1e-6 ? f(grazing, w) * w.z : 0.0; }))
      sum += x;
    return sum;
  };
  EXPECT_GT(received([](auto& l, auto& v) { return sheen_of_the_format(0.1, l, v); }), 1.5);
  EXPECT_LT(received([](auto& l, auto& v) { return surfaces().sheen_f(l, v, 0.01); }), 1.01);
}

// The format darkens the layers under a coat by the view direction alone, by the Fresnel factor of
// its normal: total reflection must be near to that.
TEST(coated, reflects_about_as_much_as_the_format_says) {
  for (const Bsdf& base :
       {make(Rgb(0.8f), {}, 0, {}, 1), plastic(0.3f, Rgb(0.5f)), metal(0.2f, Rgb(0.7f))})
    for (const double mu : {1.0, 0.7, 0.4, 0.2}) {
      const Bsdf b = coated_by(0.01f, base);
      const Vec3d from = direction(mu, 1);
      const double fresnel = 0.04 + 0.96 * std::pow(1 - mu, 5);
      const double format = fresnel + (1 - fresnel) * whole::albedo(base, from).y;
      EXPECT_NEAR(whole::albedo(b, from).y, format, 0.015) << mu;
    }
}

TEST(coated, twin_darkened_along_the_view_alone_is_not_symmetric) {
  const Bsdf base = plastic(0.3f), b = coated_by(0.1f, base);
  int ours = 0, view_alone = 0;
  for_pairs(3, [&](const Vec3d& l, const Vec3d& v) {
    const auto along = [&](const Vec3d& to_light, const Vec3d& to_camera) {
      return whole::f(base, to_light, to_camera).y *
                 surfaces().coat_left_over(b.coat, to_camera.z) +
             surfaces().coat_f(b.coat, to_light, to_camera);
    };
    const auto differ = [](double x, double y) { return std::abs(x - y) > 1e-3 * (x + y); };
    ours += differ(whole::f(b, l, v).y, whole::f(b, v, l).y);
    view_alone += differ(along(l, v), along(v, l));
  });
  EXPECT_EQ(ours, 0);
  EXPECT_GT(view_alone, 300);
}

// Points whose coat is tilted by `angle`.
Point leaning(const Bsdf& b, double angle) {
  Point p = whole::point(b);
  p.bsdf.coat.normal = Vec3f(direction(std::cos(angle), 0.5));
  p.shading = normalize(Vec3d(-0.1, 0.15, 1));
  return p;
}

double p_of_turns(const Point& p, const Point& judged, const Vec3d& back, uint64_t stream) {
  const SphereBins bins(8, 12);
  return chi_square_of_samples(
             20000, bins.integrate([&](const Vec3d& w) {
               return scatter_pdf_w(judged, Incidence(judged, back), w, false);
             }),
             [&](uint64_t i) {
               Rng rng(32, stream, i);
               const double u = rng.uniform();
               const double v = rng.uniform();
               const double choice = rng.uniform();
               Turn turn;
               if (!tdpt::turn(p, From::camera, Incidence(p, back), {u, v, choice}, turn) ||
                   turn.dirac)
                 return bins.size();
               return bins.bin(turn.w);
             })
      .p;
}

std::vector<NamedBsdf> kinds() {
  return {{"plastic", coated_by(0.3f, plastic(0.4f))},
          {"metal", coated_by(0.4f, metal(0.3f), 0.6f)},
          {"mirror", coated_by(0.3f, metal(0))},
          {"glass", coated_by(0.3f, glass(0.4f))},
          {"thin", coated_by(0.4f, glass(0.3f, 1.5f, true))},
          {"smooth coat", coated_by(0, plastic(0.4f))},
          {"velvet", coated_by(0.3f, cloth(0.3f, plastic(0.3f), Rgb(0.5f)))}};
}

TEST(coated, walks_follow_their_density_where_the_coat_leans) {
  const auto all = kinds();
  const double least = sidak(1e-3, 4 * all.size());
  for (size_t i = 0; i < all.size(); ++i)
    for (const double z : {0.9, 0.3, -0.4, -0.9}) {
      const Point p = leaning(all[i].b, 0.3);
      EXPECT_GT(p_of_turns(p, p, direction(z, 2), i), least) << all[i].name << " " << z;
    }
}
TEST(coated, twin_a_coat_that_leans_elsewhere_is_caught) {
  const Bsdf b = coated_by(0.1f, plastic(0.4f));
  const Point p = leaning(b, 0.3), judged = leaning(b, 0.25);
  EXPECT_LT(p_of_turns(p, judged, direction(0.7, 2), 9), 1e-6);
}

// Above the coat's normal and below the other, only the coat is seen.
TEST(coated, is_seen_from_where_what_lies_under_it_is_not) {
  Point p = whole::point(coated_by(0.3f, plastic(0.3f)));
  p.shading = direction(0.5, 0);
  p.bsdf.coat.normal = Vec3f(Onb<double>(p.shading).to_local({0, 0, 1}));
  const Vec3d low = direction(0.2, std::numbers::pi), up(0, 0, 1);
  ASSERT_LT(dot(low, p.shading), 0);
  EXPECT_NEAR(layered_bsdf(p, low, up).y, surfaces().coat_f({{0, 0, 1}, 1, {}, 0.3f}, low, up),
              1e-5);
  EXPECT_GT(scatter_pdf_w(p, Incidence(p, low), up, false), 0);
  EXPECT_GT(albedo_of(p, Incidence(p, low)).y, 0.1);
  // What the coat reflects there has not entered the glass.
  p.bsdf = coated_by(0, glass(0));
  p.bsdf.coat.normal = Vec3f(Onb<double>(p.shading).to_local({0, 0, 1}));
  const Vec3d mirrored(-low.x, -low.y, low.z);
  const shader::Surfaces& all = surfaces();
  const double chance =
      all.layers_between(p, all.scatter_context_at(p, mirrored), all.seen_from(p, low), true).pdf_w;
  EXPECT_NEAR(scatter_pdf_w(p, Incidence(p, mirrored), low, true), chance * low.z, 1e-6);
}

}  // namespace tdpt::coated_test
