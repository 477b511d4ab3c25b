// A transparent film composited over the sky that it leaves out gives the opaque picture.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "tools/tdpt-render/testing/renderer.h"
#include "tools/tdpt-render/testing/rendering.h"

namespace tdpt::alpha_test {

void add_square(Scene& scene, const Vec3f& corner, const Vec3f& u, const Vec3f& v,
                const Material& material) {
  const auto first = static_cast<uint32_t>(scene.positions.size());
  const auto index = static_cast<uint32_t>(scene.materials.size());
  scene.positions.insert(scene.positions.end(), {corner, corner + u, corner + u + v, corner + v});
  scene.triangles.push_back({{first, first + 1, first + 2}, index});
  scene.triangles.push_back({{first, first + 2, first + 3}, index});
  scene.materials.push_back(material);
}

const Rgb kSky(3, 2, 1);

// Ground with the horizon behind it; on the left a half transparent sheet, on the right a pane.
Scene outdoors() {
  Scene scene;
  Material ground, sheet, pane;
  sheet.plain = pane.plain = false;
  sheet.double_sided = true;
  sheet.alpha_mode = Material::Alpha::blend;
  sheet.alpha = 0.5f;
  pane.base_color = Rgb(1);
  pane.transmission = pane.specular = 1;
  pane.roughness = 0;
  add_square(scene, {-1, -0.2f, 0.5f}, {2, 0, 0}, {0, 0, -1.5f}, ground);
  add_square(scene, {-0.4f, -0.3f, -1}, {0.3f, 0, 0}, {0, 0.5f, 0}, sheet);
  add_square(scene, {0.1f, -0.3f, -1}, {0.3f, 0, 0}, {0, 0.5f, 0}, pane);
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
  return render(*renderer_under_test(vista), integrator, settings).picture;
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

float alpha_at(const Picture& p, int x, int y) {
  return p.alpha[static_cast<size_t>(y * kWidth + x)];
}

TEST(Alpha, OverTheSkyItIsTheOpaquePicture) {
  const Scene scene = outdoors();
  for (const Integrator* integrator : {&pt, &nee, &bdpt}) {
    const Picture p = rendered(scene, *integrator, true);
    ASSERT_EQ(p.alpha.size(), p.pixels.size());
    EXPECT_LT(off_the_opaque(p, rendered(scene, *integrator, false)), 1e-5f) << integrator->name;
  }
}
TEST(Alpha, TwinOfOtherSamples) {
  const Scene scene = outdoors();
  EXPECT_GT(off_the_opaque(rendered(scene, bdpt, true), rendered(scene, bdpt, false, 2)), 0.1f);
}

TEST(Alpha, IsTheShareOfRaysThatMeetSomething) {
  const Picture p = rendered(outdoors(), bdpt, true);
  EXPECT_EQ(alpha_at(p, 0, 0), 0);
  EXPECT_EQ(p.pixels[0], Rgb(0));
  EXPECT_EQ(alpha_at(p, kWidth / 2, kHeight - 1), 1);
  const auto mean = [&](int x0, int x1) {
    float sum = 0;
    for (int y = 9; y < 11; ++y)
      for (int x = x0; x < x1; ++x) sum += alpha_at(p, x, y);
    return sum / static_cast<float>(2 * (x1 - x0));
  };
  EXPECT_NEAR(mean(7, 12), 0.5f, 0.2f);     // the sheet
  EXPECT_NEAR(mean(21, 25), 0.04f, 0.05f);  // the pane: what it reflects
}

TEST(Alpha, IsNotKeptUnlessAskedFor) {
  EXPECT_TRUE(rendered(outdoors(), bdpt, false).alpha.empty());
}

// Without any surrounding light, what is hit still has alpha.
TEST(Alpha, NeedsNoSky) {
  Scene scene = outdoors();
  const Picture lit = rendered(scene, bdpt, true);
  scene.sky = nullptr;
  EXPECT_EQ(rendered(scene, bdpt, true).alpha, lit.alpha);
}

TEST(Alpha, IsTheSameForAnyNumberOfThreads) {
  const Scene scene = outdoors();
  const Picture all = rendered(scene, bdpt, true);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Picture alone = rendered(scene, bdpt, true);
  EXPECT_EQ(all.alpha, alone.alpha);
  EXPECT_EQ(all.pixels, alone.pixels);
}

}  // namespace tdpt::alpha_test
