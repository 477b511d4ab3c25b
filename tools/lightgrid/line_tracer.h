// What traces lines of light and counts them in the grid. Behind this interface stand Embree
// (embree_lines.h), a compute shader on a Vulkan device (gpu_lines.h) and, for tests, that shader's
// scalar twin (testing/scalar_lines.h). All draw the same lines from the same seed; between Embree
// and the two others fewer than one ray in 10 000 meets another triangle.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "libcommon/formats/light_grid.h"
#include "libcommon/math/streams.h"
#include "libcommon/scene/scene.h"
#include "shaders/shared/light_layout.h"
#include "tools/lightgrid/line_tables.h"

namespace tdpt {

/// What became of a line; the numbers are those of the shaders.
enum class LineFate : uint32_t {
  none = FATE_NONE,            ///< blocked, or one of its ends is on no patch
  same_side = FATE_SAME_SIDE,  ///< does not join the sides, or an end sees mostly the other side
  joins = FATE_JOINS,
};

struct TracedLines {
  std::vector<shader::LineEnds> ends;
  std::vector<LineFate> fate;
  size_t size() const { return ends.size(); }
};

/// Cuts a line off where it leaves the grid; false where no part of it lies within.
bool clip_to(const LightGrid& grid, LightLine& line);
/// Canonical line -> metres. One that comes from the sky, or goes there, is cut off where it leaves
/// the grid.
LightLine in_metres(const Scene& scene, const LightGrid& grid, const shader::LineEnds& line);

class LineTracer {
 public:
  virtual ~LineTracer() = default;

  /// Draws the segments `first` .. `first` + n between pivot patches of cut `c`, which has pairs,
  /// and tells which are free and join its sides: same_side is a leak. Those that join are counted.
  void between_pivots(size_t c, uint32_t first, uint32_t n, TracedLines& out);
  /// Traces the line through each place, both ways to the first surface; a try without direction
  /// stands for none. `round` keeps the random numbers of several calls apart.
  void through(size_t c, uint32_t round, std::span<const shader::LineTry> tries, TracedLines& out);

  /// Counts and directions start again at 0.
  virtual void clear() = 0;
  /// Lines that passed each voxel since clear(); in and outside the air.
  virtual void counts(std::vector<uint32_t>& count) = 0;
  /// Adds the sums of their unit directions, towards the camera, since it was last called, or
  /// clear(). At most LIGHT_MOST_SUMMED segments may be drawn in between.
  virtual void take_directions(std::vector<Vec3d>& sum) = 0;

 protected:
  /// Keeps a reference to the tables. Of `grid`, only the box counts.
  LineTracer(const Scene& scene, const LineTables& tables, const LightGrid& grid, uint64_t seed);

  /// Fills out.ends and out.fate, which have p.count elements, and counts the lines that join.
  virtual void trace_segments(const shader::LightParameters& p, TracedLines& out) = 0;
  virtual void trace_tries(const shader::LightParameters& p, std::span<const shader::LineTry> tries,
                           TracedLines& out) = 0;

  const LineTables& tables_;
  const shader::LightParameters common_;  ///< what all calls share

 private:
  shader::LightParameters parameters(const Streams& streams, size_t c, uint32_t n) const;
};

/// Lines that a voxel was passed by and the sum of their directions [1/LIGHT_DIRECTION_UNITS]. The
/// order of additions does not matter to integers, so results do not depend on threads.
class VoxelSums {
 public:
  explicit VoxelSums(size_t voxels) : sums_(voxels) {}
  /// From any thread.
  void add(size_t voxel, const shader::ivec3& direction) {
    Sum& sum = sums_[voxel];
    __atomic_fetch_add(&sum.count_x, packed(1, direction.x), __ATOMIC_RELAXED);
    __atomic_fetch_add(&sum.y_z, packed(direction.y, direction.z), __ATOMIC_RELAXED);
  }
  void clear();
  void counts(std::vector<uint32_t>& count) const;
  void take_directions(std::vector<Vec3d>& sum);

 private:
  // Two sums in one word, each of 31 bits and a sign: half of the atomic additions, which are what
  // the march costs. What the lower one borrows from the upper, low() tells.
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

}  // namespace tdpt
