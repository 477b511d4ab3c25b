// What renders a submission step by step: a device, or its twin on the CPU. The schedule of steps
// [wavefront.h] is the same for both.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "libcommon/base/progress.h"
#include "shaders/shared/path/render_layout.h"

namespace tdpt {

/// Kernels; what invocation i does, `first` and `next` being those of StepParameters. Each has one
/// heavy thing to do, once: devices take the text of a function anew wherever it is called.
enum class Step : uint8_t {
  begin_light_walks,   ///< walk i: y_0 into slot first + i, and ray i
  begin_camera_walks,  ///< walk i: ray i
  go_on_light,         ///< of those that gather() found: ray i
  go_on_camera,
  trace,         ///< ray i
  arrive_light,  ///< where ray i has come to, into slot next + i
  arrive_camera,
  list_ends,       ///< of the light's vertex in slot first + i, for joins
  list_starts,     ///< of light walk i
  meet_lights,     ///< the camera's vertex in slot first + i
  begin_segments,  ///< of sample i: rays 2i and 2i + 1
  end_segments,    ///< where ray i has come to
  put_segments,    ///< segment i
  gather_sides,    ///< of segment first + i, its joinings from 2i on
  // Choose pairs of ends: joinings i, or from 2i or 3i on.
  choose_next_events,  ///< for the camera's vertex in slot first + i
  choose_joins,        ///< likewise, two
  choose_splats,       ///< of the light's vertex in slot first + i
  choose_sides,        ///< for segment first + i, two
  choose_seen,         ///< of segment first + i
  choose_segments,     ///< for camera walk first + i, three; rows of estimates from slot `next` on
  // Before the last: of segments, and of what they would bring.
  flag_lit,           ///< segment first + i
  list_lit,           ///< i of all segments, which pick() has ranked
  estimate_segments,  ///< to the camera's vertex in slot first + i, row i
  // Of joining i of those that pick() found:
  scatter_ends,  ///< the light's end (first: 0), or the camera's
  see,           ///< whether it brings anything
  join,          ///< makes paths of it
  join_sides,
  join_segments,
  kSteps
};
inline constexpr std::array<const char*, static_cast<size_t>(Step::kSteps)> kStepNames{
    "begin light walks",
    "begin camera walks",
    "go on, light",
    "go on, camera",
    "trace",
    "arrive, light",
    "arrive, camera",
    "list ends",
    "list starts",
    "meet lights",
    "begin segments",
    "end segments",
    "put segments",
    "gather sides",
    "choose next events",
    "choose joins",
    "choose splats",
    "choose sides",
    "choose seen",
    "choose segments",
    "flag lit",
    "list lit",
    "estimate segments",
    "scatter ends",
    "see",
    "join",
    "join sides",
    "join segments"};

/// How much room there is.
struct Room {
  uint32_t vertices = 0;  ///< slots
  uint32_t samples = 0;   ///< of a submission; kMostOfPool at least
  constexpr uint32_t joinings() const { return 4 * samples; }  ///< at a time
  constexpr uint64_t estimates() const { return 16 * uint64_t{vertices}; }
  /// As many flags as any step asks for.
  constexpr uint32_t flags() const { return std::max(vertices, joinings()); }
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
  /// Finds a place for each end that light walks have for joins, walk by walk.
  virtual void place_ends(uint32_t walks) = 0;
  /// All words of the film and of what is counted beside it; 0 from then on.
  virtual std::vector<uint32_t> take_film() = 0;
};

}  // namespace tdpt
