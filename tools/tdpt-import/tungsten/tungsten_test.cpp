#include "tools/tdpt-import/described.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "libcommon/testing/files/temp_folder.h"
#include "tools/tdpt-import/meshes/meshes.h"

namespace tdpt::foreign::tungsten_test {

using std::numbers::pi;

Described described(const std::string& type, const std::string& transform) {
  const testing::TempFolder folder;
  Source source(folder.write(
      "scene.json",
      fmt::format(R"({{"primitives": [{{"type": "{}", "transform": {}}}]}})", type, transform)));
  return read_tungsten(source);
}

// Tungsten's own (u, v) at a point of a shape with axes X, Y, Z of lengths s at the origin, by
// intersectionInfo() of its sources; std::nullopt where they have no u.
using Uv = std::array<double, 2>;
std::optional<Uv> tungsten_uv(const std::string& type, const Vec3d& p, const Vec3d& n,
                              const std::array<Vec3d, 3>& axes, const Vec3d& s) {
  const auto turned = [](double y, double x) { return std::atan2(y, x) / (2 * pi) + 0.5; };
  const double x = dot(p, axes[0]), y = dot(p, axes[1]), z = dot(p, axes[2]);
  const double wide = std::max(s.x, s.z);
  if (type == "quad") return Uv{x / s.x + 0.5, z / s.z + 0.5};
  if (type == "cube") {
    const double at[] = {x / s.x + 0.5, y / s.y + 0.5, z / s.z + 0.5};
    size_t dim = 0;
    for (size_t i = 1; i < 3; ++i)
      if (std::abs(dot(n, axes[i])) > std::abs(dot(n, axes[dim]))) dim = i;
    return Uv{at[(dim + 1) % 3], at[(dim + 2) % 3]};
  }
  if (type == "sphere") {
    if (std::hypot(x, y) < 1e-5) return {};
    return Uv{turned(y, x), std::acos(std::clamp(z / length(p), -1.0, 1.0)) / pi};
  }
  if (type == "disk") {  // the frame of Duff et al. about the normal
    const Vec3d m = axes[1];
    const double sign = m.z < 0 ? -1 : 1, a = -1 / (sign + m.z), b = m.x * m.y * a;
    const Vec3d tangent{1 + sign * m.x * m.x * a, sign * b, -sign * m.x};
    const Vec3d bitangent{b, sign + m.y * m.y * a, -m.y};
    if (length(p) < 1e-6) return {};
    return Uv{turned(dot(p, tangent), dot(p, bitangent)), length(p) / wide};
  }
  if (std::abs(dot(n, axes[1])) > 0.5) return Uv{x / wide + 0.5, z / wide + 0.5};  // a cap
  return Uv{turned(z, x), y / s.y + 0.5};
}

// Images lie on shapes as in Tungsten: all of its vertices, turned and of uneven size.
TEST(Tungsten, ImagesLieOnShapesAsInItsSources) {
  const std::array<Vec3d, 3> axes{Vec3d{2, 2, 1} / 3.0, Vec3d{-2, 1, 2} / 3.0,
                                  Vec3d{1, -2, 2} / 3.0};
  const Vec3d s{1.5, 2.5, 2};
  const Vec3d x = axes[0] * s.x, y = axes[1] * s.y, z = axes[2] * s.z;
  const std::string matrix = fmt::format("[{},{},{},0, {},{},{},0, {},{},{},0, 0,0,0,1]", x.x, y.x,
                                         z.x, x.y, y.y, z.y, x.z, y.z, z.z);
  for (const std::string type : {"quad", "sphere", "disk", "cube", "cylinder"}) {
    const Described d = described(type, matrix);
    const Shape& shape = d.shapes.at(0);
    const Mesh& mesh = d.meshes.at(shape.mesh);
    size_t compared = 0;
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
      const Vec3f &p = mesh.positions[i], &n = mesh.normals[i];
      const auto uv = tungsten_uv(type, shape.to_world.point({p.x, p.y, p.z}),
                                  shape.to_world.vector({n.x, n.y, n.z}), axes, s);
      if (!uv) continue;
      const double turns = mesh.uv[i][0] - (*uv)[0], rows = mesh.uv[i][1] - (1 - (*uv)[1]);
      ASSERT_NEAR(turns, std::round(turns), 3e-3) << type << " " << i;  // corners lie outside
      ASSERT_NEAR(rows, 0, 3e-3) << type << " " << i;
      ++compared;
    }
    EXPECT_GE(compared, 4u) << type;
  }
}

// Of radius 1/2 and height 1, with its front outside.
TEST(Tungsten, CylindersAreClosed) {
  const Mesh mesh = described("cylinder", "{}").meshes.at(0);
  double surface = 0;
  for (const auto& t : mesh.triangles) {
    Vec3d middle{0, 0, -0.5};
    for (const uint32_t corner : t) middle += in_double(mesh.positions[corner]) / 3.0;
    surface += length(front_of(mesh, t)) / 2;
    EXPECT_GT(dot(front_of(mesh, t), middle), 0);
  }
  EXPECT_NEAR(surface, pi + pi / 2, 1e-4);
}

}  // namespace tdpt::foreign::tungsten_test
