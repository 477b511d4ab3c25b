// The sky in floats: its radiance is the renderer's, and directions are drawn with the reported
// density; each test has a fault that must be found.
#include "libcommon/testing/statistics/chi_square.h"
#include "tools/tdpt-render/testing/lights.h"

namespace tdpt::sky_scalar_test {

using std::numbers::pi;

constexpr double kRight = 1e-4, kWrong = 1e-9;
constexpr uint64_t kSamples = 60000;
constexpr int kColumns = 32, kRows = 16;
constexpr size_t kBins = size_t{kColumns} * kRows;

size_t bin_of(const Vec3d& w) {
  const double u = std::atan2(w.x, -w.z) / (2 * pi) + 0.5;
  const double v = std::acos(std::clamp(w.y, -1.0, 1.0)) / pi;
  return static_cast<size_t>(std::min(static_cast<int>(v * kRows), kRows - 1) * kColumns +
                             std::min(static_cast<int>(u * kColumns), kColumns - 1));
}
std::vector<double> integral(const std::function<double(const Vec3f&)>& density, int fine = 36) {
  std::vector<double> sums(kBins);
  const int rows = kRows * fine, columns = kColumns * fine;
  for (int i = 0; i < rows; ++i) {
    const double theta = (i + 0.5) * pi / rows;
    const double sr = 2 * pi / columns * (std::cos(i * pi / rows) - std::cos((i + 1) * pi / rows));
    for (int j = 0; j < columns; ++j) {
      const double phi = ((j + 0.5) / columns - 0.5) * 2 * pi;
      const Vec3d w(std::sin(theta) * std::sin(phi), std::cos(theta),
                    -std::sin(theta) * std::cos(phi));
      sums[static_cast<size_t>(i / fine * kColumns + j / fine)] += density(Vec3f(w)) * sr;
    }
  }
  return sums;
}
double sum(const std::vector<double>& all) {
  double s = 0;
  for (const double x : all) s += x;
  return s;
}

/// Those that have a sky; `smooth`: only those whose sky a lattice can integrate.
std::vector<std::unique_ptr<LitVista>> under_skies(bool smooth = false) {
  std::vector<std::unique_ptr<LitVista>> all = lit_vistas();
  std::erase_if(all, [&](const auto& lit) {
    if (!lit->tables.has_sky) return true;
    return smooth && !lit->scene.sky->suns().empty() &&
           lit->scene.sky->suns()[0].half_angle < 5 * kDegree;
  });
  return all;
}
Vec3f any_direction(uint64_t i) {
  const FourNumbers n(81, i);
  const double y = 1 - 2 * static_cast<double>(n.u), r = std::sqrt(1 - y * y);
  return Vec3f(Vec3d(r * std::cos(2 * pi * n.v), y, r * std::sin(2 * pi * n.v)));
}

// Number of directions whose radiance or density differs; a few are within a millionth of an edge.
int off(const LitVista& lit, double fault = 1) {
  const LightSelection& selection = lit.vista.openings.selection;
  int n = 0;
  for (uint64_t i = 0; i < 20000; ++i) {
    const Vec3f w = any_direction(i);
    const shader::InSky mine = lit.scalar.look_at_sky(w);
    const Lights::InSky theirs = selection.look(normalize(Vec3d(w)));
    bool far = false;
    for (int c = 0; c < 3; ++c)
      far = far || std::abs(mine.radiance[c] * kUnit - theirs.radiance[c] * fault) >
                       1e-4 * max_component(theirs.radiance) + 1e-4;
    n += far;
  }
  return n;
}
TEST(sky_scalar, is_seen_as_the_renderer_sees_it) {
  for (const auto& lit : under_skies()) EXPECT_LE(off(*lit), 2) << lit->name;
}
TEST(sky_scalar, twin_a_sky_one_percent_brighter) {
  for (const auto& lit : under_skies(true)) EXPECT_GT(off(*lit, 1.01), 5000) << lit->name;
}

// Densities match the renderer's, except below 1/65535 of a block's light, and at borders between
// parts with weights of their own.
TEST(sky_scalar, has_the_renderers_densities) {
  for (const auto& lit : under_skies()) {
    const LightSelection& selection = lit->vista.openings.selection;
    const LightSource& sky = *selection.lights().sky();
    int plain_off = 0, start_off = 0;
    for (uint64_t i = 0; i < 20000; ++i) {
      const FourNumbers n(82, i);
      const shader::SkyPlace place = lit->scalar.drawn_in_sky(
          lit->tables.settings.plain, lit->scalar.pick_word(n.pick, n.side), n.u, n.v);
      const shader::InSky mine = lit->scalar.look_in_sky(place);
      const Lights::InSky theirs = selection.look(normalize(Vec3d(place.towards)));
      const Vec3d away = -normalize(Vec3d(place.towards));
      const double start = selection.pdf(sky, ~0u, away, theirs) / selection.sky_pdf_1();
      plain_off += std::abs(mine.plain_w / theirs.plain_w - 1) > 0.01;
      start_off += std::abs(mine.start_w / start - 1) > 0.01;
    }
    EXPECT_LE(plain_off, 20) << lit->name;
    EXPECT_LE(start_off, 20) << lit->name;
  }
}

double plain(const LitVista& lit, double fault) {
  const auto density = [&](const Vec3f& w) {
    return lit.scalar.look_at_sky(w).plain_w * (w.y > 0.8f ? fault : 1);
  };
  return chi_square_of_samples(kSamples, integral(density),
                               [&](uint64_t i) {
                                 const FourNumbers n(83, i);
                                 const shader::SkyPlace p = lit.scalar.drawn_in_sky(
                                     lit.tables.settings.plain,
                                     lit.scalar.pick_word(n.pick, n.side), n.u, n.v);
                                 EXPECT_NEAR(length(Vec3d(p.towards)), 1, 4e-7);
                                 return bin_of(Vec3d(p.towards));
                               })
      .p;
}
TEST(sky_scalar, directions_have_their_density) {
  for (const auto& lit : under_skies(true)) EXPECT_GT(plain(*lit, 1), kRight) << lit->name;
}
TEST(sky_scalar, twin_directions_near_the_top_a_tenth_off) {
  for (const auto& lit : under_skies(true)) EXPECT_LT(plain(*lit, 0.9), kWrong) << lit->name;
}

// Only the lights of the sky.
double starts(const LitVista& lit, double fault) {
  const auto density = [&](const Vec3f& w) {
    return fault * lit.scalar.light_pdf(shader::SOURCE_SKY, ~0u, -w, lit.scalar.look_at_sky(w));
  };
  std::vector<double> probability = integral(density);
  EXPECT_NEAR(sum(probability) / lit.tables.settings.sky_pdf_1, fault, 0.01) << lit.name;
  return chi_square_of_samples(kSamples, probability,
                               [&](uint64_t i) {
                                 const FourNumbers n(84, i);
                                 const shader::LightPlace p =
                                     lit.scalar.sample_light(n.pick, n.u, n.v, n.side);
                                 if (p.source != shader::SOURCE_SKY) return kBins;
                                 return bin_of(-Vec3d(p.position));
                               })
      .p;
}
TEST(sky_scalar, walks_begin_with_their_density) {
  for (const auto& lit : under_skies(true)) EXPECT_GT(starts(*lit, 1), kRight) << lit->name;
}
TEST(sky_scalar, twin_walks_that_begin_a_tenth_less_often_in_the_sky) {
  for (const auto& lit : under_skies(true)) EXPECT_LT(starts(*lit, 0.9), kWrong) << lit->name;
}

// However small, an entry is drawn with its reported probability, and the mean of 1 / pdf is its
// solid angle.
TEST(sky_scalar, suns_and_texels_of_any_size_are_drawn_as_they_are_weighed) {
  Sky::Map texel{512, 256, std::vector<Rgb>(512 * 256, Rgb(0.01f))};
  texel.texels[200 * 512 + 77] = Rgb(1e6f);
  for (const double half_angle : {6e-5, 0.25 * kDegree, 30 * kDegree}) {
    const auto sky =
        std::make_shared<Sky>(texel, 1, std::vector{sun_of({0.1, 1, 0.2}, half_angle, 3)});
    const LitVista lit("sun", open_room(sky, false), {});
    double sun = 0, bright = 0, dark = 0;
    for (uint64_t i = 0; i < kSamples; ++i) {
      const FourNumbers n(85, i);
      const shader::SkyPlace p = lit.scalar.drawn_in_sky(
          lit.tables.settings.plain, lit.scalar.pick_word(n.pick, n.side), n.u, n.v);
      const shader::InSky found = lit.scalar.look_in_sky(p);
      ASSERT_GT(found.plain_w, 0);
      const double y = shader::luminance(found.radiance) * kUnit;
      if (y > 0.1e6 && p.towards.y < 0) bright += 1 / found.plain_w;
      if (length(Vec3d(p.towards) - sky->suns()[0].towards) < 2 * std::sin(half_angle / 2))
        sun += 1 / found.plain_w;
      dark += y < 0.02;
    }
    const double share = 0.9 + 0.1 * std::log(0.1);
    const double of_texel =
        2 * share * (2 * pi / 512) * (std::cos(pi * 199.5 / 256) - std::cos(pi * 201.5 / 256));
    EXPECT_NEAR(bright / kSamples / of_texel, 1, 0.05) << half_angle;
    const double s = std::sin(half_angle / 2);
    EXPECT_NEAR(sun / kSamples / (4 * pi * s * s), 1, 0.05) << half_angle;
  }
}

// Rows of 2e-4 degrees at the poles, the seam, columns narrower than rounding.
TEST(sky_scalar, places_are_found_again) {
  Sky::Map map{4096, 512, {}};
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x)
      map.texels.push_back(
          Rgb(1 + 0.5f * static_cast<float>(std::sin(0.01 * x) * std::cos(0.02 * y))));
  const LitVista lit("large", open_room(std::make_shared<Sky>(map, 0.7), false), {});
  for (uint64_t i = 0; i < 20000; ++i) {
    const FourNumbers n(86, i);
    shader::SkyPlace p{};
    p.column = shader::below(static_cast<uint32_t>(n.pick * 0x1p32), 4096);
    p.row = i % 4 == 0   ? 0
            : i % 4 == 1 ? 512
                         : shader::below(static_cast<uint32_t>(n.side * 0x1p32), 513);
    p.across = n.u;
    p.down = n.v;
    p.towards = lit.scalar.towards_place(p);
    const shader::SkyPlace q = lit.scalar.place_in_sky(p.towards);
    const double rows = (p.row + double{p.down}) - (q.row + double{q.down});
    double columns = std::abs((p.column + double{p.across}) - (q.column + double{q.across}));
    columns = std::min(columns, 4096 - columns);
    ASSERT_LT(std::abs(rows), 2e-3) << p.row << ' ' << p.down;
    // Near a pole a column is narrower than the precision of directions.
    const double r = std::sqrt(1 - double{p.towards.y} * p.towards.y);
    ASSERT_LT(columns, 2e-4 + 3e-7 / std::max(r, 1e-9) * 4096) << p.row;
    const Sky::Cell cell{static_cast<int>(p.column), static_cast<int>(p.row), n.u, n.v};
    EXPECT_LT(length(Vec3d(p.towards) - lit.scene.sky->towards(cell)), 1e-6);
  }
}

// All random numbers at both ends of their range.
TEST(sky_scalar, ends_of_the_unit_interval_are_drawn) {
  for (const auto& lit : under_skies())
    for (int k = 0; k < 81; ++k) {
      const auto number = [&](int digit) {
        return digit == 0 ? 0.0f : digit == 1 ? 0.5f : 0.99999994f;
      };
      const shader::LightPlace p = lit->scalar.sample_light(number(k % 3), number(k / 3 % 3),
                                                            number(k / 9 % 3), number(k / 27));
      EXPECT_TRUE(std::isfinite(p.pdf) && is_finite(p.position) && is_finite(p.in_sky.radiance));
      EXPECT_NE(p.source, shader::SOURCE_NONE);
    }
}

}  // namespace tdpt::sky_scalar_test
