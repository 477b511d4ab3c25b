// Layout of image texels and of the coverage (alpha) of triangles that are not opaque: std430 in
// GLSL, the same bytes in C++. libcommon/scene/surface_tables.h fills them.
#ifndef TDPT_SHADERS_SHARED_COVERAGE_LAYOUT_H
#define TDPT_SHADERS_SHARED_COVERAGE_LAYOUT_H

#include "shaders/shared/records.h"

#include "shaders/shared/language.h"

SHARED_BEGIN

/// An image and its lookup mode. A texel is one word: red in the lowest 8 bits, then green, blue,
/// alpha.
#define TEXELS_OF_TexelGrid(VEC, WORDS, PART) \
  /* first: texel (0,0) */                    \
  /* width: 0: no texture */                  \
  /* how: TEXELS_* */                         \
  WORDS(uint, first, uint, width, uint, height, uint, how)
RECORD(TexelGrid)
#define TEXELS_NEAREST 1u
#define TEXELS_MIRROR_U 2u
#define TEXELS_CLAMP_U 4u
#define TEXELS_MIRROR_V 8u
#define TEXELS_CLAMP_V 16u
#define TEXELS_SRGB 32u  // not for alpha

/// Coverage of a triangle that is not opaque, see coverage_at() of libcommon/scene/texture.h.
#define TEXELS_OF_Coverage(VEC, WORDS, PART)                                          \
  /* u0: texture coordinates of the corners, transformed */                           \
  WORDS(float, u0, float, v0, float, u1, float, v1)                                   \
  /* alpha0: alpha factor of the material times that of the corner */                 \
  WORDS(float, u2, float, v2, float, alpha0, float, alpha1)                           \
  /* cutoff: alpha mask: opaque from this alpha on; below 0: alpha is the coverage */ \
  WORDS(float, alpha2, float, cutoff, uint, pad0, uint, pad1)                         \
  PART(TexelGrid, grid)
RECORD(Coverage)
/// Entry of coverage_of[] for triangles whose coverage is 1 (they may still be panes).
const uint kNoCoverage = 0xFFFFFFFFu;

#ifdef __cplusplus
static_assert(sizeof(TexelGrid) == 16 && sizeof(Coverage) == 64);
#endif

SHARED_END

#include "shaders/shared/language_end.h"

#endif
