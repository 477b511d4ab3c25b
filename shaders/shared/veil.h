// Whether a ray finds a surface that is not opaque: alpha as coverage_at() of
// libcommon/scene/texture.h computes it, in floats.
//
// Read within a scope that has veil_of[], veils[] and texels[]: a GLSL file behind its buffers, or
// the body of a C++ struct.

SHARED float veil_texel(Veil v, int x, int y) {
  uint at = v.first + uint(y) * v.width + uint(x);
  uint byte = (texels[at >> 2] >> (8u * (at & 3u))) & 255u;
  EXACT float alpha = float(byte) * 3.92156863e-3f;
  return alpha;
}

/// Texel number `i` of an endless row, wrapped into one of `n`.
SHARED int veil_wrap(int i, int n, bool mirror, bool clamp_to_edge) {
  if (clamp_to_edge) return min(max(i, 0), n - 1);
  int period = mirror ? 2 * n : n;
  int r = i % period;
  r = r < 0 ? r + period : r;
  return r < n ? r : period - 1 - r;
}

SHARED float veil_texture(Veil v, float u, float w) {
  bool mirror_u = (v.how & VEIL_MIRROR_U) != 0u;
  bool mirror_v = (v.how & VEIL_MIRROR_V) != 0u;
  bool clamp_u = (v.how & VEIL_CLAMP_U) != 0u;
  bool clamp_v = (v.how & VEIL_CLAMP_V) != 0u;
  int width = int(v.width);
  int height = int(v.height);
  bool nearest = (v.how & VEIL_NEAREST) != 0u;
  EXACT float shift = nearest ? 0.0f : 0.5f;
  EXACT float x = u * float(width) - shift;
  EXACT float y = w * float(height) - shift;
  EXACT float x0 = min(max(floor(x), -1e9f), 1e9f);
  EXACT float y0 = min(max(floor(y), -1e9f), 1e9f);
  int ix = veil_wrap(int(x0), width, mirror_u, clamp_u);
  int iy = veil_wrap(int(y0), height, mirror_v, clamp_v);
  float first = veil_texel(v, ix, iy);
  if (nearest) return first;
  int jx = veil_wrap(int(x0) + 1, width, mirror_u, clamp_u);
  int jy = veil_wrap(int(y0) + 1, height, mirror_v, clamp_v);
  EXACT float fx = min(max(x - x0, 0.0f), 1.0f);
  EXACT float fy = min(max(y - y0, 0.0f), 1.0f);
  EXACT float low = first + (veil_texel(v, jx, iy) - first) * fx;
  float left = veil_texel(v, ix, jy);
  EXACT float high = left + (veil_texel(v, jx, jy) - left) * fx;
  EXACT float alpha = low + (high - low) * fy;
  return alpha;
}

SHARED float veil_coverage(Veil v, float b1, float b2) {
  EXACT float b0 = 1.0f - b1 - b2;
  EXACT float alpha = v.alpha0 * b0 + v.alpha1 * b1 + v.alpha2 * b2;
  if (v.width > 0u) {
    EXACT float u = v.u0 * b0 + v.u1 * b1 + v.u2 * b2;
    EXACT float w = v.v0 * b0 + v.v1 * b1 + v.v2 * b2;
    EXACT float textured = alpha * veil_texture(v, u, w);
    alpha = textured;
  }
  if (v.cutoff >= 0.0f) return alpha >= v.cutoff ? 1.0f : 0.0f;
  return alpha;
}

/// Whether `triangle`, which is not opaque, is there for a ray. `coin`: a number of the ray's own.
SHARED bool surface_stops(uint triangle, float b1, float b2, uint coin) {
  return unit_float(mixed(coin, triangle)) < veil_coverage(veils[veil_of[triangle]], b1, b2);
}
