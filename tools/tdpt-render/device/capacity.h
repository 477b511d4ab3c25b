// Whether a vista and its film fit into a device's memory, and how much is left for samples.
#pragma once
#include "libcommon/gpu/device.h"
#include "tools/tdpt-render/device/machine.h"
#include "tools/tdpt-render/device/render_tables.h"

namespace tdpt {

/// A part of the memory that a scene takes, however many samples are rendered at a time.
struct SceneShare {
  std::string name;  ///< "the triangles"
  uint64_t bytes;
};

/// All parts.
std::vector<SceneShare> shares_of(const RenderTables& tables);

/// What a rendering needs of a device beside the samples.
struct DeviceNeeds {
  std::vector<SceneShare> scene;  ///< all in one buffer
  uint64_t film = 0;              ///< bytes
  bool layered = false;           ///< vertices store their layers [SurfaceFeatures::layers]
  size_t buffers = 0;             ///< storage buffers that a kernel binds
};

/// The slots and samples that suit the device `name`: together with scene and film at most three
/// quarters of its memory; by themselves at most an eighth, since laptops share it with everything
/// else, or whatever the fewest samples take. Throws Error (no_device), with the number needed and
/// the one allowed, if that is too much.
Capacity capacity_on(const std::string& name, const gpu::Limits& limits, const DeviceNeeds& needs);

}  // namespace tdpt
