// What renders a submission step by step: a device, or its twin on the CPU. The schedule of steps
// [wavefront.h] is the same for both.
#pragma once
#include <cstdint>
#include <vector>

#include "shaders/shared/path/render_layout.h"

namespace tdpt {

/// Kernels; invocation i works on the slots that StepParameters names.
enum class Step : uint8_t {
  begin_light_walks,
  begin_camera_walks,
  go_on_light,  ///< of those that gather() found, into slots from `next` on
  go_on_camera,
  list_ends,    ///< of the light's vertices in slots from `first` on, for joins
  list_starts,  ///< of light walk `first` + i
  draw_segments,
  connect,  ///< the camera's vertices in slots from `first` on
  splat,    ///< the light's vertices
  see_segments,
  join_segments,  ///< of camera walk `first` + i
  kSteps
};

/// How much room there is.
struct Room {
  uint32_t vertices = 0;  ///< slots
  uint32_t samples = 0;   ///< of a submission; kMostOfPool at least
};

/// Samples of a pool.
constexpr uint32_t kMostOfPool = 256;

class Machine {
 public:
  virtual ~Machine() = default;
  virtual Room room() const = 0;
  /// For all steps that follow. `pool_offsets`: how far along its stretch the pixel of each sample
  /// of pool 0 lies.
  virtual void set(const shader::RenderParameters& parameters,
                   const std::vector<uint32_t>& pool_offsets) = 0;
  /// Runs them one after the other.
  virtual void run(Step step, const shader::StepParameters& parameters) = 0;
  /// Of the slots from `first` on those whose walk may go on, in order, for the next step that goes
  /// on. Returns how many there are.
  virtual uint32_t gather(bool of_light, uint32_t first, uint32_t count) = 0;
  /// Finds a place for each end that light walks have for joins, walk by walk.
  virtual void place_ends(uint32_t walks) = 0;
  /// All words of the film and of what is counted beside it; 0 from then on.
  virtual std::vector<uint32_t> take_film() = 0;
};

}  // namespace tdpt
