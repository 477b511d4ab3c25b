// Converts meshes of placed nodes to world-space triangles. Internal to this room.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "libcommon/math/vec.h"
#include "libcommon/scene/gltf/attributes.h"
#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/gltf/materials.h"
#include "libcommon/scene/gltf/nodes.h"
#include "libcommon/scene/gltf/skins.h"
#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

// Detects glass objects modelled as thin sheets: closed transmitting surfaces whose material lacks
// KHR_materials_volume. The format defines these as bubbles; usually a solid was meant.

class Bubbles {
 public:
  /// Examines a placed mesh: three `corners` per triangle, into its vertices, which begin at
  /// `first` in `world` [m].
  void look_at(const Material& material, const std::vector<uint32_t>& corners,
               const std::vector<Vec3d>& world, uint32_t first);
  /// One sentence for all of them; empty if none was found.
  std::string warning() const;

 private:
  size_t count_ = 0;
  std::string name_;  ///< name of the first one's material
};

class MeshReader {
 public:
  /// `uses`: per material of the file, followed by the default for surfaces without one.
  MeshReader(const Document& document, Scene& scene, std::vector<MaterialUse>& uses,
             const std::vector<PlacedNode>& nodes);

  /// Adds the meshes of all visible nodes: triangles and attributes to the scene, vertices to
  /// `world()`. Makes room for those of area lights, too. A scene whose instances would fill the
  /// memory is refused before any vertex is read.
  void run();

  /// Call when all vertices are in `world()`.
  void finish() { attributes_.finish(world_.size()); }

  std::vector<Vec3d>& world() { return world_; }  ///< [m]
  double grain() const { return grain_; }         ///< largest rounding error of a vertex [m]
  bool unnamed_material() const { return unnamed_material_; }
  void warn() const;

 private:
  using Key = std::pair<size_t, size_t>;  // mesh, primitive

  void make_room();
  void add_node(const PlacedNode& node);
  // `to_world` of an instance; empty: the node's own.
  void add_mesh(const PlacedNode& node, const Deformation& deformation,
                const std::optional<Affine>& to_world);
  Placing placing_of(const PlacedNode& node, const AttributeSet& set,
                     const std::optional<Affine>& to_world);
  const SkinMaps& skin_of(size_t node);
  void add_vertices(const PlacedNode& node, const AttributeSet& set, const Placing& placing);
  std::vector<uint32_t> corners(const Primitive& primitive, size_t vertices, const Key& key);
  void add_triangles(const std::vector<uint32_t>& corner, uint32_t first, bool mirrored,
                     size_t material);
  void note_grain(const Affine& to_world, size_t accessor, const std::vector<uint32_t>& corner,
                  uint32_t first);
  void note_primitive(const Key& key, const Primitive& primitive, const AttributeSet& set,
                      const Deformation& deformation);
  Deformation deformation_of(size_t node) const;
  const std::vector<Primitive>& primitives_of(const PlacedNode& node) const;
  size_t material_of(const Primitive& primitive) const;

  const Document& d_;
  Scene& scene_;
  std::vector<MaterialUse>& uses_;
  const std::vector<PlacedNode>& nodes_;
  AttributeReader attributes_;
  NodeMaps maps_;
  std::map<size_t, SkinMaps> skins_;
  std::vector<Vec3d> world_;
  double grain_ = 0;
  bool unnamed_material_ = false;
  Bubbles bubbles_;
  size_t no_surfaces_ = 0;
  std::set<Key> without_positions_, incomplete_, without_uv_, coloured_, without_joints_;
  std::set<size_t> skinned_instances_;  // nodes
};

/// Which materials the surfaces of visible meshes use.
std::vector<bool> used_materials(const Document& document, const std::vector<PlacedNode>& nodes);

}  // namespace tdpt::gltf
