// Vertex attributes of placed meshes, gathered into the scene's arrays. Internal to this room.
#pragma once
#include <string>
#include <vector>

#include "libcommon/scene/gltf_accessors.h"
#include "libcommon/scene/gltf_document.h"
#include "libcommon/scene/gltf_materials.h"
#include "libcommon/scene/gltf_nodes.h"
#include "libcommon/scene/scene.h"

namespace tdpt::gltf {

/// Accessors of a primitive's attributes, -1 for those that are not there or not needed. Primitives
/// of a mesh share their vertices where all of these agree.
struct AttributeSet {
  int position = -1, normal = -1, tangent = -1, colour = -1;
  std::array<int, 2> uv{-1, -1};
  auto operator<=>(const AttributeSet&) const = default;
};

/// What of a primitive that has a POSITION is read for a material.
AttributeSet choose_attributes(const tinygltf::Primitive& primitive, const MaterialUse& use);

/// Throws InputError when an attribute has another count than POSITION. `place`: the primitive's.
void check_counts(const Document& document, const AttributeSet& set, const std::string& place);

class AttributeReader {
 public:
  AttributeReader(const Document& document, Scene& scene) : d_(document), scene_(scene) {}

  /// Appends all but the positions of a set, placed by `to_world`, for the vertices from `first`
  /// on.
  void add(const AttributeSet& set, const Affine& to_world, size_t first);

  /// Tells a material what colours its primitive's vertices have.
  void note_colours(const AttributeSet& set, MaterialUse& use) const;

  /// Fills up the arrays that are in use to all `vertices`.
  void finish(size_t vertices);

 private:
  std::vector<float> values(int accessor, const Attribute& attribute) const;

  const Document& d_;
  Scene& scene_;
};

/// Fills scene.smooth, and drops the normals if no triangle is smooth. After drop_flat_triangles.
void mark_smooth_triangles(Scene& scene);

}  // namespace tdpt::gltf
