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

/// Vertex indices: SCALAR of unsigned 8, 16 or 32 bits, each below `vertices`.
std::vector<uint32_t> read_indices(const Document& document, size_t accessor, size_t vertices);

}  // namespace tdpt::gltf
