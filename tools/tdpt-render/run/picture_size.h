// How large a picture becomes.
#pragma once
#include <cstdint>

#include "libcommon/scene/scene.h"

namespace tdpt {

struct PictureSize {
  int width = 0, height = 0;  ///< pixels
};

/// What `width` and `height` leave open, given as 0: square pixels, the camera's aspect (16 : 9
/// where it has none), 640 wide. Throws UsageError for one that is too large.
PictureSize picture_size(const Camera& camera, int64_t width, int64_t height);

/// Where neither is given, what the scene says of them, and as above what that leaves open. Throws
/// InputError where that is too large.
PictureSize picture_size(const Scene& scene, const Camera& camera, int64_t width, int64_t height);

}  // namespace tdpt
