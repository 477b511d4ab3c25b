// Parts of a shot for which portals are found together.
#pragma once
#include <vector>

#include "tools/tdpt/request.h"

namespace tdpt {

struct Part {
  FrameRange frames;
  bool moves = false;  ///< the scene does, beside its cameras
};

/// Frames in which nothing but cameras moves are one part. Each frame in which the scene moves is a
/// part of its own. Reads the scene.
std::vector<Part> parts_of_shot(const Arguments& a);

}  // namespace tdpt
