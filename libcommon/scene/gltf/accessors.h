// Reads numbers from accessors, each checked against its bufferView and buffer first. Internal to
// this room.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "libcommon/math/vec.h"
#include "libcommon/scene/gltf/document.h"

namespace tdpt::gltf {

/// What an accessor is expected to hold.
struct Numbers {
  const char* noun;   ///< in messages
  size_t components;  ///< 1: SCALAR, 2 to 4: VEC, 16: MAT4
  /// numbers: of any type; shares: floats or normalized integers; indices: unsigned integers.
  enum class Kind { numbers, shares, indices } kind = Kind::numbers;
  std::optional<double> fourth{};  ///< VEC3 is allowed, too, and has this as its fourth component
};
inline constexpr Numbers kTranslations = {"translations", 3};
inline constexpr Numbers kRotations = {"rotations", 4, Numbers::Kind::shares};
inline constexpr Numbers kScales = {"scales", 3};

/// `count` elements (default: all) from element `first` on, all finite. Throws InputError if the
/// accessor has fewer.
std::vector<double> read_numbers(const Document& document, size_t accessor, const Numbers& numbers,
                                 size_t first = 0, size_t count = SIZE_MAX);

/// The first `count` elements as stored: not necessarily finite.
std::vector<float> read_floats(const Document& document, size_t accessor, const Numbers& numbers,
                               size_t count);

/// Vertex positions, or what is added to them, `count` (default: all). All are finite.
std::vector<Vec3d> read_positions(const Document& document, size_t accessor,
                                  size_t count = SIZE_MAX);

/// Vertex indices, each below `vertices`.
std::vector<uint32_t> read_indices(const Document& document, size_t accessor, size_t vertices);

}  // namespace tdpt::gltf
