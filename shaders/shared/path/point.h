// A vertex of a path as a surface or light point, for kernels and their scalar build: as in
// tools/tdpt-render/path/bsdf/point.h, with indices instead of pointers. Everything is canonical;
// radiance is divided by the power of two that the upload chose.
//
// Densities are per canonical area (pdf_A) unless their name says otherwise.
#ifndef TDPT_SHADERS_SHARED_PATH_POINT_H
#define TDPT_SHADERS_SHARED_PATH_POINT_H

#include "shaders/shared/elementary.h"
#include "shaders/shared/records.h"
#include "shaders/shared/vector.h"

#include "shaders/shared/language.h"

SHARED_BEGIN

const uint kNoTriangle = 0xFFFFFFFFu;

// The end from which a walk comes.
const uint FROM_LIGHT = 0u;
const uint FROM_CAMERA = 1u;

// What light begins at a point.
const uint SOURCE_NONE = 0u;
const uint SOURCE_FRONT = 1u;  ///< a surface that emits on its front
const uint SOURCE_BOTH = 2u;   ///< on both sides
const uint SOURCE_SKY = 3u;
const uint SOURCE_LAMPS = 4u;  ///< lamp source - SOURCE_LAMPS of the table of lamps

#ifdef __cplusplus
using Source = uint;  // code in doubles has its own
#else
#define Source uint
#endif

/// A point is on one side of a portal if it is at least this far from its plane (canonical); for
/// points nearer to it rounding would decide.
const float kPlaneMargin = 2e-6f;

/// Light from infinity is followed from so far before the origin (canonical).
const float kBeforeTheScene = 4.0f;

/// The unit direction back along which a walk arrived at a point; 0: it begins there.
#ifdef __cplusplus
using Arrival = vec3;  // code in doubles has its own
#else
#define Arrival vec3
#endif
SHARED bool begins(Arrival back) {
  return is_zero(back);
}
SHARED Arrival no_arrival() {
  return vec3(0.0f, 0.0f, 0.0f);
}

#define TEXELS_OF_Coat(VEC, WORDS, PART)                                        \
  /* normal: unit, in the shading frame of the surface under it */              \
  /* strength: [0,1]; 0: none */                                                \
  VEC(normal, float, strength)                                                  \
  /* under: average transmittance of interface and coat for the diffuse lobe */ \
  /* alpha: GGX; below 1e-4: smooth */                                          \
  VEC(under, float, alpha)
RECORD(Coat)

/// The BSDF parameters at a point [bsdf.h].
#define TEXELS_OF_Bsdf(VEC, WORDS, PART)                                          \
  /* diffuse: colour under the interface, [0,1] */                                \
  /* thin: 1: transmits straight on, without refraction */                        \
  VEC(diffuse, uint, thin)                                                        \
  /* f0: reflectance of the interface at normal incidence */                      \
  /* f90: the same at grazing incidence (Schlick); 0: no interface */             \
  VEC(f0, float, f90)                                                             \
  /* through: colour of the transmitted light; 0: opaque */                       \
  /* eta: index behind the front side / in front of it; used if it transmits */   \
  VEC(through, float, eta)                                                        \
  /* sheen: colour, [0,1] */                                                      \
  /* sheen_alpha: squared roughness; 0: no sheen */                               \
  VEC(sheen, float, sheen_alpha)                                                  \
  /* dip: correction of a conductor's reflectance near 82 degrees [fresnel.h] */  \
  /* alpha: GGX, [0,1]; below 1e-4, or for |eta - 1| < 1e-4 in a solid: smooth */ \
  VEC(dip, float, alpha)                                                          \
  PART(Coat, coat)
RECORD(Bsdf)

/// Radiance and densities of a direction of the sky.
struct InSky {
  vec3 radiance;
  float plain_w;  ///< density of the sky's directions when sampling by luminance [1/sr]
  float start_w;  ///< density when sampling the start of walks [1/sr]
};

struct Point {
  vec3 position;  ///< at infinity: the unit direction in which the light travels
  vec3 normal;    ///< unit geometric normal of the front side; 0 off surfaces
  vec3 shading;   ///< unit, front side; only if not simple
  uint triangle;  ///< kNoTriangle off surfaces
  uint material;  ///< of a surface
  uint source;    ///< SOURCE_*
  bool simple;    ///< only diffuse, about the geometric normal, by `color`; else see `shading` and
                  ///< `bsdf`
  bool connectible;  ///< some lobe is not Dirac
  vec3 color;
  vec3 emission;  ///< of a surface that emits
  InSky in_sky;   ///< of a point in the sky
  Bsdf bsdf;
};

SHARED bool on_surface(Point p) {
  return p.triangle != kNoTriangle;
}

/// The connection from one point to another.
struct Edge {
  vec3 w;    ///< unit
  float d2;  ///< squared distance; 1 if one end is infinitely far
};
SHARED Edge reversed(Edge e) {
  Edge r;
  r.w = -e.w;
  r.d2 = e.d2;
  return r;
}

/// |cos| to the surface; 1 if not on a surface.
SHARED float cosine_to(Point p, vec3 w) {
  return on_surface(p) ? abs(dot(p.normal, w)) : 1.0f;
}
/// Converts the density pdf_w of leaving along `e` to that of arriving at `to`: pdf_A = pdf_w
/// |cos_to| / d^2.
SHARED float to_area(float pdf_w, Edge e, Point to) {
  return pdf_w * cosine_to(to, e.w) * reciprocal(e.d2);
}
/// G without visibility [1/m2]: |cos_a cos_b| / d^2.
SHARED float geometry(Point a, Point b, Edge e) {
  return cosine_to(a, e.w) * cosine_to(b, e.w) * reciprocal(e.d2);
}
/// A point on the line of light through `p` along unit w that lies `distance` before the origin,
/// and never behind p.
SHARED vec3 before_the_origin(vec3 p, vec3 w, float distance) {
  return p - w * max(dot(p, w) + distance, 1.0f);
}
/// The same before all of the scene's frame, which is within 2 of the origin.
SHARED vec3 before_the_scene(vec3 p, vec3 w) {
  return before_the_origin(p, w, kBeforeTheScene);
}
SHARED bool same_side(Point p, vec3 wi, vec3 wo) {
  return dot(p.normal, wi) * dot(p.normal, wo) > 0.0f;
}

/// Normalisation W of the guiding distribution at a point; 0 if no portal can be aimed at.
struct GuideTotals {
  vec3 facing;  ///< normal on the side of the surface that the path's edges are on; 0: both sides
  float from_light;   ///< for a walk from the light that scatters here
  float from_camera;  ///< for one from the camera
  float emitted;      ///< for a walk that begins here
};

/// What next events know about a point.
struct LightContext {
  vec3 facing;  ///< normal on the side of the surface that light arrives at; 0: both sides
  float seen;   ///< sum S_F of the sky through the windows
  float sent;   ///< by the rectangular lights
};

/// The next direction of a walk.
GENERIC_STRUCT Turn {
  VEC3 w;       ///< unit
  VEC3 weight;  ///< f cos / pdf_w
  bool dirac;
};

/// Lobe probabilities of a walk that scatters at a point.
GENERIC_STRUCT Odds {
  REAL dirac;  ///< that a Dirac lobe is chosen
  REAL broad;  ///< that a lobe is chosen that is not narrow; 1 if some lobe is Dirac
};

SHARED_END

#include "shaders/shared/language_end.h"

#endif
