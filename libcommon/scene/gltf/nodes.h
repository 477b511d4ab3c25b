// The node hierarchy flattened: every node of the scene with its place in the world, double
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
  /// Whether it turns left hands into right ones (negative determinant).
  bool mirrors() const;
};

/// Translation * rotation (a quaternion x, y, z, w of any length) * scale; nothing for a rotation
/// of zeros.
std::optional<Affine> affine_of(const Vec3d& translation, const std::array<double, 4>& rotation,
                                const Vec3d& scale);

/// The map of a node into its parent. Throws InputError where it is none.
Affine local_map(const Document& document, size_t node);

constexpr const char* kVisibility = "KHR_node_visibility";
/// Whether it hides a node, of checked JSON, and all below but the cameras.
bool is_hidden(const nlohmann::json& node);

struct PlacedNode {
  size_t node;
  Affine map;    ///< to_world() if nothing is wrong
  bool visible;  ///< neither it nor one above is hidden
  /// Why there is no such map: of this node, or of one above; null: there is. An error only for
  /// those who need the map.
  std::shared_ptr<const InputError> fault{};
  /// Throws the fault.
  const Affine& to_world() const {
    if (fault) throw InputError(*fault);
    return map;
  }
};

/// Nodes of the default scene (else of the first scene, else below every root), parents first, in
/// file order. Throws InputError for cycles and nodes with two parents.
/// `warnings` get a sentence about roots that are children, too.
std::vector<PlacedNode> place_nodes(const Document& document, std::vector<std::string>& warnings);

}  // namespace tdpt::gltf
