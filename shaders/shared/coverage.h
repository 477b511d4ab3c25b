// Decides whether a ray is stopped by a surface that is not fully opaque.
//
// Method: stochastic transparency. A surface stops a share of the rays equal to its coverage
// (alpha); 1 - coverage is its transmittance. The same computation as coverage_at() of
// libcommon/scene/texture.h, in floats.
//
// Include it in a scope that has load_x(i) of TABLES_OF_COVERAGE [tables.h], scene_has_coverage,
// coverage_has_textures and opacity_at(triangle, w), which is 1 if there are no panes: a GLSL file
// after its buffers, or the body of a C++ struct.

#include "shaders/shared/rng.h"
#include "shaders/shared/texels.h"

#include "shaders/shared/language.h"

SHARED float alpha_texel(uint i) MEMBER_CONST {
  return share_of_byte(load_texel_word(i) >> 24);
}

SHARED float coverage_of_place(Coverage v, float b1, float b2) MEMBER_CONST {
  // Exact if the corners agree: an alpha equal to the cutoff counts as opaque.
  float alpha = v.alpha0 + (v.alpha1 - v.alpha0) * b1 + (v.alpha2 - v.alpha0) * b2;
  if (coverage_has_textures && v.grid.width > 0u) {
    float u = v.u0 + (v.u1 - v.u0) * b1 + (v.u2 - v.u0) * b2;
    float w = v.v0 + (v.v1 - v.v0) * b1 + (v.v2 - v.v0) * b2;
    TexelSpan span = texel_span(v.grid, texture_coordinate(u), texture_coordinate(w));
    alpha = alpha * bilinear(span, alpha_texel(span.texel00), alpha_texel(span.texel10),
                             alpha_texel(span.texel01), alpha_texel(span.texel11));
  }
  alpha = min(max(alpha, 0.0f), 1.0f);
  if (v.cutoff >= 0.0f) return alpha >= v.cutoff ? 1.0f : 0.0f;
  return alpha;
}

/// Coverage of a triangle at (b1, b2): the probability that it stops a ray. 1 if it is opaque.
SHARED float coverage_at(uint triangle, float b1, float b2) MEMBER_CONST {
  if (!scene_has_coverage) return 1.0f;
  uint i = load_coverage_index(triangle);
  return i == kNoCoverage ? 1.0f : coverage_of_place(load_coverage(i), b1, b2);
}

/// Whether `triangle`, which does not stop every ray, stops this one. `w`: direction, of any
/// length; `coin`: a random number that belongs to the ray.
SHARED bool surface_stops(uint triangle, float b1, float b2, uint coin, vec3 w) MEMBER_CONST {
  if (!scene_has_coverage && !scene_has_panes) return true;
  return hashed_unit(coin, triangle) < coverage_at(triangle, b1, b2) * opacity_at(triangle, w);
}

#include "shaders/shared/language_end.h"
