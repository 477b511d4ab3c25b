// Cameras that see through the backs of single-sided surfaces: all integrators agree on the
// picture, which equals that from beyond the wall; light is not affected.
#include <gtest/gtest.h>

#include "tools/tdpt-render/integrators/features.h"
#include "tools/tdpt-render/run/scene_cache.h"
#include "tools/tdpt-render/testing/agreement.h"
#include "tools/tdpt-render/testing/rendering.h"
#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/sheets.h"

namespace tdpt::culling_test {

constexpr int kWidth = 32, kHeight = 24;

// Rooms whose walls face inwards, and a camera that culls.
Scene rooms(const std::string& file, const Vec3d& from, const Vec3d& to) {
  Scene scene = read_gltf(TDPT_TESTDATA "/scenes/" + file);
  for (Material& m : scene.materials) m.double_sided = false;
  Camera& camera = scene.cameras[0];
  camera.position = scene.frame.to_canonical(from);
  camera.forward = normalize(to - from);
  camera.right = normalize(cross(camera.forward, Vec3d{0, 1, 0}));
  camera.up = cross(camera.right, camera.forward);
  camera.culls = true;
  return scene;
}

const Portal kWindow = rectangle({2.05, 0.2, -0.8}, {0, 0, 1.6}, {0, 1.6, 0});

Picture rendered(const Scene& scene, const Integrator& integrator, int max_depth = 8) {
  const Vista vista(scene, scene.camera(""), kWidth, kHeight, {kWindow});
  Job settings;
  settings.limits.spp = 16;
  settings.max_depth = max_depth;
  settings.alpha = scene.sky != nullptr;
  return render(vista, integrator, settings).picture;
}

double mean(const Picture& picture) {
  double sum = 0;
  for (const Rgb& c : picture.pixels) sum += luminance(c);
  return sum / static_cast<double>(picture.pixels.size());
}

constexpr AgreementSettings kSettings{.runs = 32, .spp = 4};

// From outside the end wall of the camera's room, looking through it.
Scene cutaway() {
  return rooms("window.glb", {-1.5, 1.3, 0.4}, {2, 1, -0.1});
}

// The walls' backs are also lit, and face the camera: light walks reach them. Without pt, which
// hits the lamp too seldom to estimate its own error.
TEST(culling, all_integrators_agree) {
  Scene scene = cutaway();
  scene.sky = std::make_shared<Sky>(Sky::Map{1, 1, {Rgb(0.5f)}}, 0);
  const Vista vista(scene, scene.camera(""), kWidth, kHeight, {kWindow});
  expect_agreement(vista, {&nee, &tdpt_org, &tdpt_ref, &tdpt_guided}, kSettings);
}

// Slightly in front of the wall and slightly behind it, with the same random numbers.
TEST(culling, shows_what_a_camera_beyond_the_wall_sees) {
  const Vec3d to{2, 1, -0.1}, wall{0, 1.3, 0.4}, hair = normalize(to - wall) * 1e-4;
  const Scene before = rooms("window.glb", wall - hair, to),
              behind = rooms("window.glb", wall + hair, to);
  Scene uncut = before;  // twin
  uncut.cameras[0].culls = false;
  for (const Integrator* integrator : integrators()) {
    const double inside = mean(rendered(behind, *integrator));
    EXPECT_GT(inside, 0.05);
    EXPECT_NEAR(mean(rendered(before, *integrator)) / inside, 1, 0.01) << integrator->name;
    EXPECT_LT(mean(rendered(uncut, *integrator)), 0.01 * inside) << integrator->name;
  }
}

// A minimal scene: a lamp on the camera's side of a wall that faces away, and beyond the wall the
// square that it would light.
Scene lamp_before_a_wall(bool double_sided) {
  Scene scene;
  Material wall;
  wall.double_sided = double_sided;
  scene = with_sheet(scene, Material(), {-2, -2, -1}, {4, 0, 0}, {0, 4, 0});
  scene = with_sheet(scene, wall, {-2, -2, 0}, {0, 4, 0}, {4, 0, 0});
  PunctualLight lamp;
  lamp.position = {0, 0, 0.5};
  lamp.intensity = Rgb(1);
  scene.lights.push_back(lamp);
  Camera camera;
  camera.position = {0, 0, 1};
  camera.right = {1, 0, 0};
  camera.up = {0, 1, 0};
  camera.forward = {0, 0, -1};
  camera.culls = true;
  scene.cameras.push_back(camera);
  return scene;
}

TEST(culling, light_does_not_pass_what_the_camera_sees_through) {
  for (const Integrator* integrator : {&nee, &bdpt, &tdpt_ref}) {
    const Picture picture = rendered(lamp_before_a_wall(false), *integrator, 2);
    EXPECT_EQ(mean(picture), 0) << integrator->name;
    // Twin: a wall that is drawn, and lit.
    EXPECT_GT(mean(rendered(lamp_before_a_wall(true), *integrator, 2)), 0.1) << integrator->name;
  }
}

// A single wall that faces away, in front of the sky.
Scene wall_before_the_sky() {
  Scene scene = lamp_before_a_wall(false);
  scene.triangles.erase(scene.triangles.begin(), scene.triangles.begin() + 2);
  scene.lights.clear();
  scene.sky = std::make_shared<Sky>(Sky::Map{1, 1, {Rgb(3, 2, 1)}}, 0);
  return scene;
}

TEST(culling, is_that_of_alpha_the_sky_and_the_features) {
  Scene scene = wall_before_the_sky();
  for (const bool culls : {true, false}) {
    scene.cameras[0].culls = culls;
    const Picture picture = rendered(scene, bdpt);
    const Vista vista(scene, scene.camera(""), kWidth, kHeight, {});
    const Channels seen = features(vista, {"depth"}, 1);
    for (size_t i = 0; i < picture.pixels.size(); ++i) {
      EXPECT_EQ(picture.alpha[i], culls ? 0 : 1);
      EXPECT_EQ(seen.at("depth.Z")[i] >= 1e10f, culls);
    }
  }
}

TEST(culling, backs_that_the_camera_sees_are_told) {
  Scene scene = wall_before_the_sky();
  scene.materials.back().name = "plaster";
  const auto sentence = [&] {
    return backs_sentence(Vista(scene, scene.camera(""), kWidth, kHeight, {}));
  };
  EXPECT_EQ(sentence(), "");
  scene.cameras[0].culls = false;
  EXPECT_NE(sentence().find("in 100 % of the picture"), std::string::npos);
  EXPECT_NE(sentence().find("\"plaster\""), std::string::npos);
  scene.materials.back().double_sided = true;
  EXPECT_EQ(sentence(), "");
}

}  // namespace tdpt::culling_test
