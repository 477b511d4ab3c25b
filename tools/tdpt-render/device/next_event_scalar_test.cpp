// Next events in floats: at rectangular lights and through windows they have the reported density,
// which is the renderer's, wherever they are made.
#include "libcommon/testing/statistics/chi_square.h"
#include "tools/tdpt-render/testing/lights.h"

namespace tdpt::next_event_scalar_test {

using std::numbers::pi;

constexpr double kRight = 1e-4, kWrong = 1e-9;
constexpr uint64_t kSamples = 60000;
constexpr float kThrough = 0.5f;

struct Place {
  Vec3d place, normal;  // [m]
  bool both_ways = false;
};

// The same point for the scalar build and for the renderer, whose windows have been evaluated.
struct Seen {
  shader::Point p{};
  shader::LightContext light_context{};
  Vertex v;

  Seen(const LitVista& lit, const Place& place) {
    const Vec3d normal = normalize(place.normal);
    p.position = Vec3f(lit.scene.frame.to_canonical(place.place));
    p.normal = p.shading = Vec3f(normal);
    p.triangle = 0;
    p.simple = !place.both_ways;
    p.connectible = true;
    lit.scalar.look_out(p, place.both_ways ? Vec3f() : p.normal, light_context);
    v.position = Vec3d(p.position);
    v.normal = v.shading = Vec3d(p.normal);
    v.material = &lit.scene.materials[0];
    v.simple = p.simple;
    if (place.both_ways) v.bsdf.through = Rgb(0.5f);
    lit.vista.next_events().look_out(v.normal, v);
    lit.vista.next_events().look_at_rect_lights(v);
  }
};

float pdf_of(const LitVista& lit, const Seen& s, const shader::LightPlace& at) {
  return lit.scalar.next_event_pdf(s.p, s.light_context, kThrough, at.source, at.triangle,
                                   at.position, at.in_sky);
}
shader::LightPlace sampled(const LitVista& lit, Seen& s, uint64_t seed, uint64_t i) {
  const FourNumbers n(seed, i);
  return lit.scalar.sample_next_event(s.p, s.light_context, kThrough, n.pick, n.u, n.v, n.side);
}

std::unique_ptr<LitVista> rect_lights() {
  return std::make_unique<LitVista>("rectangular lights", with_rect_lights(diffuse_rooms()),
                                    std::vector<Portal>{});
}
const std::vector<Place> kBeforeRectLights{
    {{1.0, 0.0, 0.0}, {0, 1, 0}},              // the floor
    {{1.9, 0.3, 0.8}, {-1, 0.3, -0.2}},        // sees some of each
    {{0.2, 0.4, -0.3}, {0.1, 1, 0.2}},         // before one that its horizon cuts
    {{0.051, 0.6, -0.1}, {1, 0, 0}, true},     // a millimetre before it
    {{1.3, 1.3, 0.25}, {0.3, -1, 0.1}, true},  // transmits light, between all
    {{3.5, 0.5, 0.1}, {0, 1, 0}},              // in the lamp's room
};
constexpr size_t kLattice = 6;

double at_rect_lights(const Place& shaded, const Place& claimed) {
  const auto lit = rect_lights();
  Seen s(*lit, shaded);
  const Seen other(*lit, claimed);
  const std::vector<RectLight>& all = lit->vista.world->rect_lights;
  std::vector<double> probability;
  double sum = 0;
  for (const RectLight& rect_light : all) {
    const auto density = [&](double x, double y) {
      const Vec3f at(rect_light.corner + rect_light.x * (x * rect_light.length_x) +
                     rect_light.y * (y * rect_light.length_y));
      return double{
          lit->scalar.next_event_pdf(other.p, other.light_context, 0, shader::SOURCE_FRONT,
                                     x < y ? rect_light.triangle1 : rect_light.triangle0, at, {})};
    };
    const auto at = [](size_t k) { return static_cast<double>(k) / kLattice; };
    for (size_t k = 0; k < kLattice * kLattice; ++k) {
      const size_t i = k / kLattice, j = k % kLattice;
      probability.push_back(rect_light.length_x * rect_light.length_y *
                            integrate(density, at(i), at(i + 1), at(j), at(j + 1)));
      sum += probability.back();
    }
  }
  EXPECT_NEAR(sum, 1, 1e-3);
  const auto part = [](double x) {
    return std::min(static_cast<size_t>(std::max(x, 0.0) * kLattice), kLattice - 1);
  };
  const auto draw = [&](uint64_t i) {
    const shader::LightPlace p = sampled(*lit, s, 91, i);
    for (size_t k = 0; k < all.size(); ++k) {
      const RectLight& rect_light = all[k];
      if (p.triangle != rect_light.triangle0 && p.triangle != rect_light.triangle1) continue;
      const TriangleShape shape = shape_of(lit->scene, p.triangle);
      EXPECT_LT(length(shape.p0 + shape.e1 * p.b1 + shape.e2 * p.b2 - Vec3d(p.position)), 1e-6);
      EXPECT_EQ(p.pdf, pdf_of(*lit, s, p));
      const Vec3d r = Vec3d(p.position) - rect_light.corner;
      return (k * kLattice + part(dot(rect_light.x, r) / rect_light.length_x)) * kLattice +
             part(dot(rect_light.y, r) / rect_light.length_y);
    }
    return probability.size();
  };
  return chi_square_of_samples(kSamples, probability, draw).p;
}
TEST(next_event_scalar, rect_lights_have_their_density) {
  for (const Place& place : kBeforeRectLights) EXPECT_GT(at_rect_lights(place, place), kRight);
}
TEST(next_event_scalar, twin_a_density_of_another_horizon) {
  Place tilted = kBeforeRectLights[1];
  tilted.normal.y += 0.2;
  EXPECT_LT(at_rect_lights(kBeforeRectLights[1], tilted), kWrong);
}

// At the renderer's sampled points both have the same density; the same light is sent.
TEST(next_event_scalar, rect_lights_are_the_renderers) {
  const auto lit = rect_lights();
  for (const Place& place : kBeforeRectLights) {
    Seen s(*lit, place);
    int others = 0;
    // In floats a height of a millimetre is accurate to 1e-4.
    EXPECT_NEAR(s.light_context.sent / s.v.light_context.sent, 1, 3e-4);
    for (uint64_t i = 0; i < 2000; ++i) {
      const FourNumbers n(92, i);
      const Lights::Point q = lit->vista.next_events().sample(s.v, 0, n.pick, n.u, n.v, n.side);
      const float pdf = lit->scalar.next_event_pdf(s.p, s.light_context, 0, shader::SOURCE_FRONT,
                                                   q.triangle, Vec3f(q.position), {});
      EXPECT_NEAR(pdf / q.pdf, 1, 1e-3);
      const shader::LightPlace p =
          lit->scalar.sample_next_event(s.p, s.light_context, 0, n.pick, n.u, n.v, n.side);
      others += p.triangle != q.triangle || length(Vec3d(p.position) - q.position) > 3e-4;
    }
    EXPECT_LE(others, 4);
  }
}

TEST(next_event_scalar, rect_lights_that_send_nothing_are_not_chosen) {
  const auto lit = rect_lights();
  for (const Place& dark : {Place{{0.01, 0.5, 0}, {-1, 0, 0}}, Place{{1.0, 2.5, 0.9}, {0, 1, 0}}}) {
    Seen s(*lit, dark);
    EXPECT_EQ(s.light_context.sent, 0);
    EXPECT_EQ(sampled(*lit, s, 93, 0).source, shader::SOURCE_NONE);
    for (const RectLight& rect_light : lit->vista.world->rect_lights)
      EXPECT_EQ(lit->scalar.next_event_pdf(s.p, s.light_context, 0, shader::SOURCE_FRONT,
                                           rect_light.triangle0, Vec3f(rect_light.corner), {}),
                0);
  }
}

// In its plane, on it, at its corner, a micrometre before it.
TEST(next_event_scalar, rect_lights_are_finite_at_the_extremes) {
  const auto lit = rect_lights();
  for (const Vec3d& place :
       {Vec3d(0.05, 0.5, 0), Vec3d(0.050001, 0.5, 0), Vec3d(0.050001, 0.1, -0.5),
        Vec3d(0.05, 0.05, -0.7), Vec3d(0.0499999, 0.4, 0.1), Vec3d(0.5, 1.949999, -0.4)})
    for (const Vec3d& normal : {Vec3d(1, 0, 0), Vec3d(0, -1, 0), Vec3d(1, 1, 1)}) {
      Seen s(*lit, {place, normal});
      EXPECT_TRUE(std::isfinite(s.light_context.sent));
      for (uint64_t i = 0; i < 200; ++i) {
        const shader::LightPlace p = sampled(*lit, s, 94, i);
        EXPECT_TRUE(std::isfinite(p.pdf) && p.pdf >= 0 && is_finite(p.position)) << p.pdf;
        EXPECT_EQ(p.pdf, pdf_of(*lit, s, p));
      }
    }
}

// Through windows. Bins of latitude and longitude.
constexpr int kColumns = 32, kRows = 16;
constexpr size_t kBins = size_t{kColumns} * kRows;
size_t bin_of(const Vec3d& w) {
  const double u = std::atan2(w.x, -w.z) / (2 * pi) + 0.5;
  const double v = std::acos(std::clamp(w.y, -1.0, 1.0)) / pi;
  return static_cast<size_t>(std::min(static_cast<int>(v * kRows), kRows - 1) * kColumns +
                             std::min(static_cast<int>(u * kColumns), kColumns - 1));
}
const std::vector<Place> kBehindWindows{{{3, 0, 0}, {0, 1, 0}},
                                        {{3.9, 1.2, -0.5}, {1, 0.2, 0}},
                                        {{0.3, 1, 0.1}, {1, 0, 0}},
                                        {{3, 0.3, -0.4}, {0, 0, 1}},
                                        {{3, 1.2, 0.6}, {0.3, 0, -1}, true}};

std::unique_ptr<LitVista> behind_windows(bool one_colour) {
  const auto suns = std::vector{sun_of({0.3, 1, 0.4}, 12 * kDegree, 4)};
  return std::make_unique<LitVista>(
      "windows", open_room(one_colour ? one_colour_sky({1, 2, 3}) : uneven_sky(suns)),
      three_windows());
}

// `through`: probability, according to the density, of looking through windows. Samples below the
// horizon are not evaluated: they count where they were drawn.
double at_windows(const LitVista& lit, const Place& place, float through, int fine) {
  Seen s(lit, place);
  EXPECT_GT(s.light_context.seen, 0);
  std::vector<double> probability(kBins);
  const int rows = kRows * fine, columns = kColumns * fine;
  for (int i = 0; i < rows; ++i) {
    const double theta = (i + 0.5) * pi / rows;
    const double sr = 2 * pi / columns * (std::cos(i * pi / rows) - std::cos((i + 1) * pi / rows));
    for (int j = 0; j < columns; ++j) {
      const double phi = ((j + 0.5) / columns - 0.5) * 2 * pi;
      const Vec3f w(Vec3d(std::sin(theta) * std::sin(phi), std::cos(theta),
                          -std::sin(theta) * std::cos(phi)));
      probability[static_cast<size_t>(i / fine * kColumns + j / fine)] +=
          sr * lit.scalar.next_event_pdf(s.p, s.light_context, through, shader::SOURCE_SKY, ~0u, -w,
                                         lit.scalar.look_at_sky(w));
    }
  }
  return chi_square_of_samples(kSamples, probability,
                               [&](uint64_t i) {
                                 const shader::LightPlace p = sampled(lit, s, 95, i);
                                 if (p.source != shader::SOURCE_SKY) return kBins;
                                 EXPECT_TRUE(p.pdf == 0 || p.pdf == pdf_of(lit, s, p));
                                 return bin_of(-Vec3d(p.position));
                               })
      .p;
}
TEST(next_event_scalar, windows_have_their_density) {
  for (const bool one_colour : {true, false}) {
    const auto lit = behind_windows(one_colour);
    for (const Place& place : kBehindWindows)
      EXPECT_GT(at_windows(*lit, place, kThrough, 72), kRight) << place.place.x;
  }
}
TEST(next_event_scalar, twin_windows_that_are_looked_through_more_often_than_is_said) {
  const auto lit = behind_windows(false);
  for (const Place& place : kBehindWindows)
    EXPECT_LT(at_windows(*lit, place, 0.8f * kThrough, 24), kWrong) << place.place.x;
}

// Radiance and densities are the renderer's; every sample that does not lie on a window's edge is
// found in it again.
TEST(next_event_scalar, windows_are_the_renderers) {
  for (const auto& lit : lit_vistas()) {
    if (!lit->tables.has_windows) continue;
    for (const Place& place : kBehindWindows) {
      Seen s(*lit, place);
      if (s.v.light_context.seen == 0) {
        EXPECT_EQ(s.light_context.seen, 0);
        continue;
      }
      EXPECT_NEAR(s.light_context.seen * kUnit / s.v.light_context.seen, 1, 2e-3) << lit->name;
      int off = 0;
      for (uint64_t i = 0; i < 4000; ++i) {
        const FourNumbers n(96, i);
        const Vec3f w = lit->scalar.towards_window(s.p.position, s.light_context.facing,
                                                   s.light_context.seen, n.pick, n.u, n.v);
        const double mine = lit->scalar.windows_pdf_w(s.p.position, s.light_context.facing,
                                                      s.light_context.seen, w);
        const double theirs = lit->vista.openings.windows.windows_pdf_w(
            s.v.position, s.v.light_context.facing, s.v.light_context.seen, normalize(Vec3d(w)));
        ASSERT_GT(mine, 0) << lit->name << ' ' << place.place.x << ' ' << i;
        off += !(std::abs(mine / theirs - 1) < 5e-3);
      }
      EXPECT_LE(off, 4) << lit->name << ' ' << place.place.x;
    }
  }
}

struct Moments {
  double mean = 0, variance = 0;
};
constexpr int kEstimates = 200000;
template <class Estimate>
Moments moments(const Estimate& estimate) {
  double sum = 0, squares = 0;
  for (uint64_t i = 0; i < kEstimates; ++i) {
    const double f = estimate(FourNumbers(98, i));
    sum += f, squares += f * f;
  }
  const double mean = sum / kEstimates;
  return {mean, squares / kEstimates - mean * mean};
}
// Unoccluded irradiance from the sky at an upright surface, by each.
Moments by_scalar(const LitVista& lit, Seen& s) {
  return moments([&](const FourNumbers& n) {
    const shader::LightPlace p =
        lit.scalar.sample_next_event(s.p, s.light_context, kThrough, n.pick, n.u, n.v, n.side);
    if (p.source != shader::SOURCE_SKY || !(p.pdf > 0)) return 0.0;
    const double cosine = std::max(-dot(Vec3d(p.position), s.v.normal), 0.0);
    return cosine * luminance(p.in_sky.radiance) * kUnit / p.pdf;
  });
}
Moments by_renderer(const LitVista& lit, Seen& s) {
  return moments([&](const FourNumbers& n) {
    const Lights::Point q = lit.vista.next_events().sample(s.v, kThrough, n.pick, n.u, n.v, n.side);
    if (!q.source || !q.source->is_sky()) return 0.0;
    Point light;
    light.source = q.source;
    light.position = q.position;
    light.in_sky = q.in_sky;
    const double pdf = lit.vista.next_events().pdf(s.v, light).of(kThrough);
    const double cosine = std::max(-dot(q.position, s.v.normal), 0.0);
    return pdf > 0 ? cosine * luminance(q.in_sky.radiance) / pdf : 0.0;
  });
}
// Difference of the means in standard errors; `fault`: factor on one of them.
double off_by(const Moments& a, const Moments& b, double fault) {
  return std::abs(a.mean * fault - b.mean) / std::sqrt((a.variance + b.variance) / kEstimates);
}
TEST(next_event_scalar, estimates_are_the_renderers_and_no_noisier) {
  for (const auto& lit : lit_vistas()) {
    if (!lit->tables.has_sky) continue;
    Seen s(*lit, {{3, 0, 0}, {0, 1, 0}});
    const Moments mine = by_scalar(*lit, s), theirs = by_renderer(*lit, s);
    EXPECT_LT(off_by(mine, theirs, 1), 4.5) << lit->name;
    EXPECT_GT(off_by(mine, theirs, 1.05), 4.5) << lit->name;  // twin
    EXPECT_LT(mine.variance, 1.05 * theirs.variance) << lit->name;
  }
}

// Very close to a window, far from it, beside its edge.
TEST(next_event_scalar, windows_are_finite_at_the_extremes) {
  for (const bool one_colour : {true, false}) {
    const auto lit = behind_windows(one_colour);
    for (const Vec3d& place :
         {Vec3d(4.0999, 1, 0), Vec3d(4.09999, 0.10001, -0.89), Vec3d(4.1, 1, 0), Vec3d(0, 0, -1),
          Vec3d(2.04, 1, 0), Vec3d(2.05, 0.875, -0.125)})
      for (const Vec3d& normal : {Vec3d(1, 0, 0), Vec3d(-1, 0, 0), Vec3d(0, 1, 0)}) {
        Seen s(*lit, {place, normal});
        EXPECT_TRUE(std::isfinite(s.light_context.seen) && s.light_context.seen >= 0);
        for (uint64_t i = 0; i < 200; ++i) {
          const shader::LightPlace p = sampled(*lit, s, 97, i);
          EXPECT_TRUE(std::isfinite(p.pdf) && p.pdf >= 0 && is_finite(p.position));
          EXPECT_EQ(is_finite(p.in_sky.radiance), true);
        }
      }
  }
}

// Most of the table is the sun's: a window that does not show it must keep its precision.
TEST(next_event_scalar, beside_a_sun_the_rest_of_the_sky_is_seen_as_exactly) {
  const auto with = [](float irradiance) {
    return std::make_unique<LitVista>(
        "sun",
        open_room(std::make_shared<Sky>(uneven_map(), 0.3,
                                        std::vector{sun_of({1, 0.35, 0.1}, kDegree, irradiance)}),
                  false),
        three_windows());
  };
  const auto faint = with(1e-6f), strong = with(1e4f);
  // From near the ceiling the window shows only the lowest part of the sky.
  const Place place{{2.3, 1.95, 0}, {0.2, -1, 0}};
  Seen a(*faint, place), b(*strong, place);
  ASSERT_GT(a.light_context.seen, 0);
  EXPECT_NEAR(b.light_context.seen / a.light_context.seen, 1, 0.05);
}

}  // namespace tdpt::next_event_scalar_test
