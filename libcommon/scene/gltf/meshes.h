// Meshes of placed nodes, as world-space triangles, and their vertex attributes, gathered into the
// scene's arrays. Internal to this room.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "libcommon/math/vec.h"
#include "libcommon/scene/gltf/accessors.h"
#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/gltf/materials.h"
#include "libcommon/scene/gltf/nodes.h"
#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

/// Which materials the surfaces of visible meshes use.
std::vector<bool> used_materials(const Document& document, const PlacedNodes& nodes);

/// What was read of the meshes besides their triangles and attributes.
struct Meshes {
  std::vector<Vec3d> world;  ///< vertices [m]
  double grain = 0;          ///< largest rounding error of a vertex [m]
  bool unnamed_material = false;
};

/// Adds the meshes of all visible nodes to the scene. Makes room for the vertices of area lights,
/// too. A scene whose instances would fill the memory is refused before any vertex is read. `uses`:
/// per material of the file, followed by the default for surfaces without one.
Meshes read_meshes(const Document& document, const PlacedNodes& nodes, Scene& scene,
                   std::vector<MaterialUse>& uses, Notes& notes);

// Vertex attributes.

/// Attributes of a vertex but for joints and weights.
enum AttributeKind { kPosition, kNormal, kTangent, kTexCoord0, kTexCoord1, kColour, kAttributes };
inline constexpr std::array kAttributeNames = {"POSITION",   "NORMAL",     "TANGENT",
                                               "TEXCOORD_0", "TEXCOORD_1", "COLOR_0"};
constexpr std::array<size_t, kAttributes> kAttributeComponents = {3, 3, 4, 2, 2, 4};

/// By AttributeKind; kNone for those that are absent or not needed.
using Accessors = std::array<size_t, kAttributes>;

/// A morph target with non-zero weight, with the accessors of its deltas.
struct MorphTarget {
  double weight = 0;
  Accessors accessors;
  auto operator<=>(const MorphTarget&) const = default;
};

/// Weights of the targets of a node's mesh: the node's own, else the mesh's; missing ones are 0.
const std::vector<double>& morph_weights(const Document& document, size_t node);

/// Adds weight times delta of each target to the positions of a primitive.
void add_position_deltas(const Document& document, const std::vector<MorphTarget>& targets,
                         std::vector<Vec3d>& positions);

/// What a primitive uses. Primitives of a mesh share vertices if all of it agrees.
struct AttributeSet {
  Accessors accessors;
  std::vector<MorphTarget> targets;
  std::vector<JointSet> joints;  ///< of a mesh with a skin
  auto operator<=>(const AttributeSet&) const = default;
};

/// Selects what a material needs of a primitive, which has a POSITION.
/// `weights`: of the mesh's morph targets.
AttributeSet choose_attributes(const Primitive& primitive, const MaterialUse& use,
                               const std::vector<double>& weights, bool skinned);

/// Transforms of vertices: one for all, or with a skin one per vertex.
struct Placing {
  Affine to_world;  ///< with a skin: that of its first joint
  bool mirrors = false;
  std::vector<Affine> of_vertices{};  ///< empty: to_world for all
  const Affine& map_of(size_t vertex) const {
    return of_vertices.empty() ? to_world : of_vertices[vertex];
  }
};

/// Appends all attributes of a set but the positions, for the vertices from `first` on.
void add_attributes(const Document& document, const AttributeSet& set, const Placing& placing,
                    size_t first, Scene& scene);

/// Tells the material which vertex colours its primitive has.
void note_colours(const Document& document, const AttributeSet& set, MaterialUse& use);

/// Fills up the attributes in use to `vertices` elements.
void fill_attributes(size_t vertices, Scene& scene);

/// Fills scene.smooth; drops the normals if no triangle is smooth. Call after drop_flat_triangles.
void mark_smooth_triangles(Scene& scene);

}  // namespace tdpt::gltf
