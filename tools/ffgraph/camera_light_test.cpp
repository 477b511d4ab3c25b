#include <cmath>

#include <gtest/gtest.h>

#include "tools/ffgraph/light_flow.h"

namespace tdpt::camera_light_test {

// Three patches: the lamp's room, a wall that the camera sees, a closet that it does not.
struct Rooms {
  Scene scene;
  PatchMap patches;
  Etendue etendue;
  LightTerms terms;

  explicit Rooms(double to_closet = 10) : patches(empty_map(scene)) {
    for (int32_t i = 0; i < 3; ++i) patches.add({{i, 0, 0}, 0, 0});
    etendue.samples = {100, 100, 100};
    etendue.pairs = {{0, 1, 20}, {0, 2, to_closet}};
    terms = {{0, 0, 0}, {50, 0, 0}, {0.5, 0.5, 0.5}, {{0, 10, 0}}};
  }
  static PatchMap empty_map(Scene& scene) {
    scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    scene.triangles = {{{0, 1, 2}, 0}};
    scene.materials.resize(1);
    return {scene, {}, {0}};
  }
  // Share of the camera's light that goes from i to j.
  double share(uint32_t i, uint32_t j, size_t camera = 0) const {
    const auto light = camera_light(patches, etendue, terms);
    double sum = 0;
    for (const Etendue::Pair& p : etendue.pairs)
      if ((p.i == i && p.j == j) || (p.i == j && p.j == i))
        sum += 0.5 * p.count * light[i].brightness * light[j].importance[camera];
    return sum;
  }
};

// All that the camera sees of patch 1 came from patch 0; back goes what is reflected twice more:
// 0.05 of a patch's light arrives at the other, half of it is reflected.
TEST(CameraLight, IsThatOfRadiosity) {
  const Rooms rooms;
  const double round = 0.1 * 0.5 * 0.1 * 0.5, closet = 0.05 * 0.5 * 0.05 * 0.5;
  const double crossing = (1 - closet) / (1 - closet - round);
  EXPECT_NEAR(rooms.share(0, 1), crossing, 1e-3);
  EXPECT_NEAR(rooms.share(1, 0), crossing - 1, 1e-3);
}

// Light goes into the closet and comes back out of it: a little, and as much.
TEST(CameraLight, KnowsWhatAClosetIsWorth) {
  const Rooms rooms;
  EXPECT_NEAR(rooms.share(0, 2), rooms.share(2, 0), 1e-6);
  EXPECT_LT(rooms.share(0, 2), 0.002);
  EXPECT_GT(Rooms(60).share(0, 2), 0.02);  // twin: a wide one
}

// A second camera, in the lamp's room, changes nothing for the first, whatever its picture's light.
TEST(CameraLight, IsThatOfEachCamera) {
  Rooms both;
  for (const bool first : {true, false}) {
    both.terms.seen = {{0, 10, 0}, {30, 0, 0}};
    if (!first) std::swap(both.terms.seen[0], both.terms.seen[1]);
    const Rooms alone;
    EXPECT_NEAR(both.share(0, 1, first ? 0 : 1), alone.share(0, 1), 1e-3);
    EXPECT_LT(both.share(0, 1, first ? 1 : 0), 0.1);
  }
}

TEST(CameraLight, OfACameraThatSeesNoLightHasNoImportance) {
  Rooms both;
  both.terms.seen = {{0, 0, 0}, {0, 10, 0}};
  const auto light = camera_light(both.patches, both.etendue, both.terms);
  ASSERT_FALSE(light.empty());
  for (const PatchLight& l : light) EXPECT_EQ(l.importance[0], 0);
  EXPECT_NEAR(both.share(0, 1, 1), Rooms().share(0, 1), 1e-9);
}

TEST(CameraLight, IsNothingWhereTheCameraSeesNoLight) {
  Rooms dark;
  dark.terms.direct[0] = 0;
  EXPECT_TRUE(camera_light(dark.patches, dark.etendue, dark.terms).empty());
}

// Rough estimates may say that a small patch exchanges more than it has; light must not grow.
TEST(CameraLight, NoPatchHandsOnMoreThanItHas) {
  Rooms rooms;
  rooms.etendue.samples[0] = 0.01;
  rooms.terms.albedo = {0.95, 0.95, 0.5};
  EXPECT_TRUE(std::isfinite(rooms.share(0, 1)));
  EXPECT_LT(rooms.share(0, 1), 40);
}

TEST(Albedos, AreThoseOfColourTextureAndGlass) {
  Scene scene;
  scene.materials.resize(4);
  for (Material& m : scene.materials) m.base_color = Rgb(0.5f);
  scene.materials[1].transmission = 0.8f;
  scene.images.push_back({1, 2, {255, 255, 255, 255, 0, 0, 0, 255}});
  scene.materials[2].maps[MAP_BASE].image = 0;
  scene.materials[3].base_color = Rgb(1.0f);
  const std::vector<double> albedo = albedos_of(scene);
  EXPECT_NEAR(albedo[0], 0.5, 1e-6);
  EXPECT_NEAR(albedo[1], 0.1, 1e-6);
  EXPECT_NEAR(albedo[2], 0.25, 1e-6);
  EXPECT_LT(albedo[3], 1);  // closed white rooms must lose light
}

}  // namespace tdpt::camera_light_test
