// Bindings, records and parameters of the light grid's kernels. Canonical frame, unless a comment
// says voxels or cells.
#ifndef TDPT_SHADERS_SHARED_LIGHT_LAYOUT_H
#define TDPT_SHADERS_SHARED_LIGHT_LAYOUT_H

#include "shaders/shared/bvh.h"
#include "shaders/shared/coverage_layout.h"
#include "shaders/shared/tables.h"

#include "shaders/shared/language.h"

// Bindings: the scene as texels (0), the beginnings of its tables (1), storage buffers in this
// order, then the images.
#define LIGHT_TABLES(TABLE) \
  TABLES_OF_BVH(TABLE)      \
  TABLES_OF_COVERAGE(TABLE)
// BUFFER(binding, type, array): tables of the cuts.
#define LIGHT_CUTS(BUFFER)            \
  BUFFER(2, PivotArc, pivot_arcs)     \
  BUFFER(3, PatchPieces, patches)     \
  BUFFER(4, Piece, pieces)            \
  BUFFER(5, uint, first_cell)         \
  BUFFER(6, PatchCell, patch_cells)   \
  BUFFER(7, FaceNormal, face_normals) \
  BUFFER(8, uint, region_sides)
#define LIGHT_TRIES 9
#define LIGHT_LINES 10
#define LIGHT_FATES 11
#define LIGHT_LISTS 12
// 3D images of 32-bit integers.
#define LIGHT_COUNT 13
#define LIGHT_DIRECTION_X 14
#define LIGHT_DIRECTION_Y 15
#define LIGHT_DIRECTION_Z 16

#define LIGHT_GROUP 64  // invocations of a work group
// Units of the summed directions, and how many unit vectors may be summed without exceeding 31
// bits.
#define LIGHT_DIRECTION_UNITS 2048.0f
#define LIGHT_MOST_SUMMED 524288

SHARED_BEGIN

/// Where each table of the scene begins in its texels.
struct LightFirstTexels {
#define FIRST_OF_SCENE(type, name, array) uint name;
  LIGHT_TABLES(FIRST_OF_SCENE)
#undef FIRST_OF_SCENE
};

/// A pair of patches, the light side's first; also a slot of the alias table over the pairs of its
/// cut.
struct PivotArc {
  uint from_patch;
  uint to_patch;
  uint threshold;  ///< a coin below it keeps this slot, any other takes the alias
  uint alias;
};

/// The pieces of a patch, consecutive.
struct PatchPieces {
  uint first;
  uint count;
};

/// A triangle of a patch's surface within its cell; also a slot of the alias table over the patch's
/// pieces.
struct Piece {
  vec3 a;
  uint face;  ///< 2*triangle + side, side 1: the back
  vec3 b;
  uint threshold;
  vec3 c;
  uint alias;
};

/// The part of a patch on one face, and its cell. The parts on a face are sorted by level, then
/// cell. A region has the patches that lie on the same side of every cut; region_sides has two
/// words for each: bit c is set on the camera's side of cut c.
struct PatchCell {
  ivec3 cell;
  uint level_region;  ///< level << 24 | region
};

struct FaceNormal {
  vec3 normal;  ///< unit, of the triangle's front
  uint pad;
};

/// A point in the air and a unit direction: a line through it is to be traced.
struct LineTry {
  vec3 place;
  uint pad0;
  vec3 direction;
  uint pad1;
};

/// A line between two surfaces. If it joins the sides of the cut, `light` lies on the light's side.
struct LineEnds {
  vec3 light;
  uint light_face;
  vec3 camera;
  uint camera_face;
};

/// Lines that wait for a kernel: their number, and the work groups to dispatch for them.
struct LightList {
  uint groups_x;
  uint groups_y;
  uint groups_z;
  uint count;
};

// Outcome of a line.
#define FATE_NONE 0u       // blocked, or one of its ends is on no patch
#define FATE_SAME_SIDE 1u  // it does not join the sides, or one end sees mostly the other side
#define FATE_JOINS 2u

/// Push constants.
struct LightParameters {
  vec3 grid_corner;
  float voxels_per_unit;
  ivec3 dim;
  uint cut;
  vec3 cell_corner;
  float cells_per_unit;  ///< of level 0; level l has 4^l times as many
  word64 seed;
  uint stream;
  uint round;
  uint first;  ///< number of the first segment or try
  uint count;
  uint first_arc;
  uint arcs;
  uint levels;          ///< bit l: some patch has level l
  uint first_sky_face;  ///< this face and all later ones are whole patches of the sky
  uint pad0;
  uint pad1;
};

SHARED_END

#ifdef __cplusplus
namespace tdpt::shader {
static_assert(sizeof(PivotArc) == 16 && sizeof(PatchPieces) == 8 && sizeof(Piece) == 48);
static_assert(sizeof(PatchCell) == 16 && sizeof(FaceNormal) == 16);
static_assert(sizeof(LineTry) == 32 && sizeof(LineEnds) == 32 && sizeof(LightParameters) == 96);
}  // namespace tdpt::shader
#endif

#include "shaders/shared/language_end.h"

#endif
