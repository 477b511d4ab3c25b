// What the renderer's kernels read and write, from the sizes of their records.
#pragma once
#include "tools/tdpt-render/device/gpu_renderer.h"

namespace tdpt {

/// How often one step ran, and the time it took.
struct StepWork {
  double seconds = 0;  ///< of the device; if it is a CPU, over all its cores
  uint64_t runs = 0, invocations = 0;
};
struct DeviceWork {
  std::array<StepWork, static_cast<size_t>(Step::kSteps)> steps;
  StepWork gather;    ///< ranks and lists: pick() and place_ends()
  double making = 0;  ///< seconds of compiling kernels
};

/// Bytes.
struct Traffic {
  double read = 0, written = 0;
};

/// Counts whole records [shaders/shared/path/render_layout.h], once for every invocation that reads
/// or writes them, as if there were no cache and no walk had ended. It is an upper bound, except
/// that reads by MIS weights along a path, the scene and the film are not counted. `connections`:
/// pairs of ends whose contribution was estimated. `layered`: vertices store their layers.
Traffic traffic_of(const DeviceWork& work, uint64_t connections, bool layered);

}  // namespace tdpt
