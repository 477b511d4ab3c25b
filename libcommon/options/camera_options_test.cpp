#include "libcommon/options/camera_options.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libcommon/scene/film_plane.h"
#include "libcommon/testing/files/refusal.h"

namespace tdpt::camera_options_test {

constexpr double kRadians = std::numbers::pi / 180;

// A box of 4 x 2 x 1 m around (10, 0, 0) without a camera, with an unused vertex far outside.
Scene box(const Vec3d& half = {2, 1, 0.5}) {
  Scene scene;
  scene.path = "box.glb";
  scene.frame = {{10, 0, 0}, 0.25};
  for (int i = 0; i < 8; ++i) {
    const Vec3d corner{i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y,
                       i & 4 ? half.z : -half.z};
    scene.positions.push_back(Vec3f(corner * scene.frame.scale));
  }
  for (uint32_t i = 0; i < 6; ++i) scene.triangles.push_back({{i, i + 1, i + 2}, 0});
  scene.materials.emplace_back();
  scene.positions.push_back({900, 900, 900});  // of no triangle
  return scene;
}

Camera chosen(const CameraArguments& a, const Scene& scene = box()) {
  cli::Common common;
  common.quiet = true;
  return chosen_camera(scene, a, common);
}
// The notes on stderr.
std::string said(const CameraArguments& a, const Scene& scene) {
  ::testing::internal::CaptureStderr();
  chosen_camera(scene, a, cli::Common());
  return ::testing::internal::GetCapturedStderr();
}
CameraArguments placed(const std::string& from, const std::string& at, const std::string& up = "",
                       double fov = 0) {
  CameraArguments a;
  a.look_from = from, a.look_at = at, a.up = up, a.fov = fov;
  return a;
}
/// What is said of a wrong use; of all else this throws.
std::string complaint(const CameraArguments& a) {
  return testing::refusal<UsageError>([&] { chosen(a); });
}
void expect_near(const Vec3d& a, const Vec3d& b) {
  EXPECT_NEAR(length(a - b), 0, 1e-12) << a.x << ' ' << a.y << ' ' << a.z;
}

TEST(CameraOptions, ACameraStandsAndLooksWhereItIsTold) {
  const Camera c = chosen(placed("14,-.5,0", "14,-0.5,-3e0"));
  expect_near(c.position, {1, -0.125, 0});
  expect_near(c.forward, {0, 0, -1});
  expect_near(c.right, {1, 0, 0});
  expect_near(c.up, {0, 1, 0});
  EXPECT_NEAR(c.yfov, 45 * kRadians, 1e-12);
  EXPECT_FALSE(c.culls);
  const Camera turned = chosen(placed("14,0,0", "14,0,-3", "2,2,5", 90));
  EXPECT_NEAR(turned.yfov, std::numbers::pi / 2, 1e-12);
  expect_near(turned.up, Vec3d{std::sqrt(0.5), std::sqrt(0.5), 0});
  expect_near(turned.right, Vec3d{std::sqrt(0.5), -std::sqrt(0.5), 0});
}

TEST(CameraOptions, WhatLooksStraightDownHasTheFarSideAtItsTop) {
  expect_near(chosen(placed("10,5,0", "10,0,0")).up, {0, 0, -1});
  expect_near(chosen(placed("10,5,0", "10,0,0")).right, {1, 0, 0});
  expect_near(chosen(placed("10,-5,0", "10,0,0")).up, {0, 0, 1});
  expect_near(chosen(placed("10,5,0", "10,0,0", "1,0,0")).up, {1, 0, 0});
}

// Extent of the scene on the film, in half widths; more than 1: it is cut off.
double share_of_film(const Scene& scene, const Camera& camera) {
  double most = 0;
  for (const Triangle& t : scene.triangles)
    for (const uint32_t v : t.vertex) {
      const Vec3d d = Vec3d(scene.positions[v]) - camera.position;
      const double depth = dot(d, camera.forward) * std::tan(0.5 * camera.yfov);
      if (!(depth > 0)) return 2;
      most = std::max(
          {most, std::abs(dot(d, camera.right)) / depth, std::abs(dot(d, camera.up)) / depth});
    }
  return most;
}

TEST(CameraOptions, FrameTellsItsPlaceFarFromTheOriginToo) {
  Scene scene = box({2, 1, 0.5});
  CameraArguments a;
  a.frame = true;
  EXPECT_NE(said(a, scene).find("--look-at 10,0,0 "), std::string::npos) << said(a, scene);
  scene.frame.centre = {4512345.125, 0, 0};
  EXPECT_NE(said(a, scene).find("--look-at 4512345.125,0,0 "), std::string::npos) << said(a, scene);
}

TEST(CameraOptions, FrameHasAllInViewAndLittleMore) {
  for (const Vec3d& half : {Vec3d{2, 1, 0.5}, Vec3d{0.1, 2, 0.1}, Vec3d{0.5, 0.01, 2}})
    for (const double fov : {0.0, 20.0, 120.0}) {
      const Scene scene = box(half);
      CameraArguments a;
      a.frame = true;
      a.fov = fov;
      Camera camera = chosen(a, scene);
      EXPECT_TRUE(camera.culls) << "as viewers";
      EXPECT_GT(camera.position.x, 0) << "to the right";
      EXPECT_GT(camera.position.y, 0) << "above";
      EXPECT_GT(camera.position.z, 0) << "before";
      EXPECT_LT(share_of_film(scene, camera), 1);
      EXPECT_GT(share_of_film(scene, camera), 0.85);
      camera.position = camera.position + camera.forward * (0.2 * length(camera.position));
      EXPECT_GT(share_of_film(scene, camera), 1) << "twin that stands nearer";
    }
}

Scene with_cameras(const std::vector<std::string>& names) {
  Scene scene = box();
  for (const std::string& name : names) scene.cameras.emplace_back().name = name;
  return scene;
}

TEST(CameraOptions, OneOfTheSceneIsTakenByItsName) {
  const Scene scene = with_cameras({"hall", "yard"});
  CameraArguments a;
  EXPECT_EQ(chosen(a, scene).name, "hall");
  a.names = {"yard"};
  a.cull = true;
  EXPECT_EQ(chosen(a, scene).name, "yard");
  EXPECT_TRUE(chosen(a, scene).culls);
}

TEST(CameraOptions, TheSceneMayNameTheOneThatIsTaken) {
  Scene scene = with_cameras({"hall", "yard"});
  scene.defaults.place = "scenes[1].extras";
  scene.defaults.camera = "yard";
  CameraArguments hall;
  hall.names = {"hall"};
  EXPECT_EQ(chosen({}, scene).name, "yard");
  EXPECT_EQ(chosen(hall, scene).name, "hall");
  EXPECT_EQ(chosen(placed("14,0,0", "10,0,0"), scene).name, "--look-from");
  scene.defaults.camera = "cellar";
  EXPECT_EQ(chosen(hall, scene).name, "hall");
  EXPECT_THROW(chosen({}, scene), InputError);
}

TEST(CameraOptions, WhatContradictsItselfIsRefused) {
  const auto refused = [](const CameraArguments& a, const std::string& words) {
    EXPECT_EQ(complaint(a).find(words), 0u) << complaint(a);
  };
  refused(placed("1,2,3", ""), "--look-from and --look-at");
  refused(placed("", "1,2,3"), "--look-from and --look-at");
  refused(placed("", "", "0,1,0"), "--up goes with");
  refused(placed("", "", "", 30), "--fov goes with");
  CameraArguments both = placed("1,2,3", "4,5,6"), framed;
  both.names = framed.names = {"hall"};
  framed.frame = true;
  refused(both, "--camera hall: --look-from");
  refused(framed, "--camera hall: --frame");
  both.names = {}, both.frame = true;
  refused(both, "--frame: --look-from");
}

TEST(CameraOptions, WhatIsNoPlaceIsRefused) {
  for (const std::string text : {"1,2", "1,2,3,4", "1,,2", "a,b,c", "1,2,3 ", " 1,2,3", "1,2,nan",
                                 "inf,0,0", "1;2;3", "1,2,", "1e999,0,0"}) {
    EXPECT_EQ(complaint(placed(text, "0,0,0")).find("--look-from " + text + ": expected X,Y,Z"),
              0u);
    EXPECT_EQ(complaint(placed("0,0,0", text)).find("--look-at " + text + ": expected X,Y,Z"), 0u);
  }
  EXPECT_NE(complaint(placed("0,0,0", "0,0,0")), "");
  EXPECT_NE(complaint(placed("0,0,0", "0,0,1", "0,0,5")), "");
  EXPECT_NE(complaint(placed("0,0,0", "0,0,1", "0,0,0")), "");
  EXPECT_NE(complaint(placed("4e8,0,0", "0,0,1")), "");
}

// Exact names come first, so that one of any name can be chosen.
TEST(CameraOptions, SeveralAreNamedOneByOneWithCommasOrAll) {
  using Names = std::vector<std::string>;
  Scene scene = with_cameras({"hall", "yard", "a,b"});
  EXPECT_EQ(names_of_cameras(scene, {"yard", "hall"}), (Names{"yard", "hall"}));
  EXPECT_EQ(names_of_cameras(scene, {"yard,hall", "yard"}), (Names{"yard", "hall"}));
  EXPECT_EQ(names_of_cameras(scene, {"all"}), (Names{"hall", "yard", "a,b"}));
  EXPECT_EQ(names_of_cameras(scene, {"a,b"}), (Names{"a,b"}));
  EXPECT_EQ(names_of_cameras(scene, {"hall,nobody"}), (Names{"hall", "nobody"}));
  EXPECT_THROW(names_of_cameras(scene, {"hall,,yard"}), UsageError);
  scene.cameras[0].name = "all";
  EXPECT_EQ(names_of_cameras(scene, {"all"}), (Names{"all"}));
}

TEST(CameraOptions, OfSeveralNoneIsChosenForOne) {
  Scene scene = with_cameras({"hall", "yard"});
  CameraArguments a;
  a.names = {"hall", "yard"};
  EXPECT_THROW(chosen(a, scene), UsageError);
  const std::vector<Camera> both = chosen_cameras(scene, a, {});
  ASSERT_EQ(both.size(), 2u);
  EXPECT_EQ(both[1].name, "yard");
  a.names = {"hall,nobody"};
  EXPECT_THROW(chosen_cameras(scene, a, {}), InputError);
  a.names = {};
  EXPECT_EQ(chosen_cameras(scene, a, {}).size(), 1u);
}

// On a film 36 mm wide a lens of 50 mm sees 39.6 degrees across: at f/2 its aperture is 25 mm wide.
TEST(Aperture, IsThatOfALensOf50Millimetres) {
  Camera camera;
  const double angle = 2 * std::atan(18.0 / 50);
  EXPECT_NEAR(angle * 180 / std::numbers::pi, 39.6, 0.01);
  camera.yfov = angle;
  EXPECT_NEAR(aperture_radius(FilmPlane(camera, 200, 300), 2), 0.0125, 1e-9);  // upright
  camera.yfov = 2 * std::atan(std::tan(angle / 2) * 200 / 300);
  EXPECT_NEAR(aperture_radius(FilmPlane(camera, 300, 200), 2), 0.0125, 1e-9);
  EXPECT_NEAR(aperture_radius(FilmPlane(camera, 300, 200), 4), 0.00625, 1e-9);
}

TEST(Words, TellLensAndShutter) {
  EXPECT_EQ(focus_words(2.3456), "2.35 m");
  EXPECT_EQ(focus_words(HUGE_VAL), "infinity");
  EXPECT_EQ(shutter_words({}, {}), "an instant");
  EXPECT_EQ(shutter_words({{}, {}, 180}, {"1-4", 24}), "180 degrees at 24 frames per second");
}

}  // namespace tdpt::camera_options_test
