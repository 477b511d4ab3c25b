// Connected components of triangles across shared edges.
//
// Method: half-edge connectivity (OpenMesh) over vertices welded by position in a hash table, and
// union-find over the edges whose two triangles face roughly the same way.
#include "tools/ffgraph/patch_map.h"

#include <array>
#include <bit>
#include <numeric>

#include <oneapi/tbb/parallel_for.h>
#include <OpenMesh/Core/Mesh/TriConnectivity.hh>
#include <OpenMesh/Core/System/omstream.hh>

#include "libcommon/math/rng.h"

namespace tdpt {
namespace {

// Connectivity only: the mesh needs no positions.
using Mesh = OpenMesh::TriConnectivity;

// Silences OpenMesh, which prints each face that it refuses; the invalid handle says the same.
class SilentOpenMesh {
 public:
  SilentOpenMesh() { omerr().disable(); }
  ~SilentOpenMesh() { omerr().enable(); }
};

std::array<uint32_t, 3> place(const Vec3f& p) {
  // +0 and -0 are the same position.
  const auto bits = [](float v) { return v == 0 ? 0 : std::bit_cast<uint32_t>(v); };
  return {bits(p.x), bits(p.y), bits(p.z)};
}

// An index for each position: equal for equal positions, dense from 0 in order of first appearance.
struct Welded {
  std::vector<uint32_t> number;
  uint32_t count = 0;
};

Welded weld(const std::vector<Vec3f>& positions) {
  constexpr uint32_t kEmpty = UINT32_MAX;
  Welded out;
  out.number.resize(positions.size());
  // Open addressing, at most half full; slots hold the first index of a position.
  std::vector<uint32_t> slots(std::bit_ceil(2 * positions.size() + 2), kEmpty);
  for (uint32_t v = 0; v < positions.size(); ++v) {
    const auto p = place(positions[v]);
    size_t at = mix64(mix64(uint64_t{p[0]} << 32 | p[1]) + p[2]) & (slots.size() - 1);
    while (slots[at] != kEmpty && place(positions[slots[at]]) != p)
      at = (at + 1) & (slots.size() - 1);
    if (slots[at] == kEmpty) {
      slots[at] = v;
      out.number[v] = out.count++;
    } else {
      out.number[v] = out.number[slots[at]];
    }
  }
  return out;
}

// 2n rounded, combined into one number.
uint32_t normal_bin(const Vec3d& n) {
  const auto round = [](double v) { return static_cast<uint32_t>(std::lround(2 * v) + 2); };
  return round(n.x) | round(n.y) << 8 | round(n.z) << 16;
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
  const auto count = static_cast<uint32_t>(scene.triangles.size());
  Mesh mesh;
  std::vector<uint32_t> triangle_of_face;
  {
    const Welded welded = weld(scene.positions);
    mesh.reserve(welded.count, count + count / 2, count);
    for (uint32_t v = 0; v < welded.count; ++v) mesh.new_vertex();
    triangle_of_face.reserve(count);
    for (uint32_t t = 0; t < count; ++t) {
      std::array<Mesh::VertexHandle, 3> v;
      for (size_t k = 0; k < 3; ++k)
        v[k] = Mesh::VertexHandle(static_cast<int>(welded.number[scene.triangles[t].vertex[k]]));
      if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
      if (mesh.add_face(v[0], v[1], v[2]).is_valid()) triangle_of_face.push_back(t);
    }
  }

  std::vector<uint32_t> bin(count);
  tbb::parallel_for(uint32_t{0}, count,
                    [&](uint32_t t) { bin[t] = normal_bin(shape_of(scene, t).normal); });
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
