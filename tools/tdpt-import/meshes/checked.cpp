#include "tools/tdpt-import/meshes/checked.h"

#include <cmath>

#include <fmt/format.h>

#include "libcommon/base/error.h"

namespace tdpt::foreign {
namespace {

Vec3d position(const Mesh& mesh, uint32_t vertex) {
  const Vec3f& p = mesh.positions[vertex];
  return {p.x, p.y, p.z};
}

bool is_unit(const Vec3f& n) {
  return n.x != 0 || n.y != 0 || n.z != 0;
}

// In double precision, since squares of small or large floats leave the range of float.
Vec3f unit_or_zero(const Vec3d& n) {
  const double l = length(n);
  if (!(l > 0) || !std::isfinite(l)) return {};
  return {static_cast<float>(n.x / l), static_cast<float>(n.y / l), static_cast<float>(n.z / l)};
}

void mend_normals(Mesh& mesh) {
  size_t usable = 0;
  for (Vec3f& n : mesh.normals) {
    n = unit_or_zero({n.x, n.y, n.z});
    usable += is_unit(n);
  }
  if (usable == 0) mesh.normals.clear();
  if (usable == mesh.normals.size()) return;
  std::vector<Vec3d> sums(mesh.positions.size());  // weighted by area
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3d at = position(mesh, a);
    const Vec3d n = cross(position(mesh, b) - at, position(mesh, c) - at);
    for (const uint32_t corner : {a, b, c}) sums[corner] = sums[corner] + n;
  }
  for (size_t i = 0; i < sums.size(); ++i) {
    if (is_unit(mesh.normals[i])) continue;
    mesh.normals[i] = unit_or_zero(sums[i]);
    if (!is_unit(mesh.normals[i])) mesh.normals[i] = {0, 0, 1};  // only of triangles without area
  }
}

}  // namespace

void check(Mesh& mesh, const std::string& name) {
  if (mesh.triangles.empty()) throw InputError(name, "", "has no faces");
  for (size_t i = 0; i < mesh.positions.size(); ++i)
    if (!is_finite(mesh.positions[i]))
      throw InputError(name, fmt::format("vertex {}", i), "its position is not finite");
  for (size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const uint32_t corner : mesh.triangles[i])
      if (corner >= mesh.positions.size())
        throw InputError(name, fmt::format("face {}", i),
                         fmt::format("refers to vertex {}, but the file has only {}", corner,
                                     mesh.positions.size()));
  for (auto& uv : mesh.uv)
    for (float& x : uv)
      if (!std::isfinite(x)) x = 0;
  mend_normals(mesh);
}

}  // namespace tdpt::foreign
