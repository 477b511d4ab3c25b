// Closed glass surfaces without volume cause a warning; panes and solids do not.
#include <gtest/gtest.h>
#include <cmath>
#include <numbers>

#include "libcommon/testing/scenes/materials.h"

namespace tdpt::testing::bubbles_test {

struct Surface {
  std::vector<float> positions;
  std::vector<uint16_t> indices;
};

// Each face has its own corners, as exporters write flat shading. `share`: of each face's width and
// height, in its middle.
Surface box(float x, float y, float z, size_t faces = 6, float share = 1) {
  Surface s;
  for (size_t face = 0; face < faces; ++face) {
    const size_t axis = face / 2, a = (axis + 1) % 3, b = (axis + 2) % 3;
    const float side = face % 2 ? 1.f : -1.f, size[3] = {x, y, z};
    const auto first = static_cast<uint16_t>(s.positions.size() / 3);
    for (const auto& [u, v] : {std::pair(-1.f, -1.f), {side, -side}, {1.f, 1.f}, {-side, side}}) {
      float p[3];
      p[axis] = side, p[a] = share * u, p[b] = share * v;
      for (size_t c = 0; c < 3; ++c) s.positions.push_back(p[c] * size[c] / 2);
    }
    for (const int i : {0, 1, 2, 0, 2, 3}) s.indices.push_back(static_cast<uint16_t>(first + i));
  }
  return s;
}

// With a seam, where the texture coordinates restart.
Surface ball(int n) {
  Surface s;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= 2 * n; ++j) {
      const double theta = std::numbers::pi * i / n, phi = std::numbers::pi * j / n;
      for (const double x :
           {std::sin(theta) * std::cos(phi), std::cos(theta), -std::sin(theta) * std::sin(phi)})
        s.positions.push_back(static_cast<float>(x));
    }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < 2 * n; ++j) {
      const int a = i * (2 * n + 1) + j, b = a + 2 * n + 1;
      if (i + 1 < n)
        for (const int k : {a, b, b + 1}) s.indices.push_back(static_cast<uint16_t>(k));
      if (i > 0)
        for (const int k : {a, b + 1, a + 1}) s.indices.push_back(static_cast<uint16_t>(k));
    }
  return s;
}

Json glass(Json extensions = Json::object()) {
  extensions["KHR_materials_transmission"] = {{"transmissionFactor", 1}};
  return {{"name", "glass"},
          {"pbrMetallicRoughness", {{"metallicFactor", 0}}},
          {"extensions", extensions}};
}

Sentences warnings(const Surface& s, const Json& material, int times = 1,
                   const Json& placement = Json::object()) {
  GlbBuilder b;
  const int m = b.material(material);
  const int mesh = b.mesh({{"attributes", {{"POSITION", b.floats(s.positions, 3)}}},
                           {"indices", b.indices_u16(s.indices)},
                           {"material", m}});
  for (int i = 0; i < times; ++i) {
    Json node = placement;
    node["mesh"] = mesh;
    b.node(node);
  }
  return load(b).warnings;
}

const Sentences kBubble{
    "closed meshes of glass without a thickness (KHR_materials_volume) are soap bubbles, not "
    "solid: "
    "material \"glass\""};

TEST(Bubbles, BallsAndBlocksWithoutAThicknessAreTold) {
  for (const Surface& s : {ball(12), box(1, 1, 1), box(1, 1, 0.05f)})
    EXPECT_EQ(warnings(s, glass()), kBubble);
  EXPECT_EQ(warnings(ball(12), glass(), 3), kBubble);
}

TEST(Bubbles, WhereverTheyLieAndHoweverTheyAreTurned) {
  for (const Json& placement :
       {Json{{"translation", {1e4, -5, 2}}}, Json{{"scale", {-1e-3, 1e-3, 1e-3}}}})
    EXPECT_EQ(warnings(ball(12), glass(), 1, placement), kBubble);
}

// One pane in each wall of a room, all in one mesh: their area vectors cancel as those of a closed
// surface do.
TEST(Bubbles, PanesInOppositeWallsAreNot) {
  for (const size_t walls : {2, 4, 6})
    EXPECT_EQ(warnings(box(6, 3, 4, walls, 0.4f), glass()), Sentences{}) << walls;
  // Walls of glass without lids, edge to edge; with lids they are a body.
  EXPECT_EQ(warnings(box(6, 3, 4, 4), glass()), Sentences{});
  EXPECT_EQ(warnings(box(6, 3, 4), glass()), kBubble);
}

TEST(Bubbles, PanesSolidsAndWhatDoesNotRefractAreNot) {
  EXPECT_EQ(warnings(box(1, 1, 1, 5), glass()), Sentences{});      // open
  EXPECT_EQ(warnings(box(1, 1, 1, 1), glass()), Sentences{});      // one sheet
  EXPECT_EQ(warnings(box(1.2f, 1, 0.01f), glass()), Sentences{});  // a pane with two faces
  EXPECT_EQ(warnings(ball(12), glass({{"KHR_materials_ior", {{"ior", 1}}}})), Sentences{});
  EXPECT_EQ(warnings(ball(12), glass({{"KHR_materials_volume", {{"thicknessFactor", 1}}}})),
            Sentences{});
  EXPECT_EQ(warnings(ball(12), lambert(0.5, 0.5, 0.5)), Sentences{});
}

}  // namespace tdpt::testing::bubbles_test
