// Numbers out of accessors, each checked against its bufferView and buffer first. Internal to this
// room.
#pragma once
#include <cstdint>
#include <vector>

#include "libcommon/math/vec.h"
#include "libcommon/scene/gltf_document.h"

namespace tdpt::gltf {

/// Vertex positions: VEC3 of floats, or of integers with KHR_mesh_quantization. All are finite.
std::vector<Vec3d> read_positions(const Document& document, size_t accessor);

/// What an attribute may be made of, besides floats.
struct Attribute {
  const char* name;  ///< in the file
  const char* noun;  ///< in messages
  size_t components;
  bool may_be_vec3;      ///< VEC3 for VEC4: the fourth is 1
  bool may_be_unsigned;  ///< 8 or 16 bit, normalized
  bool quantizable;      ///< any 8 or 16 bit integers with KHR_mesh_quantization
};
constexpr Attribute kNormal = {"NORMAL", "normals", 3, false, false, true};
constexpr Attribute kTangent = {"TANGENT", "tangents", 4, false, false, true};
constexpr Attribute kTexCoord[2] = {{"TEXCOORD_0", "texture coordinates", 2, false, true, true},
                                    {"TEXCOORD_1", "texture coordinates", 2, false, true, true}};
constexpr Attribute kColour = {"COLOR_0", "vertex colours", 4, true, true, false};

/// A vertex attribute, `components` floats for each vertex, as they stand in the file: not
/// necessarily finite. Whatever has a normalized integer type lies in [0,1] or [-1,1].
std::vector<float> read_attribute(const Document& document, size_t accessor,
                                  const Attribute& attribute);

/// Vertex indices: SCALAR of unsigned 8, 16 or 32 bits, each below `vertices`.
std::vector<uint32_t> read_indices(const Document& document, size_t accessor, size_t vertices);

}  // namespace tdpt::gltf
