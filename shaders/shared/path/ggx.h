// GGX microfacets in floats [tools/tdpt-render/path/bsdf/ggx.h]. Shading frame, directions unit,
// w.z > 0. What would cancel near the normal or the horizon is written so that it does not.
#ifndef TDPT_SHADERS_SHARED_PATH_GGX_H
#define TDPT_SHADERS_SHARED_PATH_GGX_H

#include "shaders/shared/vector.h"

#include "shaders/shared/language.h"

SHARED_BEGIN

const float kInversePi = 0.318309886f;
const float kSmoothAlpha =
    1.00000005e-4f;                   ///< alpha below it counts as 0: 1e-4f still, as in doubles
const float kMatchedIndices = 1e-4f;  ///< so does alpha where indices differ by less
const float kInSurface = 1e-20f;      ///< directions with a smaller cosine lie in the surface
const float kRoughGrazing = 1e-9f;    ///< a rough interface is not seen at smaller cosines
const float kUprightFacet = 1e-6f;    ///< facets steeper than that: rounding loses their density
const float kNarrowAlpha = 0.3f;  ///< lobes of less are narrow: aims at portals are not for them

/// D [1/sr].
SHARED float ggx_d(vec3 h, float a) {
  float s = a * a * (h.z * h.z) + (h.x * h.x + h.y * h.y);
  float t = a * reciprocal(s);
  return t * t * kInversePi;
}

/// (1 + 2 L(w)) w_z.
SHARED float ggx_stretched(float cosine, float a) {
  return root(a * a + (1.0f - a) * (1.0f + a) * (cosine * cosine));
}

/// G1(w) / w_z; finite down to w_z = 0.
SHARED float ggx_g1_over_cos(float cosine, float a) {
  return 2.0f * reciprocal(cosine + ggx_stretched(cosine, a));
}

/// G2(v, w) / (v_z w_z).
SHARED float ggx_g2_over_cos(float cos_v, float cos_w, float a) {
  return 2.0f * reciprocal(cos_w * ggx_stretched(cos_v, a) + cos_v * ggx_stretched(cos_w, a));
}

/// Normal with density D_w(h) from two uniform numbers in [0,1); 0 in a case of probability 0.
SHARED vec3 ggx_visible_normal(vec3 w, float a, float u, float v) {
  vec3 s = vec3(a * w.x, a * w.y, w.z);
  s = s * inverse_root(max(dot(s, s), 1e-37f));
  float cosine;
  float sine;
  cos_sin_turns(u, cosine, sine);
  float below = v * (1.0f + s.z);  // 1 - z, z the height in the cap
  float hz = (1.0f - v) * (1.0f + s.z);
  float r = root(max(below * (2.0f - below), 0.0f));
  vec3 h = vec3(a * (r * cosine + s.x), a * (r * sine + s.y), hz);
  float l2 = dot(h, h);
  return l2 > 1e-36f ? h * inverse_root(l2) : vec3(0.0f);
}

SHARED_END

#include "shaders/shared/language_end.h"

#endif
