// Whether a world and its film find room in a device's memory, and how much is left to samples.
#pragma once
#include "libcommon/gpu/device.h"
#include "tools/tdpt-render/device/machine.h"
#include "tools/tdpt-render/device/render_tables.h"

namespace tdpt {

/// Some of what a scene takes, however many samples are rendered at a time.
struct SceneShare {
  std::string name;  ///< "the triangles"
  uint64_t bytes;
};

/// All of them.
std::vector<SceneShare> shares_of(const RenderTables& tables);

/// What else a rendering asks of a device.
struct DeviceNeeds {
  std::vector<SceneShare> scene;  ///< one buffer for all of them
  uint64_t film = 0;              ///< bytes
  bool layered = false;           ///< vertices keep what they are made of [SurfaceFeatures::layers]
  size_t buffers = 0;             ///< storage buffers that a kernel binds
};

/// As many slots, and samples, as suit the device `name`: scene, film and they take three
/// quarters of its memory at the most, they alone an eighth, since laptops share it with all else,
/// or what the fewest samples take. Throws Error (no_device), with the number that is needed and
/// the one that is allowed, where that is too much.
Capacity capacity_on(const std::string& name, const gpu::Limits& limits, const DeviceNeeds& needs);

}  // namespace tdpt
