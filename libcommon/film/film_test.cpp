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
    EXPECT_TRUE(a.add(0, 0, grey(values[i]), i));
    const size_t j = values.size() - 1 - i;
    EXPECT_TRUE(b.add(0, 0, grey(values[j]), j));
  }
  EXPECT_EQ(a.sums(), b.sums());
  EXPECT_NEAR(a.sums()[0].x, 700127.101001, 1e-9);
}

TEST(film, a_dark_room_beside_a_bright_one_keeps_its_digits) {
  Film film(2, 1, 1e6);
  for (uint64_t i = 0; i < 1000; ++i) {
    film.add(0, 0, grey(1e-6), mix64(i));
    film.add(1, 0, grey(1e9), mix64(i + 1000));
  }
  EXPECT_NEAR(film.sums()[0].x, 1e-3, 1e-9);
  EXPECT_EQ(film.sums()[1].x, 1e12);
}

TEST(film, holds_contributions_from_close_to_the_camera_and_refuses_larger_ones) {
  Film film(1, 1, 1);
  EXPECT_TRUE(film.add(0, 0, grey(0x1p45), 0));
  EXPECT_TRUE(film.add(0, 0, grey(0x1p45), 0));
  EXPECT_TRUE(film.add(0, 0, grey(0x1p13), 0));
  EXPECT_FALSE(film.add(0, 0, grey(1e30), 0));
  EXPECT_FALSE(film.add(0, 0, grey(-1), 0));
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

// Variance of the means of many pictures / the variance that each estimates for itself.
double ratio_of_variances(double fault, double scale = 1) {
  constexpr int kPictures = 400, kBlocks = 8;
  double said = 0, sum = 0, square = 0;
  for (uint64_t p = 0; p < kPictures; ++p) {
    Film::Options options;
    options.error_block = 2;
    Film film(1, 1, 1, options);
    for (uint64_t b = 0; b < kBlocks; ++b) {
      for (uint64_t s = 2 * b; s < 2 * b + 2; ++s) {
        Rng rng(1, p, s);
        const double u = rng.uniform();
        film.add(0, 0, grey(scale * (u < 0.1 ? 10 : u)), mix64(s));
      }
      film.complete({2 * b, 2});
    }
    const double mean = film.sums()[0].x / (2 * kBlocks);
    said += film.variance()[0] / kPictures * fault;
    sum += mean / kPictures;
    square += mean * mean / kPictures;
  }
  return said / (square - sum * sum);
}
TEST(film, tells_its_variance) {
  // At power 1: blocks as dark as a shadow and as bright as a small lamp.
  for (double scale : {1e-7, 1e-3, 1.0, 1e5})
    EXPECT_NEAR(ratio_of_variances(1, scale), 1, 0.2) << scale;
  EXPECT_GT(std::abs(ratio_of_variances(2) - 1), 0.2);  // twin: variance of single samples
  EXPECT_EQ(ratio_of_variances(1, 1e9), std::numeric_limits<double>::infinity());
}

}  // namespace tdpt::film_test
