// The picture split by technique.
#include <gtest/gtest.h>

#include "tools/tdpt-render/testing/renderer.h"
#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::layers_test {

RenderResult render_rooms(const Integrator& integrator, bool layers) {
  const Scene scene = read_gltf(two_rooms_path());
  const Vista vista(scene, scene.camera(""), 40, 30, {portal_in_the_hole()});
  Job settings;
  settings.limits.spp = 8;
  settings.layers = layers;
  return render(vista, integrator, settings);
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

TEST(layers, add_up_to_the_same_picture_with_the_shares_that_the_tally_says) {
  for (const Integrator* integrator : integrators()) {
    SCOPED_TRACE(integrator->name);
    const RenderResult r = render_rooms(*integrator, true);
    const RenderResult without = render_rooms(*integrator, false);
    EXPECT_EQ(r.picture.pixels, without.picture.pixels);
    EXPECT_TRUE(layers_of(without).empty());
    const std::map<std::string, Picture> layers = layers_of(r);
    double total = 0;
    for (double e : r.tally.energy) total += e;
    size_t techniques = 0;
    for (size_t i = 0; i < kTechniques; ++i) {
      const auto layer = layers.find(kTechniqueNames[i]);
      EXPECT_EQ(layer != layers.end(), integrator->mixture.has(static_cast<Technique>(i)));
      if (layer == layers.end()) continue;
      ++techniques;
      EXPECT_NEAR(mean_luminance(layer->second) / mean_luminance(r.picture),
                  r.tally.energy[i] / total, 1e-5);
      std::map<std::string, Picture> less = layers;  // twin: one is left out
      less.erase(layer->first);
      if (r.tally.energy[i] > 0) {
        EXPECT_GT(worst_difference(r.picture, less), 1000) << layer->first;
      }
    }
    EXPECT_EQ(layers.size(), techniques);
    // The pixel and each layer are rounded once.
    EXPECT_LE(worst_difference(r.picture, layers), 1.0 + static_cast<double>(techniques));
  }
}

}  // namespace tdpt::layers_test
