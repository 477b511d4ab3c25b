// The kernels' functions on the CPU: light_lines.h, which states its requirements, over a C++
// tracer. `Tracer` has segment_blocked() and first_hit() as declared in traversal.h.
#pragma once
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
