// No path is sampled for a picture that no path can light.
#include "tools/tdpt-render/plan/plan.h"

#include <gtest/gtest.h>

#include "libcommon/scene/sky.h"
#include "tools/tdpt-render/plan/candidates.h"
#include "tools/tdpt-render/testing/rendering.h"
#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::session_test {

constexpr int kWidth = 16, kHeight = 12;
constexpr uint64_t kSpp = 8;

Scene rooms() {
  return read_gltf(two_rooms_path());
}
Scene under_a_sky(Scene scene) {
  scene.sky = std::make_shared<Sky>(Sky::Map{1, 1, {Rgb(1.0f)}}, 0.0);
  return scene;
}
// Above the roof, looking up, turned by `degrees` towards the camera's right.
Camera from_above(const Scene& scene, double degrees) {
  const double a = degrees * std::numbers::pi / 180;
  Camera camera = scene.camera("");
  camera.position = {0, 5, 0};
  camera.forward = {std::sin(a), std::cos(a), 0};
  camera.right = {std::cos(a), -std::sin(a), 0};
  camera.up = {0, 0, 1};
  camera.yfov = 1;
  return camera;
}

RenderResult rendered(const Vista& vista, bool alpha = false) {
  Job settings;
  settings.limits.spp = kSpp;
  settings.alpha = alpha;
  return render(vista, auto_candidates(vista), settings);
}

TEST(longest_path, of_a_scene_without_light_is_none_and_costs_no_ray) {
  Scene scene = rooms();
  for (Material& m : scene.materials) m.emission = {};
  const Vista vista(scene, scene.camera(""), kWidth, kHeight, {});
  EXPECT_EQ(longest_path(vista, kMaxDepth, false), 0);
  const RenderResult r = rendered(vista);
  EXPECT_EQ(r.tally.rays.closest + r.tally.rays.shadow, 0u);
  EXPECT_EQ(r.spp(), kSpp);
  EXPECT_EQ(r.nonzero(), 0);
  EXPECT_EQ(r.picture.pixels.size(), size_t{kWidth * kHeight});
  // A transparent film still tells what is met.
  const RenderResult transparent = rendered(vista, true);
  EXPECT_EQ(transparent.tally.rays.closest, kSpp * kWidth * kHeight);
  for (const float a : transparent.picture.alpha) EXPECT_EQ(a, 1);
}

TEST(longest_path, is_none_where_the_camera_looks_past_everything) {
  const Scene scene = rooms();
  const Vista vista(scene, from_above(scene, 0), kWidth, kHeight, {});
  EXPECT_FALSE(may_see_surfaces(vista));
  const RenderResult r = rendered(vista);
  EXPECT_EQ(r.tally.rays.closest + r.tally.rays.shadow, 0u);
  EXPECT_EQ(r.nonzero(), 0);
}

TEST(longest_path, is_the_cameras_ray_where_only_the_sky_is_seen) {
  const Scene scene = under_a_sky(rooms());
  const Vista vista(scene, from_above(scene, 0), kWidth, kHeight, {});
  const RenderResult r = rendered(vista);
  EXPECT_EQ(r.tally.rays.closest, kSpp * kWidth * kHeight);
  EXPECT_EQ(r.tally.rays.shadow, 0u);
  for (const Rgb& p : r.picture.pixels) EXPECT_NEAR(p.x, 1, 1e-5);
}

// Twin: a camera that sees a corner of the scene samples as usual. From 4 above its centre the cube
// fills a cone of 2 atan(sqrt(2)/4) about the downward direction.
TEST(longest_path, is_as_asked_for_where_a_surface_may_be_seen) {
  const Scene scene = rooms();
  for (const double degrees : {160.0, 180.0, 200.0}) {
    const Vista vista(scene, from_above(scene, degrees), kWidth, kHeight, {});
    EXPECT_TRUE(may_see_surfaces(vista)) << degrees;
    EXPECT_EQ(longest_path(vista, kMaxDepth, false), kMaxDepth);
    EXPECT_GT(rendered(vista).tally.rays.closest, kSpp * kWidth * kHeight);
  }
  const Vista inside(scene, scene.camera(""), kWidth, kHeight, {});
  EXPECT_EQ(longest_path(inside, 7, false), 7);
}

// Never false if a camera ray hits something.
TEST(longest_path, never_passes_by_what_a_ray_meets) {
  const Scene scene = rooms();
  size_t met_in = 0, passed_by = 0;
  for (int degrees = 0; degrees < 360; degrees += 3) {
    const Vista vista(scene, from_above(scene, degrees), kWidth, kHeight, {});
    bool met = false;
    for (int y = 0; y <= kHeight; ++y)
      for (int x = 0; x <= kWidth; ++x) {
        Hit hit;
        met |= vista.world->tracer.closest({vista.view.film.position()},
                                           vista.view.film.direction(x, y), hit);
      }
    met_in += met;
    passed_by += !may_see_surfaces(vista);
    EXPECT_FALSE(met && !may_see_surfaces(vista)) << degrees;
  }
  EXPECT_GT(met_in, 10u);
  EXPECT_GT(passed_by, 60u);
}

}  // namespace tdpt::session_test
