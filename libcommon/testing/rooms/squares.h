// A square, for files that differ from a sound one by a fault, and the same compressed. Its bytes
// are hard-coded, as an encoder once wrote them, so that files made from them are the same
// everywhere.
#pragma once
#include "libcommon/testing/files/glb_builder.h"

namespace tdpt::testing {

/// One square, one material, one camera: accessors[0] positions, accessors[1] indices; nodes[0] the
/// square, nodes[1] the camera.
GlbBuilder square();

/// KHR_draco_mesh_compression: accessors[0] positions, accessors[1] indices, bufferViews[0].
GlbBuilder square_by_draco();

/// EXT_meshopt_compression: the same accessors, of bufferViews[0] and [1]; their compressed data
/// are 67 bytes at the start of the binary chunk and 11 bytes from byte 68 on.
GlbBuilder square_by_meshopt();

/// Two by two texels, lossless.
std::string texels_by_webp();

}  // namespace tdpt::testing
