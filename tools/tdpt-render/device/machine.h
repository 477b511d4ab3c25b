// Renders a submission step by step: a device, or the scalar build of its kernels on the CPU. Both
// follow the same schedule of steps [wavefront.h].
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "libcommon/base/progress.h"
#include "shaders/shared/path/render_layout.h"

namespace tdpt {

/// The kernels, or what the scalar build runs in their place [steps.def].
enum class Step : uint8_t {
#define STEP(name, call) name,
#include "shaders/shared/path/steps.def"
  kSteps
};
inline constexpr std::array<const char*, static_cast<size_t>(Step::kSteps)> kStepNames{
#define STEP(name, call) #name,
#include "shaders/shared/path/steps.def"
};

struct Capacity {
  uint32_t vertices = 0;  ///< slots
  uint32_t samples = 0;   ///< in a submission; at least kMostOfCache
  constexpr uint32_t connections() const { return 4 * samples; }  ///< at a time
  constexpr uint64_t estimates() const { return 16 * uint64_t{vertices}; }
  /// The most flags that any step needs.
  constexpr uint32_t flags() const { return std::max(vertices, connections()); }
};

/// Samples in a cache, at most.
constexpr uint32_t kMostOfCache = 256;

class Machine {
 public:
  virtual ~Machine() = default;
  virtual Capacity room() const = 0;
  /// For all steps that follow. `cache_offsets`: by sample of cache 0, the position of its pixel
  /// within its stretch.
  virtual void set(const shader::RenderParameters& parameters,
                   const std::vector<uint32_t>& cache_offsets) = 0;
  /// Prepares these steps for the parameters that were set, which would otherwise delay the first
  /// run of each. Reports each.
  virtual void prepare(const std::vector<Step>&, ProgressBar&) {}
  /// Steps run one after the other.
  virtual void run(Step step, const shader::StepParameters& parameters) = 0;
  /// Compacts the `count` slots from `first` on to those whose walk continues, in order, for the
  /// next step. Returns their number.
  virtual uint32_t gather(bool of_light, uint32_t first, uint32_t count) = 0;
  /// Compacts 0 .. count-1 to those that a step flagged, in order, and ranks each by how many come
  /// before it. Returns their number.
  virtual uint32_t pick(uint32_t count) = 0;
  /// Allocates places for the light vertices that connections can use, walk by walk.
  virtual void place_ends(uint32_t walks) = 0;
  /// Returns all words of the film and its counters, and clears them.
  virtual std::vector<uint32_t> take_film() = 0;
};

}  // namespace tdpt
