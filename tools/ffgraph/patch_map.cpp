#include "tools/ffgraph/patch_map.h"

#include <bit>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include <oneapi/tbb/parallel_for.h>
#include <OpenMesh/Core/Mesh/TriConnectivity.hh>
#include <OpenMesh/Core/System/omstream.hh>

namespace tdpt {

// ---- Connected components of triangles across shared edges ----
//
// Method: half-edge connectivity (OpenMesh) over vertices welded by position, and union-find over
// the edges whose two triangles face roughly the same way.

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

struct HashOfPlace {
  size_t operator()(const std::array<uint32_t, 3>& p) const {
    return mix64(mix64(uint64_t{p[0]} << 32 | p[1]) + p[2]);
  }
};

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
    // Positions are numbered densely from 0 in order of first appearance.
    std::unordered_map<std::array<uint32_t, 3>, int, HashOfPlace> number;
    number.reserve(scene.positions.size());
    std::vector<int> vertex;
    for (const Vec3f& p : scene.positions)
      vertex.push_back(number.try_emplace(place(p), static_cast<int>(number.size())).first->second);
    mesh.reserve(number.size(), count + count / 2, count);
    for (size_t v = 0; v < number.size(); ++v) mesh.new_vertex();
    triangle_of_face.reserve(count);
    for (uint32_t t = 0; t < count; ++t) {
      std::array<Mesh::VertexHandle, 3> v;
      for (size_t k = 0; k < 3; ++k)
        v[k] = Mesh::VertexHandle(vertex[scene.triangles[t].vertex[k]]);
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

// ---- Patches ----

namespace {

// `q`: in base cells.
std::array<int32_t, 3> cell_at(const Vec3d& q, int level) {
  const auto fine = static_cast<double>(uint64_t{1} << 2 * level);
  const auto index = [fine](double v) {
    const double bounded = std::clamp(v * fine, -2147483648.0, 2147483647.0);
    const auto i = static_cast<int32_t>(bounded);  // towards zero; std::floor is a library call
    return i - (static_cast<double>(i) > bounded ? 1 : 0);
  };
  return {index(q.x), index(q.y), index(q.z)};
}

}  // namespace

void PatchTable::set(const PatchKey& key, uint32_t number) {
  Entry& entry = entries_[place_of(key)];
  const bool is_new = entry.number == kNoPatch;
  entry = {key, number};
  if (!is_new || 2 * ++used_ < entries_.size()) return;
  std::vector<Entry> old(4 * entries_.size());
  old.swap(entries_);
  for (const Entry& e : old)
    if (e.number != kNoPatch) entries_[place_of(e.key)] = e;
}

PatchMap::PatchMap(const Scene& scene, const PatchGrid& grid, std::vector<uint32_t> component,
                   const FineRegion& fine)
    : scene_(&scene),
      grid_(grid),
      fine_level_(fine.level),
      fine_low_((fine.low - grid.origin) / grid.base_cell),
      fine_high_((fine.high - grid.origin) / grid.base_cell),
      component_(std::make_shared<const std::vector<uint32_t>>(std::move(component))) {}

PatchMap::Extent PatchMap::extent() const {
  Extent extent;
  for (const auto& [key, value] : entry_.entries()) {
    if (value == kNoPatch || key.piece == kSkyPiece) continue;
    for (size_t k = 0; k < 3; ++k) {
      const int32_t base = key.cell[k] >> (2 * key.level);
      extent.low[k] = std::min(extent.low[k], base);
      extent.high[k] = std::max(extent.high[k], base);
    }
  }
  return extent;
}

bool PatchMap::always_split(const PatchKey& key) const {
  if (key.level >= fine_level_) return false;
  const double size = std::ldexp(1.0, -2 * key.level);
  for (int axis = 0; axis < 3; ++axis) {
    const double low = key.cell[static_cast<size_t>(axis)] * size;
    if (low > fine_high_[axis] || low + size < fine_low_[axis]) return false;
  }
  return true;
}

std::pair<PatchKey, uint32_t> PatchMap::search(uint32_t face, const Vec3d& canonical) const {
  const Vec3d q = in_grid(canonical);
  PatchKey key{cell_at(q, 0), 0, piece(face)};
  for (;;) {
    const uint32_t found = lookup(key);
    if (found != kSplit) return {key, found};
    ++key.level;
    key.cell = cell_at(q, key.level);
  }
}

uint32_t PatchMap::find(uint32_t face, const Vec3d& canonical) const {
  return search(face, canonical).second;
}

uint32_t PatchMap::find_or_add(uint32_t face, const Vec3d& canonical) {
  const auto [key, found] = search(face, canonical);
  return found == kNoPatch ? add(key) : found;
}

std::vector<uint32_t> PatchMap::add_all(const std::vector<WalkHit>& places) {
  const auto on_face = [&](size_t k) { return places[k].face / 2 < component_->size(); };
  std::vector<uint32_t> patch(places.size(), kNoPatch);
  // Short blocks first, while most points add a patch.
  for (size_t first = 0, block = 1 << 10; first < places.size();) {
    const size_t end = std::min(first + block, places.size());
    tbb::parallel_for(first, end, [&](size_t k) {
      if (on_face(k)) patch[k] = find(places[k].face, Vec3d(places[k].position));
    });
    for (; first < end; ++first)
      if (on_face(first) && patch[first] == kNoPatch)
        patch[first] = find_or_add(places[first].face, Vec3d(places[first].position));
    block = std::min<size_t>(2 * block, 1 << 18);
  }
  return patch;
}

uint32_t PatchMap::add(const PatchKey& key) {
  if (const uint32_t known = entry_.at(key); known != kNoPatch) return known;
  const uint32_t id = size();
  entry_.set(key, id);
  keys_.push_back(key);
  PatchKey up = key;
  while (up.level > 0) {
    up = up.parent();
    entry_.set(up, kSplit);
  }
  if (key.piece >= piece_touched_.size()) piece_touched_.resize(key.piece + 1, 0);
  piece_touched_[key.piece] = 1;
  return id;
}

uint32_t PatchMap::add_sky(uint32_t bin) {
  sky_ = true;
  if (const uint32_t known = find_sky(bin); known != kNoPatch) return known;
  entry_.set(sky_key(bin), size());
  keys_.push_back(sky_key(bin));
  return size() - 1;
}

std::vector<uint32_t> PatchMap::keep(const std::vector<uint8_t>& kept) {
  std::vector<uint32_t> numbers(size(), kNoPatch);
  std::vector<PatchKey> keys;
  for (uint32_t i = 0; i < size(); ++i) {
    if (!kept[i]) continue;
    numbers[i] = static_cast<uint32_t>(keys.size());
    keys.push_back(keys_[i]);
  }
  keys_ = std::move(keys);
  PatchTable table;
  for (const auto& [key, value] : entry_.entries())
    if (value == kSplit)
      table.set(key, kSplit);
    else if (value != kNoPatch && kept[value])
      table.set(key, numbers[value]);
  entry_ = std::move(table);
  return numbers;
}

PatchMap PatchMap::split(const std::vector<uint8_t>& chosen) const {
  PatchMap finer = *this;
  finer.entry_ = {};
  finer.keys_.clear();
  finer.piece_touched_.clear();
  for (const auto& [key, value] : entry_.entries())
    if (value == kSplit || (value != kNoPatch && chosen[value])) finer.entry_.set(key, kSplit);
  return finer;
}

}  // namespace tdpt
