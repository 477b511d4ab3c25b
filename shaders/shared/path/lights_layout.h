// Tables of the lights, which tools/tdpt-render/device/tables.h fills, and points on lights.
// Canonical frame; radiance is divided by the power of two that the upload chose.
#ifndef TDPT_SHADERS_SHARED_PATH_LIGHTS_LAYOUT_H
#define TDPT_SHADERS_SHARED_PATH_LIGHTS_LAYOUT_H

#include "shaders/shared/path/point.h"
#include "shaders/shared/path/portal_layout.h"
#include "shaders/shared/records.h"
#include "shaders/shared/rng.h"
#include "shaders/shared/warp.h"

#include "shaders/shared/language.h"

SHARED_BEGIN

/// A point that light leaves from: tdpt::Lights::Point.
struct LightPlace {
  uint source;    ///< SOURCE_*; SOURCE_NONE: there is no such point
  uint triangle;  ///< kNoTriangle off surfaces
  float b1;
  float b2;
  vec3 position;  ///< at infinity: the unit direction in which its light travels
  vec3 normal;    ///< unit, on the side that light leaves from; 0 off surfaces
  InSky in_sky;
  float pdf;  ///< per canonical area; for the sky per solid angle; for others the light's
              ///< probability
};

/// An emitting triangle.
#define TEXELS_OF_Emitter(VEC, WORDS, PART) \
  VEC(p0, uint, triangle)                   \
  VEC(e1, float, pdf_A)                     \
  /* source: SOURCE_FRONT or SOURCE_BOTH */ \
  VEC(e2, uint, source)                     \
  VEC(normal, uint, pad)
RECORD(Emitter)

const uint kNoProfile = 0xFFFFFFFFu;

/// A light without extent [lamp.h]. Versine: 1 - cos, which a float can hold for narrow cones. If
/// there is a profile, its rings give the density; cone, extent and pdf_w describe its whole reach.
#define TEXELS_OF_Lamp(VEC, WORDS, PART)                                                    \
  /* parallel: 1: infinitely far */                                                         \
  VEC(position, uint, parallel)                                                             \
  VEC(direction, float, pdf_1)                                                              \
  /* intensity: irradiance for parallel light */                                            \
  /* extent: of the emitted directions [sr]; parallel: of the disc perpendicular to them */ \
  VEC(intensity, float, extent)                                                             \
  /* cone: versine of the half angle of emission; 2: all directions */                      \
  /* edge: versine from which it is dark; above 2: nowhere */                               \
  /* per_edge: slope of the falloff per versine, from the edge inwards, before squaring */  \
  /* pdf_w: 1/extent */                                                                     \
  WORDS(float, cone, float, edge, float, per_edge, float, pdf_w)                            \
  /* across: unit, where horizontal angles of its profile are 0 */                          \
  /* profile: index in light_words[], or kNoProfile: even intensity except for the edge */  \
  VEC(across, uint, profile)
RECORD(Lamp)

#define TEXELS_OF_SkySun(VEC, WORDS, PART)                                                       \
  /* versine: of its half angle */                                                               \
  VEC(towards, float, versine)                                                                   \
  /* drawn: versine of the sampled disc, a little smaller, so that lookups find the sun again */ \
  VEC(radiance, float, drawn)                                                                    \
  /* plain_w: density of its directions when sampling by luminance */                            \
  /* start_w: the same when sampling the start of walks */                                       \
  WORDS(float, plain_w, float, start_w, uint, pad0, uint, pad1)
RECORD(SkySun)

/// A distribution over the sky: entries of light_words[] [sky.h], blocks of fine cells row by row,
/// then the suns. Without a map the first entry is all of the sky.
struct SkyTable {
  uint begin;
  uint guide;
  uint entries;
  uint blocks;   ///< entries that are not suns
  uint columns;  ///< of blocks
  uint block;    ///< fine cells per block along each axis
  uint split_x;  ///< fine cells per cell
  uint split_y;
};

#define TEXELS_OF_SkyTexel(VEC, WORDS, PART) WORDS(float, r, float, g, float, b, float, pad)
RECORD(SkyTexel)

/// A direction of the sky and its place in the map: between the centres of columns `column` and the
/// next, of rows `row` - 1 and `row` (tdpt::Sky::Cell).
struct SkyPlace {
  vec3 towards;
  uint column;
  uint row;
  float across;
  float down;
};

/// An emitting rectangle: tdpt::RectLight.
#define TEXELS_OF_RectLight(VEC, WORDS, PART)                                                     \
  VEC(corner, float, length_x)                                                                    \
  VEC(x, float, length_y)                                                                         \
  VEC(y, float, least_height)                                                                     \
  /* weight: selection weight, per area */                                                        \
  VEC(normal, float, weight)                                                                      \
  /* source: SOURCE_FRONT or SOURCE_BOTH */                                                       \
  /* triangle0: above the diagonal (x, then y) */                                                 \
  /* triangle1: below it */                                                                       \
  /* corners: two bits each: the rectangle's corners that are b1's and b2's of triangle0, then */ \
  /* of triangle1 */                                                                              \
  WORDS(uint, source, uint, triangle0, uint, triangle1, uint, corners)
RECORD(RectLight)

/// The rectangle of a portal in front of the sky: tdpt::WindowSky::Window, in its frame's axes.
#define TEXELS_OF_SkyWindow(VEC, WORDS, PART)       \
  WORDS(float, x0, float, x1, float, y0, float, y1) \
  WORDS(float, z, uint, frame, uint, pad0, uint, pad1)
RECORD(SkyWindow)

/// Summed-area table of the sky for windows of one direction: tdpt::WindowFrame. Whole numbers
/// modulo 2^32, so that differences are exact.
#define TEXELS_OF_WindowFrame(VEC, WORDS, PART)                                                  \
  /* cells: along either axis */                                                                 \
  VEC(x, uint, cells)                                                                            \
  /* sums: index in light_words[]: [i (cells + 1) + j], sum of cells below column i and row j */ \
  VEC(y, uint, sums)                                                                             \
  /* unit: luminance x solid angle of one unit of the sums */                                    \
  VEC(z, float, unit)
RECORD(WindowFrame)

/// All single values. Members that begin with "first_" are indices in light_words[].
struct LightSettings {
  SkyTable plain;  ///< distribution by luminance
  SkyTable start;  ///< distribution for the start of light walks: the same unless scene_prefers
  uint first_begin;
  uint first_guide;
  uint entries;   ///< emitters, lamps, the sky
  uint emitters;  ///< number of emitters
  uint lamps;
  uint suns;
  uint rect_lights;
  uint pad0;
  uint first_pdf_A;  ///< floats, by triangle of the scene
  uint first_row;    ///< of the sky's map, SkyRow
  uint first_cell;   ///< shares of a block's cells: eight words a block, two bytes each
  uint first_view;   ///< masks of windows
  vec3 sky_colour;   ///< if there is no map
  float colour_w;    ///< its density of directions by luminance
  uint spread_low;   ///< 2^64 over the number of words that choose the sky
  uint spread_high;
  float sky_pdf_1;
  float sky_extent;  ///< of the disc that covers the scene
  float sky_cos;     ///< of the map's rotation
  float sky_sin;
  uint sky_width;
  uint sky_height;
  vec3 view_low;
  float view_scale;  ///< cells per unit
  uint view_x;       ///< cells
  uint view_y;
  uint view_z;
  uint view_beyond;    ///< mask outside the grid
  float radius;        ///< of a ball around the origin that holds all triangles
  float surfaces;      ///< probability of emitters
  float per_surfaces;  ///< 1 over the number of words that choose them
  uint pad1;
};

#ifdef __cplusplus
RECORD_OF_REALS(Lamp)
static_assert(sizeof(Emitter) == 64 && sizeof(Lamp) == 80 && sizeof(SkySun) == 48);
static_assert(sizeof(SkyTexel) == 16 && sizeof(RectLight) == 80 && sizeof(SkyWindow) == 32);
static_assert(sizeof(WindowFrame) == 48 && sizeof(LightSettings) == 208);
#endif

SHARED_END

#include "shaders/shared/language_end.h"

#endif
