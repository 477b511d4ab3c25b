#include "tools/tdpt/parts.h"

#include "libcommon/scene/scene_file.h"

namespace tdpt {

std::vector<Part> parts_of_shot(const Arguments& a) {
  SceneFile file(a.scene, a.pose.animations);
  const FrameRange range = frame_range(a.shot);
  std::vector<Part> parts;
  std::string before;
  for (int64_t k = range.first; k <= range.last; ++k) {
    std::string pose = file.glance_at(static_cast<double>(k) / a.shot.fps).pose_hash;
    if (k > range.first && pose == before)
      parts.back().frames.last = k;
    else
      parts.push_back({{k, k}});
    before = std::move(pose);
  }
  for (Part& part : parts) part.moves = parts.size() > 1 && part.frames.count() == 1;
  return parts;
}

}  // namespace tdpt
