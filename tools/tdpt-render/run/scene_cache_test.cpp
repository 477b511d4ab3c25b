// What a camera focuses on, and why a picture is black.
#include "tools/tdpt-render/run/scene_cache.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/sheets.h"

namespace tdpt::scene_cache_test {

class focus : public ::testing::Test {
 protected:
  // With a sheet across the view, so many metres in front of the camera.
  static Scene with(const Scene& scene, const Material& m, double distance) {
    const Camera camera = scene.camera("");
    const Vec3d at = scene.frame.to_metres(camera.position) + camera.forward * distance;
    return with_sheet(scene, m, at - camera.right * 0.1 - camera.up * 0.07, camera.right * 0.2,
                      camera.up * 0.2);
  }
  static double metres(const Scene& scene, const Camera& camera) {
    return distance_in_the_middle(World(scene, false), {camera, 16, 12}) / scene.frame.scale;
  }
  double metres(const Scene& scene) const { return metres(scene, scene.camera("")); }

  const Scene room_ = read_gltf(two_rooms_path());
  const double wall_ = metres(room_);
};

TEST_F(focus, is_on_the_first_thing_that_stops_most_of_the_light) {
  EXPECT_NEAR(wall_, 2.15, 0.01);
  EXPECT_NEAR(metres(with(room_, Material(), 0.7)), 0.7, 1e-6);
  EXPECT_NEAR(metres(with(room_, clear_pane(), 0.7)), wall_, 1e-6);
}

TEST_F(focus, is_as_far_as_can_be_where_there_is_nothing) {
  Camera away = room_.camera("");
  away.position += away.forward * 100;
  EXPECT_TRUE(std::isinf(metres(room_, away)));
}

TEST_F(focus, on_a_veil_depends_on_its_coverage_alone) {
  for (const float alpha : {0.3f, 0.49f, 0.51f, 0.9f}) {
    for (const double distance : {0.5, 0.5001, 0.5002, 0.5003, 0.5004})
      EXPECT_NEAR(metres(with(room_, veil(alpha), distance)), alpha < 0.5f ? wall_ : distance, 1e-6)
          << alpha;
  }
}

// The camera sees a wall that no light reaches, or stands in the wall.
TEST(camera_sight, a_black_picture_is_told_why_as_far_as_rays_tell) {
  const Scene scene = read_gltf(two_rooms_path());
  const Vista vista(scene, scene.camera(""), 8, 6, {});
  EXPECT_EQ(why_black(vista), "are the samples too few, or is a door shut?");
  Scene inside = scene;
  for (Triangle& t : inside.triangles) std::swap(t.vertex[1], t.vertex[2]);
  inside.normals.clear();
  const Vista in_a_wall(inside, inside.camera(""), 8, 6, {});
  EXPECT_NE(why_black(in_a_wall).find("stand in a wall"), std::string::npos);
}

}  // namespace tdpt::scene_cache_test
