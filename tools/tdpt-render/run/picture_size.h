// The size of a picture.
#pragma once
#include <cstdint>

#include "libcommon/scene/scene.h"
#include "tools/tdpt-render/run/options.h"

namespace tdpt {

struct PictureSize {
  int width = 0, height = 0;  ///< pixels
};

/// Fills in what `width` and `height` leave open as 0: square pixels, the camera's aspect (16 : 9
/// if it has none), 640 wide. Throws UsageError if too large.
PictureSize picture_size(const Camera& camera, int64_t width, int64_t height);

/// If neither is given, takes what the scene says, and fills in the rest as above. Throws
/// InputError if that is too large.
PictureSize picture_size(const Scene& scene, const Camera& camera, int64_t width, int64_t height);

/// Throws UsageError if the film of such a picture takes too much memory [memory_limit.h]. With
/// `auto` it may get layers for all techniques of its candidates.
void expect_memory_of_film(const RenderArguments& a, const PictureSize& size);

}  // namespace tdpt
