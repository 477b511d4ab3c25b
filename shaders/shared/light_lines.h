// Draws lines of light between the two sides of a cut (section 4.2): between pivot patches, or
// through a point in the air.
//
// Include it in a scope that has the tables of light_layout.h under their names (pivot_arcs[],
// patches[], pieces[], first_cell[], patch_cells[], face_normals[], region_sides[]), their
// parameters `light`, segment_blocked() and first_hit() of traversal.h or replacements, and
// count_voxel(): a GLSL file after its buffers, or the body of a C++ struct.

#include "shaders/shared/bvh.h"
#include "shaders/shared/grid_walk.h"
#include "shaders/shared/light_layout.h"
#include "shaders/shared/rng.h"
#include "shaders/shared/warp.h"

#include "shaders/shared/language.h"

// Rays around each end of a line that vote on which side of the cut it lies.
#define LINE_VOTES 16
#define LINE_LEAD 4  // a lead of so many votes decides early
#define LINE_FEWEST_VOTES 4
// Offset from the surface: 16 units in the last place of coordinates up to 1.
#define LINE_STEP 9.5367431640625e-7f
// Random streams besides that of the line itself.
#define LINE_VOTES_OF_LIGHT 0x100u
#define LINE_VOTES_OF_CAMERA 0x200u
#define LINE_COIN 0x300u

/// Unit normal on the side that the face number names.
SHARED vec3 normal_of_face(uint face) {
  vec3 n = face_normals[face >> 1].normal;
  return (face & 1u) != 0u ? -n : n;
}

// Offset ray origin. On the dome of a sky, far outside the scene, the offset is a fraction of the
// distance: nothing lies there.
SHARED vec3 stepped_off(vec3 place, vec3 along) {
  float far = max(max(abs(place.x), abs(place.y)), abs(place.z));
  float step = far > 2.0f ? far * 0.0078125f : LINE_STEP;
  vec3 p = place + along * step;
  return p;
}

SHARED Rng numbers_of_line(uint stream, uint number) MEMBER_CONST {
  return rng_of(light.seed, word64_of(0u, stream), word64_of(0u, number),
                word64_of(0u, light.round));
}

SHARED vec3 place_on_patch(uint patch_index, INOUT(Rng) random, OUT(uint) face) {
  uint first = patches[patch_index].first;
  uint pick = random_word(random);
  uint coin = random_word(random);
  uint slot = first + below(pick, patches[patch_index].count);
  if (coin >= pieces[slot].threshold) slot = pieces[slot].alias;
  face = pieces[slot].face;
  float u = unit_float(random_word(random));
  float v = unit_float(random_word(random));
  float b1;
  float b2;
  uniform_triangle(u, v, b1, b2);
  vec3 a = pieces[slot].a;
  vec3 place = a + (pieces[slot].b - a) * b1 + (pieces[slot].c - a) * b2;
  return place;
}

/// Draws a pair of the cut in proportion to its capacity and, on each of its two patches, a point
/// uniform by area.
SHARED LineEnds draw_line(uint number) {
  Rng random = numbers_of_line(light.stream, number);
  uint pick = random_word(random);
  uint coin = random_word(random);
  uint slot = light.first_arc + below(pick, light.arcs);
  if (coin >= pivot_arcs[slot].threshold) slot = pivot_arcs[slot].alias;
  LineEnds line;
  line.light = place_on_patch(pivot_arcs[slot].from_patch, random, line.light_face);
  line.camera = place_on_patch(pivot_arcs[slot].to_patch, random, line.camera_face);
  return line;
}

/// Random number by which the rays of a line decide whether non-opaque surfaces stop them.
SHARED uint coin_of_line(uint number) {
  Rng random = numbers_of_line(light.stream + LINE_COIN, number);
  return random_word(random);
}

/// Whether both end faces look along the line and nothing blocks it.
SHARED bool line_is_free(LineEnds line, uint number) {
  vec3 w = line.camera - line.light;
  vec3 n = normal_of_face(line.light_face);
  vec3 m = normal_of_face(line.camera_face);
  if (dot(w, n) <= 0.0f || dot(w, m) >= 0.0f) return false;
  vec3 light_end = stepped_off(line.light, n);
  vec3 camera_end = stepped_off(line.camera, m);
  // Start at the end whose coordinates are exact.
  bool from_sky = line.light_face >= light.first_sky_face;
  return !segment_blocked(from_sky ? camera_end : light_end, from_sky ? light_end : camera_end,
                          coin_of_line(number));
}

// A value out of range, or NaN (the corner of cells without size), maps to a cell of no patch.
SHARED int cell_coordinate(float x) {
  return x >= -2e9f ? int(floor(min(x, 2e9f))) : -2000000000;
}

/// Negative if `p` comes before the cell (level, cell), 0 if it is that cell, positive if after it.
SHARED int order_of_cells(PatchCell p, uint level, ivec3 cell) {
  int by_level = int(p.level_region >> 24) - int(level);
  if (by_level != 0) return by_level;
  if (p.cell.x != cell.x) return p.cell.x < cell.x ? -1 : 1;
  if (p.cell.y != cell.y) return p.cell.y < cell.y ? -1 : 1;
  if (p.cell.z != cell.z) return p.cell.z < cell.z ? -1 : 1;
  return 0;
}

/// Index in patch_cells of the finest patch that contains `place` on `face`; false if there is none
/// (no walk has reached that surface).
SHARED bool cell_at(uint face, vec3 place, OUT(uint) index) {
  uint begin = first_cell[face];
  uint end = first_cell[face + 1u];
  index = begin;
  if (begin == end) return false;
  if (face >= light.first_sky_face) return true;
  vec3 from_corner = place - light.cell_corner;
  for (int level = 15; level >= 0; --level) {
    if ((light.levels & (1u << uint(level))) == 0u) continue;
    // 4^level, written as a float's exponent.
    float scale = light.cells_per_unit * uintBitsToFloat(uint(127 + 2 * level) << 23);
    vec3 q = from_corner * scale;
    ivec3 cell = ivec3(cell_coordinate(q.x), cell_coordinate(q.y), cell_coordinate(q.z));
    uint low = begin;
    uint high = end;
    while (low < high) {
      uint middle = (low + high) >> 1;
      if (order_of_cells(patch_cells[middle], uint(level), cell) < 0) {
        low = middle + 1u;
      } else {
        high = middle;
      }
    }
    if (low < end && order_of_cells(patch_cells[low], uint(level), cell) == 0) {
      index = low;
      return true;
    }
  }
  return false;
}

/// The region of that patch.
SHARED bool region_at(uint face, vec3 place, OUT(uint) region) {
  uint index;
  bool found = cell_at(face, place, index);
  region = found ? patch_cells[index].level_region & 0xffffffu : 0u;
  return found;
}

/// 0: the light's side of the cut, 1: the camera's.
SHARED uint side_of_region(uint region) {
  return (region_sides[2u * region + (light.cut >> 5)] >> (light.cut & 31u)) & 1u;
}

/// Whether cosine-distributed rays from an end of a line hit mostly patches of its own side.
SHARED bool sees_its_side(vec3 end, uint face, uint side, uint stream, uint number) {
  Rng random = numbers_of_line(stream, number);
  vec3 normal = normal_of_face(face);
  vec3 origin = stepped_off(end, normal);
  int same = 0;
  int other = 0;
  for (int i = 0; i < LINE_VOTES; ++i) {
    uint coin = random_word(random);
    float u = unit_float(coin);
    float v = unit_float(random_word(random));
    vec3 w = cosine_hemisphere(normal, u, v);
    SurfaceHit hit;
    if (!first_hit(origin, w, coin, hit)) continue;
    uint back = dot(face_normals[hit.triangle].normal, w) > 0.0f ? 1u : 0u;
    vec3 place = origin + w * hit.t;
    uint region;
    if (!region_at(2u * hit.triangle + back, place, region)) continue;
    if (side_of_region(region) == side) {
      ++same;
    } else {
      ++other;
    }
    if (abs(same - other) >= LINE_LEAD || 2 * same > LINE_VOTES || 2 * other > LINE_VOTES) break;
  }
  return same > other && same + other >= LINE_FEWEST_VOTES;
}

/// Whether each end of a line sees mostly its own side of the cut. A line that fails is a leak
/// through a patch that straddles the opening.
SHARED bool ends_see_their_sides(LineEnds line, uint number) {
  return sees_its_side(line.light, line.light_face, 0u, light.stream + LINE_VOTES_OF_LIGHT,
                       number) &&
         sees_its_side(line.camera, line.camera_face, 1u, light.stream + LINE_VOTES_OF_CAMERA,
                       number);
}

/// First surface from `place` along `w`: its point, its face, and its side of the cut.
SHARED bool end_along(vec3 place, vec3 w, uint coin, OUT(vec3) end, OUT(uint) face,
                      OUT(uint) side) {
  end = place;
  face = 0u;
  side = 0u;
  vec3 origin = stepped_off(place, w);
  SurfaceHit hit;
  if (!first_hit(origin, w, coin, hit)) return false;
  uint back = dot(face_normals[hit.triangle].normal, w) > 0.0f ? 1u : 0u;
  face = 2u * hit.triangle + back;
  vec3 met = origin + w * hit.t;
  end = met;
  uint region;
  if (!region_at(face, end, region)) return false;
  side = side_of_region(region);
  return true;
}

/// The line through a point, traced both ways to the first surface. FATE_JOINS: its ends lie on
/// different sides of the cut, and `line` is oriented from light to camera.
SHARED uint line_through(LineTry through, uint number, OUT(LineEnds) line) {
  // A direction of zero marks an unused entry.
  line.light = through.place;
  line.camera = through.place;
  line.light_face = 0u;
  line.camera_face = 0u;
  float square = dot(through.direction, through.direction);
  if (square == 0.0f) return FATE_NONE;
  uint coin = coin_of_line(number);
  vec3 ahead;
  uint ahead_face;
  uint ahead_side;
  vec3 behind;
  uint behind_face;
  uint behind_side;
  if (!end_along(through.place, through.direction, coin, ahead, ahead_face, ahead_side) ||
      !end_along(through.place, -through.direction, coin, behind, behind_face, behind_side))
    return FATE_NONE;
  if (ahead == behind) return FATE_NONE;
  bool along = behind_side == 0u;
  line.light = along ? behind : ahead;
  line.light_face = along ? behind_face : ahead_face;
  line.camera = along ? ahead : behind;
  line.camera_face = along ? ahead_face : behind_face;
  return ahead_side == behind_side ? FATE_SAME_SIDE : FATE_JOINS;
}

SHARED vec3 in_voxels(vec3 place) {
  vec3 p = (place - light.grid_corner) * light.voxels_per_unit;
  return p;
}

SHARED ivec3 direction_in_units(vec3 w) {
  float square = dot(w, w);
  if (square < 1e-30f) return ivec3(0, 0, 0);
  float scale = inverse_root(square) * LIGHT_DIRECTION_UNITS;
  vec3 v = w * scale + vec3(0.5f, 0.5f, 0.5f);
  return ivec3(int(floor(v.x)), int(floor(v.y)), int(floor(v.z)));
}

/// Clips [enter, leave], parameters along a + t way in voxels, to the grid's range on one axis.
SHARED void within_axis(float a, float way, int dim, INOUT(float) enter, INOUT(float) leave) {
  float per_way = reciprocal(either_sign(way) * max(abs(way), 1e-18f));
  float t0 = -a * per_way;
  float t1 = (float(dim) - a) * per_way;
  enter = max(enter, min(t0, t1));
  leave = min(leave, max(t0, t1));
}

/// Clips a line to the sky, in voxels, to the grid; false if it misses the grid.
SHARED bool within_grid(INOUT(vec3) a, INOUT(vec3) b) {
  vec3 way = b - a;
  float enter = 0.0f;
  float leave = 1.0f;
  within_axis(a.x, way.x, light.dim.x, enter, leave);
  within_axis(a.y, way.y, light.dim.y, enter, leave);
  within_axis(a.z, way.z, light.dim.z, enter, leave);
  if (!(enter < leave)) return false;
  vec3 first = a + way * enter;
  vec3 last = leave < 1.0f ? a + way * leave : b;
  a = first;
  b = last;
  return true;
}

/// Counts the line in every voxel that it passes through.
SHARED void march(LineEnds line) {
  vec3 w = line.camera - line.light;
  ivec3 direction = direction_in_units(w);
  vec3 from = in_voxels(line.light);
  vec3 to = in_voxels(line.camera);
  if (max(line.light_face, line.camera_face) >= light.first_sky_face && !within_grid(from, to))
    return;
  OF_FLOAT(VoxelWalk) walk = voxel_walk(from, to, light.dim);
  do {
    count_voxel(walk.at, direction);
  } while (next_voxel(walk));
}

#include "shaders/shared/language_end.h"
