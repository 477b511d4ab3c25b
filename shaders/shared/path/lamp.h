// What leaves a lamp, a light without extent: a point, a spot, or parallel light. A spot's smooth
// edge between its cones is the one that KHR_lights_punctual recommends, without its lower bound of
// 0.001 on the difference of the cosines, which narrow spots fall below.
//
// lights_layout.h comes before, which tells what a Lamp is. C++ has one in doubles, too.

#include "shaders/shared/language.h"

/// 1 - cos of the angle between a lamp's axis and unit w.
SHARED REAL versine_from_axis(IN(Lamp) lamp, VEC3 w) MEMBER_CONST {
  VEC3 d = w - lamp.direction;
  return 0.5f * dot(d, d);
}
/// Along unit w: intensity, of parallel light irradiance.
SHARED VEC3 lamp_radiance(IN(Lamp) lamp, VEC3 w) MEMBER_CONST {
  REAL inside = (lamp.edge - versine_from_axis(lamp, w)) * lamp.per_edge;
  REAL share = min(max(inside, 0.0f), 1.0f);
  return lamp.intensity * (share * share);
}
/// Density of the direction w in which a walk leaves [1/sr], uniform within the cone; of parallel
/// light of the line along w [1/canonical area].
SHARED REAL lamp_pdf_w(IN(Lamp) lamp, VEC3 w) MEMBER_CONST {
  return versine_from_axis(lamp, w) > lamp.edge ? REAL(0.0f) : lamp.pdf_w;
}
/// Such a direction, of a lamp that is not infinitely far.
SHARED VEC3 leave_lamp(IN(Lamp) lamp, REAL u, REAL v) MEMBER_CONST {
  REAL cosine = REAL(0);
  REAL sine = REAL(0);
  cos_sin_turns(u, cosine, sine);
  REAL h = v * lamp.cone;
  REAL r = root(h * (2.0f - h));
  VEC3 local = VEC3(r * cosine, r * sine, 1.0f - h);
  return normalized(to_world(onb_about(lamp.direction), local));
}
/// Where light along unit w begins that passes a ball around the origin: on a disc across it.
SHARED VEC3 before_the_disc(VEC3 w, REAL radius, REAL u, REAL v) MEMBER_CONST {
  REAL cosine = REAL(0);
  REAL sine = REAL(0);
  cos_sin_turns(u, cosine, sine);
  REAL r = radius * root(v);
  VEC3 local = VEC3(r * cosine, r * sine, -2.0f * radius);
  return to_world(onb_about(w), local);
}

#include "shaders/shared/language_end.h"
