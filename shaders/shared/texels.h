// Finds the texels for a texture coordinate: bilinear or nearest, with the wrap modes of
// libcommon/scene/texture.cpp, in floats. Also converts texel bytes to [0,1].
#ifndef TDPT_SHADERS_SHARED_TEXELS_H
#define TDPT_SHADERS_SHARED_TEXELS_H

#include "shaders/shared/coverage_layout.h"

#include "shaders/shared/language.h"

SHARED_BEGIN

/// The four texels around a point, and the weights of the second column and row.
struct TexelSpan {
  uint texel00;
  uint texel10;
  uint texel01;
  uint texel11;
  float x;
  float y;
};

/// The greatest even number of images below u; 0 for coordinates that count as 0.
SHARED float whole_images(float u) {
  return 2.0f * floor(0.5f * u);
}

/// Coordinates beyond 1e9 images count as 0.
SHARED float texture_coordinate(float u) {
  return abs(u) < 1e9f ? u : 0.0f;
}

/// A coordinate wrapped into the image, [0,1], or, if mirrored, into the image and its reflection,
/// [0,2].
SHARED float within_image(float u, bool mirror, bool clamp_to_edge) {
  if (clamp_to_edge) return min(max(u, 0.0f), 1.0f);
  float images = mirror ? whole_images(u) : floor(u);
  return u - images;
}

/// Index of the texel `i` texels from the start of a row of `n`, i in [-1, 2n].
SHARED int wrapped_texel(int i, int n, bool mirror, bool clamp_to_edge) {
  if (clamp_to_edge) return min(max(i, 0), n - 1);
  if (mirror) return i < 0 ? 0 : i < n ? i : max(2 * n - 1 - i, 0);
  return i < 0 ? i + n : i >= n ? i - n : i;
}

SHARED TexelSpan texel_span(TexelGrid grid, float u, float v) {
  bool mirror_u = (grid.how & TEXELS_MIRROR_U) != 0u;
  bool mirror_v = (grid.how & TEXELS_MIRROR_V) != 0u;
  bool clamp_u = (grid.how & TEXELS_CLAMP_U) != 0u;
  bool clamp_v = (grid.how & TEXELS_CLAMP_V) != 0u;
  bool nearest = (grid.how & TEXELS_NEAREST) != 0u;
  int width = int(grid.width);
  int height = int(grid.height);
  // The centre of texel i lies at i + 1/2.
  float shift = nearest ? 0.0f : 0.5f;
  float x = within_image(u, mirror_u, clamp_u) * float(width) - shift;
  float y = within_image(v, mirror_v, clamp_v) * float(height) - shift;
  int column = int(floor(x));
  int row = int(floor(y));
  uint column0 = uint(wrapped_texel(column, width, mirror_u, clamp_u));
  uint column1 = uint(wrapped_texel(column + 1, width, mirror_u, clamp_u));
  uint row0 = grid.first + grid.width * uint(wrapped_texel(row, height, mirror_v, clamp_v));
  uint row1 = grid.first + grid.width * uint(wrapped_texel(row + 1, height, mirror_v, clamp_v));
  TexelSpan span;
  span.texel00 = row0 + column0;
  span.texel10 = row0 + column1;
  span.texel01 = row1 + column0;
  span.texel11 = row1 + column1;
  span.x = nearest ? 0.0f : x - floor(x);
  span.y = nearest ? 0.0f : y - floor(y);
  return span;
}

SHARED float bilinear(TexelSpan span, float t00, float t10, float t01, float t11) {
  float low = t00 + (t10 - t00) * span.x;
  float high = t01 + (t11 - t01) * span.x;
  return low + (high - low) * span.y;
}

/// byte / 255, correctly rounded: the first product is exact.
SHARED float share_of_byte(uint byte) {
  float b = float(byte);
  return b * 0.00392150879f + b * 5.9838392e-08f;
}

SHARED_END

#include "shaders/shared/language_end.h"

#endif
