// Skins, morph targets and animations against the same scene with explicit geometry.
#include <gtest/gtest.h>
#include <cmath>
#include <functional>

#include "libcommon/base/error.h"
#include "libcommon/scene/gltf/nodes.h"
#include "libcommon/testing/scenes/strips.h"

namespace tdpt::testing::motion_test {

// They need not add up to 1.
const std::vector<float> kWeights = {1,     0,     0, 0, 0, 0.5f,  0, 0,
                                     0.25f, 0.75f, 0, 0, 0, 0.25f, 0, 0.75f};
const std::vector<uint8_t> kJoints = {0, 1, 1, 1, 0, 1, 7, 7, 0, 1, 0, 0, 0, 0, 0, 1};

/// The effect of skinned()'s joints on a vertex, by textbook matrices.
Affine joint(int k) {
  // Joint 0 translates by (0, 0, 2); joint 1 rotates by a quarter about z, x to y, at (1, 0, 0),
  // and is a child of joint 0; the inverse bind matrix of joint 1 translates by (-1, 0, 0).
  const Affine move{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 2}};
  if (k == 0) return move;
  const Affine turn{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}, {1, 0, 0}};
  const Affine unbind{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}};
  return move * turn * unbind;
}

/// The strip `s`, bent by two joints. `weights`: an accessor of b, or -1.
Scene skinned(const Strip& s, GlbBuilder b = {}, int weights = -1) {
  Json p = add_strip(b, s);
  const std::string joints(kJoints.begin(), kJoints.end());
  p["attributes"]["JOINTS_0"] = b.accessor(b.view(joints), 5121, "VEC4", 4);
  p["attributes"]["WEIGHTS_0"] = weights < 0 ? b.floats(kWeights, 4) : weights;
  // The mesh's own node is ignored; a joint's place in the hierarchy matters.
  b.node({{"mesh", b.mesh(p)}, {"skin", 0}, {"translation", {5, 5, 5}}, {"scale", {-3, 1, 1}}});
  const double half = std::sqrt(0.5);
  b.json["nodes"].push_back({{"rotation", {0, 0, half, half}}, {"translation", {1, 0, 0}}});
  b.node({{"translation", {0, 0, 2}}, {"children", {b.json["nodes"].size() - 1}}});
  const auto first = b.json["nodes"].size() - 1;
  std::vector<float> m(32);
  for (size_t i = 0; i < 2; ++i)
    for (size_t c = 0; c < 4; ++c) m[16 * i + 5 * c] = 1;
  m[28] = -1;
  const int view =
      b.view(std::string(reinterpret_cast<const char*>(m.data()), m.size() * sizeof(float)));
  b.json["skins"] = Json::array({{{"joints", {first, first - 1}},
                                  {"inverseBindMatrices", b.accessor(view, 5126, "MAT4", 2)}}});
  add_frame(b);
  return load(b);
}

/// The same explicitly: each vertex through the blend of its joints' matrices.
Strip bent(Strip s, const std::vector<float>& weights) {
  for (size_t v = 0; v < 4; ++v) {
    Affine blend{{}, {}, {}, {}};
    double total = 0;
    for (size_t k = 0; k < 4; ++k) total += weights[4 * v + k];
    for (size_t k = 0; k < 4; ++k) {
      const double w = weights[4 * v + k] / total;
      if (w == 0) continue;
      const Affine a = joint(kJoints[4 * v + k]);
      blend.x += a.x * w, blend.y += a.y * w, blend.z += a.z * w, blend.t += a.t * w;
    }
    const auto vec = [&](const std::vector<float>& from, size_t n) {
      return Vec3d(from[n * v], from[n * v + 1], from[n * v + 2]);
    };
    const auto put = [&](std::vector<float>& to, size_t n, const Vec3d& value) {
      for (size_t c = 0; c < 3; ++c) to[n * v + c] = static_cast<float>(value[static_cast<int>(c)]);
    };
    // Cofactors: the inverse transpose up to the determinant.
    const Affine cofactors{
        cross(blend.y, blend.z), cross(blend.z, blend.x), cross(blend.x, blend.y), {}};
    put(s.positions, 3, blend.point(vec(s.positions, 3)));
    put(s.normals, 3, normalize(cofactors.vector(vec(s.normals, 3))));
    put(s.tangents, 4, normalize(blend.vector(vec(s.tangents, 4))));
  }
  return s;
}

Scene still(const Strip& s) {
  GlbBuilder b;
  b.node({{"mesh", b.mesh(add_strip(b, s))}});
  add_frame(b);
  return load(b);
}

TEST(Skins, AreTheSameSceneAsTheMeshBaked) {
  const Scene s = skinned({});
  EXPECT_EQ(s.warnings, Sentences{});
  expect_near(s, still(bent({}, kWeights)));
}

TEST(Skins, AVertexWithoutWeightFollowsItsFirstJoint) {
  GlbBuilder b;
  std::vector<float> none = kWeights, first = kWeights;
  none[5] = 0, first[4] = 1, first[5] = 0;  // of vertex 1, whose first joint is 0
  const int weights = b.floats(none, 4);
  expect_near(skinned({}, b, weights), still(bent({}, first)));
}

/// The strip, all of whose vertices follow the first of `joints`, which are nodes from 1 on.
GlbBuilder following(const Json& joints, const std::vector<Json>& nodes, Json p, GlbBuilder b) {
  p["attributes"]["JOINTS_0"] = b.accessor(b.view(std::string(16, '\0')), 5121, "VEC4", 4);
  p["attributes"]["WEIGHTS_0"] = b.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 4);
  b.node({{"mesh", b.mesh(p)}, {"skin", 0}});
  for (const Json& n : nodes) b.json["nodes"].push_back(n);
  b.json["skins"] = Json::array({{{"joints", joints}}});
  add_frame(b);
  return b;
}
GlbBuilder following(const Json& joints, const std::vector<Json>& nodes) {
  GlbBuilder b;
  const Json strip = add_strip(b, {});
  return following(joints, nodes, strip, b);
}

Strip moved_by(float x, float y, float z) {
  Strip s;
  for (size_t v = 0; v < 4; ++v)
    s.positions[3 * v] += x, s.positions[3 * v + 1] += y, s.positions[3 * v + 2] += z;
  return s;
}

TEST(Skins, SetsOfJointsFollowEachOther) {
  GlbBuilder b;
  Json p = add_strip(b, {});
  p["attributes"]["JOINTS_1"] = b.accessor(b.view(std::string(16, '\1')), 5121, "VEC4", 4);
  p["attributes"]["WEIGHTS_1"] = b.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, 4);
  const std::vector<Json> nodes = {{{"translation", {0, 0, 2}}}, {{"translation", {4, 0, 0}}}};
  expect_near(load(following({1, 2}, nodes, p, b)), still(moved_by(2, 0, 1)));
}

TEST(Skins, JointsMayStandOutsideOfTheScene) {
  const std::vector<Json> nodes = {{{"translation", {1, 0, 0}}},
                                   {{"translation", {0, 2, 0}}, {"children", {1}}}};
  expect_near(load(following({1}, nodes)), still(moved_by(1, 2, 0)));
}

TEST(Skins, WhatHasNoJointsIsPlacedByItsNode) {
  GlbBuilder b;
  b.node({{"mesh", b.mesh(add_strip(b, {}))}, {"skin", 0}, {"translation", {1, 0, 0}}});
  b.json["skins"] = Json::array({{{"joints", {0}}}});
  add_frame(b);
  const Scene s = load(b);
  expect_near(s, still(moved_by(1, 0, 0)));
  EXPECT_EQ(s.warnings,
            Sentences{"primitives of skinned meshes without joints are placed by their node: "
                      "meshes[0].primitives[0]"});
}

TEST(Skins, MirroringJointsKeepTheFrontTheFront) {
  GlbBuilder c;
  c.node({{"mesh", c.mesh(add_strip(c, {}))}, {"scale", {-1, 1, 1}}});
  add_frame(c);
  const std::vector<Json> nodes = {{{"scale", {-1, 1, 1}}}, Json::object()};
  const Scene s = load(following({1}, nodes));
  expect_near(s, load(c));
  EXPECT_EQ(s.triangles[0].vertex, load(c).triangles[0].vertex);
  // Joints that no vertex follows have no effect.
  EXPECT_EQ(load(following({1, 2, 2}, nodes)).triangles[0].vertex, s.triangles[0].vertex);
}

/// The strip with two targets that change every attribute; `set` sets the weights.
GlbBuilder morphing(const std::function<void(GlbBuilder&, Json& node, Json& mesh)>& set) {
  GlbBuilder b;
  Json p = add_strip(b, {});
  const std::vector<float> up = {0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0, 4};
  const std::vector<float> lean = {0.5f, 0, 0, 0, 0.5f, 0, 0, 0, 0.5f, 0.25f, 0, 0};
  const std::vector<float> shift = {0.5f, 0, 0.5f, 0, 0.5f, 0, 0.5f, 0};
  const std::vector<float> tint = {0, 0.5f, 0, 0.5f, 0, 0, 0, 0.5f, 0, 0, 0, 0.5f};
  p["targets"] = Json::array({{{"POSITION", b.floats(up, 3)},
                               {"NORMAL", b.floats(lean, 3)},
                               {"TANGENT", b.floats(lean, 3)},
                               {"TEXCOORD_0", b.floats(shift, 2)},
                               {"COLOR_0", b.floats(tint, 3)}},
                              {{"POSITION", b.floats(lean, 3)}}});
  const auto mesh = static_cast<size_t>(b.mesh(p));
  Json node = {{"mesh", mesh}};
  set(b, node, b.json["meshes"][mesh]);
  b.node(node);
  add_frame(b);
  return b;
}

/// The same explicitly, with the weights of the first and of the second target.
Strip morphed(float first, float second) {
  Strip s;
  const float lean[12] = {0.5f, 0, 0, 0, 0.5f, 0, 0, 0, 0.5f, 0.25f, 0, 0};
  const float tint[12] = {0, 0.5f, 0, 0.5f, 0, 0, 0, 0.5f, 0, 0, 0, 0.5f};
  for (size_t v = 0; v < 4; ++v) {
    s.positions[3 * v + 2] += first * static_cast<float>(v + 1);
    s.uv[2 * v] += first * 0.5f;
    for (size_t c = 0; c < 3; ++c) {
      s.positions[3 * v + c] += second * lean[3 * v + c];
      s.normals[3 * v + c] += first * lean[3 * v + c];
      s.tangents[4 * v + c] += first * lean[3 * v + c];
      float& colour = s.colours[4 * v + c];
      colour = std::clamp(colour + first * tint[3 * v + c], 0.0f, 1.0f);
    }
  }
  return s;
}

TEST(Morphs, AreTheSameSceneAsTheMeshBaked) {
  const Scene both = load(morphing([](GlbBuilder&, Json&, Json& mesh) {
    mesh["weights"] = {0.5, 2};
  }));
  EXPECT_EQ(both.warnings, Sentences{});
  expect_near(both, still(morphed(0.5f, 2)));
  const Scene by_node = load(morphing([](GlbBuilder&, Json& node, Json& mesh) {
    mesh["weights"] = {0.5, 2};
    node["weights"] = {-1, 0.25};
  }));
  expect_near(by_node, still(morphed(-1, 0.25f)));
}

TEST(Morphs, WithoutWeightsChangeNothing) {
  expect_same(load(morphing([](GlbBuilder&, Json&, Json&) {})), still({}));
  expect_same(load(morphing([](GlbBuilder&, Json&, Json& mesh) {
                mesh["weights"] = {0, 0};
              })),
              still({}));
}

TEST(Morphs, ComeBeforeTheSkin) {
  GlbBuilder b;
  Json p = add_strip(b, {});
  p["targets"] = {{{"POSITION", b.floats({0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0, 4}, 3)}}};
  b = following({1}, {{{"scale", {1, 1, 2}}}}, p, b);
  b.json["nodes"][0]["weights"] = {1};
  const Scene s = load(b);
  const double scale = s.frame.scale;  // the middle of the frame is the origin
  EXPECT_NEAR(s.positions[3].z, (0 + 4) * 2 * scale, 1e-6);
  EXPECT_NEAR(s.positions[2].z, (0.5 + 3) * 2 * scale, 1e-6);
}

const Sentences kAtTime0{
    "the scene stands as its animations begin; they last 1 s: --at takes another time"};

/// A channel of b that animates node 0; `output`: its accessor.
void animate(GlbBuilder& b, const std::string& path, int output,
             const std::string& interpolation = "LINEAR") {
  const int input = b.floats({0.5f, 1}, 1);
  b.json["animations"].push_back(
      {{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", path}}}}}},
       {"samplers", {{{"input", input}, {"output", output}, {"interpolation", interpolation}}}}});
}

Scene moved(const Json& transform, const std::function<void(GlbBuilder&)>& change = {}) {
  GlbBuilder b;
  Json node = transform;
  node["mesh"] = b.mesh(add_strip(b, {}));
  b.node(node);
  if (change) change(b);
  add_frame(b);
  return load(b);
}

TEST(Animations, AreTakenAtTheirBeginning) {
  const Json place = {{"translation", {1, 2, 3}}, {"rotation", {0, 0, 1, 0}}, {"scale", {1, 2, 1}}};
  const Json elsewhere = {{"translation", {4, 4, 4}}, {"scale", {3, 3, 3}}};
  const Scene s = moved(elsewhere, [](GlbBuilder& b) {
    animate(b, "translation", b.floats({1, 2, 3, 7, 7, 7}, 3), "STEP");
    // A key of a spline is a tangent, a value and a tangent.
    animate(b, "scale", b.floats({9, 9, 9, 1, 2, 1, 9, 9, 9, 9, 9, 9, 5, 5, 5, 9, 9, 9}, 3),
            "CUBICSPLINE");
    const int bytes = b.accessor(b.view(std::string("\0\0\x7f\0\x7f\0\0\0", 8)), 5120, "VEC4", 2);
    b.json["accessors"].back()["normalized"] = true;
    animate(b, "rotation", bytes);
  });
  expect_same(s, moved(place));
  EXPECT_EQ(s.warnings, kAtTime0);
}

TEST(Animations, ThatMoveNothingAreToldOf) {
  const Scene s =
      moved({{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 2, 3, 1}}}, [](GlbBuilder& b) {
        animate(b, "translation", b.floats({4, 4, 4, 7, 7, 7}, 3));
        animate(b, "pointer", b.floats({4, 4, 4, 7, 7, 7}, 3));
      });
  expect_same(s, moved({{"translation", {1, 2, 3}}}));
  EXPECT_EQ(s.warnings,
            (Sentences{"channels of nodes that have a matrix are left out: animation \"animation\"",
                       "channels that move no node (KHR_animation_pointer) are left out: animation "
                       "\"animation.1\""}));
}

}  // namespace tdpt::testing::motion_test
