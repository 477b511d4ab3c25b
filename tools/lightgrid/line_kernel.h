// The kernels' functions on the CPU: light_lines.h, which states its requirements, over a C++
// tracer. `Tracer` has segment_blocked() and first_hit() as declared in traversal.h.
#pragma once
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "shaders/shared/bvh.h"
#include "shaders/shared/grid_walk.h"
#include "shaders/shared/light_layout.h"
#include "shaders/shared/rng.h"
#include "shaders/shared/warp.h"
#include "tools/lightgrid/line_tracer.h"

namespace tdpt::shader {

template <class Tracer>
class LineKernel {
 public:
  LineKernel(const Tracer& tracer, const LineTables& t, const LightParameters& p, VoxelSums& sums)
      : tracer_(tracer),
        light(p),
#define REFER(binding, type, array) array(t.array.data()),
        LIGHT_CUTS(REFER)
#undef REFER
            sums_(sums) {
  }

  /// Segment p.first + i: light_segments.comp, light_votes.comp and light_march.comp in sequence.
  LineFate segment(uint i, LineEnds& line) {
    const uint number = light.first + i;
    line = draw_line(number);
    if (!line_is_free(line, number)) return LineFate::none;
    if (!ends_see_their_sides(line, number)) return LineFate::same_side;
    march(line);
    return LineFate::joins;
  }
  /// light_through.comp and light_votes.comp in sequence.
  LineFate try_through(uint i, const LineTry& through, LineEnds& line) {
    const uint number = light.first + i;
    const uint fate = line_through(through, number, line);
    if (fate != FATE_JOINS) return LineFate{fate};
    return ends_see_their_sides(line, number) ? LineFate::joins : LineFate::same_side;
  }

#include "shaders/shared/light_lines.h"

 private:
  bool segment_blocked(const vec3& a, const vec3& b, uint coin) const {
    return tracer_.segment_blocked(a, b, coin);
  }
  bool first_hit(const vec3& origin, const vec3& direction, uint coin, SurfaceHit& hit) const {
    return tracer_.first_hit(origin, direction, coin, hit);
  }
  void count_voxel(const ivec3& at, const ivec3& direction) {
    const auto x = static_cast<size_t>(at.x), y = static_cast<size_t>(at.y),
               z = static_cast<size_t>(at.z), nx = static_cast<size_t>(light.dim.x),
               ny = static_cast<size_t>(light.dim.y);
    sums_.add(x + nx * (y + ny * z), direction);
  }

  const Tracer& tracer_;
  const LightParameters light;
#define REFERS(binding, type, array) const type* array;
  LIGHT_CUTS(REFERS)
#undef REFERS
  VoxelSums& sums_;
};

}  // namespace tdpt::shader

namespace tdpt {

/// A line tracer that runs the kernel on all cores with any ray tracer.
template <class Rays>
class CpuLines : public LineTracer {
 public:
  CpuLines(const Scene& scene, const LineTables& tables, const LightGrid& grid, uint64_t seed)
      : LineTracer(scene, tables, grid, seed), rays_(scene), sums_(grid.count.size()) {}

  void clear() override { sums_.clear(); }
  void counts(std::vector<uint32_t>& count) override { sums_.counts(count); }
  void take_directions(std::vector<Vec3d>& sum) override { sums_.take_directions(sum); }

 protected:
  void trace_segments(const shader::LightParameters& p, TracedLines& out) override {
    parallel(p, [&](auto& kernel, uint32_t i) { out.fate[i] = kernel.segment(i, out.ends[i]); });
  }
  void trace_tries(const shader::LightParameters& p, std::span<const shader::LineTry> tries,
                   TracedLines& out) override {
    parallel(p, [&](auto& kernel, uint32_t i) {
      out.fate[i] = kernel.try_through(i, tries[i], out.ends[i]);
    });
  }

 private:
  template <class Trace>
  void parallel(const shader::LightParameters& p, const Trace& trace) {
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, p.count, 256), [&](const auto& range) {
      shader::LineKernel<Rays> kernel(rays_, tables_, p, sums_);
      for (uint32_t i = range.begin(); i < range.end(); ++i) trace(kernel, i);
    });
  }

  const Rays rays_;
  VoxelSums sums_;
};

}  // namespace tdpt
