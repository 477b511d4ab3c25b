// Whether a ray is stopped by a surface that is not opaque.
//
// Stochastic transparency: a surface covers a share of each place, its alpha, and stops that share
// of the rays; 1 - coverage is its transmittance. Computed as coverage_at() of
// libcommon/scene/texture.h does, in floats.
//
// Read within a scope that has coverage_of[], coverages[], texels[], scene_has_coverage and
// coverage_has_textures: a GLSL file behind its buffers, or the body of a C++ struct.

#include "shaders/shared/language.h"

SHARED float alpha_texel(Coverage v, int x, int y) MEMBER_CONST {
  return texels[v.first + uint(y) * v.width + uint(x)];
}

/// A coordinate within the image it falls on, or, mirrored, within it and its reflection: [0,1] or
/// [0,2].
SHARED float within_image(float u, bool mirror, bool clamp_to_edge) MEMBER_CONST {
  if (clamp_to_edge) return min(max(u, 0.0f), 1.0f);
  float half_u = 0.5f * u;
  float images = mirror ? 2.0f * floor(half_u) : floor(u);
  float r = u - images;
  return r;
}

/// Index of the texel `i` texels from the start of a row of `n`, i in [-1, 2n].
SHARED int wrapped_texel(int i, int n, bool mirror, bool clamp_to_edge) MEMBER_CONST {
  if (clamp_to_edge) return min(max(i, 0), n - 1);
  if (mirror) return i < 0 ? 0 : i < n ? i : max(2 * n - 1 - i, 0);
  return i < 0 ? i + n : i >= n ? i - n : i;
}

SHARED float alpha_texture(Coverage v, float u, float w) MEMBER_CONST {
  bool mirror_u = (v.how & COVERAGE_MIRROR_U) != 0u;
  bool mirror_v = (v.how & COVERAGE_MIRROR_V) != 0u;
  bool clamp_u = (v.how & COVERAGE_CLAMP_U) != 0u;
  bool clamp_v = (v.how & COVERAGE_CLAMP_V) != 0u;
  bool nearest = (v.how & COVERAGE_NEAREST) != 0u;
  int width = int(v.width);
  int height = int(v.height);
  // The middle of texel i lies at i + 1/2.
  float shift = nearest ? 0.0f : 0.5f;
  float x = within_image(u, mirror_u, clamp_u) * float(width) - shift;
  float y = within_image(w, mirror_v, clamp_v) * float(height) - shift;
  int column = int(floor(x));
  int row = int(floor(y));
  int column0 = wrapped_texel(column, width, mirror_u, clamp_u);
  int row0 = wrapped_texel(row, height, mirror_v, clamp_v);
  float alpha00 = alpha_texel(v, column0, row0);
  if (nearest) return alpha00;
  int column1 = wrapped_texel(column + 1, width, mirror_u, clamp_u);
  int row1 = wrapped_texel(row + 1, height, mirror_v, clamp_v);
  float alpha10 = alpha_texel(v, column1, row0);
  float alpha01 = alpha_texel(v, column0, row1);
  float alpha11 = alpha_texel(v, column1, row1);
  float fx = x - floor(x);
  float fy = y - floor(y);
  float low = alpha00 + (alpha10 - alpha00) * fx;
  float high = alpha01 + (alpha11 - alpha01) * fx;
  float alpha = low + (high - low) * fy;
  return alpha;
}

SHARED float coverage_at(Coverage v, float b1, float b2) MEMBER_CONST {
  // Exact where the corners agree: a mask at its cutoff is there.
  float alpha = v.alpha0 + (v.alpha1 - v.alpha0) * b1 + (v.alpha2 - v.alpha0) * b2;
  if (coverage_has_textures && v.width > 0u) {
    float u = v.u0 + (v.u1 - v.u0) * b1 + (v.u2 - v.u0) * b2;
    float w = v.v0 + (v.v1 - v.v0) * b1 + (v.v2 - v.v0) * b2;
    alpha = alpha * alpha_texture(v, u, w);
  }
  alpha = min(max(alpha, 0.0f), 1.0f);
  if (v.cutoff >= 0.0f) return alpha >= v.cutoff ? 1.0f : 0.0f;
  return alpha;
}

/// Whether `triangle`, which is not opaque, is there for a ray. `coin`: a number of the ray's own.
SHARED bool surface_stops(uint triangle, float b1, float b2, uint coin) MEMBER_CONST {
  if (!scene_has_coverage) return true;
  return hashed_unit(coin, triangle) < coverage_at(coverages[coverage_of[triangle]], b1, b2);
}

#include "shaders/shared/language_end.h"
