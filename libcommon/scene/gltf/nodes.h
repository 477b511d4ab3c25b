// Flattens the node hierarchy: every node of the scene with its world transform, in double
// precision. Internal to this room.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libcommon/math/vec.h"
#include "libcommon/scene/gltf/document.h"

namespace tdpt::gltf {

/// Affine map p -> x p.x + y p.y + z p.z + t.
struct Affine {
  Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, t{};
  Vec3d vector(const Vec3d& v) const { return x * v.x + y * v.y + z * v.z; }
  Vec3d point(const Vec3d& p) const { return vector(p) + t; }
  Affine operator*(const Affine& b) const {
    return {vector(b.x), vector(b.y), vector(b.z), point(b.t)};
  }
  /// Whether it changes handedness (negative determinant).
  bool mirrors() const;
};

/// Translation * rotation (a quaternion x, y, z, w of any length) * scale; empty for a rotation of
/// zeros.
std::optional<Affine> affine_of(const Vec3d& translation, const std::array<double, 4>& rotation,
                                const Vec3d& scale);

/// The map of a node into its parent. Throws InputError if it is invalid.
Affine local_map(const Document& document, size_t node);

constexpr const char* kVisibility = "KHR_node_visibility";
/// Whether an extension hides this node (of checked JSON) and all below it but the cameras.
bool is_hidden(const nlohmann::json& node);

struct PlacedNode {
  size_t node;
  Affine map;    ///< to_world(), if there is no fault
  bool visible;  ///< neither it nor an ancestor is hidden
  /// Why there is no such map: an error of this node or an ancestor; null: none. Thrown only when
  /// the map is needed.
  std::shared_ptr<const InputError> fault{};
  /// Throws the fault.
  const Affine& to_world() const {
    if (fault) throw InputError(*fault);
    return map;
  }
};

/// Nodes of the default scene (else of the first scene, else all roots and what is below), parents
/// first, in file order. Throws InputError for cycles and nodes with two parents. Adds a sentence
/// to `warnings` about roots that are also children.
std::vector<PlacedNode> place_nodes(const Document& document, std::vector<std::string>& warnings);

}  // namespace tdpt::gltf
