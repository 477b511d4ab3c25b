// Interface that traces lines of light and counts them in the grid. Implementations: Embree
// (below), compute shaders on a Vulkan device and, for tests, the scalar
// build of these shaders (testing/scalar_lines.h). All generate the same lines from the same seed;
// Embree's rays hit another triangle than the two others' in fewer than 1 of 10 000 cases.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "libcommon/formats/light_grid.h"
#include "libcommon/math/streams.h"
#include "libcommon/scene/scene.h"
#include "shaders/shared/light_layout.h"
#include "tools/lightgrid/line_tables.h"

namespace tdpt {

namespace gpu {
class Device;
}

/// Outcome of a line; the numbers are those of the shaders.
enum class LineFate : uint32_t {
  none = FATE_NONE,            ///< blocked, or an end is on no patch
  same_side = FATE_SAME_SIDE,  ///< does not connect the sides, or an end sees mostly the other side
  joins = FATE_JOINS,
};

struct TracedLines {
  std::vector<shader::LineEnds> ends;
  std::vector<LineFate> fate;
  size_t size() const { return ends.size(); }
};

/// Clips a line to the grid; false if no part of it lies within.
bool clip_to(const LightGrid& grid, LightLine& line);

class LineTracer {
 public:
  virtual ~LineTracer() = default;

  /// Samples segments `first` .. `first` + n between pivot patches of cut `c`, which must have
  /// pairs, and reports which are unoccluded and connect its sides (same_side: a leak). Those that
  /// do are counted.
  void between_pivots(size_t c, uint32_t first, uint32_t n, TracedLines& out);
  /// Traces the line through each point both ways to the first surface; a try without direction is
  /// skipped. `round` separates the random numbers of several calls.
  void through(size_t c, uint32_t round, std::span<const shader::LineTry> tries, TracedLines& out);

  /// Resets counts and directions to 0.
  virtual void clear() = 0;
  /// Number of lines that passed each voxel since clear(), in air or not.
  virtual void counts(std::vector<uint32_t>& count) = 0;
  /// Adds the sums of their unit directions, towards the camera, since the last call or clear(). At
  /// most LIGHT_MOST_SUMMED segments may be sampled in between.
  virtual void take_directions(std::vector<Vec3d>& sum) = 0;

  /// The finest patch that contains `place` [canonical] on `face`; UINT32_MAX: none.
  uint32_t patch_at(uint32_t face, const shader::vec3& place) const;
  /// Canonical line of cut `c` -> metres. A line from or to the sky is clipped to the grid.
  /// `share`: brightness of the patch at its one end times importance of that at the other, in the
  /// direction of the light; 1 where no patch has light.
  LightLine in_metres(const Scene& scene, const LightGrid& grid, size_t c,
                      const shader::LineEnds& line) const;

 protected:
  /// Keeps a reference to the tables. Uses only the box of `grid`.
  LineTracer(const Scene& scene, const LineTables& tables, const LightGrid& grid, uint64_t seed);

  /// Fills out.ends and out.fate, which have p.count elements, and counts the lines that connect
  /// the sides.
  virtual void trace_segments(const shader::LightParameters& p, TracedLines& out) = 0;
  virtual void trace_tries(const shader::LightParameters& p, std::span<const shader::LineTry> tries,
                           TracedLines& out) = 0;

  const LineTables& tables_;
  const shader::LightParameters common_;  ///< shared by all calls

 private:
  shader::LightParameters parameters(const Streams& streams, size_t c, uint32_t n) const;
};

/// Per voxel, the number of lines through it and the sum of their directions
/// [1/LIGHT_DIRECTION_UNITS]. Integer additions commute, so results do not depend on threads.
class VoxelSums {
 public:
  explicit VoxelSums(size_t voxels) : sums_(voxels) {}
  /// Thread-safe.
  void add(size_t voxel, const shader::ivec3& direction) {
    Sum& sum = sums_[voxel];
    __atomic_fetch_add(&sum.count_x, packed(1, direction.x), __ATOMIC_RELAXED);
    __atomic_fetch_add(&sum.y_z, packed(direction.y, direction.z), __ATOMIC_RELAXED);
  }
  void clear();
  void counts(std::vector<uint32_t>& count) const;
  void take_directions(std::vector<Vec3d>& sum);

 private:
  // Two sums in one word, each of 31 bits and a sign: this halves the atomic additions, which
  // dominate the cost of the march. low() accounts for what the lower sum borrows from the upper.
  static uint64_t packed(int32_t high, int32_t low) {
    return (uint64_t{static_cast<uint32_t>(high)} << 32) + static_cast<uint64_t>(int64_t{low});
  }
  static int32_t low(uint64_t word) { return static_cast<int32_t>(static_cast<uint32_t>(word)); }
  static int32_t high(uint64_t word) {
    return static_cast<int32_t>((word - static_cast<uint64_t>(int64_t{low(word)})) >> 32);
  }
  struct Sum {
    uint64_t count_x = 0, y_z = 0;
    shader::ivec3 direction() const { return {low(count_x), high(y_z), low(y_z)}; }
  };
  std::vector<Sum> sums_;
};

// Lines of light traced by Embree on all cores.

/// Keeps references to the scene and the tables.
std::unique_ptr<LineTracer> make_embree_lines(const Scene& scene, const LineTables& tables,
                                              const LightGrid& grid, uint64_t seed);

// Lines of light traced on a Vulkan device (gpu_lines.cpp).

/// Keeps a reference to the tables. Throws Error (no_device) if the scene or the grid is too large
/// for the device. The scene's glass must be open. `most_lines`: of a submission.
std::unique_ptr<LineTracer> make_gpu_lines(const gpu::Device& device, const Scene& scene,
                                           const LineTables& tables, const LightGrid& grid,
                                           uint64_t seed, uint32_t most_lines = 1u << 18);

}  // namespace tdpt
