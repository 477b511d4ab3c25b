// Films are sums independent of order, and parts of a picture merge to the whole.
#include "libcommon/film/film.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>
#include <oneapi/tbb/parallel_for.h>

#include "libcommon/math/rng.h"

namespace tdpt::film_test {

Vec3d grey(double v) {
  return {v, v, v};
}

TEST(fixed_sum, holds_what_is_added_in_any_order_and_from_any_thread) {
  std::vector<Units> values;
  for (uint64_t i = 0; i < 20000; ++i)
    values.push_back(static_cast<Units>(mix64(i)) << (mix64(i + 1) % 48));
  Units expected = 0;
  for (Units v : values) expected += v;
  FixedSum in_order, backwards, parallel;
  for (Units v : values) in_order.add(v);
  for (size_t i = values.size(); i-- > 0;) backwards.add(values[i]);
  tbb::parallel_for(size_t{0}, values.size(), [&](size_t i) { parallel.add(values[i]); });
  EXPECT_TRUE(in_order.units() == expected);
  EXPECT_TRUE(backwards.units() == expected);
  EXPECT_TRUE(parallel.units() == expected);
}

TEST(fixed_sum, says_when_it_wraps_round) {
  FixedSum sum, other;
  EXPECT_TRUE(sum.add(~Units{0}));
  EXPECT_FALSE(sum.add(1));
  EXPECT_TRUE(sum.units() == 0);
  EXPECT_TRUE(other.add(1));
  EXPECT_FALSE(other.add(~Units{0}));
}

// Mean of rounded values far below a unit; `fair`: rounding uses random bits.
double mean_of_dim(double value, bool fair) {
  constexpr int n = 100000;
  Units sum = 0;
  for (int i = 0; i < n; ++i) {
    Units units;
    EXPECT_TRUE(to_units(value, 1, fair ? mix64(static_cast<uint64_t>(i)) : ~uint64_t{0}, units));
    sum += units;
  }
  return from_units(sum, 1) / n;
}
TEST(fixed_sum, rounding_darkens_nothing) {
  for (double value : {0.001, 0.37, 3.75, 1e6 + 0.25})
    EXPECT_NEAR(mean_of_dim(value, true), value, 4 * 0.5 / std::sqrt(1e5)) << value;
  EXPECT_EQ(mean_of_dim(0.37, false), 0);  // twin: rounding down
}

TEST(fixed_sum, is_exact_where_a_double_is) {
  for (double value : {1.0, 0x1p52 + 1, 0x1.8p53, 0x1.fffffffffffffp109, 12345.0}) {
    Units units;
    EXPECT_TRUE(to_units(value, 1, 0, units));
    EXPECT_EQ(from_units(units, 1), value);
  }
  Units units;
  for (double value : {-1.0, 0x1p110, std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_FALSE(to_units(value, 1, 0, units)) << value;
}

TEST(film, does_not_depend_on_the_order_of_contributions) {
  const std::vector<double> values{1e-6, 3.7, 123.4, 0.001, 7e5};
  Film a(1, 1, 10), b(1, 1, 10);
  for (size_t i = 0; i < values.size(); ++i) {
    EXPECT_TRUE(a.add(0, 0, grey(values[i]), i, i));
    const size_t j = values.size() - 1 - i;
    EXPECT_TRUE(b.add(0, 0, grey(values[j]), j, j));
  }
  EXPECT_EQ(a.sums(), b.sums());
  EXPECT_NEAR(a.sums()[0].x, 700127.101001, 1e-9);
}

TEST(film, a_dark_room_beside_a_bright_one_keeps_its_digits) {
  Film film(2, 1, 1e6);
  for (uint64_t i = 0; i < 1000; ++i) {
    film.add(0, 0, grey(1e-6), mix64(i), i);
    film.add(1, 0, grey(1e9), mix64(i + 1000), i);
  }
  EXPECT_NEAR(film.sums()[0].x, 1e-3, 1e-9);
  EXPECT_EQ(film.sums()[1].x, 1e12);
}

TEST(film, holds_contributions_from_close_to_the_camera_and_refuses_larger_ones) {
  Film film(1, 1, 1);
  EXPECT_TRUE(film.add(0, 0, grey(0x1p45), 0, 0));
  EXPECT_TRUE(film.add(0, 0, grey(0x1p45), 0, 0));
  EXPECT_TRUE(film.add(0, 0, grey(0x1p13), 0, 0));
  EXPECT_FALSE(film.add(0, 0, grey(1e30), 0, 0));
  EXPECT_FALSE(film.add(0, 0, grey(-1), 0, 0));
  EXPECT_EQ(film.sums()[0].x, 0x1p46 + 0x1p13);
}

TEST(film, knows_its_samples) {
  Film film(1, 1, 1);
  for (const SampleRange& r : {SampleRange{4, 2}, {0, 2}, {8, 1}, {2, 2}}) film.complete(r);
  EXPECT_EQ(film.ranges(), (std::vector<SampleRange>{{0, 6}, {8, 1}}));
  EXPECT_EQ(film.samples(), 7u);
  EXPECT_THROW(film.complete({5, 1}), std::invalid_argument);
  EXPECT_THROW(film.complete({7, 2}), std::invalid_argument);
  EXPECT_EQ(film.samples(), 7u);
}

TEST(film, says_what_memory_its_sums_take) {
  for (const Film::Options& options :
       {Film::Options(), Film::Options{{"camera", "", "light"}, false, false},
        Film::Options{{}, true, false}, Film::Options{{"camera"}, true, true}}) {
    Film pixel(1, 1, 1, options);
    size_t bytes = 0;
    for (const Film::Numbers& n : pixel.numbers()) bytes += n.each * n.bytes;
    EXPECT_EQ(options.bytes_of_pixel(), bytes);
  }
  EXPECT_EQ(Film::Options().bytes_of_pixel(), 48u);
}

TEST(film, merges_with_films_of_the_same_picture_only) {
  Film::Options other;
  other.layers = {"camera"};
  Film film(2, 1, 1), stranger(2, 1, 1, other), small(1, 1, 1), brighter(2, 1, 8), same(2, 1, 1);
  film.complete({0, 2});
  same.complete({1, 2});
  for (const Film* bad : {&stranger, &small, &brighter, &same})
    EXPECT_THROW(film.merge(*bad), std::invalid_argument);
  EXPECT_EQ(film.ranges(), (std::vector<SampleRange>{{0, 2}}));
}

TEST(film, counts_what_rays_meet_and_merges_it) {
  Film::Options transparent;
  transparent.alpha = true;
  Film film(2, 1, 1, transparent), other(2, 1, 1, transparent), opaque(2, 1, 1);
  EXPECT_TRUE(opaque.alpha().empty());
  film.meet(0, 0);
  film.complete({0, 1});
  EXPECT_EQ(film.alpha(), (std::vector<float>{1, 0}));
  other.meet(0, 0);
  other.meet(1, 0);
  other.complete({1, 3});
  film.merge(other);
  EXPECT_EQ(film.alpha(), (std::vector<float>{0.5f, 0.25f}));
  EXPECT_THROW(film.merge(opaque), std::invalid_argument);
  film.clear();
  EXPECT_EQ(film.alpha(), (std::vector<float>{0, 0}));
}

TEST(film, has_two_halves_whichever_samples_are_there) {
  Film film(1, 1, 1, {.halves = true}), later(1, 1, 1, {.halves = true}), plain(1, 1, 1);
  for (const uint64_t s : {1, 2}) film.add(0, 0, grey(static_cast<double>(s)), 0, s);
  for (const uint64_t s : {4, 5, 6}) later.add(0, 0, grey(static_cast<double>(s)), 0, s);
  film.complete({1, 2});
  later.complete({4, 3});
  film.merge(later);
  EXPECT_EQ(film.half(0).pixels, std::vector<Rgb>{Rgb(4)});
  EXPECT_EQ(film.half(1).pixels, std::vector<Rgb>{Rgb(3)});
  EXPECT_EQ(film.picture().pixels, std::vector<Rgb>{Rgb(18.0f / 5)});
  EXPECT_DOUBLE_EQ(film.variance()[0], 1.0 * 3 * 2 / 25);
  EXPECT_THROW(film.merge(plain), std::invalid_argument);
  film.clear();
  EXPECT_EQ(film.half(1).pixels, std::vector<Rgb>{Rgb(0)});
  film.add(0, 0, grey(1), 0, 2);
  film.complete({2, 1});
  EXPECT_EQ(film.half(0).pixels, std::vector<Rgb>{Rgb(1)});
  EXPECT_EQ(film.half(1).pixels, std::vector<Rgb>{Rgb(0)});
  EXPECT_EQ(film.variance()[0], 0);
}

TEST(film, spreads_its_variance_over_5_x_5_pixels) {
  Film film(7, 6, 1, {.halves = true});
  film.add(0, 0, grey(2), 0, 0);
  film.complete({0, 2});
  const std::vector<double> variance = film.variance();
  EXPECT_DOUBLE_EQ(variance[0], 1.0 / 9);
  EXPECT_DOUBLE_EQ(variance[1], 1.0 / 12);
  EXPECT_DOUBLE_EQ(variance[7 * 2 + 2], 1.0 / 25);
  EXPECT_EQ(variance[3], 0);
  EXPECT_EQ(variance[7 * 3], 0);
}

// The variance that pictures tell of themselves / the variance of their means. `share`: of the odd
// samples that repeat the even one before, a fault.
double ratio_of_variances(double share, double scale = 1) {
  constexpr int kPictures = 1000, kSamples = 7;
  double told = 0, sum = 0, square = 0;
  for (uint64_t p = 0; p < kPictures; ++p) {
    Film film(1, 1, 1, {.halves = true});
    for (uint64_t s = 0; s < kSamples; ++s) {
      const bool repeats = s % 2 == 1 && Rng(2, p, s).uniform() < share;
      const double u = Rng(1, p, repeats ? s - 1 : s).uniform();
      film.add(0, 0, grey(scale * (u < 0.1 ? 10 : u)), mix64(s), s);
    }
    film.complete({0, kSamples});
    const double mean = film.sums()[0].x / kSamples;
    told += film.variance()[0] / kPictures;
    sum += mean / kPictures;
    square += mean * mean / kPictures;
  }
  return told / (square - sum * sum);
}
TEST(film, tells_its_variance) {
  for (double scale : {1e-7, 1.0, 1e9}) EXPECT_NEAR(ratio_of_variances(0, scale), 1, 0.2) << scale;
  EXPECT_LT(ratio_of_variances(0.3), 0.8);  // twin: halves that share samples
}

}  // namespace tdpt::film_test
