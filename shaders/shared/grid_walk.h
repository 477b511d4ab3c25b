// Lists the voxels that a segment passes through: 3D DDA after Amanatides and Woo, with guaranteed
// termination. It takes exactly the steps that lead from the voxel of one end to that of the other.
// The axis with the nearest wall steps first; an axis that has arrived steps no more. Rounding may
// choose another way round a corner but cannot run past the end.
//
//   VoxelWalk w = voxel_walk(a, b, dim);
//   do visit(w.at); while (next_voxel(w));
#ifndef TDPT_SHADERS_SHARED_GRID_WALK_H
#define TDPT_SHADERS_SHARED_GRID_WALK_H

#include "shaders/shared/real.h"

#include "shaders/shared/language.h"

SHARED_BEGIN

GENERIC_STRUCT VoxelWalk {
  ivec3 at;    ///< voxel
  ivec3 step;  ///< +1 or -1
  ivec3 left;  ///< steps left along each axis
  VEC3 next;   ///< parameter of the next wall: 0 at a, 1 at b
  VEC3 delta;  ///< distance between walls, in that parameter
};

GENERIC int voxel_of(REAL x, int dim) {
  REAL f = min(max(floor(x), REAL(0)), REAL(dim - 1));
  return int(f);
}

GENERIC void walk_along(REAL a, REAL b, int dim, OUT(int) at, OUT(int) step, OUT(int) left,
                        OUT(REAL) next, OUT(REAL) delta) {
  at = voxel_of(a, dim);
  int end = voxel_of(b, dim);
  step = end < at ? -1 : 1;
  left = abs(end - at);
  // If a step is left, |d| is at least one unit in the last place of the voxel's number; otherwise
  // the value does not matter.
  REAL d = b - a;
  REAL inverse = reciprocal(max(abs(d), REAL(1e-18f)));
  REAL wall = REAL(step > 0 ? at + 1 : at);
  REAL distance = max(step > 0 ? wall - a : a - wall, REAL(0));
  delta = inverse;
  REAL first = distance * inverse;
  next = first;
}

/// Starts a walk along the segment a-b, in units of voxels from the grid's corner. Parts outside
/// the grid are clamped to its border.
GENERIC OF_REAL(VoxelWalk) voxel_walk(VEC3 a, VEC3 b, ivec3 dim) {
  OF_REAL(VoxelWalk) w;
  walk_along(a.x, b.x, dim.x, w.at.x, w.step.x, w.left.x, w.next.x, w.delta.x);
  walk_along(a.y, b.y, dim.y, w.at.y, w.step.y, w.left.y, w.next.y, w.delta.y);
  walk_along(a.z, b.z, dim.z, w.at.z, w.step.z, w.left.z, w.next.z, w.delta.z);
  return w;
}

/// Parameter of the next wall along each axis; huge on an axis that has arrived.
GENERIC VEC3 walls_ahead(OF_REAL(VoxelWalk) w) {
  return VEC3(w.left.x > 0 ? w.next.x : REAL(3e38f), w.left.y > 0 ? w.next.y : REAL(3e38f),
              w.left.z > 0 ? w.next.z : REAL(3e38f));
}

/// Parameter at which the segment leaves the voxel; 1 in the last one.
GENERIC REAL leaves_voxel(OF_REAL(VoxelWalk) w) {
  VEC3 wall = walls_ahead(w);
  return min(min(min(wall.x, wall.y), wall.z), REAL(1));
}

/// Moves to the next voxel; false at the end.
GENERIC bool next_voxel(INOUT(OF_REAL(VoxelWalk)) w) {
  VEC3 wall = walls_ahead(w);
  if (w.left.x + w.left.y + w.left.z == 0) return false;
  bool x = wall.x <= wall.y && wall.x <= wall.z;
  bool y = !x && wall.y <= wall.z;
  ivec3 along = ivec3(x ? 1 : 0, y ? 1 : 0, x || y ? 0 : 1);
  w.at = w.at + w.step * along;
  w.left = w.left - along;
  VEC3 way = w.delta * VEC3(along);
  VEC3 next = w.next + way;
  w.next = next;
  return true;
}

SHARED_END

#include "shaders/shared/language_end.h"

#endif
