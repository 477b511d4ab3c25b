#include "tools/tdpt-render/run/features.h"

#include <cmath>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "libcommon/base/error.h"
#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/run/arguments.h"
#include "tools/tdpt-render/run/render.h"
#include "tools/tdpt-render/testing/renderer.h"
#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::features_test {

constexpr int kWidth = 32, kHeight = 24;

const std::vector<std::string> kAll{"albedo", "normal", "position", "depth"};

class seen : public ::testing::Test {
 protected:
  // Value at pixel (x, y).
  Vec3d three(const std::string& name, const char* parts, int x, int y) const {
    Vec3d v;
    for (int c = 0; c < 3; ++c) v[c] = at(name + "." + parts[c], x, y);
    return v;
  }
  double at(const std::string& channel, int x, int y) const {
    return static_cast<double>(
        channels_.at(channel)[static_cast<size_t>(y) * kWidth + static_cast<size_t>(x)]);
  }

  const Scene scene_ = read_gltf(two_rooms_path());
  const World world_{scene_, scene_.camera(""), kWidth, kHeight, {}};
  const Channels channels_ = features(world_, kAll, 1);
};

TEST_F(seen, from_the_camera_lies_behind_its_pixel_at_its_depth) {
  const FilmPlane& film = world_.film;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const Vec3d p = scene_.frame.to_canonical(three("position", "XYZ", x, y));
      const Vec3d away = p - film.position();
      double u, v;
      ASSERT_TRUE(film.raster(normalize(away), u, v));
      // In a pixel that sees a corner the mean is slightly off.
      EXPECT_NEAR(u, x + 0.5, 1) << x << ' ' << y;
      EXPECT_NEAR(v, y + 0.5, 1) << x << ' ' << y;
      EXPECT_NEAR(at("depth.Z", x, y), dot(away, film.forward()) / scene_.frame.scale, 1e-5);
    }
}

TEST_F(seen, surfaces_have_their_normals_and_albedos) {
  int whole = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const Vec3d n = three("normal", "XYZ", x, y);
      EXPECT_LT(length(n), 1 + 1e-6);
      if (length(n) < 1 - 1e-6) continue;  // a corner
      ++whole;
      // The ray through the centre hits the same wall.
      const Vec3d w = world_.film.direction(x + 0.5, y + 0.5);
      Hit hit;
      ASSERT_TRUE(world_.tracer.closest({world_.film.position()}, w, hit));
      EXPECT_LT(dot(n, w), 0);
      EXPECT_NEAR(std::abs(dot(n, hit.normal)), 1, 1e-6);
      const Vec3d albedo = three("albedo", "RGB", x, y);
      EXPECT_GE(albedo.x, 0);
      EXPECT_LE(max_component(Rgb(Vec3f(albedo))), 1.0f + 1e-6f);
    }
  EXPECT_GT(whole, kWidth * kHeight / 2);
  // The wall straight ahead has one material.
  const Vec3d w = world_.film.direction(2.5, 12.5);
  Hit hit;
  ASSERT_TRUE(world_.tracer.closest({world_.film.position()}, w, hit));
  const Vec3d base(scene_.material_of(hit.triangle).base_color),
      albedo = three("albedo", "RGB", 2, 12);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(albedo[c], base[c], 1e-6);
}

TEST_F(seen, nothing_is_black_and_far) {
  Camera away = scene_.camera("");
  away.position = away.position + away.forward * 100;
  const World outside(scene_, away, 4, 3, {});
  const Channels none = features(outside, kAll, 1);
  EXPECT_EQ(none.at("depth.Z"), std::vector<float>(12, 1e10f));
  for (const char* name : {"albedo.R", "normal.X", "position.Z"})
    EXPECT_EQ(none.at(name), std::vector<float>(12)) << name;
}

TEST_F(seen, depends_on_no_thread_and_on_nothing_else_that_is_asked_for) {
  tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(features(world_, kAll, 1), channels_);
  const Channels depth = features(world_, {"depth"}, 1);
  EXPECT_EQ(depth.size(), 1u);
  EXPECT_EQ(depth.at("depth.Z"), channels_.at("depth.Z"));
  EXPECT_TRUE(features(world_, {"variance"}, 1).empty());
}

TEST(aov, names_are_known_or_refused) {
  Arguments a;
  EXPECT_TRUE(aovs_of(a).empty());
  a.aov = "depth,albedo,depth";
  EXPECT_EQ(aovs_of(a), (std::vector<std::string>{"albedo", "depth"}));
  a.aov = "all";
  EXPECT_EQ(aovs_of(a).size(), 6u);
  for (const char* bad : {"depht", "all,depth", ",", "depth,,albedo", " depth"}) {
    a.aov = bad;
    EXPECT_THROW(aovs_of(a), UsageError) << bad;
  }
}

// Variance reported by a film over that seen among pictures of other seeds. `share`: a planted
// fault, a factor on the reported variance.
double told_over_seen_variance(double share) {
  const Scene scene = read_gltf(two_rooms_path());
  const World world(scene, scene.camera(""), 12, 9, {portal_in_the_hole()});
  RenderSettings settings;
  settings.spp = 8;
  settings.variance = true;
  constexpr uint64_t kPictures = 48;
  std::vector<double> sum(108), square(108);
  double told = 0, seen = 0;
  for (uint64_t seed = 1; seed <= kPictures; ++seed) {
    settings.seed = seed;
    const RenderResult r = render(*renderer_under_test(world), bdpt, settings);
    const std::vector<double> variance = r.render_state->film.variance();
    for (size_t i = 0; i < 108; ++i) {
      const auto y = static_cast<double>(luminance(r.picture.pixels[i]));
      sum[i] += y, square[i] += y * y;
      told += share * variance[i] / kPictures;
    }
  }
  for (size_t i = 0; i < 108; ++i)
    seen += (square[i] - sum[i] * sum[i] / kPictures) / (kPictures - 1);
  return told / seen;
}
TEST(aov, variance_is_that_of_pictures_of_other_seeds) {
  // Not below 1, and above where the samples of a pixel are stratified.
  const double told = told_over_seen_variance(1);
  EXPECT_GT(told, 0.75);
  EXPECT_LT(told, 4);
  EXPECT_LT(told_over_seen_variance(0.25), 0.75);  // twin
}

}  // namespace tdpt::features_test
