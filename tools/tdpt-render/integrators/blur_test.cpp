// A lens and a shutter blur: all integrators show the same picture, and one that differs from those
// of other blurs. What they draw: libcommon/scene/film_plane_test.
#include <gtest/gtest.h>

#include "tools/tdpt-render/testing/agreement.h"
#include "tools/tdpt-render/testing/blur.h"
#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::blur_test {

constexpr AgreementSettings kSettings{.runs = 32, .spp = 4};

/// Every second triangle below the glowing ceiling is dark, so that it shows where splats fall.
Scene chequered() {
  Scene scene = below_a_glowing_ceiling();
  Material dark = scene.materials[1];
  dark.base_color = Rgb(0.05f);
  scene.materials.push_back(dark);
  for (size_t i = 0; i < scene.triangles.size(); i += 2)
    if (scene.triangles[i].material == 1) scene.triangles[i].material = 2;
  return scene;
}

TEST(blurred_ceiling, is_the_same_by_all_integrators) {
  const Scene scene = chequered();
  const Camera camera = scene.camera("");
  Vista vista(scene, camera, 32, 24, {rectangle({-0.8, 0.9, -0.8}, {1.6, 0, 0}, {0, 0, 1.6})});
  vista.view.blur = strong_blur(camera);
  // Without pt, from which dark walls hide long paths.
  expect_agreement(vista, {&nee, &tdpt_org, &tdpt_ref, &tdpt_guided}, kSettings);
  // Twins: sharp, at rest, and by a pinhole.
  const DepthRuns reference = render_runs(vista, bdpt, kSettings.of_reference());
  for (const CameraBlur& blur :
       {CameraBlur(), strong_blur(camera, 0.06, 0), strong_blur(camera, 0)}) {
    vista.view.blur = blur;
    EXPECT_FALSE(judge(render_runs(vista, nee, kSettings), reference).holds());
  }
}

}  // namespace tdpt::blur_test
