// Test only: given segments, and not drawn ones, through the functions of shaders/shared/.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "shaders/shared/bvh.h"
#include "shaders/shared/grid_walk.h"
#include "shaders/shared/light_layout.h"
#include "shaders/shared/tables.h"

layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer BvhNodes { BvhNode bvh_nodes[]; };
layout(std430, binding = 1) readonly buffer BvhTriangles { BvhTriangle bvh_triangles[]; };
layout(std430, binding = 2) readonly buffer Segments { LineEnds segments[]; };
layout(std430, binding = 3) buffer Blocked { uint blocked[]; };
layout(std430, binding = 4) buffer Hits { SurfaceHit hits[]; };
layout(r32ui, binding = 5) uniform uimage3D voxel_count;
layout(push_constant) uniform Parameters { LightParameters light; };

bool surface_stops(uint triangle, float b1, float b2, uint coin, vec3 w) { return true; }

TABLES_OF_BVH(LOADS)

#include "shaders/shared/traversal.h"

vec3 in_voxels(vec3 place) {
  vec3 p = (place - light.grid_corner) * light.voxels_per_unit;
  return p;
}

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= light.count) return;
  vec3 a = segments[i].light;
  vec3 b = segments[i].camera;
  blocked[i] = segment_blocked(a, b, i) ? 1u : 0u;
  SurfaceHit hit;
  vec3 w = b - a;
  bool found = first_hit(a, w, i, hit);
  if (!found) hit.triangle = 0xffffffffu;
  hits[i] = hit;
  VoxelWalk walk = voxel_walk(in_voxels(a), in_voxels(b), light.dim);
  do {
    imageAtomicAdd(voxel_count, walk.at, 1u);
  } while (next_voxel(walk));
}
