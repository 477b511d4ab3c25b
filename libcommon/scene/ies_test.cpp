// IES profiles: intensity by direction, and errors in files.
#include "libcommon/scene/ies.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <numbers>

#include "libcommon/base/error.h"
#include "libcommon/math/rng.h"
#include "libcommon/scene/lights.h"
#include "libcommon/testing/files/ies_text.h"

namespace tdpt::ies_test {

using testing::IesText;
constexpr double kDegree = std::numbers::pi / 180;

LightProfile read(const std::string& text) {
  return read_ies(text, "lamp.ies", "");
}

// A lamp that aims down, x across: [cd] at angles in degrees.
struct Lamp {
  PunctualLight light;
  LightSource source;
  explicit Lamp(const std::string& text) : light(light_of(text)), source(source_of(light)) {}

  static PunctualLight light_of(const std::string& text) {
    PunctualLight light;
    light.profile = std::make_shared<LightProfile>(read(text));
    light.intensity = Rgb(static_cast<float>(light.profile->peak));
    light.direction = {0, 0, -1}, light.across = {1, 0, 0};
    return light;
  }
  static LightSource source_of(const PunctualLight& light) {
    return LightSource::punctual(light,
                                 2 * std::numbers::pi * (1 - std::cos(light.profile->reach)));
  }
  double along(const Vec3d& w) const { return source.emitted({}, {}, w).x; }
  double at(double vertical, double horizontal) const {
    const double s = std::sin(vertical * kDegree);
    return along({s * std::cos(horizontal * kDegree), s * std::sin(horizontal * kDegree),
                  -std::cos(vertical * kDegree)});
  }
};

TEST(ies, between_the_angles_of_a_file_intensity_is_linear) {
  const Lamp lamp(IesText{
      .multiplier = 2, .ballast = 0.5, .vertical = {0, 10, 30, 90}, .candela = {100, 80, 40, 10}}
                      .text());
  EXPECT_EQ(lamp.light.profile->peak, 100);
  for (const double around : {0.0, 77.0, 200.0}) {
    EXPECT_NEAR(lamp.at(0, around), 100, 1e-4);
    EXPECT_NEAR(lamp.at(5, around), 90, 1e-4);
    EXPECT_NEAR(lamp.at(10, around), 80, 1e-4);
    EXPECT_NEAR(lamp.at(25, around), 50, 1e-4);
    EXPECT_NEAR(lamp.at(89.99, around), 10, 1e-2);
    EXPECT_EQ(lamp.at(90.01, around), 0);
    EXPECT_EQ(lamp.at(180, around), 0);
  }
}

TEST(ies, a_quarter_or_a_half_stands_for_all_around) {
  struct Plane {
    std::vector<double> at;  // angles around
    double candela;
  };
  struct Case {
    std::vector<double> horizontal, candela;  // the latter at all vertical angles
    std::vector<Plane> planes;
  };
  const std::vector<Case> cases = {
      {{0, 30, 90},
       {9, 3, 6},
       {{{30, 150, 210, 330}, 3}, {{60, 120, 240, 300}, 4.5}, {{0, 180}, 9}}},
      {{0, 90, 180}, {2, 4, 8}, {{{45, 315}, 3}, {{135, 225}, 6}}},
      {{90, 180, 270}, {2, 4, 8}, {{{0, 180}, 4}, {{45, 135}, 3}, {{225, 315}, 6}}},
      // Planes need not lie at 0 or 180: 0 is 360, and what lies between is interpolated.
      {{90, 135, 225, 270},
       {1, 2, 4, 5},
       {{{0, 180, 359.9999}, 3}, {{22.5, 157.5}, 2.5}, {{202.5, 337.5}, 3.5}}},
      {{90, 270}, {2, 6}, {{{0, 180}, 4}, {{45, 135}, 3}}},
      {{0, 45, 90, 200}, {1, 2, 3, 5}, {{{280}, 3}}},
      {{0, 120, 240}, {3, 6, 9}, {{{60}, 4.5}, {{180}, 7.5}, {{300}, 6}, {{359.9999}, 3}}}};
  for (const Case& c : cases) {
    IesText text{.vertical = {0, 90}, .horizontal = c.horizontal, .candela = {}};
    for (const double candela : c.candela) text.candela.insert(text.candela.end(), 2, candela);
    const Lamp lamp(text.text());
    for (const Plane& p : c.planes)
      for (const double a : p.at) EXPECT_NEAR(lamp.at(45, a), p.candela, 1e-4) << a;
  }
}

// Light walks start in proportion to power, which is the mean over the directions within reach.
TEST(ies, mean_and_reach_are_those_of_its_directions) {
  for (const IesText& text : {IesText{.vertical = {0, 20, 35, 60, 90}, .candela = {5, 4, 1, 0, 0}},
                              IesText{.vertical = {90, 120, 180}, .candela = {1, 7, 2}},
                              IesText{.vertical = {0, 50, 90},
                              .horizontal = {0, 45, 90},
                              .candela = {1, 2, 3, 4, 9, 6, 7, 3, 0}}}) {
    const Lamp lamp(text.text());
    constexpr int kColumns = 72, kRows = 500;
    double sum = 0, missed = 0;
    for (int i = 0; i < kColumns * kRows; ++i) {
      const double around = 2 * std::numbers::pi * (i % kColumns + 0.5) / kColumns;
      const double cosine = 1 - 2 * (i / kColumns + 0.5) / kRows,
                   sine = std::sqrt(1 - cosine * cosine);
      const Vec3d w(sine * std::cos(around), sine * std::sin(around), cosine);
      const double value = lamp.along(w) / lamp.light.profile->peak;
      sum += value;
      if (value > 0 && lamp.source.pdf_w({}, w) == 0) ++missed;
    }
    const double solid = 2 * std::numbers::pi * (1 - std::cos(lamp.light.profile->reach));
    EXPECT_NEAR(4 * std::numbers::pi * sum / (kColumns * kRows) / solid, lamp.light.profile->mean,
                0.01 * lamp.light.profile->mean);
    EXPECT_EQ(missed, 0);
  }
  EXPECT_NEAR(
      read(IesText{.vertical = {0, 20, 35, 60, 90}, .candela = {5, 4, 1, 0, 0}}.text()).reach,
      60 * kDegree, 1e-12);
}

// Visits directions sampled by leave(), at numbers that fill the square evenly.
template <class Visit>
void each_leaving(const Lamp& lamp, int draws, const Visit& visit) {
  const Scene scene;
  const Lights lights(scene);
  Lights::Point point;
  point.source = &lamp.source;
  for (int i = 0; i < draws; ++i) {
    const double u = std::fmod(0.5 + 0.7548776662466927 * i, 1.0);
    const double v = std::fmod(0.5 + 0.5698402909980532 * i, 1.0);
    visit(lights.leave(point, u, v).direction);
  }
}

// Samples of leave() have the density of pdf_w() and carry the power of the profile.
TEST(ies, walks_leave_by_the_rings_of_a_profile) {
  const Lamp lamp(IesText{
      .vertical = {10, 12, 30, 60, 100, 180},
      .horizontal = {0, 90, 180},
      .candela = {9, 8, 2, 0, 0, 0, 9, 9, 1, 1, 0, 0, 9, 9, 0, 0, 0,
                  0}}.text());
  constexpr int kDraws = 20000, kBins = 40;
  std::vector<double> drawn(kBins), told(kBins);
  double carried = 0;
  each_leaving(lamp, kDraws, [&](const Vec3d& w) {
    ASSERT_GT(lamp.source.pdf_w({}, w), 0);
    EXPECT_NEAR(lamp.source.cos_per_pdf_w(w) * lamp.source.pdf_w({}, w), 1, 1e-12);
    const auto bin = static_cast<size_t>((1 + w.z) / 2 * kBins);
    drawn[std::min<size_t>(bin, kBins - 1)] += 1.0 / kDraws;
    carried += lamp.along(w) * lamp.source.cos_per_pdf_w(w) / kDraws;
  });
  for (size_t b = 0; b < kBins; ++b)
    for (int k = 0; k < 100; ++k) {
      const double z = 2 * (static_cast<double>(b) + (k + 0.5) / 100) / kBins - 1;
      // No light inside the first row's angle.
      if (z > -std::cos(10 * kDegree))
        told[b] += lamp.source.pdf_w({}, {std::sqrt(1 - z * z), 0, z}) * 4 * std::numbers::pi /
                   kBins / 100;
    }
  for (size_t b = 0; b < kBins; ++b)
    EXPECT_NEAR(drawn[b], told[b], 5 * std::sqrt(told[b] / kDraws) + 2e-4) << b;
  const LightProfile& p = *lamp.light.profile;
  const double power = p.peak * p.mean * 2 * std::numbers::pi * (1 - std::cos(p.reach));
  EXPECT_NEAR(carried, power, 0.02 * power);
}

// Mean throughput / power for a narrow beam to the side.
double carried_of_power(double density_times) {
  Lamp lamp(IesText{
      .vertical = {0, 85, 90, 95, 180},
      .horizontal = {0, 20, 25, 30, 360},
      .candela = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 9, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}}
                .text());
  LightProfile profile = *lamp.light.profile;
  for (size_t r = 1; r < profile.words[0]; ++r) {
    uint32_t& word = profile.words[profile.words.size() - r];
    word = std::bit_cast<uint32_t>(std::bit_cast<float>(word) * static_cast<float>(density_times));
  }
  lamp.light.profile = std::make_shared<LightProfile>(profile);
  lamp.source = Lamp::source_of(lamp.light);
  constexpr int kDraws = 20000;
  double carried = 0;
  each_leaving(lamp, kDraws, [&](const Vec3d& w) {
    carried += lamp.along(w) * lamp.source.cos_per_pdf_w(w) / kDraws;
  });
  return carried /
         (profile.peak * profile.mean * 2 * std::numbers::pi * (1 - std::cos(profile.reach)));
}

TEST(ies, walks_carry_the_power_of_a_narrow_beam) {
  EXPECT_NEAR(carried_of_power(1), 1, 0.03);
  EXPECT_LT(carried_of_power(1.1), 0.95);  // twin: densities a tenth too large
}

// Two rows that are equal as floats, and angles a ten thousandth of a degree apart.
TEST(ies, extremes_keep_their_densities) {
  for (const IesText& text :
       {IesText{.vertical = {0, 179.99, 180}, .candela = {0, 0, 1}},
        IesText{.vertical = {0, 179.9998, 179.9999, 180}, .candela = {1, 0, 1, 1}},
        IesText{.vertical = {0, 0.0001, 0.0002}, .candela = {5, 5, 5}},
        IesText{.vertical = {179.9998, 179.9999, 180}, .candela = {1, 2, 1}},
        IesText{.multiplier = 1e30,
        .ballast = 1e-20,
        .vertical = {0, 45, 90},
        .candela = {5e-30, 3e-30, 0}}}) {
    const Lamp lamp(text.text());
    ASSERT_GT(lamp.light.profile->peak, 0);
    double all = 0;
    constexpr int kDraws = 10000;
    each_leaving(lamp, kDraws, [&](const Vec3d& w) {
      const double pdf = lamp.source.pdf_w({}, w);
      ASSERT_TRUE(pdf > 0 && std::isfinite(pdf)) << text.text();
      all += 1 / pdf / kDraws;
    });
    const double solid = 2 * std::numbers::pi * (1 - std::cos(lamp.light.profile->reach));
    if (text.vertical[0] == 0) {
      EXPECT_NEAR(all, solid, 0.05 * solid) << text.text();
    }
  }
  // As dark as floats can represent, or darker.
  const IesText dark{.multiplier = 1e-30,
                     .ballast = 1e-30,
                     .vertical = {0, 45, 90},
                     .candela = {5e-304, 5e-304, 0}};
  EXPECT_EQ(read(dark.text()).peak, 0);
}

TEST(ies, what_stands_behind_the_ballast_factor_counts_in_old_files_alone) {
  const std::string text = IesText{.vertical = {0, 90}, .candela = {100, 50}}.text();
  const auto peak = [&](const std::string& first) {
    std::string other = first + text.substr(text.find('\n'));
    other.replace(other.find("\n1 1 60"), 7, "\n1 1.1 60");
    return read(other).peak;
  };
  EXPECT_EQ(peak("IESNA:LM-63-1995"), 100);
  EXPECT_EQ(peak("IESNA:LM-63-2002"), 100);
  EXPECT_EQ(peak("IES:LM-63-2019"), 100);
  EXPECT_NEAR(peak("IESNA91"), 110, 1e-9);
  EXPECT_NEAR(peak("[of 1986]"), 110, 1e-9);
}

TEST(ies, is_read_as_makers_write_it) {
  const IesText plain{.vertical = {0, 45, 90}, .candela = {3, 2, 1}};
  const LightProfile known = read(plain.text());
  const auto same = [&](const std::string& text) {
    const LightProfile other = read(text);
    return other.words == known.words && other.peak == known.peak;
  };
  std::string dos, commas, broken;
  for (const char c : plain.text()) {
    dos += c == '\n' ? "\r\n" : std::string(1, c);
    commas += c;
    broken += c;
  }
  EXPECT_TRUE(same(dos));
  const size_t numbers = plain.text().find("1 1000");
  for (size_t i = numbers; i < commas.size(); ++i) {
    if (commas[i] == ' ') commas[i] = ',';
    if (broken[i] == ' ') broken[i] = '\n';
  }
  EXPECT_TRUE(same(commas));
  EXPECT_TRUE(same(broken));
  EXPECT_TRUE(same(plain.text().substr(plain.text().find("TILT="))));  // of 1986
  IesText tilted = plain;
  tilted.tilt = "INCLUDE\n1\n2\n0 90\n1 0.9";
  EXPECT_TRUE(same(tilted.text()));
  tilted.tilt = "other.tlt";
  EXPECT_TRUE(same(tilted.text()));
  std::string plus = plain.text();
  plus.replace(plus.find("1 1000"), 6, "+1 -1");
  EXPECT_TRUE(same(plus));
  EXPECT_EQ(read(IesText{.vertical = {0, 90}, .candela = {0, 0}}.text()).peak, 0);
}

TEST(ies, what_is_wrong_is_told_with_its_line) {
  const IesText sound{.vertical = {0, 45, 90}, .candela = {3, 2, 1}};
  const auto with = [&](auto change) {
    IesText text = sound;
    change(text);
    return text.text();
  };
  const std::string two_planes = with([](IesText& t) {
    t.horizontal = {0, 45}, t.candela = {1, 2, 3, 4, 5, 6};
  });
  for (const auto& [text, says] : std::vector<std::pair<std::string, std::string>>{
           {"", "1: is no IES file: no line begins with TILT="},
           {"no lamp\nat all", "1: is no IES file: no line begins with TILT="},
           {with([](IesText& t) { t.candela.pop_back(); }), "9: ends before its intensities"},
           {with([](IesText& t) { t.candela[1] = -2; }), "8: intensities: -2, expected 0 to 1e+30"},
           {with([](IesText& t) { t.vertical[1] = 95; }),
            "6: vertical angles: 90 follows 95, expected angles that ascend"},
           {with([](IesText& t) { t.vertical[2] = 181; }),
            "6: vertical angles: 181, expected 0 to 180"},
           {with([](IesText& t) { t.type = 4; }),
            "4: photometric type: 4, expected 1, a goniophotometer of type C"},
           {with([](IesText& t) { t.multiplier = -1; }),
            "4: multiplier: -1, expected 1e-30 to 1e+30"},
           {two_planes,
            "8: horizontal angles go from 0 to 45, expected 0 to 90, 180 or 360, or 90"},
           {"TILT=NONE\n1 1000 1 9e9 1 1 2 0 0 0",
            "2: number of vertical angles: 9000000000, expected 2 to 34"},
           {"TILT=NONE\n1 1000 1 2.5 1 1 2 0 0 0",
            "2: number of vertical angles: 2.5, expected an integer"}}) {
    try {
      read(text);
      ADD_FAILURE() << says;
    } catch (const InputError& e) {
      EXPECT_TRUE(std::string(e.what()).starts_with("lamp.ies:" + says)) << e.what();
    }
  }
}

// Whatever a file contains: it is refused, or gives a table with valid indices and values in [0,1].
TEST(ies, damaged_files_are_refused_or_sound) {
  const std::string sound = IesText{
      .vertical = {0, 30, 60, 90},
      .horizontal = {0, 90, 180},
      .candela = {9, 8, 7, 6, 5, 4, 3, 2, 1, 0, 1,
                  2}}.text();
  int refused = 0, read_all = 0;
  for (uint64_t i = 0; i < 2000; ++i) {
    Rng rng(7, 0, i);
    std::string text = sound;
    for (uint64_t n = 1 + rng.bits() % 3; n > 0; --n)
      text[rng.bits() % text.size()] = "0123456789.-+eE \n,x"[rng.bits() % 19];
    LightProfile p;
    try {
      p = read(text);
    } catch (const InputError&) {
      ++refused;
      continue;
    }
    ++read_all;
    if (!(p.peak > 0)) continue;
    const size_t rows = p.words[0], columns = p.words[1];
    ASSERT_EQ(p.words.size(), 2 + rows + columns + rows * columns + 3 * rows - 1);
    for (size_t k = 2; k < 2 + rows + columns + rows * columns; ++k) {
      const auto value = std::bit_cast<float>(p.words[k]);
      ASSERT_TRUE(value >= 0 && value <= 1) << text;
      const bool ascends = k > 2 && k != 2 + rows && k < 2 + rows + columns;
      ASSERT_TRUE(!ascends || value > std::bit_cast<float>(p.words[k - 1])) << text;
    }
    ASSERT_TRUE(p.mean > 0 && p.mean <= 1 + 1e-9 && p.reach > 0) << text;
  }
  EXPECT_GT(refused, 100);
  EXPECT_GT(read_all, 100);
}

}  // namespace tdpt::ies_test
