// Instances against the same scene without instancing; hidden nodes.
#include <gtest/gtest.h>
#include <cmath>

#include "libcommon/testing/scenes/strips.h"

namespace tdpt::testing::instances_test {

/// Two instances: (1, 2, 3), rotated by a quarter about z, scaled by 2 along x; and (4, 5, 6),
/// mirrored.
Scene instanced(const Json& attributes, GlbBuilder b) {
  Json node = {{"mesh", b.mesh(add_strip(b, {}))}, {"translation", {0.5, 0, 0}}};
  node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = attributes;
  b.node(node);
  add_frame(b);
  return load(b);
}

Scene copied(const std::vector<Json>& transforms) {
  GlbBuilder b;
  const int mesh = b.mesh(add_strip(b, {}));
  for (Json t : transforms) {
    t["mesh"] = mesh;
    b.json["nodes"].push_back(t);
    b.node({{"translation", {0.5, 0, 0}}, {"children", {b.json["nodes"].size() - 1}}});
  }
  add_frame(b);
  return load(b);
}

TEST(Instances, AreTheSameSceneAsCopiedNodes) {
  const float half = std::sqrt(0.5f);
  GlbBuilder b;
  const Json all = {{"TRANSLATION", b.floats({1, 2, 3, 4, 5, 6}, 3)},
                    {"ROTATION", b.floats({0, 0, half, half, 0, 0, 0, 1}, 4)},
                    {"SCALE", b.floats({2, 1, 1, 1, -1, 1}, 3)},
                    {"_ID", 0}};
  const Scene scene = instanced(all, b);
  const double h = half;
  expect_same(
      scene, copied({{{"translation", {1, 2, 3}}, {"rotation", {0, 0, h, h}}, {"scale", {2, 1, 1}}},
                     {{"translation", {4, 5, 6}}, {"scale", {1, -1, 1}}}}));
  EXPECT_EQ(scene.warnings, Sentences{});
}

TEST(Instances, MayHaveOneAttributeAlone) {
  GlbBuilder b;
  const Json scales = {{"SCALE", b.floats({1, 2, 3, 3, 2, 1}, 3)}};
  expect_same(instanced(scales, b), copied({{{"scale", {1, 2, 3}}}, {{"scale", {3, 2, 1}}}}));
  expect_same(instanced(Json::object(), {}), copied({Json::object()}));
}

/// A strip, a camera and a lamp; nodes are for a test to add.
GlbBuilder with_camera_and_lamp() {
  GlbBuilder b;
  b.json["cameras"] = Json::array({{{"type", "perspective"}, {"perspective", {{"yfov", 1}}}}});
  b.json["extensions"]["KHR_lights_punctual"]["lights"] = Json::array({{{"type", "point"}}});
  b.mesh({{"attributes", {{"POSITION", b.floats(kPositions, 3)}}}, {"mode", 5}});
  return b;
}
const Json kAll = {
    {"mesh", 0}, {"camera", 0}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}};

TEST(Instances, HoldTheNodesCameraAndLampOnce) {
  GlbBuilder b = with_camera_and_lamp();
  Json node = kAll;
  node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] =
      b.floats({0, 0, 1, 0, 0, 2, 0, 0, 3}, 3);
  b.node(node);
  const Scene s = load(b);
  EXPECT_EQ(s.triangles.size(), 6u);
  EXPECT_EQ(s.cameras.size(), 1u);
  EXPECT_EQ(s.lights.size(), 1u);
}

TEST(Visibility, HidesMeshesAndLampsBelowButNoCameras) {
  for (const bool visible : {false, true}) {
    GlbBuilder b = with_camera_and_lamp();
    b.json["extensionsRequired"] = {"KHR_node_visibility"};
    Json below = kAll;
    below["extensions"]["KHR_node_visibility"]["visible"] = true;
    b.json["nodes"].push_back(below);
    b.node({{"mesh", 0},
            {"children", {0}},
            {"extensions", {{"KHR_node_visibility", {{"visible", visible}}}}}});
    b.node({{"mesh", 0}, {"extensions", {{"KHR_node_visibility", Json::object()}}}});
    const Scene s = load(b);
    EXPECT_EQ(s.triangles.size(), visible ? 6u : 2u);
    EXPECT_EQ(s.lights.size(), visible ? 1u : 0u);
    EXPECT_EQ(s.cameras.size(), 1u);
  }
}

}  // namespace tdpt::testing::instances_test
