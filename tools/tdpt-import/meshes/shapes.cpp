// Squares, cubes and surfaces of revolution as meshes, and what can be done to any mesh.
#include <cmath>
#include <map>
#include <numbers>

#include "tools/tdpt-import/meshes/meshes.h"

namespace tdpt::foreign {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr uint32_t kCorners = 64;  // around the axis

// The parallelogram centre -+ right -+ up, whose front is where right x up points to.
void add_face(Mesh& mesh, const Vec3f& centre, const Vec3f& right, const Vec3f& up) {
  const auto first = static_cast<uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {centre - right - up, centre + right - up,
                                               centre + right + up, centre - right + up});
  mesh.normals.insert(mesh.normals.end(), 4, normalize(cross(right, up)));
  mesh.uv.insert(mesh.uv.end(), {{0, 1}, {1, 1}, {1, 0}, {0, 0}});
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

// One circle of a surface of revolution about z: radius and height, those of its normal, and v.
struct Ring {
  double r, z, normal_r, normal_z, v;
};

// Rings run from the upper end of an image to its lower end; u = phi / (2 pi) from +x towards +y.
Mesh revolved(const std::vector<Ring>& rings) {
  Mesh mesh;
  for (const Ring& ring : rings)
    for (uint32_t i = 0; i <= kCorners; ++i) {
      // The last column is the first again.
      const double phi = 2 * kPi * (i % kCorners) / kCorners, c = std::cos(phi), s = std::sin(phi);
      mesh.positions.push_back(in_single({ring.r * c, ring.r * s, ring.z}));
      mesh.normals.push_back(in_single({ring.normal_r * c, ring.normal_r * s, ring.normal_z}));
      mesh.uv.push_back({static_cast<float>(i) / kCorners, static_cast<float>(ring.v)});
    }
  constexpr uint32_t row = kCorners + 1;
  for (uint32_t k = 0; k + 1 < rings.size(); ++k)
    for (uint32_t i = 0; i < kCorners; ++i) {
      const uint32_t a = k * row + i, b = a + row;  // above, below
      if (rings[k + 1].r > 0) mesh.triangles.push_back({a, b, b + 1});
      if (rings[k].r > 0) mesh.triangles.push_back({a, b + 1, a + 1});
    }
  return mesh;
}

}  // namespace

void flip_v(Mesh& mesh) {
  for (auto& uv : mesh.uv) uv[1] = 1 - uv[1];
}

double area_of(const Mesh& mesh, const Affine& map) {
  const auto corner = [&](uint32_t i) { return map.point(in_double(mesh.positions[i])); };
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += length(cross(corner(b) - corner(a), corner(c) - corner(a))) / 2;
  return sum;
}

void smooth(Mesh& mesh, bool across_seams) {
  std::map<std::array<float, 3>, size_t> first_at;
  std::vector<size_t> first;  // vertex at the place of each
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3f& p = mesh.positions[i];
    first.push_back(across_seams ? first_at.try_emplace({p.x, p.y, p.z}, i).first->second : i);
  }
  std::vector<Vec3d> sums(first.size());
  for (const auto& corners : mesh.triangles)
    for (size_t k = 0; k < 3; ++k) {
      const Vec3d p = in_double(mesh.positions[corners[k]]);
      const Vec3d a = in_double(mesh.positions[corners[(k + 1) % 3]]) - p,
                  b = in_double(mesh.positions[corners[(k + 2) % 3]]) - p;
      const Vec3d n = cross(a, b);
      const double l = length(n);
      Vec3d& sum = sums[first[corners[k]]];
      if (l > 0) sum = sum + n * (std::atan2(l, dot(a, b)) / l);
    }
  mesh.normals.clear();
  for (const size_t i : first) {
    const double l = length(sums[i]);
    mesh.normals.push_back(l > 0 ? in_single(sums[i] / l)
                                 : Vec3f{0, 0, 1});  // opposite ones cancel
  }
}

Mesh square() {
  Mesh mesh;
  add_face(mesh, {}, {1, 0, 0}, {0, 1, 0});
  return mesh;
}

// Images lie on the faces as on Mitsuba's cube.
Mesh cube() {
  Mesh mesh;
  add_face(mesh, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
  add_face(mesh, {-1, 0, 0}, {0, 1, 0}, {0, 0, -1});
  add_face(mesh, {0, 1, 0}, {-1, 0, 0}, {0, 0, 1});
  add_face(mesh, {0, -1, 0}, {0, 0, 1}, {-1, 0, 0});
  add_face(mesh, {0, 0, 1}, {0, 1, 0}, {-1, 0, 0});
  add_face(mesh, {0, 0, -1}, {0, -1, 0}, {-1, 0, 0});
  return mesh;
}

Mesh sphere() {
  constexpr int rows = kCorners / 2;
  std::vector<Ring> rings;
  for (int k = 0; k <= rows; ++k) {
    const double theta = kPi * k / rows, c = std::cos(theta);
    const double s = k == 0 || k == rows ? 0 : std::sin(theta);
    rings.push_back({s, c, s, c, static_cast<double>(k) / rows});
  }
  // Chords lie inside: the surface of the cone frustums between edges' midpoints, summed up.
  const double half = kPi / kCorners;
  double area = 0;
  for (size_t k = 0; k + 1 < rings.size(); ++k) {
    const Ring &a = rings[k], &b = rings[k + 1];
    const double slant = std::hypot((a.r - b.r) * std::cos(half), a.z - b.z);
    area += kCorners * (a.r + b.r) * std::sin(half) * slant;
  }
  for (Ring& ring : rings) ring.r *= std::sqrt(4 * kPi / area), ring.z *= std::sqrt(4 * kPi / area);
  return revolved(rings);
}

Mesh disc() {
  const double r = std::sqrt(2 * kPi / (kCorners * std::sin(2 * kPi / kCorners)));
  return revolved({{0, 0, 0, 1, 0}, {r, 0, 0, 1, 1}});
}

Mesh cylinder() {
  const double r = kPi / kCorners / std::sin(kPi / kCorners);
  return revolved({{r, 1, 1, 0, 0}, {r, 0, 1, 0, 1}});
}

}  // namespace tdpt::foreign
