#include "tools/ffgraph/camera_poses.h"

#include <cmath>

#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "libcommon/testing/files/glb_builder.h"
#include "libcommon/testing/files/temp_folder.h"

namespace tdpt::testing::camera_poses_test {
namespace {

Camera camera_at(double x, double angle = 0) {
  Camera camera;
  camera.position = {x, 0, 0};
  camera.forward = {std::sin(angle), 0, -std::cos(angle)};
  camera.up = {0, 1, 0};
  return camera;
}

using Indices = std::vector<size_t>;

TEST(TellingPoses, OfACameraThatStandsAreOne) {
  EXPECT_EQ(telling_poses({camera_at(0)}), Indices{0});
  EXPECT_EQ(telling_poses({camera_at(0), camera_at(0), camera_at(0)}), Indices{0});
}

TEST(TellingPoses, AreThoseThatMovedOrTurnedFarAndTheLast) {
  std::vector<Camera> walk, turn, both;
  for (int k = 0; k <= 8; ++k) {
    walk.push_back(camera_at(0.0625 * k));
    turn.push_back(camera_at(0, 0.2 * k + 1e-9));
    both.push_back(camera_at(0.0625 * k + 1e-9 * k, 0.2 * k));
  }
  EXPECT_EQ(telling_poses(walk), (Indices{0, 4, 8}));
  EXPECT_EQ(telling_poses(turn), (Indices{0, 4, 8}));
  EXPECT_EQ(telling_poses(both), (Indices{0, 2, 4, 6, 8}));
  walk.push_back(camera_at(0.51));
  EXPECT_EQ(telling_poses(walk), (Indices{0, 4, 8, 9}));
}

TEST(TellingPoses, OfALongWayAreAFew) {
  std::vector<Camera> walk;
  for (int k = 0; k < 200; ++k) walk.push_back(camera_at(k));
  const Indices poses = telling_poses(walk);
  ASSERT_EQ(poses.size(), kMostPoses);
  EXPECT_EQ(poses.front(), 0u);
  EXPECT_EQ(poses.back(), 199u);
}

TEST(CameraPoses, StandInTheSceneAndHaveTheNamesOfTheirFrames) {
  GlbBuilder b;
  b.node({{"mesh",
           b.mesh({{"attributes", {{"POSITION", b.floats({-1, 0, 0, 3, 0, 0, 0, 4, 0}, 3)}}}})}});
  b.camera("walk", {0, 0, 5}, {0, 0, 0}, 0.7, 1);
  const int times = b.floats({0, 1}, 1), places = b.floats({0, 0, 5, 4, 0, 5}, 3);
  b.json["animations"].push_back(
      {{"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}}}},
       {"samplers", {{{"input", times}, {"output", places}}}}});
  const TempFolder folder;
  const std::string path = folder.write("walk.glb", b.glb());
  SceneFile file(path, {});
  const Scene scene = file.at(0.5);
  const std::vector<Camera> poses = camera_poses(file, scene, {scene.camera("walk")}, {"2-4", 4});
  ASSERT_GE(poses.size(), 2u);
  EXPECT_EQ(poses.front().name, "walk, frame 2");
  EXPECT_EQ(poses.back().name, "walk, frame 4");
  EXPECT_LT(length(scene.frame.to_metres(poses.front().position) - Vec3d(2, 0, 5)), 1e-6);
  EXPECT_LT(length(scene.frame.to_metres(poses.back().position) - Vec3d(4, 0, 5)), 1e-6);
  b.json["animations"][0]["channels"][0]["target"]["node"] = 0;  // now the mesh moves
  const std::string other = folder.write("moved.glb", b.glb());
  SceneFile moves(other, {});
  EXPECT_THROW(camera_poses(moves, moves.at(0.5), {}, {"2-4", 4}), InputError);
  EXPECT_EQ(camera_poses(moves, moves.at(0.5), scene.cameras, {"2", 4}).size(), 1u);
}

}  // namespace
}  // namespace tdpt::testing::camera_poses_test
