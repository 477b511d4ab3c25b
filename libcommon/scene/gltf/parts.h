// What a document holds of a scene: materials, meshes with their vertex attributes, and lights.
// Internal to this room.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "libcommon/math/vec.h"
#include "libcommon/scene/gltf/accessors.h"
#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/gltf/nodes.h"
#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

// Materials: glTF 2.0 metallic-roughness and the supported extensions.

/// What a material needs of the meshes that use it, and what they report back.
struct MaterialUse {
  std::array<bool, 2> uv{};  ///< sets of texture coordinates that its maps use
  bool tangents = false;     ///< it has a normal map
  bool colours = true;       ///< vertex colours would change it
  bool alpha = false;        ///< it is not opaque
  bool unlit = false;     ///< its base colour became emission, which vertex colours do not change
  float least_alpha = 1;  ///< factor times the minimum of its texture
  float least_vertex_alpha = 1;  ///< set by the meshes
  bool coloured = false;         ///< set by the meshes: some vertex colour is not white
};

/// Appends a material for each in the file that is `used` (others keep their defaults), with the
/// images that they use, and adds external image files to scene.hash. Absorption is still per
/// metre. The result is parallel to the materials.
std::vector<MaterialUse> read_materials(const Document& document, const std::vector<bool>& used,
                                        Scene& scene, Notes& notes);

/// Call when the vertex colours are known: makes a material opaque if alpha is 1 everywhere, and
/// sets `plain` if nothing but base colour and emission matters.
void finish_material(const MaterialUse& use, Material& material);

// Lights: KHR_lights_punctual, EXT_lights_ies and EXT_lights_area (a draft: KhronosGroup/glTF, pull
// request 2525).

/// Upper bound on the vertices and on the triangles of an area light.
constexpr size_t kMostOfAreaLight = 65;

/// Adds the lights of visible nodes: punctual ones and luminaires, still in metres (position [m],
/// intensity of points and spots [W/sr]), and area lights, with their vertices [m], as materials
/// and triangles of their own. Lights that emit nothing are passed over; profiles in files beside
/// the scene are listed in scene.files and change its hash. Throws InputError, for lights that no
/// node holds, too.
void read_lights(const Document& document, const PlacedNodes& nodes, Scene& scene,
                 std::vector<Vec3d>& world, Notes& notes);

/// asset.generator; empty: not given.
std::string generator_of(const Document& document);

/// Transforms a light to the canonical frame. Throws InputError if its intensity there is outside
/// the range of single precision.
void to_canonical(const Document& document, const Frame& frame, PunctualLight& light);

// Meshes of placed nodes, as world-space triangles.

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
