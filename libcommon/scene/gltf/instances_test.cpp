// Instances against the same scene without instancing; hidden nodes.
#include <gtest/gtest.h>
#include <cmath>

#include "libcommon/base/error.h"
#include "libcommon/testing/scenes/strips.h"

namespace tdpt::testing::instances_test {

// ---- instances
// -----------------------------------------------------------------------------------

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

TEST(Instances, RotationsMayBeSignedIntegers) {
  GlbBuilder b;
  const Json bytes = {
      {"ROTATION", b.accessor(b.view(std::string("\x7f\0\0\0\0\0\x7f\x7f", 8)), 5120, "VEC4", 2)}};
  b.json["accessors"].back()["normalized"] = true;
  expect_same(instanced(bytes, b),
              copied({{{"rotation", {1, 0, 0, 0}}}, {{"rotation", {0, 0, 1, 1}}}}));
  GlbBuilder c;
  const Json shorts = {
      {"ROTATION", c.accessor(c.view(std::string("\0\0\0\x80\0\0\0\0", 8)), 5122, "VEC4", 1)}};
  c.json["accessors"].back()["normalized"] = true;
  expect_same(instanced(shorts, c), copied({{{"rotation", {0, -1, 0, 0}}}}));
}

TEST(Instances, HoldTheNodesCameraAndLampOnce) {
  GlbBuilder b;
  b.json["cameras"] = Json::array({{{"type", "perspective"}, {"perspective", {{"yfov", 1}}}}});
  b.json["extensions"]["KHR_lights_punctual"]["lights"] = Json::array({{{"type", "point"}}});
  const int p = b.floats(kPositions, 3);
  Json node = {{"mesh", b.mesh({{"attributes", {{"POSITION", p}}}, {"mode", 5}})}, {"camera", 0}};
  node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] =
      b.floats({0, 0, 1, 0, 0, 2, 0, 0, 3}, 3);
  node["extensions"]["KHR_lights_punctual"]["light"] = 0;
  b.node(node);
  const Scene s = load(b);
  EXPECT_EQ(s.triangles.size(), 6u);
  EXPECT_EQ(s.cameras.size(), 1u);
  EXPECT_EQ(s.lights.size(), 1u);
}

TEST(Instances, ThatWouldFillTheMemoryAreRefusedBeforeTheyDo) {
  GlbBuilder b;
  const int p = b.floats(std::vector<float>(30000), 3);
  const int t = b.accessor(-1, 5126, "VEC3", 100000);
  b.json["accessors"].back().erase("bufferView");
  Json node = {{"mesh", b.mesh({{"attributes", {{"POSITION", p}}}})}};
  node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = t;
  b.node(node);
  try {
    load(b);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find(":nodes[0]: brings the scene to 1000000000 vertices and "
                                         "333300000 triangles, expected at most"),
              std::string::npos)
        << e.what();
  }
}

// ---- visibility
// ----------------------------------------------------------------------------------

TEST(Visibility, HidesMeshesAndLampsBelowButNoCameras) {
  GlbBuilder b;
  b.json["cameras"] = Json::array({{{"type", "perspective"}, {"perspective", {{"yfov", 1}}}}});
  b.json["extensions"]["KHR_lights_punctual"]["lights"] = Json::array({{{"type", "point"}}});
  const int p = b.floats(kPositions, 3);
  const int mesh = b.mesh({{"attributes", {{"POSITION", p}}}, {"mode", 5}});
  Json below = {{"mesh", mesh}, {"camera", 0}};
  below["extensions"]["KHR_lights_punctual"]["light"] = 0;
  below["extensions"]["KHR_node_visibility"]["visible"] = true;
  b.json["nodes"].push_back(below);
  for (const bool visible : {false, true}) {
    GlbBuilder c = b;
    c.node({{"mesh", mesh},
            {"children", {0}},
            {"extensions", {{"KHR_node_visibility", {{"visible", visible}}}}}});
    c.node({{"mesh", mesh}, {"extensions", {{"KHR_node_visibility", Json::object()}}}});
    c.json["extensionsRequired"] = {"KHR_node_visibility"};
    const Scene s = load(c);
    EXPECT_EQ(s.triangles.size(), visible ? 6u : 2u);
    EXPECT_EQ(s.lights.size(), visible ? 1u : 0u);
    EXPECT_EQ(s.cameras.size(), 1u);
  }
}

}  // namespace tdpt::testing::instances_test
