// The picture split by technique.
#include <gtest/gtest.h>

#include "tools/tdpt-render/testing/renderer.h"
#include "tools/tdpt-render/testing/rendering.h"
#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/variant.h"

namespace tdpt::layers_test {

RenderResult render_rooms(const Integrator& integrator, bool layers) {
  const Scene scene = read_gltf(two_rooms_path());
  const Vista vista(scene, scene.camera(""), 40, 30, {portal_in_the_hole()});
  Job settings;
  settings.limits.spp = 16;
  settings.layers = layers;
  return render(*renderer_under_test(vista), integrator, settings);
}

// Largest difference between a pixel and the sum of its layers, in units of the pixel's rounding to
// single precision.
double worst_difference(const Picture& picture, const std::map<std::string, Picture>& layers) {
  double worst = 0;
  for (size_t i = 0; i < picture.pixels.size(); ++i) {
    Vec3d sum;
    for (const auto& [name, layer] : layers) sum += Vec3d(layer.pixels[i]);
    for (int c = 0; c < 3; ++c) {
      const double pixel = picture.pixels[i][c];
      const double rounding = std::max(pixel, 1e-30) * 0x1p-24;
      worst = std::max(worst, std::abs(sum[c] - pixel) / rounding);
    }
  }
  return worst;
}

double mean_luminance(const Picture& picture) {
  double sum = 0;
  for (const Rgb& p : picture.pixels) sum += luminance(p);
  return sum / static_cast<double>(picture.pixels.size());
}

TEST(layers, add_up_to_the_picture_for_every_integrator) {
  for (const Integrator* integrator : integrators_under_test()) {
    const RenderResult r = render_rooms(*integrator, true);
    const std::map<std::string, Picture> layers = layers_of(r);
    size_t techniques = 0;
    for (size_t i = 0; i < kTechniques; ++i) {
      const bool there = integrator->mixture.has(static_cast<Technique>(i));
      techniques += there;
      EXPECT_EQ(layers.count(kTechniqueNames[i]), there ? 1u : 0u) << integrator->name;
    }
    EXPECT_EQ(layers.size(), techniques);
    // The pixel and each layer are rounded once.
    EXPECT_LE(worst_difference(r.picture, layers), 1.0 + static_cast<double>(techniques))
        << integrator->name;
    for (const auto& [name, layer] : layers)
      if (integrator == &tdpt_org) {
        EXPECT_GT(mean_luminance(layer), 0) << name;
      }
  }
}

TEST(layers, twin_a_technique_left_out_of_the_sum_is_noticed) {
  const RenderResult r = render_rooms(tdpt_org, true);
  for (const char* name : kTechniqueNames) {
    std::map<std::string, Picture> less = layers_of(r);
    less.erase(name);
    EXPECT_GT(worst_difference(r.picture, less), 1000) << name;
  }
}

TEST(layers, do_not_change_a_bit_of_the_picture) {
  for (const Integrator* integrator : integrators_under_test()) {
    const RenderResult with = render_rooms(*integrator, true);
    const RenderResult without = render_rooms(*integrator, false);
    EXPECT_EQ(with.picture.pixels, without.picture.pixels) << integrator->name;
    EXPECT_TRUE(layers_of(without).empty());
  }
}

TEST(layers, are_the_shares_that_the_tally_says) {
  const RenderResult r = render_rooms(tdpt_ref, true);
  const double picture = mean_luminance(r.picture);
  const std::map<std::string, Picture> layers = layers_of(r);
  double total = 0;
  for (double e : r.tally.energy) total += e;
  for (size_t i = 0; i < kTechniques; ++i) {
    const auto layer = layers.find(kTechniqueNames[i]);
    const double share = layer == layers.end() ? 0 : mean_luminance(layer->second) / picture;
    EXPECT_NEAR(share, r.tally.energy[i] / total, 1e-5) << kTechniqueNames[i];
  }
}

TEST(layers, a_contribution_goes_to_its_own_layer) {
  Film::Options options;
  options.layers = {"a", "", "b"};
  Film film(2, 1, 1, options);
  EXPECT_TRUE(film.add_to_layer(2, 1, 0, Vec3d(2, 2, 2), 0));
  EXPECT_TRUE(film.add_to_layer(1, 1, 0, Vec3d(4, 4, 4), 0));  // is dropped
  EXPECT_TRUE(film.add(0, 0, Vec3d(1, 1, 1), 0, 0));
  EXPECT_EQ(film.sums(), (std::vector<Vec3d>{{1, 1, 1}, {}}));
  EXPECT_EQ(film.layer_sums(2), (std::vector<Vec3d>{{}, {2, 2, 2}}));
  for (size_t layer : {0, 1}) EXPECT_EQ(film.layer_sums(layer), (std::vector<Vec3d>{{}, {}}));
}

}  // namespace tdpt::layers_test
