// The node hierarchy flattened: every node of the scene with its place in the world, double
// precision. Internal to this room.
#pragma once
#include <array>
#include <vector>

#include "libcommon/math/vec.h"
#include "libcommon/scene/gltf_document.h"

namespace tdpt::gltf {

/// Affine map p -> x p.x + y p.y + z p.z + t.
struct Affine {
  Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, t{};
  Vec3d vector(const Vec3d& v) const { return x * v.x + y * v.y + z * v.z; }
  Vec3d point(const Vec3d& p) const { return vector(p) + t; }
  Affine operator*(const Affine& b) const {
    return {vector(b.x), vector(b.y), vector(b.z), point(b.t)};
  }
  /// Whether it turns left hands into right ones (negative determinant).
  bool mirrors() const;
};

struct PlacedNode {
  size_t node;
  Affine to_world;
};

/// Nodes of the default scene (else of the first scene, else below every root), parents first, in
/// file order. Throws InputError for cycles, nodes with two parents and maps that are not affine.
std::vector<PlacedNode> place_nodes(const Document& document);

}  // namespace tdpt::gltf
