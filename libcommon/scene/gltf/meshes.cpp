#include "libcommon/scene/gltf/parts.h"

#include <fmt/format.h>
#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "libcommon/base/file.h"
#include "libcommon/base/words.h"
#include "libcommon/scene/gltf/accessors.h"

namespace tdpt::gltf {

namespace {

// Instances multiply the contents of a file; beyond these numbers no ray tracer here could build
// its hierarchy. A small file cannot reach them.
constexpr size_t kMostVertices = size_t{1} << 27, kMostTriangles = size_t{1} << 28;
constexpr size_t kSome = size_t{1} << 22, kPerByte = 256;
// Morph targets and joints cost only time.
constexpr size_t kMostBends = size_t{1} << 31;

/// The mesh shown by a node, or kNone.
size_t mesh_of(const Document& d, const PlacedNode& n) {
  return n.visible ? d.nodes[n.node].mesh : kNone;
}

// Temporary memory per vertex of a skinned primitive: its map, joints and weights.
constexpr size_t kBendingBytes = sizeof(Affine) + 10 * sizeof(double);

/// Bytes per vertex in Scene, besides the position.
size_t bytes_of(const AttributeSet& set) {
  size_t bytes = 0;
  for (size_t k = kNormal; k < kAttributes; ++k)
    if (set.accessors[k] != kNone) bytes += kAttributeComponents[k] * sizeof(float);
  return bytes;
}

class MeshReader {
 public:
  MeshReader(const Document& d, const PlacedNodes& nodes, Scene& scene,
             std::vector<MaterialUse>& uses, Notes& notes)
      : d_(d), scene_(scene), uses_(uses), notes_(notes), nodes_(nodes) {}

  Meshes run() {
    make_room();
    for (const PlacedNode& n : nodes_.of_scene)
      if (mesh_of(d_, n) != kNone) add_node(n);
    return std::move(out_);
  }

 private:
  void make_room() {
    const size_t bytes = most_bytes(d_);
    const auto most = [&](size_t limit) { return std::min(limit, kSome + kPerByte * bytes); };
    const size_t most_vertices = most(kMostVertices), most_triangles = most(kMostTriangles),
                 most_bends = most(kMostBends);
    // A count beyond the file's bytes is wrong, and is refused with its place when it is read.
    const auto count = [&](size_t accessor) {
      return std::min(d_.accessors[accessor].count, bytes);
    };
    size_t vertices = 0, triangles = 0, bends = 0, of_attributes = 0, bent = 0;
    for (const PlacedNode& n : nodes_.of_scene) {
      if (n.visible && d_.nodes[n.node].area_light != kNone) {  // far fewer than the limits
        vertices += kMostOfAreaLight;
        triangles += kMostOfAreaLight;
      }
      const size_t mesh = mesh_of(d_, n);
      if (mesh == kNone) continue;
      // Clamped so that no product overflows.
      const size_t times =
          is_skinned(n.node) ? 1 : std::min(instances_declared(d_, n.node), kMostTriangles + 1);
      std::set<AttributeSet> seen;
      for (const Primitive& p : d_.meshes[mesh].primitives) {
        const size_t position = find_attribute(p.attributes, "POSITION");
        if (position == kNone) continue;
        const size_t points = std::min(count(position), kMostVertices + 1);
        if (p.is_surface()) {
          const AttributeSet set = attributes_of(p, n.node);
          bends += std::min(times * points, kMostVertices + 1) *
                       (set.targets.size() + set.joints.size()) +
                   p.targets.size();
          if (seen.insert(set).second) {
            vertices += times * points;
            of_attributes += times * points * bytes_of(set);
            if (!set.joints.empty()) bent = std::max(bent, points);
          }
        }
        const size_t corners =
            std::min(count(p.indices != kNone ? p.indices : position), 3 * kMostTriangles + 3);
        triangles += times * (p.mode == kTriangles ? corners / 3 : corners);
        if (vertices > most_vertices || triangles > most_triangles)
          d_.fail(
              place("nodes", n.node),
              fmt::format("brings the scene to {} vertices and {} triangles, expected at most {} "
                          "and {}",
                          vertices, triangles, most_vertices, most_triangles));
        if (bends > most_bends)
          d_.fail(place("nodes", n.node),
                  fmt::format("brings the scene to {} vertices times morph targets and joints, "
                              "expected at most {}",
                              bends, most_bends));
      }
    }
    expect_memory(d_.file, "nodes",
                  fmt::format("{} vertices and {} triangles", vertices, triangles),
                  vertices * (sizeof(Vec3d) + sizeof(Vec3f)) + of_attributes +
                      bent * kBendingBytes + triangles * sizeof(Triangle));
    out_.world.reserve(vertices);
    scene_.triangles.reserve(triangles);
  }

  bool is_skinned(size_t node) const { return d_.nodes[node].skin != kNone; }

  AttributeSet attributes_of(const Primitive& p, size_t node) const {
    return choose_attributes(p, uses_[material_of(p)], morph_weights(d_, node), is_skinned(node));
  }

  const std::vector<Primitive>& primitives_of(const PlacedNode& n) const {
    return d_.meshes[d_.nodes[n.node].mesh].primitives;
  }

  size_t material_of(const Primitive& p) const {
    return p.material == kNone ? uses_.size() - 1 : p.material;
  }

  void add_node(const PlacedNode& n) {
    if (is_skinned(n.node)) {  // the extension does not define instances of skinned meshes
      if (instances_declared(d_, n.node) > 1)
        notes_.add("instances of skinned meshes are left out", place("nodes", n.node));
      add_mesh(n, {});
      return;
    }
    const auto& primitives = primitives_of(n);
    if (std::any_of(primitives.begin(), primitives.end(), std::mem_fn(&Primitive::is_surface)))
      for (const Affine& to_world : place_instances(d_, n)) add_mesh(n, to_world);
  }

  void add_mesh(const PlacedNode& n, const std::optional<Affine>& to_world) {
    const size_t mesh = d_.nodes[n.node].mesh;
    struct Shared {
      uint32_t first;
      Placing placing;
    };
    std::map<AttributeSet, Shared> known;  // primitives often share all vertices
    const auto& primitives = primitives_of(n);
    for (size_t k = 0; k < primitives.size(); ++k) {
      const Primitive& p = primitives[k];
      const std::string where = place("meshes", mesh) + "." + place("primitives", k);
      if (!p.is_surface()) continue;
      const size_t position = find_attribute(p.attributes, "POSITION");
      if (position == kNone) {
        notes_.add("primitives without POSITION are left out", where);
        continue;
      }
      const AttributeSet set = attributes_of(p, n.node);
      auto it = known.find(set);
      if (it == known.end()) {
        const auto first = static_cast<uint32_t>(out_.world.size());
        Placing placing = placing_of(n, set, to_world);
        add_vertices(n, set, placing);
        add_attributes(d_, set, placing, first, scene_);
        placing.of_vertices = {};
        it = known.emplace(set, Shared{first, std::move(placing)}).first;
      }
      const auto& [first, placing] = it->second;
      const size_t vertices = d_.accessors[position].count;
      const std::vector<uint32_t> corner = corners(p, vertices, where);
      add_triangles(corner, first, placing.mirrors, material_of(p));
      note_grain(placing.to_world, position, corner, first);
      note_primitive(where, p, set, is_skinned(n.node));
    }
  }

  Placing placing_of(const PlacedNode& n, const AttributeSet& set,
                     const std::optional<Affine>& to_world) {
    if (set.joints.empty()) {
      const Affine& map = to_world ? *to_world : n.to_world;
      return {map, map.mirrors(), {}};
    }
    const size_t skin = d_.nodes[n.node].skin;
    std::vector<Affine>& joints = skins_[skin];
    if (joints.empty()) joints = joint_maps(d_, skin, nodes_);
    std::vector<Affine> of_vertices =
        blend_joints(d_, joints, set.joints, d_.accessors[set.accessors[kPosition]].count);
    const auto mirrored = std::count_if(of_vertices.begin(), of_vertices.end(),
                                        [](const Affine& a) { return a.mirrors(); });
    return {joints.front(), 2 * mirrored > std::ssize(of_vertices), std::move(of_vertices)};
  }

  void add_vertices(const PlacedNode& n, const AttributeSet& set, const Placing& placing) {
    std::vector<Vec3d> positions = read_positions(d_, set.accessors[kPosition]);
    add_position_deltas(d_, set.targets, positions);
    for (size_t i = 0; i < positions.size(); ++i) {
      out_.world.push_back(placing.map_of(i).point(positions[i]));
      if (!is_finite(out_.world.back()))
        d_.fail(place("nodes", n.node), "its transform takes a vertex beyond double precision");
    }
  }

  std::vector<uint32_t> corners(const Primitive& p, size_t vertices, const std::string& where) {
    std::vector<uint32_t> list;
    if (p.indices != kNone) {
      list = read_indices(d_, p.indices, vertices);
    } else {
      list.resize(vertices);
      for (uint32_t i = 0; i < vertices; ++i) list[i] = i;
    }
    // Incomplete triangles are ignored, as in every graphics interface.
    const bool strips = p.mode != kTriangles;
    if (strips ? list.size() < 3 : list.size() % 3 != 0)
      notes_.add("corners that make no triangle are left out", where);
    if (!strips || list.size() < 3) {
      list.resize(list.size() - list.size() % 3);
      return list;
    }
    std::vector<uint32_t> out;
    out.reserve(3 * (list.size() - 2));
    for (size_t i = 0; i + 2 < list.size(); ++i) {
      // glTF 2.0, 3.7.2.1: every second triangle of a strip has the opposite orientation.
      if (p.mode == kStrip)
        out.insert(out.end(), {list[i], list[i + 1 + i % 2], list[i + 2 - i % 2]});
      else
        out.insert(out.end(), {list[i + 1], list[i + 2], list[0]});
    }
    return out;
  }

  void add_triangles(const std::vector<uint32_t>& corner, uint32_t first, bool mirrored,
                     size_t material) {
    const auto m = static_cast<uint32_t>(material);
    for (size_t i = 0; i + 2 < corner.size(); i += 3) {
      Triangle t{{first + corner[i], first + corner[i + 1], first + corner[i + 2]}, m};
      if (mirrored) std::swap(t.vertex[1], t.vertex[2]);  // keeps the front side
      scene_.triangles.push_back(t);
    }
  }

  /// Estimates the rounding error of these vertices: of floats in the file and of doubles in world
  /// space.
  void note_grain(const Affine& to_world, size_t accessor, const std::vector<uint32_t>& corner,
                  uint32_t first) {
    const bool floats = d_.accessors[accessor].component_type == kFloat;
    const Vec3d& moved = to_world.t;
    double reach = 0;  // largest coordinate of the untransformed vertices
    for (const uint32_t c : corner) reach = std::max(reach, length(out_.world[first + c] - moved));
    out_.grain =
        std::max(out_.grain, (floats ? 0x1p-24 : 0) * reach + 0x1p-53 * (length(moved) + reach));
  }

  void note_primitive(const std::string& where, const Primitive& p, const AttributeSet& set,
                      bool skinned) {
    MaterialUse& use = uses_[material_of(p)];
    out_.unnamed_material |= p.material == kNone;
    note_colours(d_, set, use);
    for (size_t u = 0; u < 2; ++u)
      if (use.uv[u] && set.accessors[kTexCoord0 + u] == kNone)
        notes_.add("texture coordinates that a material asks for are missing, taken as 0", where);
    if (use.unlit && p.attributes.contains("COLOR_0"))
      notes_.add("vertex colours of unlit materials are left out", where);
    if (skinned && set.joints.empty())
      notes_.add("primitives of skinned meshes without joints are placed by their node", where);
  }

  const Document& d_;
  Scene& scene_;
  std::vector<MaterialUse>& uses_;
  Notes& notes_;
  const PlacedNodes& nodes_;
  std::map<size_t, std::vector<Affine>> skins_;  // maps of their joints
  Meshes out_;
};

}  // namespace

std::vector<bool> used_materials(const Document& d, const PlacedNodes& nodes) {
  std::vector<bool> used(d.root()["materials"].size());
  for (const PlacedNode& n : nodes.of_scene) {
    const size_t mesh = mesh_of(d, n);
    if (mesh == kNone) continue;
    for (const Primitive& p : d.meshes[mesh].primitives)
      if (p.is_surface() && p.material != kNone) used[p.material] = true;
  }
  return used;
}

Meshes read_meshes(const Document& d, const PlacedNodes& nodes, Scene& scene,
                   std::vector<MaterialUse>& uses, Notes& notes) {
  return MeshReader(d, nodes, scene, uses, notes).run();
}

}  // namespace tdpt::gltf
