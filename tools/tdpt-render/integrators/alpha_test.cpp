// A transparent film composited over the sky that it leaves out gives the opaque picture.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "tools/tdpt-render/testing/rendering.h"
#include "tools/tdpt-render/testing/sheets.h"

namespace tdpt::alpha_test {

const Rgb kSky(3, 2, 1);

// Ground with the horizon behind it; on the left a half transparent sheet, on the right a pane.
Scene outdoors() {
  Scene scene;
  Material sheet = veil(0.5f);
  sheet.double_sided = true;
  scene = with_sheet(scene, Material(), {-1, -0.2, 0.5}, {2, 0, 0}, {0, 0, -1.5});
  scene = with_sheet(scene, sheet, {-0.4, -0.3, -1}, {0.3, 0, 0}, {0, 0.5, 0});
  scene = with_sheet(scene, clear_pane(), {0.1, -0.3, -1}, {0.3, 0, 0}, {0, 0.5, 0});
  Camera camera;
  camera.right = {1, 0, 0};
  camera.up = {0, 1, 0};
  camera.forward = {0, 0, -1};
  scene.cameras.push_back(camera);
  scene.sky = std::make_shared<Sky>(Sky::Map{1, 1, {kSky}}, 0);
  return scene;
}

constexpr int kWidth = 32, kHeight = 24;

Picture rendered(const Scene& scene, const Integrator& integrator, bool alpha, uint64_t seed = 1) {
  const Vista vista(scene, scene.camera(""), kWidth, kHeight, {});
  Job settings;
  settings.limits.spp = 16;
  settings.seed = seed;
  settings.alpha = alpha;
  return render(vista, integrator, settings).picture;
}

// Largest difference, once over the sky, from a picture that includes it.
float off_the_opaque(const Picture& transparent, const Picture& opaque) {
  float most = 0;
  for (size_t i = 0; i < opaque.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c)
      most = std::max(most, std::abs(transparent.pixels[i][c] +
                                     (1 - transparent.alpha[i]) * kSky[c] - opaque.pixels[i][c]));
  return most;
}

TEST(Alpha, OverTheSkyItIsTheOpaquePicture) {
  const Scene scene = outdoors();
  for (const Integrator* integrator : {&pt, &nee, &bdpt}) {
    const Picture p = rendered(scene, *integrator, true);
    ASSERT_EQ(p.alpha.size(), p.pixels.size());
    const Picture opaque = rendered(scene, *integrator, false);
    EXPECT_TRUE(opaque.alpha.empty());
    EXPECT_LT(off_the_opaque(p, opaque), 1e-5f) << integrator->name;
    // Twin: of other samples.
    EXPECT_GT(off_the_opaque(p, rendered(scene, *integrator, false, 2)), 0.1f);
  }
}

TEST(Alpha, IsTheShareOfRaysThatMeetSomething) {
  Scene scene = outdoors();
  const Picture p = rendered(scene, bdpt, true);
  const auto alpha_at = [&](int x, int y) { return p.alpha[static_cast<size_t>(y * kWidth + x)]; };
  EXPECT_EQ(alpha_at(0, 0), 0);
  EXPECT_EQ(p.pixels[0], Rgb(0));
  EXPECT_EQ(alpha_at(kWidth / 2, kHeight - 1), 1);
  const auto mean = [&](int x0, int x1) {
    float sum = 0;
    for (int y = 9; y < 11; ++y)
      for (int x = x0; x < x1; ++x) sum += alpha_at(x, y);
    return sum / static_cast<float>(2 * (x1 - x0));
  };
  EXPECT_NEAR(mean(7, 12), 0.5f, 0.2f);     // the sheet
  EXPECT_NEAR(mean(21, 25), 0.04f, 0.05f);  // the pane: what it reflects
  // On one thread, and without any surrounding light.
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Picture alone = rendered(scene, bdpt, true);
  EXPECT_EQ(p.alpha, alone.alpha);
  EXPECT_EQ(p.pixels, alone.pixels);
  scene.sky = nullptr;
  EXPECT_EQ(rendered(scene, bdpt, true).alpha, p.alpha);
}

}  // namespace tdpt::alpha_test
