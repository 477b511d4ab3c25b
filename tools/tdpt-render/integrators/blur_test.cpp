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

class blurred : public ::testing::Test {
 protected:
  blurred() { world_.blur = strong_blur(camera_); }

  // Blocks of 4 x 4 pixels.
  static std::vector<double> blocks_of(const Picture& picture) {
    std::vector<double> blocks(static_cast<size_t>(kWidth / 4 * (kHeight / 4)));
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        blocks[static_cast<size_t>(y / 4 * (kWidth / 4) + x / 4)] +=
            luminance(picture.pixels[static_cast<size_t>(y * kWidth + x)]) / 16;
    return blocks;
  }
  static Picture picture(const World& world, const Integrator& integrator, uint64_t spp,
                         uint64_t seed) {
    RenderSettings settings;
    settings.spp = spp;
    settings.seed = seed;
    settings.max_depth = 4;
    settings.quiet = true;
    return render(world, integrator, settings).picture;
  }
  testing::BlockRuns rendered_by(const Integrator& integrator, uint64_t spp) const {
    testing::BlockRuns runs;
    for (size_t r = 0; r < kRuns; ++r)
      runs.add(blocks_of(picture(world_, integrator, spp, testing::fresh(100 + r))));
    return runs;
  }
  // Each run: the mean of sharp pictures for `blur`, by nee.
  testing::BlockRuns mean_of_sharp(const CameraBlur& blur) const {
    constexpr int kEach = 3;  // by number
    World sharp(scene_, camera_, kWidth, kHeight, {});
    testing::BlockRuns runs;
    for (size_t r = 0; r < kRuns; ++r) {
      std::vector<double> sum(blocks_of({kWidth, kHeight, std::vector<Rgb>(kWidth * kHeight)}));
      for (int i = 0; i < kEach * kEach * kEach; ++i) {
        Rng rng(testing::fresh(r), 7, static_cast<uint64_t>(i));
        const auto in = [&](int part) { return (part % kEach + rng.uniform()) / kEach; };
        const double u = in(i), v = in(i / kEach), time = in(i / kEach / kEach);
        sharp.film = blur.draw(world_.film, u, v, time);
        const auto one = blocks_of(
            picture(sharp, nee, 1, testing::fresh(1000 + r * 100 + static_cast<size_t>(i))));
        for (size_t b = 0; b < sum.size(); ++b) sum[b] += one[b] / (kEach * kEach * kEach);
      }
      runs.add(sum);
    }
    return runs;
  }

  const Scene scene_ = below_a_glowing_ceiling();
  const Camera camera_ = scene_.camera("");
  World world_{
      scene_, camera_, kWidth, kHeight, {rectangle({-0.8, 0.9, -0.8}, {1.6, 0, 0}, {0, 0, 1.6})}};
};

TEST_F(blurred, all_integrators_agree) {
  expect_agreement(world_, {&pt, &nee, &tdpt_org, &tdpt_ref, &tdpt_guided}, {.runs = 32, .spp = 4});
}

TEST_F(blurred, the_picture_is_the_mean_of_sharp_ones) {
  const testing::BlockRuns mean = mean_of_sharp(world_.blur);
  for (const Integrator* integrator : {&pt, &bdpt, &tdpt_guided}) {
    const testing::BlockRuns runs = rendered_by(*integrator, 16);
    EXPECT_TRUE(
        testing::holds(testing::compare(runs, mean), integrator->name, runs, mean, kWidth / 4));
  }
  // Twins: other blurs are told apart.
  const testing::BlockRuns runs = rendered_by(bdpt, 16);
  const auto differs = [&](const CameraBlur& blur) {
    return !testing::compare(runs, mean_of_sharp(blur)).holds();
  };
  EXPECT_TRUE(differs({}));
  EXPECT_TRUE(differs(strong_blur(camera_, 0.06, 0)));  // no motion
  EXPECT_TRUE(differs(strong_blur(camera_, 0)));        // no lens
}

TEST_F(blurred, splats_of_another_place_of_the_lens_are_caught) {
  const DepthRuns reference = render_runs(world_, bdpt, {.runs = 32, .spp = 8});
  Variant off(tdpt_org);
  // What its own eye does not see, the one in the middle might, and the other way round.
  off.loses = [](const World& world, const Contribution& found) {
    const Path& path = found.path;
    double x, y;
    return found.strategy == Strategy{Technique::light, path.k()} &&
           !world.film.raster(between(path.vertex(path.k()), path.vertex(path.k() - 1)).w, x, y);
  };
  EXPECT_FALSE(judge(render_runs(world_, off, {.runs = 32, .spp = 4}), reference).holds());
}

TEST(blurred_furnace, shows_the_same_everywhere) {
  const Scene scene = [] {
    Scene furnace = read_gltf(furnace_path());
    for (Material& m : furnace.materials) m.base_color = Rgb(0.9f);
    return furnace;
  }();
  World world(scene, scene.camera(""), 16, 12, {portal_in_the_furnace()});
  world.blur = strong_blur(scene.camera(""));
  for (const Integrator* integrator : integrators()) {
    const MeanAndError r = rendered(world, *integrator, 8);
    std::printf("%-11s %8.4f +- %.4f\n", integrator->name, r.mean, r.error);
    EXPECT_LT(r.z(10), 5) << integrator->name;
    EXPECT_LT(r.error, 0.01 * r.mean) << integrator->name;
  }
}

}  // namespace tdpt::blur_test
