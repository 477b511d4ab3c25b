// A lens and a shutter blur: all integrators show the same picture, which is the mean of the sharp
// pictures seen from places on the lens at moments of the exposure.
#include <gtest/gtest.h>

#include "tools/tdpt-render/testing/agreement.h"
#include "tools/tdpt-render/testing/blur.h"
#include "tools/tdpt-render/testing/means.h"
#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::blur_test {

constexpr int kWidth = 32, kHeight = 24;
constexpr size_t kRuns = 16;

Portal across_the_room() {
  return rectangle({-0.8, 0.9, -0.8}, {1.6, 0, 0}, {0, 0, 1.6});
}

class blurred : public ::testing::Test {
 protected:
  blurred() { vista_.view.blur = strong_blur(camera_); }

  // Blocks of 4 x 4 pixels.
  static std::vector<double> blocks_of(const Picture& picture) {
    std::vector<double> blocks(static_cast<size_t>(kWidth / 4 * (kHeight / 4)));
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        blocks[static_cast<size_t>(y / 4 * (kWidth / 4) + x / 4)] +=
            luminance(picture.pixels[static_cast<size_t>(y * kWidth + x)]) / 16;
    return blocks;
  }
  static Picture picture(const Vista& vista, const Integrator& integrator, uint64_t spp,
                         uint64_t seed) {
    Job settings;
    settings.limits.spp = spp;
    settings.seed = seed;
    settings.max_depth = 4;
    settings.quiet = true;
    return render(vista, integrator, settings).picture;
  }
  testing::BlockRuns rendered_by(const Integrator& integrator, uint64_t spp) const {
    testing::BlockRuns runs;
    for (size_t r = 0; r < kRuns; ++r)
      runs.add(blocks_of(picture(vista_, integrator, spp, testing::fresh(100 + r))));
    return runs;
  }
  // Each run: the mean of sharp pictures for `blur`.
  testing::BlockRuns mean_of_sharp(const CameraBlur& blur, const Integrator& integrator) const {
    constexpr int kEach = 3;  // by number
    Vista sharp(scene_, camera_, kWidth, kHeight, {});
    testing::BlockRuns runs;
    for (size_t r = 0; r < kRuns; ++r) {
      std::vector<double> sum(blocks_of({kWidth, kHeight, std::vector<Rgb>(kWidth * kHeight)}));
      for (int i = 0; i < kEach * kEach * kEach; ++i) {
        Rng rng(testing::fresh(r), 7, static_cast<uint64_t>(i));
        const auto in = [&](int part) { return (part % kEach + rng.uniform()) / kEach; };
        const double u = in(i), v = in(i / kEach), time = in(i / kEach / kEach);
        sharp.view.film = blur.draw(vista_.view.film, u, v, time);
        const auto one = blocks_of(
            picture(sharp, integrator, 1, testing::fresh(1000 + r * 100 + static_cast<size_t>(i))));
        for (size_t b = 0; b < sum.size(); ++b) sum[b] += one[b] / (kEach * kEach * kEach);
      }
      runs.add(sum);
    }
    return runs;
  }

  // Every second triangle is dark.
  static Scene chequered() {
    Scene scene = below_a_glowing_ceiling();
    Material dark = scene.materials[1];
    dark.base_color = Rgb(0.05f);
    scene.materials.push_back(dark);
    for (size_t i = 0; i < scene.triangles.size(); i += 2)
      if (scene.triangles[i].material == 1) scene.triangles[i].material = 2;
    return scene;
  }

  const Scene scene_ = chequered();
  const Camera camera_ = scene_.camera("");
  Vista vista_{scene_, camera_, kWidth, kHeight, {across_the_room()}};
};

// Dark walls would hide long paths from pt.
TEST(blurred_ceiling, is_the_same_by_all_integrators) {
  const Scene scene = below_a_glowing_ceiling();
  Vista vista(scene, scene.camera(""), kWidth, kHeight, {across_the_room()});
  vista.view.blur = strong_blur(scene.camera(""));
  expect_agreement(vista, {&pt, &nee, &tdpt_org, &tdpt_ref, &tdpt_guided}, {.runs = 32, .spp = 4});
}

TEST_F(blurred, the_picture_is_the_mean_of_sharp_ones) {
  const testing::BlockRuns mean = mean_of_sharp(vista_.view.blur, nee);
  for (const Integrator* integrator : {&pt, &bdpt, &tdpt_guided}) {
    const testing::BlockRuns runs = rendered_by(*integrator, 16);
    EXPECT_TRUE(
        testing::holds(testing::compare(runs, mean), integrator->name, runs, mean, kWidth / 4));
  }
  // Twins: other blurs are told apart.
  const testing::BlockRuns runs = rendered_by(bdpt, 16);
  const auto differs = [&](const CameraBlur& blur) {
    return !testing::compare(runs, mean_of_sharp(blur, nee)).holds();
  };
  EXPECT_TRUE(differs({}));
  EXPECT_TRUE(differs(strong_blur(camera_, 0.06, 0)));  // no motion
  EXPECT_TRUE(differs(strong_blur(camera_, 0)));        // no lens
}

// Light vertices projected to the film carry all of this picture, whose walls differ.
TEST_F(blurred, splats_fall_where_their_own_sample_sees_them) {
  const Integrator splats{"splats", 9, {TechniqueSet(Technique::light)}};
  const testing::BlockRuns mean = mean_of_sharp(vista_.view.blur, splats);
  const testing::BlockRuns runs = rendered_by(splats, 64);
  EXPECT_TRUE(testing::holds(testing::compare(runs, mean), "splats", runs, mean, kWidth / 4));
  // Twin: by the film of the middle of lens and exposure.
  testing::BlockRuns faulty;
  for (size_t r = 0; r < kRuns; ++r) {
    Picture by_middle{kWidth, kHeight, std::vector<Rgb>(kWidth * kHeight)};
    constexpr int kSpp = 64;
    const PathObserver observer = [&](const Contribution& found) {
      const Path& path = found.path;
      const Vec3d w = between(path.vertex(path.k()), path.vertex(path.k() - 1)).w;
      double x, y;
      if (!vista_.view.film.raster(w, x, y)) return;
      by_middle.pixels[static_cast<size_t>(static_cast<int>(y) * kWidth + static_cast<int>(x))] +=
          found.value * (1.0f / kSpp);
    };
    Film film(kWidth, kHeight, 1);
    Tally tally;
    const Variant variant(splats);
    PathSampler sampler(vista_, variant.settings(4, testing::fresh(200 + r)), film, tally,
                        &observer);
    variant.picture(sampler, kWidth, kHeight, kSpp, [](int, int) {});
    faulty.add(blocks_of(by_middle));
  }
  EXPECT_FALSE(testing::compare(faulty, mean).holds());
}

TEST(blurred_furnace, shows_the_same_everywhere) {
  const Scene scene = [] {
    Scene furnace = read_gltf(furnace_path());
    for (Material& m : furnace.materials) m.base_color = Rgb(0.9f);
    return furnace;
  }();
  Vista vista(scene, scene.camera(""), 16, 12, {portal_in_the_furnace()});
  vista.view.blur = strong_blur(scene.camera(""));
  for (const Integrator* integrator : integrators()) {
    const MeanAndError r = rendered(vista, *integrator, 8);
    std::printf("%-11s %8.4f +- %.4f\n", integrator->name, r.mean, r.error);
    EXPECT_LT(r.z(10), 5) << integrator->name;
    EXPECT_LT(r.error, 0.01 * r.mean) << integrator->name;
  }
}

}  // namespace tdpt::blur_test
