// What the renderer's kernels read and write, from the sizes of their records.
#pragma once
#include "tools/tdpt-render/device/gpu_machine.h"

namespace tdpt {

/// Bytes.
struct Traffic {
  double read = 0, written = 0;
};

/// Of records [shaders/shared/path/render_layout.h], each counted whole, once for every invocation
/// that reads or writes it, as if no cache held it and no walk had ended: an upper bound but for
/// what weights read along a path, the scene, and the film, which are not counted. `connections`:
/// pairs of ends whose contribution was estimated. `layered`: vertices keep what they are made of.
Traffic traffic_of(const DeviceWork& work, uint64_t connections, bool layered);

}  // namespace tdpt
