#include "tools/ffgraph/connectivity.h"

#include <array>
#include <bit>
#include <numeric>
#include <unordered_map>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/System/omstream.hh>

#include "libcommon/math/rng.h"

namespace tdpt {
namespace {

using Mesh = OpenMesh::TriMesh_ArrayKernelT<>;

// OpenMesh reports every face that it refuses; the handle tells us the same.
class SilentOpenMesh {
 public:
  SilentOpenMesh() { omerr().disable(); }
  ~SilentOpenMesh() { omerr().enable(); }
};

struct PlaceHash {
  size_t operator()(const std::array<uint32_t, 3>& p) const {
    return mix64(mix64(mix64(p[0]) + p[1]) + p[2]);
  }
};

std::array<uint32_t, 3> place(const Vec3f& p) {
  // + 0: the two zeros are one place.
  return {std::bit_cast<uint32_t>(p.x + 0.0f), std::bit_cast<uint32_t>(p.y + 0.0f),
          std::bit_cast<uint32_t>(p.z + 0.0f)};
}

Vec3<int> normal_bin(const Vec3d& n) {
  const auto round = [](double v) { return static_cast<int>(std::lround(2 * v)); };
  return {round(n.x), round(n.y), round(n.z)};
}

class UnionFind {
 public:
  explicit UnionFind(size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }
  uint32_t find(uint32_t v) {
    while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
    return v;
  }
  void join(uint32_t a, uint32_t b) { parent_[find(a)] = find(b); }

 private:
  std::vector<uint32_t> parent_;
};

}  // namespace

std::vector<uint32_t> surface_components(const Scene& scene) {
  const SilentOpenMesh silence;
  Mesh mesh;
  std::unordered_map<std::array<uint32_t, 3>, Mesh::VertexHandle, PlaceHash> vertices;
  const auto count = static_cast<uint32_t>(scene.triangles.size());
  std::vector<uint32_t> triangle_of_face;
  for (uint32_t t = 0; t < count; ++t) {
    std::array<Mesh::VertexHandle, 3> v;
    for (int k = 0; k < 3; ++k) {
      const auto [entry, is_new] = vertices.try_emplace(place(scene.vertex(t, k)));
      if (is_new) entry->second = mesh.add_vertex({0, 0, 0});
      v[static_cast<size_t>(k)] = entry->second;
    }
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
    if (mesh.add_face(v[0], v[1], v[2]).is_valid()) triangle_of_face.push_back(t);
  }

  std::vector<Vec3<int>> bin(count);
  for (uint32_t t = 0; t < count; ++t) bin[t] = normal_bin(shape_of(scene, t).normal);
  UnionFind pieces(count);
  for (const auto& edge : mesh.edges()) {
    const auto h = mesh.halfedge_handle(edge, 0);
    const auto g = mesh.halfedge_handle(edge, 1);
    if (mesh.is_boundary(h) || mesh.is_boundary(g)) continue;
    const uint32_t a = triangle_of_face[static_cast<size_t>(mesh.face_handle(h).idx())];
    const uint32_t b = triangle_of_face[static_cast<size_t>(mesh.face_handle(g).idx())];
    if (bin[a] == bin[b]) pieces.join(a, b);
  }

  std::vector<uint32_t> number(count, UINT32_MAX), component(count);
  uint32_t next = 0;
  for (uint32_t t = 0; t < count; ++t) {
    uint32_t& n = number[pieces.find(t)];
    if (n == UINT32_MAX) n = next++;
    component[t] = n;
  }
  return component;
}

}  // namespace tdpt
