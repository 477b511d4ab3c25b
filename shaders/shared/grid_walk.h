// Which voxels a segment passes: 3D DDA after Amanatides and Woo, made to end. It takes exactly the
// steps that lead from the voxel of one end to that of the other, the axis with the next wall
// first, and none along an axis that has arrived: rounding may choose another way round a corner
// but cannot run past the end.
//
//   VoxelWalk w = voxel_walk(a, b, dim);
//   do visit(w.at); while (next_voxel(w));
#ifndef TDPT_SHADERS_SHARED_GRID_WALK_H
#define TDPT_SHADERS_SHARED_GRID_WALK_H

#include "shaders/shared/real.h"

#include "shaders/shared/language.h"

SHARED_BEGIN

struct VoxelWalk {
  ivec3 at;    ///< voxel
  ivec3 step;  ///< +1 or -1
  ivec3 left;  ///< steps that are left along each axis
  vec3 next;   ///< parameter of the next wall: 0 at a, 1 at b
  vec3 delta;  ///< from wall to wall
};

SHARED int voxel_of(float x, int dim) {
  float f = min(max(floor(x), 0.0f), float(dim - 1));
  return int(f);
}

SHARED void walk_along(float a, float b, int dim, OUT(int) at, OUT(int) step, OUT(int) left,
                       OUT(float) next, OUT(float) delta) {
  at = voxel_of(a, dim);
  int end = voxel_of(b, dim);
  step = end < at ? -1 : 1;
  left = abs(end - at);
  // Where there is a step to take, |d| is at least a unit in the last place of the voxel's number;
  // elsewhere any number does.
  EXACT float d = b - a;
  EXACT float inverse = reciprocal(max(abs(d), 1e-18f));
  EXACT float wall = float(step > 0 ? at + 1 : at);
  EXACT float distance = max(step > 0 ? wall - a : a - wall, 0.0f);
  delta = inverse;
  EXACT float first = distance * inverse;
  next = first;
}

/// Of the segment a-b in units of voxels from the grid's corner. What lies outside the grid is
/// drawn to its border.
SHARED VoxelWalk voxel_walk(vec3 a, vec3 b, ivec3 dim) {
  VoxelWalk w;
  walk_along(a.x, b.x, dim.x, w.at.x, w.step.x, w.left.x, w.next.x, w.delta.x);
  walk_along(a.y, b.y, dim.y, w.at.y, w.step.y, w.left.y, w.next.y, w.delta.y);
  walk_along(a.z, b.z, dim.z, w.at.z, w.step.z, w.left.z, w.next.z, w.delta.z);
  return w;
}

/// Goes on to the next voxel; false at the end.
SHARED bool next_voxel(INOUT(VoxelWalk) w) {
  float x = w.left.x > 0 ? w.next.x : 3e38f;
  float y = w.left.y > 0 ? w.next.y : 3e38f;
  float z = w.left.z > 0 ? w.next.z : 3e38f;
  if (w.left.x + w.left.y + w.left.z == 0) return false;
  if (x <= y && x <= z) {
    w.at.x += w.step.x;
    w.left.x -= 1;
    EXACT float n = w.next.x + w.delta.x;
    w.next.x = n;
  } else if (y <= z) {
    w.at.y += w.step.y;
    w.left.y -= 1;
    EXACT float n = w.next.y + w.delta.y;
    w.next.y = n;
  } else {
    w.at.z += w.step.z;
    w.left.z -= 1;
    EXACT float n = w.next.z + w.delta.z;
    w.next.z = n;
  }
  return true;
}

SHARED_END

#include "shaders/shared/language_end.h"

#endif
