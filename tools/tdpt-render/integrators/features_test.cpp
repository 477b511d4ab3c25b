#include "tools/tdpt-render/integrators/features.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "libcommon/base/error.h"
#include "tools/tdpt-render/run/options.h"
#include "tools/tdpt-render/testing/blur.h"
#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/sheets.h"

namespace tdpt::features_test {

constexpr int kWidth = 32, kHeight = 24;

const std::vector<std::string> kAll{"albedo", "normal", "position", "depth"};

class seen : public ::testing::Test {
 protected:
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
  const Vista vista_{scene_, scene_.camera(""), kWidth, kHeight, {}};
  const Channels channels_ = features(vista_, kAll, 1);
};

TEST_F(seen, from_the_camera_lies_behind_its_pixel_at_its_depth) {
  const FilmPlane& film = vista_.view.film;
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
      const Vec3d n = three("normal", "XYZ", x, y), albedo = three("albedo", "RGB", x, y);
      EXPECT_LT(length(n), 1 + 1e-6);
      if (length(n) < 1 - 1e-6) continue;  // a corner
      ++whole;
      // The ray through the centre hits the same wall.
      const Vec3d w = vista_.view.film.direction(x + 0.5, y + 0.5);
      Hit hit;
      ASSERT_TRUE(vista_.world->tracer.closest({vista_.view.film.position()}, w, hit));
      EXPECT_LT(dot(n, w), 0);
      EXPECT_NEAR(std::abs(dot(n, hit.normal)), 1, 1e-6);
      EXPECT_GE(albedo.x, 0);
      EXPECT_LE(max_component(albedo), 1 + 1e-6);
      if (x != 2 || y != 12) continue;  // straight ahead, of one material
      const Vec3d base(scene_.material_of(hit.triangle).base_color);
      EXPECT_LT(length(albedo - base), 1e-6);
    }
  EXPECT_GT(whole, kWidth * kHeight / 2);
}

// By as much as the mean of what is seen from places on the lens at moments of the exposure.
TEST_F(seen, by_a_lens_that_moves_is_blurred_like_the_picture) {
  Vista vista(scene_, scene_.camera(""), kWidth, kHeight, {});
  constexpr size_t kAcross = kWidth / 4;
  const auto blocks = [&] {  // of 4 x 4 pixels
    std::vector<double> sums(kAcross * (kHeight / 4));
    const Channels all = features(vista, {"albedo"}, 1);
    for (size_t i = 0; i < size_t{kWidth} * kHeight; ++i)
      sums[i / kWidth / 4 * kAcross + i % kWidth / 4] +=
          static_cast<double>(all.at("albedo.R")[i]) / 16;
    return sums;
  };
  const CameraBlur blur = strong_blur(scene_.camera(""));
  const std::vector<double> sharp = blocks();
  vista.view.blur = blur;
  const std::vector<double> blurred = blocks();
  vista.view.blur = {};
  std::vector<double> mean(sharp.size());
  constexpr int kDraws = 100;
  for (int i = 0; i < kDraws; ++i) {
    Rng rng(5, 0, static_cast<uint64_t>(i));
    const double u = rng.uniform();
    const double v = rng.uniform();
    vista.view.film = blur.draw(vista_.view.film, u, v, (i + 0.5) / kDraws);
    const std::vector<double> one = blocks();
    for (size_t b = 0; b < mean.size(); ++b) mean[b] += one[b] / kDraws;
  }
  double most = 0, twin = 0;
  for (size_t b = 0; b < mean.size(); ++b) {
    most = std::max(most, std::abs(blurred[b] - mean[b]));
    twin = std::max(twin, std::abs(sharp[b] - mean[b]));
  }
  EXPECT_LT(most, 0.03);
  EXPECT_GT(twin, 0.05);
}

TEST_F(seen, nothing_is_black_and_far) {
  Camera away = scene_.camera("");
  away.position = away.position + away.forward * 100;
  const Channels none = features(Vista(scene_, away, 4, 3, {}), kAll, 1);
  EXPECT_EQ(none.at("depth.Z"), std::vector<float>(12, 1e10f));
  for (const char* name : {"albedo.R", "normal.X", "position.Z"})
    EXPECT_EQ(none.at(name), std::vector<float>(12)) << name;
}

TEST_F(seen, depends_on_no_thread_and_on_nothing_else_that_is_asked_for) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(features(vista_, kAll, 1), channels_);
  EXPECT_EQ(features(vista_, {"depth"}, 1), (Channels{{"depth.Z", channels_.at("depth.Z")}}));
  EXPECT_TRUE(features(vista_, {"variance"}, 1).empty());
}

// Sheets across the view and beside it. The camera looks along -z; at z = 0 it sees a sheet or a
// slab, upright or turned by 45 degrees, so that reflection leads to +x.
class through : public ::testing::Test {
 protected:
  static constexpr double kHalf = 0.3;  // half the width of sheets [m]
  // Albedos of the wall behind what is looked at, and of that to which it reflects.
  const Vec3d behind_{0.8, 0.4, 0.2}, beside_{0.1, 0.3, 0.6};

  through() {
    scene_ = read_gltf(furnace_path());
    scene_.triangles.clear();
    add(plain(behind_), {0, 1, -0.8}, {1, 0, 0}, 0.9);
  }
  static Material plain(const Vec3d& colour) {
    Material m;
    m.base_color = Rgb(Vec3f(colour));
    return m;
  }
  static Material metal(float roughness) {
    Material m = plain({0.9, 0.7, 0.5});
    m.plain = false;
    m.metallic = 1;
    m.roughness = roughness;
    return m;
  }
  /// Of index 2.4; coloured, and so not one that rays pass [scene.h].
  static Material tinted_pane() {
    Material m = clear_pane();
    m.base_color = Rgb(1, 1, 0.999f);
    m.ior = 2.4f;
    return m;
  }
  /// An upright sheet about `centre` [m]; its normal is cross(u, y).
  void add(const Material& m, const Vec3d& centre, const Vec3d& u, double half = kHalf) {
    const Vec3d y(0, 1, 0);
    scene_ = with_sheet(scene_, m, centre - u * half - y * half, u * (2 * half), y * (2 * half));
  }
  /// What is looked at, turned so that its reflection is the wall beside.
  void add_turned(const Material& m) {
    add(m, {0, 1, 0}, normalize(Vec3d(1, 0, -1)));
    add(plain(beside_), {0.8, 1, 0}, {0, 0, 1});
  }
  /// A slab of glass 0.1 m thick; the wall that it reflects is behind the camera.
  void add_slab(const Material& m) {
    add(m, {0, 1, 0.05}, {1, 0, 0});
    add(m, {0, 1, -0.05}, {-1, 0, 0});
    add(plain(beside_), {0, 1, 0.95}, {1, 0, 0});
  }

  // Means over the picture, and the largest deviation from them.
  struct Means {
    Vec3d albedo, normal, position;
    double depth = 0, spread = 0;
  };
  Means means(uint64_t seed = 1) const {
    Camera camera;
    camera.position = scene_.frame.to_canonical({0, 1, 0.9});
    camera.right = {1, 0, 0}, camera.up = {0, 1, 0}, camera.forward = {0, 0, -1};
    camera.yfov = 1e-3;
    const Vista vista(scene_, camera, kWidth, kHeight, {});
    const Channels all = features(vista, kAll, seed);
    const auto three = [&](const std::string& name, const char* parts, size_t i) {
      Vec3d v;
      for (int c = 0; c < 3; ++c) v[c] = static_cast<double>(all.at(name + "." + parts[c])[i]);
      return v;
    };
    constexpr size_t kPixels = size_t{kWidth} * kHeight;
    Means m;
    for (size_t i = 0; i < kPixels; ++i) {
      m.albedo += three("albedo", "RGB", i) / kPixels;
      m.normal += three("normal", "XYZ", i) / kPixels;
      m.position += three("position", "XYZ", i) / kPixels;
      m.depth += static_cast<double>(all.at("depth.Z")[i]) / kPixels;
    }
    for (size_t i = 0; i < kPixels; ++i)
      m.spread = std::max({m.spread, length(three("albedo", "RGB", i) - m.albedo),
                           length(three("normal", "XYZ", i) - m.normal)});
    return m;
  }
  static bool shows(const Means& m, const Vec3d& albedo, const Vec3d& normal, double tolerance) {
    return length(m.albedo - albedo) < tolerance && length(m.normal - normal) < tolerance;
  }

  Scene scene_;
};

const Vec3d kTowardsCamera{0, 0, 1}, kFromBeside{-1, 0, 0};
const Vec3d kTurned = normalize(Vec3d(1, 0, 1));
/// Reflectance at 45 degrees for index 2.4: Fresnel's and Schlick's.
constexpr double kFresnel = 0.17882, kSchlick = 0.17134;

TEST_F(through, a_mirror_shows_what_it_reflects_tinted) {
  const Vec3d tint = Vec3d(0.9, 0.7, 0.5) + Vec3d(0.1, 0.3, 0.5) * std::pow(1 - std::sqrt(0.5), 5);
  const auto with = [&](float roughness) {
    scene_.triangles.resize(2);
    add_turned(metal(roughness));
    return means();
  };
  const Means mirror = with(0), rough = with(0.5f);
  EXPECT_TRUE(shows(mirror, tint * beside_, kFromBeside, 1e-3));
  EXPECT_LT(mirror.spread, 1e-3);
  // Twin: a surface at which rays end shows itself.
  EXPECT_FALSE(shows(rough, tint * beside_, kFromBeside, 0.1));
  EXPECT_LT(length(rough.normal - kTurned), 1e-6);
  for (const Means& m : {mirror, rough}) {
    EXPECT_NEAR(m.depth, 0.9, 1e-5);
    EXPECT_LT(length(m.position - Vec3d(0, 1, 0)), 1e-4);
  }
}

TEST_F(through, a_pane_blends_what_it_reflects_and_what_is_behind) {
  const auto blend = [](double reflected, const Vec3d& there, const Vec3d& here) {
    return there * reflected + here * (1 - reflected);
  };
  const Scene empty = scene_;
  // One that rays pass with the probability of transmission, by Schlick's curve.
  Material clear = tinted_pane();
  clear.base_color = Rgb(1);
  add_turned(clear);
  const Means passed = means();
  EXPECT_TRUE(shows(passed, blend(kSchlick, beside_, behind_),
                    blend(kSchlick, kFromBeside, kTowardsCamera), 1e-3));
  // Twin: the pane's own albedo is 1.
  EXPECT_FALSE(shows(passed, blend(kSchlick, Vec3d(1), behind_),
                     blend(kSchlick, kTurned, kTowardsCamera), 0.1));

  scene_ = empty;
  add_turned(tinted_pane());
  const Means lobes = means();
  EXPECT_TRUE(shows(lobes, blend(kFresnel, beside_, behind_),
                    blend(kFresnel, kFromBeside, kTowardsCamera), 1e-3));
  // By chance it would be 0.1. Rays along the border of two triangles meet both.
  for (const Means& m : {passed, lobes}) EXPECT_LT(m.spread, 0.02);
  EXPECT_NEAR(lobes.depth, 0.9, 1e-5);
}

TEST_F(through, solid_glass_refracts_and_tints) {
  Material glass = clear_pane();
  glass.solid = true;
  const Scene empty = scene_;
  add_slab(glass);
  // Two interfaces, with all reflections between them.
  const double f = 0.04, reflected = f + (1 - f) * (1 - f) * f / (1 - f * f);
  const Means slab = means();
  EXPECT_TRUE(shows(slab, beside_ * reflected + behind_ * (1 - reflected),
                    kTowardsCamera * (1 - 2 * reflected), 1e-3));

  // A sheet in its middle is tinted by 0.05 m of glass, and by no n^2.
  scene_ = empty;
  glass.absorption = Rgb(0, 5, 20) * static_cast<float>(1 / scene_.frame.scale);
  add_slab(glass);
  add(plain({0.5, 0.5, 0.5}), {0, 1, 0}, {1, 0, 0});
  const Vec3d tint(1, std::exp(-0.25), std::exp(-1));
  const Means inside = means();
  EXPECT_TRUE(
      shows(inside, beside_ * f + tint * (0.5 * (1 - f)), kTowardsCamera * (1 - 2 * f), 1e-3));
}

TEST_F(through, a_veil_counts_in_proportion) {
  add_turned(metal(0));
  const Means mirror = means();
  add(veil(0.3f), {0, 1, 0.5}, {1, 0, 0});
  const Means veiled = means();
  EXPECT_TRUE(shows(veiled, Vec3d(0.8) * 0.3 + mirror.albedo * 0.7,
                    kTowardsCamera * 0.3 + kFromBeside * 0.7, 1e-3));
  EXPECT_NEAR(veiled.depth, 0.3 * 0.4 + 0.7 * 0.9, 1e-3);
}

TEST_F(through, a_lamp_shows_its_albedo_and_is_not_passed) {
  add_turned(metal(0));
  const Means dark = means();
  for (Material& m : scene_.materials)
    if (m.plain) m.emission = Rgb(3);
  const Means lit = means();
  EXPECT_EQ(lit.albedo, dark.albedo);
  EXPECT_EQ(lit.normal, dark.normal);
  for (Material& m : scene_.materials) m.emission = Rgb(3);
  EXPECT_LT(length(means().normal - kTurned), 1e-6);
}

TEST_F(through, nothing_behind_mirrors_is_black_with_their_normal) {
  // Into the open.
  add(metal(0), {0, 1, 0}, normalize(Vec3d(1, 0, -1)));
  const Means open = means();
  EXPECT_TRUE(shows(open, {}, kTurned, 1e-6));
  EXPECT_NEAR(open.depth, 0.9, 1e-5);
  EXPECT_LT(length(open.position - Vec3d(0, 1, 0)), 1e-4);
  // Between two mirrors for ever.
  scene_.triangles.resize(2);
  add(metal(0), {0, 1, 0}, {1, 0, 0});
  add(metal(0), {0, 1, 0.95}, {1, 0, 0});
  EXPECT_TRUE(shows(means(), {}, kTowardsCamera, 1e-6));
}

TEST(aov, names_are_known_or_refused) {
  RenderArguments a;
  a.aov = "depth,albedo,depth";
  EXPECT_EQ(aovs_of(a), (std::vector<std::string>{"albedo", "depth"}));
  a.aov = "all";
  EXPECT_EQ(aovs_of(a).size(), 7u);
  for (const char* bad : {"depht", "all,depth", "depth,,albedo"}) {
    a.aov = bad;
    EXPECT_THROW(aovs_of(a), UsageError) << bad;
  }
}

}  // namespace tdpt::features_test
