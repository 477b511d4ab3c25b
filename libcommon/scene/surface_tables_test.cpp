// Alpha evaluated in floats against coverage_at() of libcommon/scene/texture.h.
#include "libcommon/scene/surface_tables.h"

#include <cmath>

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "libcommon/scene/texture.h"
#include "libcommon/testing/scenes/sheet.h"
#include "shaders/shared/rng.h"
#include "shaders/shared/tables.h"
#include "shaders/shared/texels.h"

namespace tdpt::surface_tables_test {

using testing::sheet_materials;
using testing::small_image;
using testing::with_sheet;

namespace kernel {
using namespace shader;
struct Kernel {
  TABLES_OF_COVERAGE(REFERS_TO)
  bool scene_has_coverage, coverage_has_textures, scene_has_panes;
  static float opacity_at(uint, const vec3&) { return 1; }
#include "shaders/shared/coverage.h"
};
}  // namespace kernel

// Share of points on the sheet whose coverage differs from coverage_at() by more than a thousandth;
// `shift` moves the texture.
double share_of_other_coverage(const Material& material, float shift) {
  Scene scene = with_sheet(material, small_image());
  const CoverageTables tables = make_coverages(scene);
  const kernel::Kernel kernel{
      tables.coverage_of.data(), tables.coverages.data(), tables.texels.data(), true, true, false};
  scene.materials.back().maps[MAP_BASE].transform[2] += shift;
  int different = 0;
  for (uint64_t i = 0; i < 20000; ++i) {
    Rng rng(8, 0, i);
    const float u = rng.uniform_float();
    const float v = rng.uniform_float() * (1 - u);
    const auto triangle = static_cast<uint32_t>(scene.triangles.size() - 1 - i % 2);
    const float mine = kernel.coverage_at(triangle, u, v);
    different += std::abs(mine - coverage_at(scene, {triangle, u, v})) > 1e-3f;
  }
  return different / 2e4;
}

TEST(Coverages, cover_what_textures_say) {
  const std::vector<Material> all = sheet_materials();
  for (size_t i = 0; i < all.size(); ++i) {
    EXPECT_LT(share_of_other_coverage(all[i], 0), 3e-4) << i;
    if (i == 0) continue;                                         // no texture
    EXPECT_GT(share_of_other_coverage(all[i], 0.1f), 0.01) << i;  // twin
  }
}

// Share of points on the sheet that it does not cover.
double share_uncovered(const Material& material, const Image& image, bool with_uv = true) {
  Scene scene = with_sheet(material, image);
  for (auto& colour : scene.colours) colour[3] = 1;
  if (!with_uv) scene.uv[1].clear();
  const CoverageTables tables = make_coverages(scene);
  const kernel::Kernel kernel{
      tables.coverage_of.data(), tables.coverages.data(), tables.texels.data(), true, true, false};
  int uncovered = 0;
  for (uint64_t i = 0; i < 2000; ++i) {
    Rng rng(8, 0, i);
    const float u = rng.uniform_float();
    const float v = rng.uniform_float() * (1 - u);
    const auto triangle = static_cast<uint32_t>(scene.triangles.size() - 1 - i % 2);
    uncovered += kernel.coverage_at(triangle, u, v) < 1;
    EXPECT_EQ(kernel.coverage_at(triangle, u, v), coverage_at(scene, {triangle, u, v}));
  }
  return uncovered / 2e3;
}

TEST(Coverages, masks_are_there_at_their_cutoff) {
  Material m;
  m.alpha_mode = Material::Alpha::mask;
  for (const float alpha : {1.0f, 0.9f, 0.5f, 0.3f}) {
    m.alpha = m.alpha_cutoff = alpha;
    EXPECT_EQ(share_uncovered(m, small_image()), 0) << alpha;
    m.alpha_cutoff = std::nextafter(alpha, 2.0f);
    EXPECT_EQ(share_uncovered(m, small_image()), 1) << alpha;  // twin
  }
}

TEST(Coverages, without_texture_coordinates_have_the_texel_of_the_transform) {
  Material m;
  m.alpha_mode = Material::Alpha::mask;
  m.alpha_cutoff = 0.5f;
  m.maps[MAP_BASE].image = 0;
  m.maps[MAP_BASE].nearest = true;
  const Image halves{2, 1, {0, 0, 0, 0, 255, 255, 255, 255}};  // alpha 0, then 1
  EXPECT_EQ(share_uncovered(m, halves, false), 1);
  m.maps[MAP_BASE].transform = {1, 0, 0.75f, 0, 1, 0};
  EXPECT_EQ(share_uncovered(m, halves, false), 0);
}

}  // namespace tdpt::surface_tables_test
