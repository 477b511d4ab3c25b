// Animations between their keys: against formulas of each interpolation, and the file as a whole.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "libcommon/testing/scenes/materials.h"

namespace tdpt::testing::pose_test {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// Turned by this angle about +Y.
std::vector<float> about_y(float angle, float length = 1) {
  return {0, length * std::sin(angle / 2), 0, length * std::cos(angle / 2)};
}

std::vector<float> joined(const std::vector<std::vector<float>>& parts) {
  std::vector<float> all;
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

/// A room that stands, a square that moves by node 1, a camera at node 2 that moves.
class Shot {
 public:
  Shot() {
    const int grey = b_.material(Json::object());
    const Json square = {{"material", grey},
                         {"attributes", {{"POSITION", b_.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3)}}}};
    const Json room = {
        {"material", grey},
        {"attributes", {{"POSITION", b_.floats({-50, -50, -50, 50, -50, -50, 50, 50, 50}, 3)}}}};
    b_.node({{"mesh", b_.mesh(room)}});
    b_.node({{"mesh", b_.mesh(square)}, {"name", "square"}});
    b_.camera("eye", {0, 0, 5}, {0, 0, 0}, 0.7, 1);
  }

  /// Moves a property of a node in the last animation, or in a new one of that name.
  void move(int node, const std::string& path, const std::vector<float>& times,
            const std::vector<float>& values, const std::string& way = "LINEAR",
            const std::string& animation = "") {
    Json& all = b_.json["animations"];
    if (all.empty() || !animation.empty())
      all.push_back(
          {{"name", animation}, {"channels", Json::array()}, {"samplers", Json::array()}});
    Json& a = all.back();
    a["channels"].push_back(
        {{"sampler", a["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
    const int components = path == "weights" ? 1 : path == "rotation" ? 4 : 3;
    a["samplers"].push_back({{"input", b_.floats(times, 1)},
                             {"output", b_.floats(values, components)},
                             {"interpolation", way}});
  }

  Scene at(std::optional<double> seconds, const std::vector<std::string>& names = {}) const {
    const TempFolder folder;
    return read_gltf(folder.write("shot.glb", b_.glb()), {seconds, names});
  }

  /// The square's first corner, or with `corner` another, in metres.
  Vec3d place(double seconds, uint32_t corner = 0) const {
    const Scene s = at(seconds);
    return s.frame.to_metres(Vec3d(s.positions[s.triangles[1].vertex[corner]]));
  }

  GlbBuilder& builder() { return b_; }

 private:
  GlbBuilder b_;
};

void expect_near(const Vec3d& a, const Vec3d& b, double tolerance = 2e-5) {
  EXPECT_LT(length(a - b), tolerance)
      << a.x << ' ' << a.y << ' ' << a.z << ", expected " << b.x << ' ' << b.y << ' ' << b.z;
}

TEST(Poses, LinearKeysJoinByStraightLines) {
  Shot shot;
  shot.move(1, "translation", {0.5f, 1, 3}, {1, 2, 3, 3, 2, 1, 3, 12, 1});
  for (const double before : {-7.0, 0.0, 0.5}) expect_near(shot.place(before), {1, 2, 3});
  expect_near(shot.place(0.75), {2, 2, 2});
  expect_near(shot.place(1), {3, 2, 1});
  expect_near(shot.place(1.5), {3, 4.5, 1});
  for (const double after : {3.0, 99.0}) expect_near(shot.place(after), {3, 12, 1});
}

TEST(Poses, StepsHoldUntilTheNextKey) {
  Shot shot;
  shot.move(1, "translation", {0, 1, 2}, {1, 0, 0, 2, 0, 0, 3, 0, 0}, "STEP");
  expect_near(shot.place(0.999), {1, 0, 0});
  expect_near(shot.place(1), {2, 0, 0});
  expect_near(shot.place(1.5), {2, 0, 0});
  expect_near(shot.place(2), {3, 0, 0});
}

TEST(Poses, FramesReachTheKeysThatLieAtThem) {
  Shot shot;
  std::vector<float> times, places;
  for (int k = 0; k < 40; ++k) {
    times.push_back(static_cast<float>(k) / 30);
    for (const float x : {0.25f * static_cast<float>(k), 0.0f, 0.0f}) places.push_back(x);
  }
  shot.move(1, "translation", times, places, "STEP");
  for (int k = 0; k < 40; ++k) expect_near(shot.place(k / 30.0), {0.25 * k, 0, 0});
}

// The spline through a polynomial's values with its derivatives is the polynomial.
TEST(Poses, CubicSplinesAreTheCubicsTheyComeFrom) {
  const auto value = [](double t) { return Vec3d(1 - 2 * t + t * t * t, t * t, 0.5 * t); };
  const auto slope = [](double t) { return Vec3d(-2 + 3 * t * t, 2 * t, 0.5); };
  Shot shot;
  const std::vector<float> times{1, 1.5f, 3};
  std::vector<float> keys;
  for (const float t : times)
    for (const Vec3d& v : {slope(t), value(t), slope(t)})
      for (int c = 0; c < 3; ++c) keys.push_back(static_cast<float>(v[c]));
  shot.move(1, "translation", times, keys, "CUBICSPLINE");
  for (const double t : {1.0, 1.1, 1.5, 1.7, 2.9, 3.0}) expect_near(shot.place(t), value(t), 1e-4);
  EXPECT_GT(length(shot.place(1.7) - value(1.72)), 1e-2);  // twin
}

TEST(Poses, RotationsTurnEvenlyAlongTheShorterArc) {
  Shot shot;
  // The second key has its sign reversed, and another length: the same rotation.
  shot.move(1, "rotation", {0, 2}, joined({about_y(0), about_y(0.5f * kPi, -3)}));
  for (const double t : {0.25, 1.0, 1.6}) {
    const double angle = 0.25 * std::numbers::pi * t;
    expect_near(shot.place(t, 1), {std::cos(angle), 0, -std::sin(angle)});
  }
  // A mean of the quaternions alone turns by another angle.
  const double t = 0.5, half = std::atan2(0.25 * std::sin(0.25 * std::numbers::pi),
                                          0.75 + 0.25 * std::cos(0.25 * std::numbers::pi));
  const Vec3d by_chord{std::cos(2 * half), 0, -std::sin(2 * half)};
  EXPECT_GT(length(shot.place(t, 1) - by_chord), 1e-3);  // twin
}

TEST(Poses, SplinesOfRotationsAreNormalised) {
  Shot shot;
  const std::vector<float> none{0, 0, 0, 0};
  shot.move(1, "rotation", {0, 1},
            joined({none, about_y(0), none, none, about_y(0.5f * kPi), none}), "CUBICSPLINE");
  expect_near(shot.place(0.5, 1), {std::sqrt(0.5), 0, -std::sqrt(0.5)});
}

TEST(Poses, CamerasAndLampsFollowTheirNodes) {
  Shot shot;
  shot.move(2, "translation", {0, 1}, {0, 0, 5, 0, 4, 5});
  shot.builder().json["extensionsUsed"] = {"KHR_lights_punctual"};
  shot.builder().json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  shot.builder().json["nodes"][1]["extensions"]["KHR_lights_punctual"]["light"] = 0;
  shot.move(1, "translation", {0, 1}, {0, 0, 0, 8, 0, 0});
  const Scene s = shot.at(0.25);
  expect_near(s.frame.to_metres(s.camera("eye").position), {0, 1, 5});
  expect_near(s.frame.to_metres(s.lights[0].position), {2, 0, 0});
  EXPECT_EQ(s.warnings, Sentences{});
  EXPECT_EQ(shot.at({}).warnings,
            Sentences{"the scene stands as its animations begin; they last 1 s: --at takes another "
                      "time"});
}

TEST(Poses, WeightsOfTargetsMoveToo) {
  Shot shot;
  GlbBuilder& b = shot.builder();
  Json& mesh = b.json["meshes"][1];
  mesh["primitives"][0]["targets"] = {{{"POSITION", b.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, 3)}},
                                      {{"POSITION", b.floats({0, 1, 0, 0, 1, 0, 0, 1, 0}, 3)}}};
  // A key is two tangents, two values and two tangents.
  shot.move(1, "weights", {0, 1}, {9, 9, 0, 4, 0, 0, 0, 0, 1, 0, 9, 9}, "CUBICSPLINE");
  expect_near(shot.place(0), {0, 4, 0});
  expect_near(shot.place(0.25), {0, 3.375, 0.15625});
}

TEST(Poses, AnimationsAreChosenByName) {
  Shot shot;
  shot.move(1, "translation", {0, 1}, {0, 0, 0, 1, 0, 0}, "LINEAR", "walk");
  shot.move(1, "translation", {0, 4}, {0, 0, 0, 0, 2, 0}, "LINEAR", "jump");
  const auto place = [](const Scene& s) {
    return s.frame.to_metres(Vec3d(s.positions[s.triangles[1].vertex[0]]));
  };
  const Scene all = shot.at(1);
  expect_near(place(all), {1, 0, 0});
  EXPECT_EQ(all.warnings, Sentences{"channels that move what another one moves (--animation names "
                                    "those that count) are left out: animation \"jump\""});
  const Scene jump = shot.at(1, {"jump"});
  expect_near(place(jump), {0, 0.5, 0});
  EXPECT_EQ(jump.warnings, Sentences{});
  ASSERT_EQ(jump.animations.size(), 2u);
  EXPECT_EQ(jump.animations[1].name, "jump");
  EXPECT_EQ(jump.animations[1].seconds, 4);
  try {
    shot.at(1, {"run"});
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("none is called \"run\", expected one of walk, jump"),
              std::string::npos);
  }
}

TEST(Poses, WhatIsWrongInAnimationsThatDoNotCountChangesNothing) {
  Shot shot;
  shot.move(1, "translation", {0, 1}, {0, 0, 0, 1, 0, 0}, "LINEAR", "walk");
  shot.move(1, "rotation", {0, 1}, {NAN, 0, 0, 1, 0, 0, 0, 1}, "LINEAR", "broken");
  EXPECT_EQ(shot.at(0.5, {"walk"}).warnings, Sentences{});
  EXPECT_THROW(shot.at(0.5), InputError);
}

TEST(Poses, ASceneThatStandsStillSaysSo) {
  Shot shot;
  const Scene s = shot.at(1);
  EXPECT_EQ(s.warnings, Sentences{"nothing in the scene is animated: it is the same at all times"});
  EXPECT_EQ(s.pose_hash, "");
  EXPECT_EQ(s.identity(), s.hash);
}

TEST(Poses, FilesMadeAtAnotherTimeAreToldApart) {
  Shot shot;
  shot.move(1, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
  const Scene now = shot.at(0.5), then = shot.at(0.75);
  EXPECT_EQ(now.identity(), shot.at(0.5).identity());
  EXPECT_TRUE(now.is_scene_of(then.identity()));
  check_made_from(now, shot.at(0.5).identity(), "a.cut");
  try {
    check_made_from(now, then.identity(), "a.cut");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("but at another time of its animations (--at)"),
              std::string::npos);
  }
}

TEST(Poses, OfAWalkAreOnePoseOfTheScene) {
  Shot shot;
  shot.move(2, "translation", {0, 1}, {0, 0, 5, 0, 4, 5});
  // Exporters write keys for what stands still, too.
  shot.move(1, "rotation", {0, 0.3f, 1}, joined({about_y(1), about_y(1), about_y(1, -1)}));
  shot.move(1, "scale", {0, 1}, {.1f, .1f, .1f, .1f, .1f, .1f});
  EXPECT_EQ(shot.at(0.1).identity(), shot.at(0.7).identity());
  shot.move(0, "scale", {0, 1}, {1, 1, 1, 1, 1, 1.001f});
  EXPECT_NE(shot.at(0.1).identity(), shot.at(0.7).identity());
}

TEST(Poses, OneFileIsPosedAsOftenAsWanted) {
  Shot shot;
  shot.move(1, "translation", {0, 1}, {0, 0, 0, 1, 0, 0});
  shot.move(2, "translation", {0, 1}, {0, 0, 5, 0, 4, 5});
  const TempFolder folder;
  SceneFile file(folder.write("shot.glb", shot.builder().glb()), {});
  for (const double t : {0.9, 0.1, 0.5}) {
    const Scene once = shot.at(t), again = file.at(t);
    EXPECT_EQ(once.positions, again.positions);
    EXPECT_EQ(once.identity(), again.identity());
    const SceneFile::Glance glance = file.glance_at(t);
    EXPECT_EQ(glance.pose_hash, once.pose_hash);
    ASSERT_EQ(glance.cameras.size(), 1u);
    EXPECT_EQ(once.frame.to_canonical(glance.cameras[0].position), once.cameras[0].position);
  }
}

}  // namespace
}  // namespace tdpt::testing::pose_test
