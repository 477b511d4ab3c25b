// What renders a submission step by step: a device, or its scalar build on the CPU. The schedule of
// steps [wavefront.h] is the same for both.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "libcommon/base/progress.h"
#include "shaders/shared/path/render_layout.h"

namespace tdpt {

/// Kernels, and what the CPU's scalar build of them runs [steps.def].
enum class Step : uint8_t {
#define STEP(name, call) name,
#include "shaders/shared/path/steps.def"
  kSteps
};
inline constexpr std::array<const char*, static_cast<size_t>(Step::kSteps)> kStepNames{
#define STEP(name, call) #name,
#include "shaders/shared/path/steps.def"
};

/// How much room there is.
struct Capacity {
  uint32_t vertices = 0;  ///< slots
  uint32_t samples = 0;   ///< of a submission; kMostOfCache at least
  constexpr uint32_t connections() const { return 4 * samples; }  ///< at a time
  constexpr uint64_t estimates() const { return 16 * uint64_t{vertices}; }
  /// As many flags as any step asks for.
  constexpr uint32_t flags() const { return std::max(vertices, connections()); }
};

/// Samples of a cache.
constexpr uint32_t kMostOfCache = 256;

class Machine {
 public:
  virtual ~Machine() = default;
  virtual Capacity room() const = 0;
  /// For all steps that follow. `cache_offsets`: how far along its stretch the pixel of each sample
  /// of cache 0 lies.
  virtual void set(const shader::RenderParameters& parameters,
                   const std::vector<uint32_t>& cache_offsets) = 0;
  /// Makes ready what these steps take, for what was set: the first run of each would do it, and be
  /// long. Tells of each.
  virtual void prepare(const std::vector<Step>&, Progress&) {}
  /// Runs them one after the other.
  virtual void run(Step step, const shader::StepParameters& parameters) = 0;
  /// Of the slots from `first` on those whose walk goes on, in order, for the next step that goes
  /// on. Returns how many there are.
  virtual uint32_t gather(bool of_light, uint32_t first, uint32_t count) = 0;
  /// Of 0 .. count-1 those that a step has flagged, in order, and of each how many come before it.
  /// Returns how many there are.
  virtual uint32_t pick(uint32_t count) = 0;
  /// Finds a place for each end that light walks have for connections, walk by walk.
  virtual void place_ends(uint32_t walks) = 0;
  /// All words of the film and of what is counted beside it; 0 from then on.
  virtual std::vector<uint32_t> take_film() = 0;
};

}  // namespace tdpt
