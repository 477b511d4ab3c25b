// For tests of transforms and deformations of meshes: a strip of two triangles with every
// attribute, and a comparison of scenes.
#pragma once
#include <gtest/gtest.h>

#include "libcommon/testing/scenes/materials.h"

namespace tdpt::testing {

inline const std::vector<float> kPositions = {0, 0, 0, 1, 0, 0, 0, 1, 0.5f, 1, 1, 0};
inline const std::vector<float> kNormals = {0, 0, 1, 0.6f, 0, 0.8f, 0, 0.6f, 0.8f, 0, 0, 1};
inline const std::vector<float> kTangents = {1, 0, 0, 1, 1, 0, 0, 1, 0, 1, 0, -1, 1, 0, 0, 1};
inline const std::vector<float> kUv = {0, 0, 1, 0, 0, 1, 1, 1};
inline const std::vector<float> kColours = {1, 0, 0, 1, 0,    1,    0,    1,
                                            0, 0, 1, 1, 0.5f, 0.5f, 0.5f, 1};

/// A strip of two triangles that needs every attribute, its normals and tangents as given.
struct Strip {
  std::vector<float> positions = kPositions, normals = kNormals, tangents = kTangents, uv = kUv,
                     colours = kColours;
};

inline Json add_strip(GlbBuilder& b, const Strip& s) {
  if (b.json["materials"].empty()) {
    const int texture = b.texture(kTwo);
    b.material({{"normalTexture", {{"index", texture}}},
                {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}}});
  }
  return {{"attributes",
           {{"POSITION", b.floats(s.positions, 3)},
            {"NORMAL", b.floats(s.normals, 3)},
            {"TANGENT", b.floats(s.tangents, 4)},
            {"TEXCOORD_0", b.floats(s.uv, 2)},
            {"COLOR_0", b.floats(s.colours, 4)}}},
          {"mode", 5},
          {"material", 0}};
}

/// A fixed triangle far away, so that all scenes have the same frame.
inline void add_frame(GlbBuilder& b) {
  const int p = b.floats({-8, -8, -8, 8, 8, 8, 8, -8, 8}, 3);
  const int plain = b.material(lambert(0.5, 0.5, 0.5));
  b.node({{"mesh", b.mesh({{"attributes", {{"POSITION", p}}}, {"material", plain}})}});
}

inline void expect_same(const Scene& a, const Scene& b) {
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.tangents, b.tangents);
  EXPECT_EQ(a.uv, b.uv);
  EXPECT_EQ(a.colours, b.colours);
  EXPECT_EQ(a.smooth, b.smooth);
  ASSERT_EQ(a.triangles.size(), b.triangles.size());
  for (size_t i = 0; i < a.triangles.size(); ++i)
    EXPECT_EQ(a.triangles[i].vertex, b.triangles[i].vertex);
}

template <class Values>
void expect_near(const Values& a, const Values& b, size_t components, const char* what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  for (size_t i = 0; i < a.size(); ++i)
    for (size_t c = 0; c < components; ++c) {
      const int k = static_cast<int>(c);
      float x, y;
      if constexpr (requires { a[i].x; })
        x = a[i][k], y = b[i][k];
      else
        x = a[i][c], y = b[i][c];
      EXPECT_NEAR(x, y, 1e-6) << what << ' ' << i << ' ' << c;
    }
}

/// Up to float rounding.
inline void expect_near(const Scene& a, const Scene& b) {
  expect_near(a.positions, b.positions, 3, "positions");
  expect_near(a.normals, b.normals, 3, "normals");
  expect_near(a.tangents, b.tangents, 4, "tangents");
  expect_near(a.uv[0], b.uv[0], 2, "texture coordinates");
  expect_near(a.colours, b.colours, 4, "colours");
}

}  // namespace tdpt::testing
