// KHR_materials_pbrSpecularGlossiness at a point, against the extension's equations:
// c_diff = diffuse (1 - max specular), F0 = specular, F90 = 1, alpha = (1 - glossiness)^2.
#include <gtest/gtest.h>

#include "libcommon/testing/scenes/materials.h"
#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt::specular_glossiness_test {

using testing::Json;

/// The BSDF of the triangle's material at u = `u`.
Bsdf bsdf_at(const Scene& scene, double u) {
  const Vista vista(scene, Camera(), 8, 8, {});
  Hit hit;
  hit.triangle = 0;
  hit.b1 = u;
  hit.b2 = 0.1;
  hit.normal = shape_of(scene, 0).normal;
  Point p;
  place_on_surface(*vista.world, hit, p);
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

// A conductor whose reflectance a metalness texture halves: its dip follows.
TEST(conductor, by_its_index_and_a_texture) {
  const auto model = [](const Json& pbr) {
    return Json{{"pbrMetallicRoughness", pbr},
                {"extras", {{"tdpt_eta", {4.37, 4.37, 4.37}}, {"tdpt_k", {3.5, 3.5, 3.5}}}}};
  };
  const Bsdf whole = bsdf_at(testing::scene_with({model({{"roughnessFactor", 0.5}})}), 0.25);
  const auto f0 = static_cast<float>((3.37 * 3.37 + 3.5 * 3.5) / (5.37 * 5.37 + 3.5 * 3.5));
  expect_near(whole.f0, Rgb(f0));
  expect_near(whole.diffuse, Rgb());
  EXPECT_GT(whole.dip.x, 4);
  const Scene textured =
      testing::scene_with({model({{"metallicRoughnessTexture", {{"index", 0}}}})},
                          testing::with(testing::kTwo, {{"magFilter", 9728}}));
  const Bsdf half = bsdf_at(textured, 0.25);
  const float metal = half.dip.x / whole.dip.x;
  EXPECT_GT(metal, 0.05);
  EXPECT_LT(metal, 0.95);
  EXPECT_NEAR(half.f90, 1, 1e-5);
  expect_near(half.f0, Rgb(f0 * metal + 0.04f * (1 - metal)));
}

}  // namespace tdpt::specular_glossiness_test
