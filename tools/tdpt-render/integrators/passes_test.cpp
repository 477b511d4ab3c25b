// Samples that share a cache of light walks are in pixels far apart.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tools/tdpt-render/testing/agreement.h"
#include "tools/tdpt-render/testing/rendering.h"
#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::passes_test {

constexpr int kWidth = 128, kHeight = 96;
constexpr uint64_t kPictures = 24;

using Luminance = std::vector<double>;  // of a picture, row by row

// Largest mean product of the deviations of two pixels of a column, up to 16 rows apart, in
// standard deviations; outliers are clamped to 3 of them.
double correlation_down_columns(const std::vector<Luminance>& pictures) {
  const size_t pixels = pictures[0].size();
  std::vector<Luminance> off = pictures;
  const auto n = static_cast<double>(pictures.size());
  for (size_t k = 0; k < pixels; ++k) {
    double mean = 0, squares = 0;
    for (const Luminance& p : pictures) mean += p[k] / n;
    for (const Luminance& p : pictures) squares += (p[k] - mean) * (p[k] - mean) / n;
    for (size_t i = 0; i < pictures.size(); ++i)
      off[i][k] =
          squares > 0 ? std::clamp((pictures[i][k] - mean) / std::sqrt(squares), -3.0, 3.0) : 0;
  }
  double most = 0;
  for (size_t rows = 1; rows <= 16; ++rows) {
    const size_t apart = rows * kWidth;
    double sum = 0;
    for (const Luminance& z : off)
      for (size_t k = apart; k < pixels; ++k) sum += z[k] * z[k - apart];
    most = std::max(most, sum / (n * static_cast<double>(pixels - apart)));
  }
  return most;
}

class Caches : public ::testing::Test {
 protected:
  const Scene scene_ = read_gltf(two_rooms_path());
  const Vista vista_{scene_, scene_.camera(""), kWidth, kHeight, {portal_in_the_hole()}};
};

TEST_F(Caches, leave_no_trace_down_the_columns_of_a_picture) {
  std::vector<Luminance> pictures;
  for (uint64_t seed = 1; seed <= kPictures; ++seed) {
    Job settings;
    settings.limits.spp = 1;
    settings.seed = seed;
    Luminance picture;
    for (const Rgb& p : render(vista_, tdpt_guided, settings).picture.pixels)
      picture.push_back(luminance(p));
    pictures.push_back(picture);
  }
  EXPECT_LT(correlation_down_columns(pictures), 0.03);
}

// Twin: a cache's pixels are 192 apart, the number of caches, so they lie in two columns.
TEST_F(Caches, twin_pixels_evenly_apart_are_caught) {
  Variant variant = Variant::cached(vista_, tdpt_guided, 6);
  variant.pixel = [](uint64_t cache, uint64_t i, uint64_t caches, uint64_t) {
    return cache + i * caches;
  };
  AgreementSettings settings;
  settings.spp = 1;
  settings.max_depth = 6;
  std::vector<Luminance> pictures(kPictures);
  tbb::parallel_for(uint64_t{0}, kPictures, [&](uint64_t i) {
    Tally tally;
    pictures[i].resize(size_t{kWidth} * kHeight);
    for (const Luminance& of_length : render_by_depth(vista_, variant, settings, i + 1, tally))
      for (size_t k = 0; k < of_length.size(); ++k) pictures[i][k] += of_length[k];
  });
  EXPECT_GT(correlation_down_columns(pictures), 0.06);
}

}  // namespace tdpt::passes_test
