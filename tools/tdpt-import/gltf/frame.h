// The frame in which a scene is written: right-handed, +y up, as glTF wants it.
#pragma once
#include "tools/tdpt-import/described.h"

namespace tdpt::foreign {

enum class Up { by_camera, x, y, z };

struct Frame {
  Affine to_gltf{};       ///< orthogonal; of the source's coordinates
  bool mirrored = false;  ///< the source's frame is left-handed
  Up up = Up::y;          ///< what is up in the source; never by_camera
  bool downwards = false;
};

/// Mirrors the scene along x if its first camera is mirrored, and turns `up` to +y. By the camera:
/// the axis that is nearest to what is up in its picture.
Frame frame_of(const Described& scene, Up up);

}  // namespace tdpt::foreign
