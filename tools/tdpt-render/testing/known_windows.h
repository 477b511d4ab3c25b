// For tests: a generated room under a grey sky, with a portal in each of its windows.
#pragma once
#include <algorithm>
#include <vector>

#include "libcommon/formats/portal.h"
#include "libcommon/testing/files/temp_folder.h"
#include "libcommon/testing/rooms/known_rooms.h"
#include "tools/tdpt-render/testing/sky.h"

namespace tdpt {

struct RoomWithWindows {
  Scene scene;
  std::vector<Portal> windows;

  RoomWithWindows(testing::RoomKind kind, uint64_t seed) {
    const testing::KnownRoom room = testing::known_room(kind, seed);
    const testing::TempFolder folder;
    scene = under(read_gltf(folder.write(room.file(), room.plan.glb(room.writing))),
                  one_colour_sky({1, 1, 1}));
    for (const testing::KnownAperture& a : room.placed_apertures()) {
      windows.push_back({"window", a.outline, {{0, 1, 2}, {0, 2, 3}}, {}});
      std::vector<Vec3d>& corners = windows.back().vertices;
      if (dot(cross(corners[1] - corners[0], corners[2] - corners[0]), a.normal) < 0)
        std::reverse(corners.begin(), corners.end());
    }
  }
};

}  // namespace tdpt
