// Everything that the light grid's kernels share: constants, bindings, tables and lists.
#include "shaders/shared/grid_walk.h"
#include "shaders/shared/light_layout.h"
#include "shaders/shared/rng.h"
#include "shaders/shared/texels.h"
#include "shaders/shared/bvh.h"
#include "shaders/shared/warp.h"

// Whether some surface is not opaque, and whether a texture says where. Kernels are specialised for
// the scene: software devices run both sides of a branch that any lane may take, and every device
// needs registers for both.
layout(constant_id = 0) const bool scene_has_coverage = true;
layout(constant_id = 1) const bool coverage_has_textures = true;
// The light grid has no panes of glass: they are non-opaque surfaces like others.
const bool scene_has_panes = false;
float opacity_at(uint triangle, vec3 w) { return 1.0; }

// Bindings of all light grid kernels, under the names that shaders/shared/ expects.
layout(local_size_x = LIGHT_GROUP) in;

layout(binding = 0) uniform usamplerBuffer scene_texels;
layout(std140, binding = 1) uniform Firsts { LightFirstTexels first_texels; };
#define READ(type, name, array)                              \
  type load_##name(uint i) {                                 \
    return entry_##type(scene_texels, first_texels.name, i); \
  }
LIGHT_TABLES(READ)
#define BIND(number, type, array) \
  layout(std430, binding = number) readonly buffer Read_##array { type array[]; };
LIGHT_CUTS(BIND)

layout(std430, binding = LIGHT_TRIES) readonly buffer Tries { LineTry tries[]; };
layout(std430, binding = LIGHT_LINES) buffer Lines { LineEnds lines[]; };
layout(std430, binding = LIGHT_FATES) buffer Fates { uint fates[]; };
layout(std430, binding = LIGHT_LISTS) buffer Lists {
  LightList to_vote;
  LightList to_march;
  uint listed[];  // the numbers in to_vote, then those in to_march; at most light.count each
};
layout(r32ui, binding = LIGHT_COUNT) uniform uimage3D voxel_count;
layout(r32i, binding = LIGHT_DIRECTION_X) uniform iimage3D voxel_direction_x;
layout(r32i, binding = LIGHT_DIRECTION_Y) uniform iimage3D voxel_direction_y;
layout(r32i, binding = LIGHT_DIRECTION_Z) uniform iimage3D voxel_direction_z;

layout(push_constant) uniform Parameters { LightParameters light; };

// Appends a line to the list of a later kernel and raises the number of that kernel's work groups.
void list_to_vote(uint i) {
  uint n = atomicAdd(to_vote.count, 1u);
  atomicMax(to_vote.groups_x, n / LIGHT_GROUP + 1u);
  listed[n] = i;
}
void list_to_march(uint i) {
  uint n = atomicAdd(to_march.count, 1u);
  atomicMax(to_march.groups_x, n / LIGHT_GROUP + 1u);
  listed[light.count + n] = i;
}

void count_voxel(ivec3 at, ivec3 direction) {
  imageAtomicAdd(voxel_count, at, 1u);
  imageAtomicAdd(voxel_direction_x, at, direction.x);
  imageAtomicAdd(voxel_direction_y, at, direction.y);
  imageAtomicAdd(voxel_direction_z, at, direction.z);
}

#include "shaders/shared/coverage.h"

#include "shaders/shared/traversal.h"

#include "shaders/shared/light_lines.h"
