// Reads numbers from accessors, each checked against its bufferView and buffer first. Internal to
// this room.
#pragma once
#include <cstdint>
#include <vector>

#include "libcommon/math/vec.h"
#include "libcommon/scene/gltf/document.h"

namespace tdpt::gltf {

/// Vertex positions: VEC3 of floats, or of integers with KHR_mesh_quantization. All are finite.
std::vector<Vec3d> read_positions(const Document& document, size_t accessor);

/// Component types allowed for an attribute, besides floats.
struct Attribute {
  const char* name;  ///< in the file
  const char* noun;  ///< in messages
  size_t components;
  bool may_be_vec3;       ///< VEC3 is read as VEC4 with fourth 1
  bool may_be_unsigned;   ///< 8 or 16 bit, normalized
  bool quantizable;       ///< any 8 or 16 bit integers with KHR_mesh_quantization
  bool is_delta = false;  ///< may also be signed, normalized; a VEC3's fourth is 0
};
constexpr Attribute kNormal = {"NORMAL", "normals", 3, false, false, true};
constexpr Attribute kTangent = {"TANGENT", "tangents", 4, false, false, true};
constexpr Attribute kTexCoord[2] = {{"TEXCOORD_0", "texture coordinates", 2, false, true, true},
                                    {"TEXCOORD_1", "texture coordinates", 2, false, true, true}};
constexpr Attribute kColour = {"COLOR_0", "vertex colours", 4, true, true, false};

/// Deltas of morph targets: floats, or normalized integers of 8 or 16 bits.
constexpr Attribute kTexCoordDelta = {
    "TEXCOORD", "deltas of texture coordinates", 2, false, true, true, true};
constexpr Attribute kTangentDelta = {"TANGENT", "deltas of tangents", 3, false, false, true};
constexpr Attribute kColourDelta = {"COLOR", "deltas of vertex colours", 4, true, true, false,
                                    true};

/// A vertex attribute, `components` floats per vertex, as stored: not necessarily finite.
/// Normalized integers are mapped to [0,1] or [-1,1].
std::vector<float> read_attribute(const Document& document, size_t accessor,
                                  const Attribute& attribute);

/// Type of numbers that are no vertex attribute.
struct Numbers {
  const char* noun;                    ///< in messages
  size_t components;                   ///< 1: SCALAR, 3 and 4: VEC, 16: MAT4
  bool floats, shares, signed_shares;  ///< floats; unsigned and signed 8 or 16 bits, normalized
  bool integers;                       ///< unsigned of 8 or 16 bits, not normalized
};

/// `count` elements (default: all) from element `first` on, `components` numbers each, as stored.
/// Throws InputError if the accessor has fewer.
std::vector<double> read_numbers(const Document& document, size_t accessor, const Numbers& numbers,
                                 size_t first = 0, size_t count = SIZE_MAX);

/// Vertex indices: SCALAR of unsigned 8, 16 or 32 bits, each below `vertices`.
std::vector<uint32_t> read_indices(const Document& document, size_t accessor, size_t vertices);

}  // namespace tdpt::gltf
