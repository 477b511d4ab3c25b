// The square of the malformed scenes, compressed. Its bytes are written down, as encoders wrote
// them once, so that files made of them are the same wherever they are made.
#pragma once
#include "libcommon/testing/files/glb_builder.h"

namespace tdpt::testing {

/// KHR_draco_mesh_compression: accessors[0] positions, accessors[1] indices, bufferViews[0].
GlbBuilder square_by_draco();

/// EXT_meshopt_compression: the same accessors, of bufferViews[0] and [1]; what they hold
/// compressed lies in the binary chunk, 67 bytes and from byte 68 on 11.
GlbBuilder square_by_meshopt();

/// Two by two texels, lossless.
std::string texels_by_webp();

}  // namespace tdpt::testing
