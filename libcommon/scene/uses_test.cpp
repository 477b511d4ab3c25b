#include "libcommon/scene/uses.h"

#include <gtest/gtest.h>

namespace tdpt::uses_test {

Scene with_everything() {
  Scene scene;
  Material m;
  m.metallic = m.transmission = m.coat = 1;
  m.sheen_color = Rgb(1.0f);
  m.alpha_mode = Material::Alpha::mask;
  m.absorption = Rgb(1.0f);
  m.coloured = true;
  m.maps[MAP_NORMAL].image = m.maps[MAP_EMISSION].image = 0;
  scene.materials = {m, Material{}};
  scene.images.resize(1);
  scene.triangles.resize(3);
  scene.smooth = {1, 0, 2};
  scene.colours.resize(1);
  scene.lights.resize(1);
  scene.sky = std::make_shared<Sky>(Sky::Map{1, 1, {Rgb(1.0f)}}, 0.0, std::vector<Sky::Sun>{});
  return scene;
}

TEST(uses, of_a_scene_with_everything_nothing_is_left_out) {
  for (const cli::Decision& d : uses_of(with_everything(), all_needs())) {
    EXPECT_EQ(d.chosen, "used") << d.what;
    EXPECT_NE(d.reason.front(), '0') << d.reason;
    EXPECT_EQ(d.price, "") << d.what;
  }
}

TEST(uses, of_a_plain_scene_everything_is_left_out_and_saved) {
  Scene scene;
  scene.materials.resize(2);
  const cli::Decisions all = uses_of(scene, all_needs());
  EXPECT_EQ(all.size(), all_needs().size());
  for (const cli::Decision& d : all) {
    EXPECT_EQ(d.chosen, "left out") << d.what;
    EXPECT_NE(d.price, "") << d.what;
  }
}

TEST(uses, says_how_many_ask_for_it) {
  const cli::Decisions d = uses_of(with_everything(), {"specular", "shading normals"});
  ASSERT_EQ(d.size(), 2u);
  EXPECT_EQ(cli::sentence(d[0]),
            "shading normals: used, because 2 of 3 triangles have normals that are not their own");
  EXPECT_EQ(cli::sentence(d[1]), "specular: used, because 1 of 2 materials shine");
  EXPECT_EQ(cli::sentence(uses_of(Scene{}, {"a sky"})[0]),
            "a sky: left out, because neither an environment nor a sun is given (what leaves the "
            "scene is dropped)");
}

}  // namespace tdpt::uses_test
