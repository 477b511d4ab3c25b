// KHR_materials_pbrSpecularGlossiness at a point, against the extension's equations:
// c_diff = diffuse (1 - max specular), F0 = specular, F90 = 1, alpha = (1 - glossiness)^2.
#include <gtest/gtest.h>

#include "libcommon/scene/test_materials.h"
#include "tools/tdpt-render/path/sample/surface.h"

namespace tdpt::specular_glossiness_test {

using testing::Json;

/// The surface of the triangle's material where u = `u`.
Bsdf bsdf_at(const Scene& scene, double u) {
  const World world(scene, Camera(), 8, 8, {});
  Hit hit;
  hit.triangle = 0;
  hit.b1 = u;
  hit.b2 = 0.1;
  hit.normal = shape_of(scene, 0).normal;
  Point p;
  place_on_surface(world, hit, p);
  return p.bsdf;
}

Json glossy(const Json& model) {
  return {{"extensions", {{"KHR_materials_pbrSpecularGlossiness", model}}}};
}

void expect_near(const Rgb& a, const Rgb& b) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-5) << c;
}

TEST(specular_glossiness, by_factors) {
  const Bsdf b = bsdf_at(testing::scene_with({glossy({{"diffuseFactor", {0.5, 0.25, 1, 1}},
                                                      {"specularFactor", {0.25, 0.5, 0.125}},
                                                      {"glossinessFactor", 0.75}})}),
                         0.25);
  expect_near(b.diffuse, {0.25f, 0.125f, 0.5f});
  expect_near(b.f0, {0.25f, 0.5f, 0.125f});
  EXPECT_NEAR(b.f90, 1, 1e-6);
  expect_near(b.through, Rgb(0.0f));
  EXPECT_NEAR(b.alpha, 0.0625, 1e-6);
}

TEST(specular_glossiness, by_a_texture_of_two_texels) {
  const Json model = {{"diffuseFactor", {0.5, 0.5, 0.5, 1}},
                      {"specularFactor", {0.5, 0.25, 1}},
                      {"glossinessFactor", 0.75},
                      {"specularGlossinessTexture", {{"index", 0}}}};
  const Scene scene =
      testing::scene_with({glossy(model)}, testing::with(testing::kTwo, {{"magFilter", 9728}}));
  const auto linear = [](int byte) { return static_cast<float>(testing::linear(byte / 255.0)); };
  const Bsdf bright = bsdf_at(scene, 0.25);
  expect_near(bright.f0, {0.5f, 0.25f * linear(0x80), linear(0x33)});
  expect_near(bright.diffuse, Rgb(0.25f));
  EXPECT_NEAR(bright.alpha, 0.0625, 1e-6);
  const Bsdf black = bsdf_at(scene, 0.75);
  expect_near(black.f0, Rgb(0.0f));
  EXPECT_NEAR(black.f90, 1, 1e-6);
  expect_near(black.diffuse, Rgb(0.5f));
  const double rough = 1 - 0.75 * 128 / 255;
  EXPECT_NEAR(black.alpha, rough * rough, 1e-6);
}

}  // namespace tdpt::specular_glossiness_test
