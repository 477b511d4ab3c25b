// Samplers follow their density: chi-square over points, directions and segments, each with a twin.
// Scattering: path/bsdf/bsdf_sampling_test; lights: libcommon/scene/lights_test, sky_test.
#include <gtest/gtest.h>
#include <numbers>

#include "libcommon/math/rng.h"
#include "libcommon/scene/lights.h"
#include "libcommon/testing/statistics/chi_square.h"
#include "tools/tdpt-render/testing/faults.h"

namespace tdpt::samplers_test {

constexpr double kRight = 1e-4;  // a right sampler exceeds this in all but 1 seed of 10 000
constexpr double kWrong = 1e-9;  // a wrong one stays below
constexpr uint64_t kSamples = 60000;

// A triangle in kLattice^2 bins of equal area, by barycentrics.
constexpr size_t kLattice = 6, kTriangleBins = kLattice * kLattice;
size_t triangle_bin(double b1, double b2) {
  const double x = b1 * kLattice, y = b2 * kLattice;
  const auto i = std::min(static_cast<size_t>(std::max(x, 0.0)), kLattice - 1);
  const auto j = std::min(static_cast<size_t>(std::max(y, 0.0)), kLattice - 1 - i);
  const bool upper =
      x + y - static_cast<double>(i + j) > 1 && i + j + 1 < kLattice;  // not on the diagonal
  // Row i starts after the 2 kLattice - 1, 2 kLattice - 3, ... bins of the rows before it.
  return i * (2 * kLattice - i) + 2 * j + (upper ? 1 : 0);
}
double uniform_on_triangle(double exponent) {
  return chi_square_of_samples(kSamples, std::vector<double>(kTriangleBins, 1.0 / kTriangleBins),
                               [&](uint64_t i) {
                                 Rng rng(31, 0, i);
                                 const double u = rng.uniform();
                                 const double v = rng.uniform();
                                 double b1, b2;
                                 uniform_triangle(std::pow(u, exponent), v, b1, b2);
                                 return triangle_bin(b1, b2);
                               })
      .p;
}
TEST(samplers, triangles_are_covered_evenly) {
  EXPECT_GT(uniform_on_triangle(1), kRight);
}
TEST(samplers, twin_a_triangle_without_the_root) {
  EXPECT_LT(uniform_on_triangle(1.1), kWrong);
}

template <class Pdf>
double cosine(Pdf pdf) {
  const SphereBins bins(16, 16);
  return chi_square_of_samples(kSamples, bins.integrate(pdf),
                               [&](uint64_t i) {
                                 Rng rng(32, 0, i);
                                 const double u = rng.uniform();
                                 const double v = rng.uniform();
                                 return bins.bin(cosine_hemisphere(u, v));
                               })
      .p;
}
TEST(samplers, hemispheres_are_cosine_distributed) {
  EXPECT_GT(cosine([](const Vec3d& w) { return std::max(w.z, 0.0) * std::numbers::inv_pi; }),
            kRight);
}
TEST(samplers, twin_a_hemisphere_without_the_cosine) {
  EXPECT_LT(cosine([](const Vec3d& w) { return w.z > 0 ? 0.5 * std::numbers::inv_pi : 0; }),
            kWrong);
}

// Portals: a quad of two triangles, a fan of an irregular hexagon, both with a sliver, and the quad
// with another that light crosses after it.
Portal quad() {
  return {"quad", {{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 2, 0}}, {{0, 1, 2}, {0, 2, 3}}, {}};
}
Portal fan() {
  return {"fan",
          {{0.4, 0.3, 0.9}, {2, 0, 1}, {2.5, 1, 1.2}, {2, 2, 1.25}, {0.5, 1.5, 1.05}, {0, 1, 0.95}},
          {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}},
          {}};
}
Portal sliver() {
  return {"sliver", {{0, 0, 0.5}, {0.02, 0, 0.52}, {1, 2, 0.5}}, {{0, 1, 2}}, {}};
}
Portal ahead() {
  return {
      "ahead", {{0, 0.5, 1}, {2, 0.5, 1.5}, {2, 2, 1.5}, {0, 2, 1}}, {{0, 1, 2}, {0, 2, 3}}, {}};
}
// The fan is made planar, as portals are.
Portal flat(Portal p) {
  const Vec3d n = normalize(
      cross(p.vertices[1] - p.vertices[0], p.vertices[p.vertices.size() - 1] - p.vertices[0]));
  for (Vec3d& v : p.vertices) v = v - n * dot(n, v - p.vertices[0]);
  return p;
}
const std::vector<std::vector<Portal>>& portal_sets() {
  static const std::vector<std::vector<Portal>> sets{
      {quad()}, {flat(fan())}, {quad(), flat(fan()), sliver()}, {quad(), ahead()}};
  return sets;
}
// Segments by where and in which direction they cross a plane unrelated to the portals. Their
// density there is D |cos|, D = density() [eq. 4 without G], whichever polygon they were drawn
// from. `fault(D, cos)` is the density under test.
template <class Density>
ChiSquare portal_segments(const std::vector<Portal>& portals, Density density) {
  const PortalSet set(portals, Frame{});
  // Points [-1,3]^2 of the plane z = 0.4; direction by its x/z and y/z in [-1,1]^2.
  constexpr int kBins = 4, kParts = 10, kSide = kBins * kParts;
  constexpr double kFar = 20, kHeight = 0.4;
  const auto d_of = [&](const Vec3d& at, const Vec3d& w) {
    return density(set, at - w * kFar, at + w * kFar, w.z);
  };
  std::vector<double> probability(kBins * kBins * kBins * kBins);
  const double cell = std::pow(4.0 / kSide, 2) * std::pow(2.0 / kSide, 2);
  for (int a = 0; a < kSide; ++a)
    for (int b = 0; b < kSide; ++b)
      for (int c = 0; c < kSide; ++c)
        for (int d = 0; d < kSide; ++d) {
          const Vec3d at(4 * (a + 0.5) / kSide - 1, 4 * (b + 0.5) / kSide - 1, kHeight);
          const Vec3d slope(2 * (c + 0.5) / kSide - 1, 2 * (d + 0.5) / kSide - 1, 1);
          const double l = length(slope), cos = 1 / l;
          const int bin =
              ((a / kParts * kBins + b / kParts) * kBins + c / kParts) * kBins + d / kParts;
          // dw = cos^3 d(x/z) d(y/z)
          probability[static_cast<size_t>(bin)] +=
              d_of(at, slope / l) * cos * cos * cos * cos * cell;
        }
  return chi_square_of_samples(kSamples, probability, [&](uint64_t i) {
    Rng rng(37, 0, i);
    const PortalSet::SegmentDraw s = set.sample(rng);
    if (!(s.direction.z > 0)) return probability.size();
    const Vec3d slope = s.direction / s.direction.z;
    const Vec3d at = s.position + slope * (kHeight - s.position.z);
    const auto part = [](double x, double low, double width) {
      return static_cast<int>(std::floor((x - low) / width * kBins));
    };
    const std::array<int, 4> k{part(at.x, -1, 4), part(at.y, -1, 4), part(slope.x, -1, 2),
                               part(slope.y, -1, 2)};
    size_t bin = 0;
    for (int x : k) {
      if (x < 0 || x >= kBins) return probability.size();
      bin = bin * kBins + static_cast<size_t>(x);
    }
    return bin;
  });
}
double whole_density(const PortalSet& set, const Vec3d& from, const Vec3d& to, double) {
  return set.density(from, to);
}
TEST(samplers, segments_through_portals_have_the_density_of_equation_4) {
  for (const auto& portals : portal_sets())
    EXPECT_GT(portal_segments(portals, whole_density).p, kRight);
}
TEST(samplers, twin_a_density_of_the_first_portal_alone) {
  const auto first = [](const PortalSet& set, const Vec3d& from, const Vec3d& to, double) {
    return std::min(set.density(from, to), set.polygon(0).density);
  };
  EXPECT_LT(portal_segments(portal_sets()[2], first).p, kWrong);
}
TEST(samplers, twin_a_density_without_the_surrounds) {
  const PortalSet spoilt = PortalSetFaults::without_surrounds(PortalSet(portal_sets()[0], Frame{}));
  const auto without = [&](const PortalSet&, const Vec3d& from, const Vec3d& to, double) {
    return spoilt.density(from, to);
  };
  EXPECT_LT(portal_segments(portal_sets()[0], without).p, kWrong);
}
TEST(samplers, twin_a_density_without_the_pairs) {
  const auto alone = [](const PortalSet& set, const Vec3d& from, const Vec3d& to, double) {
    return std::min(set.density(from, to), 2 * set.polygon(0).density);
  };
  EXPECT_GT(portal_segments(portal_sets()[0], alone).p, kRight);
  EXPECT_LT(portal_segments(portal_sets()[3], alone).p, kWrong);
}
TEST(samplers, twin_a_portals_cosine_not_cancelled) {
  const auto uncancelled = [](const PortalSet& set, const Vec3d& from, const Vec3d& to,
                              double cos) { return set.density(from, to) * cos; };
  for (const auto& portals : portal_sets())
    EXPECT_LT(portal_segments(portals, uncancelled).p, kWrong);
}

// A strong small triangle, a weak large one, a two-sided one, a dark one, a spot, a point and the
// sun.
Scene lamps() {
  Scene s;
  s.positions = {{0, 0, 0},     {1, 0, 0},          {0, 1, 0},       {0.1f, 0, 0.5f},
                 {0, 0.1f, 1},  {0.5f, 0.5f, 0},    {0.5f, 0.5f, 1}, {-1, -0.5f, 0.2f},
                 {-1, 0.5f, 0}, {-0.5f, 0.1f, 0.7f}};
  s.materials.resize(4);
  s.materials[0].emission = Rgb(1, 2, 3);
  s.materials[1].emission = Rgb(90, 10, 5);
  s.materials[2].emission = Rgb(2);
  s.materials[2].double_sided = true;
  s.triangles = {{{0, 1, 2}, 0}, {{0, 3, 4}, 1}, {{7, 8, 9}, 2}, {{0, 5, 6}, 3}};
  PunctualLight spot;
  spot.kind = PunctualLight::Kind::spot;
  spot.direction = normalize(Vec3d(1, 2, -0.4));
  spot.intensity = Rgb(4);
  spot.cos_inner = 0.9;
  spot.cos_outer = 0.6;
  PunctualLight point;
  point.intensity = Rgb(0.2f);
  PunctualLight sun;
  sun.kind = PunctualLight::Kind::directional;
  sun.direction = normalize(Vec3d(-0.2, 0.3, -1));
  sun.intensity = Rgb(0.3f);
  s.lights = {spot, point, sun};
  return s;
}

// Kind of a punctual light of lamps(), recognised by its density.
size_t kind_of(const Lights::Point& p) {
  if (p.source->at_infinity()) return static_cast<size_t>(PunctualLight::Kind::directional);
  const bool all_round = std::abs(p.source->cos_per_pdf_w({}) - 4 * std::numbers::pi) < 1e-9;
  return static_cast<size_t>(all_round ? PunctualLight::Kind::point : PunctualLight::Kind::spot);
}

// Directions in which light leaves triangle 2 (both sides), triangle 0, the spot and the point.
enum class Source { both_sides, one_side, spot, point };
double light_directions(Source source, double power) {
  const Scene scene = lamps();
  const Lights lights(scene);
  const LightSelection selection(lights);
  const uint32_t triangle = source == Source::both_sides ? 2 : 0;
  const bool punctual = source == Source::spot || source == Source::point;
  const auto kind = source == Source::spot ? PunctualLight::Kind::spot : PunctualLight::Kind::point;
  const Vec3d normal = shape_of(scene, triangle).normal;
  const LightSource* light = nullptr;
  const SphereBins bins(12, 12);
  std::vector<uint64_t> counts(bins.size());
  uint64_t kept = 0;
  for (uint64_t i = 0; kept < kSamples; ++i) {
    Rng rng(39, static_cast<uint64_t>(source), i);
    const Lights::Point p = selection.sample(rng);
    if (punctual ? p.source->met() || kind_of(p) != static_cast<size_t>(kind)
                 : p.triangle != triangle)
      continue;
    light = p.source;
    const double u = rng.uniform();
    const double v = rng.uniform();
    ++kept;
    ++counts[bins.bin(lights.leave(p, u, v).direction)];
  }
  std::vector<double> expected = bins.integrate([&](const Vec3d& w) {
    const double cos = dot(punctual ? light->lamp().direction : normal, w);
    return light->pdf_w(normal, w) * std::pow(1 - std::abs(cos) / 10, power);
  });
  for (double& e : expected) e *= static_cast<double>(kept);
  return chi_square(counts, expected).p;
}
TEST(samplers, light_leaves_lamps_with_their_density) {
  for (Source s : {Source::both_sides, Source::one_side, Source::spot, Source::point})
    EXPECT_GT(light_directions(s, 0), kRight) << static_cast<int>(s);
}
TEST(samplers, twin_light_that_leaves_lamps_with_another_density) {
  for (Source s : {Source::both_sides, Source::one_side, Source::spot, Source::point})
    EXPECT_LT(light_directions(s, 1), kWrong) << static_cast<int>(s);
}

}  // namespace tdpt::samplers_test
