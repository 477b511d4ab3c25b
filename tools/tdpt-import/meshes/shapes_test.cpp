#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tools/tdpt-import/meshes/meshes.h"

namespace tdpt::foreign::shapes_test {

constexpr double kPi = std::numbers::pi;

Vec3d corner(const Mesh& mesh, uint32_t i) {
  const Vec3f& p = mesh.positions[i];
  return {p.x, p.y, p.z};
}
/// Twice the area, along the front.
Vec3d front(const Mesh& mesh, const std::array<uint32_t, 3>& t) {
  const Vec3d a = corner(mesh, t[0]);
  return cross(corner(mesh, t[1]) - a, corner(mesh, t[2]) - a);
}
double area(const Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) sum += length(front(mesh, t)) / 2;
  return sum;
}
/// Whether all fronts agree with the normals and, from inside, point outwards.
bool fronts_agree(const Mesh& mesh, const Vec3d& inside) {
  for (const auto& t : mesh.triangles)
    for (const uint32_t i : t) {
      const Vec3f& n = mesh.normals[i];
      if (!(dot(front(mesh, t), Vec3d{n.x, n.y, n.z}) > 0)) return false;
      if (!(dot(front(mesh, t), corner(mesh, i) - inside) > 0)) return false;
    }
  return true;
}
/// Whether an image is not mirrored, seen from the front: v grows downwards.
bool images_are_readable(const Mesh& mesh) {
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto &p = mesh.uv[a], &q = mesh.uv[b], &r = mesh.uv[c];
    if ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]) >= 0) return false;
  }
  return true;
}
std::array<float, 2> uv_at(const Mesh& mesh, const Vec3f& at) {
  for (size_t i = 0; i < mesh.positions.size(); ++i)
    if (length(mesh.positions[i] - at) < 0.01f) return mesh.uv[i];
  return {-1, -1};
}

struct Known {
  const char* name;
  Mesh mesh;
  size_t triangles;
  double area;  // that of the round shape
  Vec3d inside;
  Vec3f place;  // where its picture has (u, v)
  std::array<float, 2> uv;
};

// Images stand upright; u = phi / (2 pi) on round ones, and v = 0 at the top.
TEST(Shapes, HaveTheirAreaTheirFrontAndTheirPictures) {
  for (const auto& [name, mesh, triangles, expected, inside, place, uv] :
       {Known{"square", square(), 2, 4, {0, 0, -1}, {-1, -1, 0}, {0, 1}},
        Known{"cube", cube(), 12, 24, {}, {-1, -1, -1}, {0, 0}},
        Known{"sphere", sphere(), 64u * 31 * 2, 4 * kPi, {}, {0, 1, 0}, {0.25f, 0.5f}},
        Known{"disc", disc(), 64, kPi, {0, 0, -1}, {0, 1, 0}, {0.25f, 1}},
        Known{"cylinder", cylinder(), 128, 2 * kPi, {0, 0, 0.5}, {0, 1, 1}, {0.25f, 0}}}) {
    SCOPED_TRACE(name);
    EXPECT_NEAR(area(mesh), expected, 1e-5);
    EXPECT_EQ(mesh.triangles.size(), triangles);
    EXPECT_TRUE(fronts_agree(mesh, inside));
    EXPECT_TRUE(images_are_readable(mesh));
    EXPECT_EQ(uv_at(mesh, place), uv);
  }
  for (const Vec3f& p : sphere().positions) EXPECT_NEAR(length(p), 1, 0.002);
  const Mesh box = cube();
  for (size_t i = 0; i < 24; ++i)  // of Mitsuba's cube, the lower left corner of the image on top
    if (box.normals[i] == Vec3f(0, 0, 1) && box.positions[i] == Vec3f(1, -1, 1)) {
      EXPECT_EQ(box.uv[i], (std::array<float, 2>{0, 1}));
    }
  Mesh twice = square();  // flipped
  flip_v(twice);
  EXPECT_EQ(twice.uv[0], (std::array<float, 2>{0, 0}));
  flip_v(twice);
  EXPECT_EQ(twice.uv, square().uv);
}

TEST(Shapes, SmoothWeighsByAngles) {
  // Around one corner of a cube, where two triangles share a face.
  Mesh m = cube();
  smooth(m);
  const float third = 1 / std::sqrt(3.0f);
  for (size_t i = 0; i < m.positions.size(); ++i)
    EXPECT_LT(length(m.normals[i] - m.positions[i] * third), 1e-6f) << i;
}

TEST(Shapes, SmoothLeavesAUnitNormalEverywhere) {
  Mesh m;
  m.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}, {-0.0f, 0, 0}};
  m.triangles = {{0, 1, 2}, {2, 1, 0}, {3, 3, 3}};  // two that cancel, one without area
  smooth(m);
  ASSERT_EQ(m.normals.size(), 5u);
  for (const Vec3f& n : m.normals) EXPECT_FLOAT_EQ(length(n), 1);
  m.triangles = {{4, 1, 2}};
  smooth(m);
  EXPECT_EQ(m.normals[0], m.normals[4]);  // -0 is the same place
}

}  // namespace tdpt::foreign::shapes_test
